#include "picture/shading.h"
#include "picture/composition.h"
#include "picture/surface_corners.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

constexpr int kSize = 64;

/// A wall that fills the picture, with a step: the left half is `step` nearer to the eye.
SurfaceLayer stepped_wall(float step) {
  SurfaceLayer layer(kSize, kSize);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      layer.distance[layer.index(x, y)] = x < kSize / 2 ? 10 - step : 10;
      layer.normal[layer.index(x, y)] = {0, 0, -1};
    }
  }
  return layer;
}

TEST(Shading, FlatWallIsOpenAndTheFootOfAStepIsNot) {
  const auto flat = compute_openness(stepped_wall(0), 0.8f, 100);
  for (const float open : flat) EXPECT_EQ(open, 1);
  const SurfaceLayer wall = stepped_wall(0.5f);
  const auto open = compute_openness(wall, 0.8f, 100);
  EXPECT_LT(open[wall.index(kSize / 2 + 1, 32)], 0.9f);
  EXPECT_GT(open[wall.index(kSize - 2, 32)], open[wall.index(kSize / 2 + 1, 32)]);
  EXPECT_EQ(open[wall.index(4, 32)], 1) << "the upper side of the step";
}

TEST(Shading, NothingThereIsOpen) {
  const SurfaceLayer empty(kSize, kSize);
  for (const float open : compute_openness(empty, 1, 100)) EXPECT_EQ(open, 1);
}

TEST(Shading, LightComesFromAboveAndClosedPlacesAreDark) {
  const Rgb grey = Rgb::Constant(0.5f);
  const Rgb up = shade(grey, {0, -0.7f, -0.7f}, 1), down = shade(grey, {0, 0.7f, -0.7f}, 1);
  EXPECT_GT(up[0], down[0]);
  EXPECT_LT(shade(grey, {0, 0, -1}, 0.2f)[0], shade(grey, {0, 0, -1}, 1)[0]);
  EXPECT_TRUE((shade(grey, {0, 0, -1}, 1) == shade(grey, {0, 0, -5}, 1)).all());
  EXPECT_TRUE(shade(grey, {0, 0, 0}, 1).isFinite().all());
}

TEST(Shading, OutlineRunsOnTheNearSideOfAStep) {
  const SurfaceLayer wall = stepped_wall(1);
  EXPECT_GT(outline_strength(wall, kSize / 2 - 1, 20, 0.5f), 0.2f);
  EXPECT_EQ(outline_strength(wall, kSize / 2, 20, 0.5f), 0);
  EXPECT_EQ(outline_strength(wall, 5, 20, 0.5f), 0);
  EXPECT_EQ(outline_strength(wall, kSize / 2 - 1, 20, 2), 0) << "a step below the size of a feature";
}

TEST(Composition, InnerSurfaceShinesThroughTheBody) {
  PictureLayers layers{stepped_wall(0), SurfaceLayer(kSize, kSize)};
  layers.samples = 2;
  layers.feature = 0.1f;
  layers.samples_at_one = 100;
  const std::size_t inside = layers.inner.index(20, 20);
  const Image plain = compose(layers);
  ASSERT_EQ(plain.width(), kSize / 2);
  layers.inner.distance[inside] = 11;  // behind
  layers.inner.normal[inside] = {0, 0, -1};
  layers.inner.value[inside] = 1;
  const Image through = compose(layers);
  EXPECT_LT(lightness(through.at(10, 10)), lightness(plain.at(10, 10)));
  EXPECT_TRUE((through.at(11, 10) == plain.at(11, 10)).all());
}

TEST(SurfaceCorners, CubeKeepsItsEdgesSharp) {
  // Two faces of a cube at a right angle, two triangles each.
  const std::vector<Vec3> x{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, -1}, {1, 1, -1}};
  const std::vector<VertexTuple<3>> faces{{0, 1, 2}, {0, 2, 3}, {1, 4, 5}, {1, 5, 2}};
  const std::vector<double> value{0.5, -1, 1, 1, 1, 1};
  const Camera camera(x, Vec3(0, 0, 1), {0, 0, 100, 100});
  const auto corners = place_corners(x, faces, camera, 1, value);
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
  const Camera camera(x, Vec3(0, 0, 1), {0, 0, 100, 100});
  const auto corners = place_corners(x, faces, camera, 1, std::vector<double>(6, -1));
  // The corner at vertex 1 is the same for the triangles on both sides of the bend.
  EXPECT_LT((corners[1].normal - corners[6].normal).norm(), 1e-6f);
  EXPECT_GT((corners[0].normal - corners[1].normal).norm(), 0.05f);
}

}  // namespace
}  // namespace selvage
