#include "picture/drawing/shading.h"
#include "picture/composing/composition.h"
#include "picture/composing/surface_corners.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

constexpr int kSize = 64;

/// A wall that fills the picture, with a step: the left half is `step` nearer to the eye.
SurfaceLayer stepped_wall(float step) {
  SurfaceLayer layer(kSize, {0, kSize});
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      layer.distance[layer.index(x, y)] = x < kSize / 2 ? 10 - step : 10;
      layer.normal[layer.index(x, y)] = {0, 0, -1};
    }
  }
  return layer;
}

TEST(Shading, FlatWallIsOpenAndTheFootOfAStepIsNot) {
  const LightField flat(stepped_wall(0), {}, 0.8f, 100);
  for (float y = 0; y < kSize; y += 0.25f)
    for (float x = 0; x < kSize; x += 0.25f) EXPECT_EQ(flat.at(x, y, 10).open, 1);
  const LightField open(stepped_wall(0.5f), {}, 0.8f, 100);
  const float foot = open.at(kSize / 2 + 1.5f, 32.5f, 10).open;
  EXPECT_LT(foot, 0.9f);
  EXPECT_GT(open.at(kSize - 1.5f, 32.5f, 10).open, foot);
  EXPECT_EQ(open.at(4.5f, 32.5f, 9.5f).open, 1) << "the upper side of the step";
}

TEST(Shading, NothingThereIsOpen) {
  const LightField nowhere, empty(SurfaceLayer(kSize, {0, kSize}), {}, 1, 100);
  for (const float x : {0.f, 7.f, kSize - 0.1f}) {
    EXPECT_EQ(nowhere.at(x, 3, 1).open, 1);
    EXPECT_EQ(empty.at(x, 3, 1).open, 1);
  }
}

TEST(Shading, LightComesFromAboveAndClosedPlacesAreDark) {
  const Rgb grey = Rgb::Constant(0.5f);
  const Rgb up = shade(grey, {0, -0.7f, -0.7f}, {}), down = shade(grey, {0, 0.7f, -0.7f}, {});
  EXPECT_GT(up[0], down[0]);
  EXPECT_LT(shade(grey, {0, 0, -1}, {0.2f, 1, 1})[0], shade(grey, {0, 0, -1}, {})[0]);
  EXPECT_TRUE((shade(grey, {0, 0, -1}, {}) == shade(grey, {0, 0, -5}, {})).all());
  EXPECT_TRUE(shade(grey, {0, 0, 0}, {}).isFinite().all());
}

TEST(Shading, OutlineRunsOnTheNearSideOfAStep) {
  const SurfaceLayer wall = stepped_wall(1);
  EXPECT_GT(outline_strength(wall, kSize / 2 - 1, 20, 0.5f), 0.2f);
  EXPECT_EQ(outline_strength(wall, kSize / 2, 20, 0.5f), 0);
  EXPECT_EQ(outline_strength(wall, 5, 20, 0.5f), 0);
  EXPECT_EQ(outline_strength(wall, kSize / 2 - 1, 20, 2), 0) << "a step below the size of a feature";
}

/// Two triangles that cover (x0, y0) to (x1, y1) at this distance.
ScreenSurface rectangle(float x0, float y0, float x1, float y1, float distance, float value) {
  const auto corner = [&](float x, float y) { return ScreenVertex{x, y, distance, {0, 0, -1}, value, 1}; };
  return {{corner(x0, y0), corner(x1, y0), corner(x1, y1), corner(x0, y1)}, {{0, 1, 2}, {0, 2, 3}}};
}

TEST(Composition, InnerSurfaceShinesThroughTheBody) {
  PictureContent content{32, 32, 2, rectangle(0, 0, 32, 32, 10, 0), {}};
  content.feature = 0.1f;
  content.pixels_at_one = 50;
  const Image plain = compose(content);
  ASSERT_EQ(plain.width(), 32);
  content.inner = rectangle(10, 10, 11, 11, 11, 1);  // behind
  const Image through = compose(content);
  EXPECT_LT(lightness(through.at(10, 10)), lightness(plain.at(10, 10)));
  EXPECT_TRUE((through.at(11, 10) == plain.at(11, 10)).all());
}

TEST(SurfaceCorners, CubeKeepsItsEdgesSharp) {
  // Two faces of a cube at a right angle, two triangles each.
  const std::vector<Vec3> x{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, -1}, {1, 1, -1}};
  const std::vector<VertexTuple<3>> faces{{0, 1, 2}, {0, 2, 3}, {1, 4, 5}, {1, 5, 2}};
  const std::vector<double> value{0.5, -1, 1, 1, 1, 1};
  View view;
  view.towards = Vec3(0, 0, 1);
  const Camera camera(x, view, {0, 0, 100, 100});
  const auto corners = place_corners({x, faces, value}, camera);
  ASSERT_EQ(corners.size(), 12u);
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(corners[i].normal[2], -1, 1e-6f) << "the face turned to the eye";
  for (int i = 6; i < 12; ++i) EXPECT_NEAR(corners[i].normal[0], 1, 1e-6f) << "the face turned to the right";
  EXPECT_EQ(corners[0].value, 0.5f);
  EXPECT_EQ(corners[0].weight, 1);
  EXPECT_EQ(corners[1].value, 0);
  EXPECT_EQ(corners[1].weight, 0);
}

TEST(SurfaceCorners, GentleBendIsSmooth) {
  const std::vector<Vec3> x{{0, 0, 0}, {1, 0, 0.2}, {1, 1, 0.2}, {0, 1, 0}, {2, 0, 0}, {2, 1, 0}};
  const std::vector<VertexTuple<3>> faces{{0, 1, 2}, {0, 2, 3}, {1, 4, 5}, {1, 5, 2}};
  View view;
  view.towards = Vec3(0, 0, 1);
  const Camera camera(x, view, {0, 0, 100, 100});
  const auto corners = place_corners({x, faces}, camera);
  // The corner at vertex 1 is the same for the triangles on both sides of the bend.
  EXPECT_LT((corners[1].normal - corners[6].normal).norm(), 1e-6f);
  EXPECT_GT((corners[0].normal - corners[1].normal).norm(), 0.05f);
}

}  // namespace
}  // namespace selvage
