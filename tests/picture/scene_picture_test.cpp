#include "picture/scene_picture.h"
#include "picture/camera_path.h"
#include "picture/composing/palette.h"
#include "picture/drawing/covered_samples.h"
#include "picture/vertex_values.h"
#include "selvage/core/error.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <numbers>
#include <random>

namespace selvage {
namespace {

/// Adds a closed box, triangles outward.
void add_box(std::vector<Vec3>& x, DrawnScene& scene, const Vec3& lower, const Vec3& upper, Index body) {
  const auto first = static_cast<Index>(x.size());
  for (int i = 0; i < 8; ++i)
    x.push_back({(i & 1 ? upper : lower)[0], (i & 2 ? upper : lower)[1], (i & 4 ? upper : lower)[2]});
  for (const auto& [a, b, c, d] : std::vector<std::array<Index, 4>>{
           {0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
    scene.surface.push_back({first + a, first + b, first + c});
    scene.surface.push_back({first + a, first + c, first + d});
  }
  scene.bodies.resize(x.size(), body);
  scene.vertex_count = x.size();
}

SceneView small_view(const Vec3& towards = {0.5, -1, 0.5}) {
  SceneView view;
  view.width = 160;
  view.height = 120;
  view.view.towards = towards;
  return view;
}

bool is_white(const Rgb& c) {
  return (c > 0.995f).all();
}

/// Pixels whose colour is nearer in direction to a body's than to grey, as shading only darkens.
int count_pixels(const Image& image, const Rgb& colour) {
  const Rgb wanted = colour / std::sqrt(colour.square().sum());
  int count = 0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const Rgb& c = image.at(x, y);
      count += (c * wanted).sum() > 0.97f * std::sqrt(c.square().sum()) && !is_white(c);
    }
  return count;
}

double colour_change(const Image& a, const Image& b) {
  double sum = 0;
  for (int y = 0; y < a.height(); ++y)
    for (int x = 0; x < a.width(); ++x) sum += (a.at(x, y) - b.at(x, y)).abs().sum();
  return sum;
}

TEST(CoveredSamples, TrianglesOfAFanCoverEachSampleOnce) {
  std::mt19937 random(5);
  std::uniform_int_distribution<int> anywhere(0, 40 * kSubsamples), on_grid(0, 80);
  for (int trial = 0; trial < 300; ++trial) {
    // A square by four triangles around a point inside, also on sample centres and edges.
    FixedPoint middle{anywhere(random), anywhere(random)};
    if (trial % 2) middle = {on_grid(random) * (kSubsamples / 2), on_grid(random) * (kSubsamples / 2)};
    const int side = 40 * kSubsamples, half = kSubsamples / 2;
    const std::array<FixedPoint, 4> corner{
        {{half, half}, {side - half, half}, {side - half, side - half}, {half, side - half}}};
    std::vector<int> count(40 * 40, 0);
    int signed_sum = 0;
    for (int i = 0; i < 4; ++i) {
      const FixedPoint &a = corner[i], &b = corner[(i + 1) % 4];
      const bool turned = (b.x - a.x) * (middle.y - a.y) - (b.y - a.y) * (middle.x - a.x) < 0;
      visit_covered_samples(a, b, middle, 40, {0, 40}, [&](int x, int y, float sa, float sb, float sc) {
        count[y * 40 + x] += turned ? -1 : 1;
        signed_sum += turned ? -1 : 1;
        EXPECT_NEAR(sa + sb + sc, 1, 1e-4);
        EXPECT_GE(std::min({sa, sb, sc}), 0);
      });
    }
    // A point outside folds triangles over: what they cover twice, they cover once with each sign.
    for (const int n : count) EXPECT_TRUE(n == 0 || n == 1) << trial;
    EXPECT_EQ(signed_sum, 39 * 39) << trial;
  }
}

TEST(ScenePicture, ShowsBodiesInTheirColoursOnWhite) {
  std::vector<Vec3> x;
  DrawnScene scene;
  add_box(x, scene, {0, 0, 0}, {1, 1, 1}, 0);
  add_box(x, scene, {2, 0, 0}, {3, 1, 1}, 1);
  const Image image = ScenePictures(scene, small_view()).draw(x, 0);
  EXPECT_GT(count_pixels(image, body_colour(0)), 1000);
  EXPECT_GT(count_pixels(image, body_colour(1)), 1000);
  EXPECT_EQ(count_pixels(image, body_colour(2)), 0);
  for (const int corner : {0, 159}) EXPECT_TRUE(is_white(image.at(corner, 0)));
}

TEST(ScenePicture, SameForAnyNumberOfThreads) {
  std::vector<Vec3> x;
  DrawnScene scene;
  add_box(x, scene, {0, 0, 0}, {1, 1, 1}, 0);
  scene.colliders.push_back({Bowl{{0, 0, 2}, {0, 0, 1}, 2.5}});
  SceneView view = small_view();
  view.cut = AxisCut{1, 0.4};
  const Image many = ScenePictures(scene, view).draw(x, 0);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(colour_change(many, ScenePictures(scene, view).draw(x, 0)), 0);
}

TEST(ScenePicture, ShadowsFallOnTheGroundOnlyWhereThereIsOne) {
  std::vector<Vec3> x;
  DrawnScene scene;
  add_box(x, scene, {0, 0, 0.3}, {1, 1, 1}, 0);
  scene.colliders.push_back({PlaneShape{}});
  const auto shaded = [&] {
    const Image image = ScenePictures(scene, small_view()).draw(x, 0);
    int count = 0;
    for (int y = 0; y < image.height(); ++y)
      for (int p = 0; p < image.width(); ++p) {
        const Rgb& c = image.at(p, y);
        count += c.maxCoeff() - c.minCoeff() < 1e-4f && c[0] < 0.9f && c[0] > 0.05f;
      }
    return count;
  };
  EXPECT_GT(shaded(), 300);
  scene.colliders.clear();
  scene.ground = false;
  EXPECT_EQ(shaded(), 0);
}

TEST(ScenePicture, ColoursByValuesWithALegend) {
  std::vector<Vec3> x;
  DrawnScene scene;
  scene.ground = false;
  add_box(x, scene, {0, 0, 0}, {1, 1, 1}, 0);
  add_box(x, scene, {2, 0, 0}, {3, 1, 1}, 1);
  std::vector<double> values(8, 0);
  values.resize(16, 4);
  ColourScale scale{4, "speed [m/s]", false, {}};
  SceneView view = small_view();
  view.scale = &scale;
  const Image image = ScenePictures(scene, view).draw(x, 0, values);
  EXPECT_GT(count_pixels(image, value_colour(0)), 500);
  EXPECT_GT(count_pixels(image, value_colour(1)), 500);
  EXPECT_EQ(count_pixels(image, body_colour(1)), 0);
  // The bar of the legend, from dark to light.
  EXPECT_LT(lightness(image.at(143, 88)), 0.35f);
  EXPECT_GT(lightness(image.at(143, 31)), 0.85f);
  // 0 may mean that there is no value.
  scale.grey_at_zero = true;
  EXPECT_LT(count_pixels(ScenePictures(scene, view).draw(x, 0, values), value_colour(0)), 200);
  // Or values are numbers of names.
  const std::vector<double> kinds{0, 0, 0, 0, 0, 0, 0, 0, 6, 6, 6, 6, 6, 6, 6, 6};
  ColourScale names{1, "", false, {"free", "", "", "", "", "", "vertex and face"}};
  view.scale = &names;
  EXPECT_GT(count_pixels(ScenePictures(scene, view).draw(x, 0, kinds), contact_colour(6)), 500);
}

TEST(ScenePicture, TurnsAboutTheVertical) {
  std::vector<Vec3> x;
  DrawnScene scene;
  add_box(x, scene, {0, 0, 0}, {3, 1, 1}, 0);
  ScenePictures pictures(scene, small_view());
  pictures.add_frame(x, 0);
  const View first = pictures.turned_view(0), quarter = pictures.turned_view(std::numbers::pi / 2);
  const Vec3 middle(1.5, 0.5, 0.5);
  EXPECT_NEAR((*first.target - middle).norm(), 0, 1e-12);
  const Vec3 a = *first.eye - middle, b = *quarter.eye - middle;
  EXPECT_NEAR((Vec3(-a[1], a[0], a[2]) - b).norm(), 0, 1e-9);
  // All is seen from all sides: the outermost pixels stay white but for the floor's shadow.
  for (const double angle : {0.0, 1.0, 2.0, 4.0}) {
    pictures.look(pictures.turned_view(angle));
    const Image image = pictures.draw(x, 0);
    EXPECT_GT(count_pixels(image, body_colour(0)), 500);
    for (int i = 0; i < image.width(); ++i) EXPECT_TRUE(is_white(image.at(i, 0)));
  }
}

TEST(CameraPath, IsStraightBetweenKeysAndRestsOutside) {
  std::vector<CameraKey> keys(2);
  keys[0] = {10, {}};
  keys[0].view.eye = Vec3(0, 0, 0);
  keys[0].view.target = Vec3(1, 0, 0);
  keys[0].view.angle = 30;
  keys[1] = {20, {}};
  keys[1].view.eye = Vec3(0, 4, 0);
  keys[1].view.target = Vec3(1, 0, 2);
  keys[1].view.angle = 50;
  EXPECT_EQ(*view_at(keys, 5).eye, Vec3(0, 0, 0));
  EXPECT_EQ(*view_at(keys, 12.5).eye, Vec3(0, 1, 0));
  EXPECT_EQ(*view_at(keys, 15).target, Vec3(1, 0, 1));
  EXPECT_EQ(view_at(keys, 15).angle, 40);
  EXPECT_EQ(*view_at(keys, 20).eye, Vec3(0, 4, 0));
  EXPECT_EQ(*view_at(keys, 99).eye, Vec3(0, 4, 0));
}

TEST(VertexValues, StrainIsThatOfTheDirectionThatIsStrainedMost) {
  const std::vector<Vec3> rest{{0, 0, 0}, {1, 0, 0}, {0.3, 1, 0}, {9, 9, 9}};
  const std::vector<VertexTuple<3>> triangle{{0, 1, 2}};
  // Twice as long in x, half in y, then turned.
  const std::vector<Vec3> now{{5, 0, 0}, {5, 0, -2}, {5, 0.5, -0.6}, {0, 0, 0}};
  const auto strains = vertex_strains(rest, now, triangle);
  for (int v = 0; v < 3; ++v) EXPECT_NEAR(strains[static_cast<std::size_t>(v)], 1, 1e-12);
  EXPECT_EQ(strains[3], 0);
  std::vector<Vec3> small = rest;
  for (Vec3& p : small) p *= 0.25;
  EXPECT_NEAR(vertex_strains(rest, small, triangle)[0], 0.75, 1e-12);
  EXPECT_EQ(vertex_strains(std::vector<Vec3>(4, Vec3::Zero()), now, triangle)[0], 0) << "no area at rest";
}

TEST(ScenePicture, CutShowsCapsAndMarksOverlaps) {
  std::vector<Vec3> x;
  DrawnScene scene;
  scene.ground = false;
  add_box(x, scene, {0, 0, 0}, {1, 1, 1}, 0);
  SceneView view = small_view({0, -1, 0});
  view.cut = AxisCut{1, 0.5};
  const Image one = ScenePictures(scene, view).draw(x, 0);
  EXPECT_GT(count_pixels(one, cap_colour(0)), 5000);
  EXPECT_EQ(count_pixels(one, mark_colour()), 0);
  view.cut = AxisCut{1, -0.5};
  EXPECT_EQ(
      colour_change(ScenePictures(scene, view).draw(x, 0), ScenePictures(scene, small_view({0, -1, 0})).draw(x, 0)), 0);
  view.cut = AxisCut{1, 0.5};
  add_box(x, scene, {0.5, 0, 0}, {1.5, 1, 1}, 1);
  const Image both = ScenePictures(scene, view).draw(x, 0);
  EXPECT_GT(count_pixels(both, mark_colour()), 1500);
  EXPECT_GT(count_pixels(both, cap_colour(0)), 1500);
  EXPECT_GT(count_pixels(both, cap_colour(1)), 1500);
}

TEST(ScenePicture, OpenSurfacesHaveNoCaps) {
  const std::vector<Vec3> x{{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}, {0, 1, 0}, {1, 1, 0}};
  DrawnScene scene;
  scene.ground = false;
  scene.vertex_count = 6;
  scene.surface = {{0, 1, 2}, {0, 2, 3}, {0, 4, 5}, {0, 5, 1}};
  scene.number_pieces();
  SceneView view = small_view({0.3, -1, 0.3});
  view.cut = AxisCut{1, 0.5};
  const Image image = ScenePictures(scene, view).draw(x, 0);
  EXPECT_EQ(count_pixels(image, mark_colour()), 0);
  EXPECT_GT(count_pixels(image, body_colour(0)), 500);
}

TEST(ScenePicture, ContainersDoNotHideTheirContents) {
  std::vector<Vec3> x;
  DrawnScene scene;
  add_box(x, scene, {0, 0, 0}, {1, 1, 1}, 0);
  const int alone = count_pixels(ScenePictures(scene, small_view()).draw(x, 0), body_colour(0));
  scene.colliders.push_back({BoxContainer{{-0.2, -0.2, 0}, {1.2, 1.2, 50}}});
  const Image boxed = ScenePictures(scene, small_view()).draw(x, 0);
  EXPECT_GT(count_pixels(boxed, body_colour(0)), alone / 4) << "smaller, as the walls are shown too";
  scene.colliders[0].shape = SphereShape{{0.5, -1.5, 0.5}, 0.6};
  EXPECT_LT(count_pixels(ScenePictures(scene, small_view()).draw(x, 0), body_colour(0)), alone / 2);
}

TEST(ScenePicture, SheetHidesTheEdgesOfAColliderThatItLiesOn) {
  const std::vector<Vec3> x{{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}};
  DrawnScene scene;
  scene.ground = false;
  scene.vertex_count = 4;
  scene.surface = {{0, 1, 2}, {0, 2, 3}};
  scene.number_pieces();
  const auto red_along_the_middle = [&](double gap) {
    scene.colliders = {{CylinderShape{{0.5, 0.2 + gap, 0.5}, {0, 1, 0}, 0.3, 0.4}}};
    const Image image = ScenePictures(scene, small_view({0, -1, 0})).draw(x, 0);
    float most = 0;
    for (int i = 40; i < 120; ++i) most = std::max(most, image.at(i, 60)[0]);
    return most;
  };
  EXPECT_LT(red_along_the_middle(0.002), 0.005f) << "all is the blue of the sheet";
  EXPECT_GT(red_along_the_middle(-0.002), 0.2f) << "before the sheet it is seen";
}

TEST(ScenePicture, CameraMayStandInsideTheScene) {
  std::vector<Vec3> x;
  DrawnScene scene;
  for (int i = 0; i < 4; ++i) add_box(x, scene, {2.0 * i, 0, 0}, {2.0 * i + 1, 1, 1}, i);
  scene.colliders.push_back({PlaneShape{}});
  SceneView view = small_view();
  view.view.eye = Vec3(3, -0.8, 0.7);
  view.view.target = Vec3(9, 0.5, 0.5);
  view.view.angle = 60;
  const Image image = ScenePictures(scene, view).draw(x, 0);
  EXPECT_EQ(count_pixels(image, body_colour(0)), 0) << "behind the eye";
  EXPECT_GT(count_pixels(image, body_colour(2)), 500);
  for (int y = 0; y < image.height(); ++y)
    for (int p = 0; p < image.width(); ++p) EXPECT_TRUE(image.at(p, y).isFinite().all());
}

TEST(ScenePicture, ColoursByPieceAndRefusals) {
  std::vector<Vec3> x;
  DrawnScene scene;
  add_box(x, scene, {0, 0, 0}, {1, 1, 1}, 0);
  add_box(x, scene, {2, 0, 0}, {3, 1, 1}, 0);
  scene.number_pieces();
  EXPECT_EQ(scene.bodies[0], 0);
  EXPECT_EQ(scene.bodies[15], 1);
  SceneView tiny = small_view();
  tiny.width = 10;
  EXPECT_THROW(ScenePictures(scene, tiny), Error);
  scene.surface.clear();
  EXPECT_THROW(ScenePictures(scene, small_view()), Error);
}

TEST(ColliderParts, LieOnTheirShapesAndMove) {
  const Room room{{-1, -1, -1}, {1, 1, 1}};
  Collider sphere{SphereShape{{1, 2, 3}, 0.5}};
  sphere.motion.keyframes = {{0, {0, 0, 0}, 0}, {1, {0, 0, 2}, 0}};
  for (const double time : {0.0, 0.5, 1.0})
    for (const Vec3& p : make_collider_part(sphere, time, room).positions)
      EXPECT_NEAR((p - Vec3(1, 2, 3 + 2 * time)).norm(), 0.5, 1e-12);
  for (const Vec3& p : make_collider_part({Bowl{{0, 0, 0}, {0, 1, 1}, 2}}, 0, room).positions) {
    EXPECT_NEAR(p.norm(), 2, 1e-12);
    EXPECT_LT(p.dot(Vec3(0, 1, 1)), 1e-9);
  }
  const ColliderPart box = make_collider_part({BoxContainer{{-1, -1, -1}, {1, 1, 100}}}, 0, room);
  EXPECT_EQ(box.triangles.size(), 10u) << "open above: the wall there is far away";
  EXPECT_TRUE(box.one_sided);
  const ColliderPart rod = make_collider_part({CylinderShape{{0, 0, 0}, {1, 0, 0}, 0.2, 3}}, 0, room);
  double volume = 0;
  for (const auto& [a, b, c] : rod.triangles)
    volume += rod.positions[a].dot(rod.positions[b].cross(rod.positions[c])) / 6;
  EXPECT_NEAR(volume, 3.14159 * 0.04 * 3, 2e-3) << "outward";
}

TEST(ColliderParts, GroundIsTheHighestFloor) {
  const Room room{{-1, -1, -0.5}, {1, 1, 2}};
  const std::vector<Collider> floors{{PlaneShape{{0, 0, -2}, {0, 0, 1}}},
                                     {PlaneShape{{0, 0, -1}, {0, 0, 1}}},
                                     {PlaneShape{{0, 0, 5}, {0, 0, 1}}},
                                     {PlaneShape{{0, 0, 0}, {0.5, 0, 0.8}}}};
  EXPECT_EQ(find_ground(floors, room).plane, 1u);
  EXPECT_LT(find_ground(floors, room).height, -1);  // thin cloth on it is seen
  EXPECT_NEAR(find_ground(floors, room).height, -1, 0.01);
  EXPECT_EQ(find_ground({}, room).height, -0.5);
  const std::vector<Collider> box{{BoxContainer{{-3, -3, -0.7}, {3, 3, 9}}}};
  EXPECT_TRUE(find_ground(box, room).walled);
}

}  // namespace
}  // namespace selvage
