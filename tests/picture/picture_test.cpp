#include "picture/paths_picture.h"

#include "picture/drawing/camera.h"
#include "picture/drawing/ink.h"
#include "picture/drawing/raster.h"
#include "picture/legend.h"
#include "selvage/core/error.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

namespace selvage {
namespace {

TEST(Colour, SrgbBytesSurvive) {
  for (int value = 0; value < 256; ++value) {
    const auto byte = static_cast<std::uint8_t>(value);
    EXPECT_EQ(to_srgb(from_srgb(byte, 0, 255)), (std::array<std::uint8_t, 3>{byte, 0, 255}));
  }
  EXPECT_EQ(to_srgb(Rgb(-1, 2, 0)), (std::array<std::uint8_t, 3>{0, 255, 0}));
}

TEST(Colour, OklabLightnessSurvives) {
  for (const float l : {0.2f, 0.5f, 0.9f}) EXPECT_NEAR(lightness(from_oklab(l, 0.02f, -0.03f)), l, 1e-3f);
}

TEST(Colour, DepthsGetDarkerByEqualSteps) {
  for (int i = 0; i < 20; ++i) {
    const float t = static_cast<float>(i) / 20;
    const float step = lightness(depth_colour(t)) - lightness(depth_colour(t + 0.05f));
    EXPECT_GT(step, 0.01f) << t;
    EXPECT_LT(step, 0.05f) << t;
  }
  EXPECT_TRUE((depth_colour(-1) == depth_colour(0)).all());
  EXPECT_TRUE((depth_colour(7) == depth_colour(1)).all());
}

View from_above() {
  View view;
  view.towards = Vec3(0, 0, 1);
  return view;
}

TEST(Camera, ShowsAllPointsAsLargeAsTheFrameAllows) {
  const std::vector<Vec3> points{{0, 0, 0}, {3, 0, 0}, {0, 2, 0}, {0, 0, 1}, {-1, -1, -1}};
  const Frame frame{10, 20, 310, 220};
  for (const Vec3& towards : {Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(1, 2, 3), Vec3(0, -1, 0)}) {
    View view;
    view.towards = towards;
    const Camera camera(points, view, frame);
    double left = INFINITY, right = -INFINITY, top = INFINITY, bottom = -INFINITY;
    for (const Vec3& p : points) {
      const Vec3 at = camera.project(p);
      EXPECT_GT(at[2], 0);
      left = std::min(left, at[0]), right = std::max(right, at[0]);
      top = std::min(top, at[1]), bottom = std::max(bottom, at[1]);
    }
    EXPECT_GE(left, 10 - 1e-9);
    EXPECT_LE(right, 310 + 1e-9);
    EXPECT_GE(top, 20 - 1e-9);
    EXPECT_LE(bottom, 220 + 1e-9);
    EXPECT_NEAR(std::max((right - left) / 300, (bottom - top) / 200), 1, 1e-9);
  }
}

TEST(Camera, LooksAtAPlaneWithXToTheRightAndYUp) {
  const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const Camera camera(points, from_above(), {0, 0, 100, 100});
  EXPECT_GT(camera.project(points[1])[0], camera.project(points[0])[0]);
  EXPECT_LT(camera.project(points[2])[1], camera.project(points[0])[1]);
  EXPECT_GT(camera.project({0, 0, -1})[2], camera.project({0, 0, 1})[2]);
}

ScreenVertex corner(float x, float y, float distance, float value = 0, float weight = 1) {
  return {x, y, distance, {0, 0, -1}, value, weight};
}

TEST(Raster, NearestTriangleIsSeenAndAllAreCounted) {
  const ScreenSurface surface{{corner(0, 0, 5, 1), corner(40, 0, 5, 1), corner(0, 40, 5, 1), corner(0, 0, 3, 2),
                               corner(20, 0, 3, 2), corner(0, 20, 3, 2)},
                              {{3, 4, 5}, {0, 1, 2}}};
  SurfaceLayer layer(50, {0, 50});
  draw_surface(surface, layer);
  const auto at = [&](int x, int y) { return layer.index(x, y); };
  EXPECT_FLOAT_EQ(layer.value[at(5, 5)], 2);
  EXPECT_EQ(layer.count[at(5, 5)], 2);
  EXPECT_FLOAT_EQ(layer.value[at(15, 15)], 1);
  EXPECT_FLOAT_EQ(layer.distance[at(15, 15)], 5);
  EXPECT_EQ(layer.count[at(15, 15)], 1);
  EXPECT_FALSE(layer.covers(at(30, 30)));
  EXPECT_NEAR(layer.edge[at(10, 0)], 0.5f, 1e-5f);
}

TEST(Raster, CoversHalfASquareAndDropsWhatHasNoWeight) {
  const std::vector<ScreenVertex> vertices{corner(0, 0, 1), corner(64, 0, 1), corner(0, 64, 1),
                                           corner(64, 64, 1, 0, 0)};
  SurfaceLayer half(64, {0, 64}), quarter(64, {0, 64});
  draw_surface({vertices, {{0, 1, 2}}}, half);
  draw_surface({vertices, {{1, 3, 2}}}, quarter);
  int in_half = 0, in_quarter = 0;
  for (std::size_t i = 0; i < half.distance.size(); ++i) {
    in_half += half.covers(i);
    in_quarter += quarter.covers(i);
  }
  EXPECT_NEAR(in_half, 64 * 64 / 2, 64);
  EXPECT_NEAR(in_quarter, 64 * 64 / 2 * 3 / 4, 96);  // all but the corner of weight 0, cut off in the middle
}

TEST(Raster, NormalsAreTurnedTowardsTheEye) {
  std::vector<ScreenVertex> vertices{corner(0, 0, 1), corner(9, 0, 1), corner(0, 9, 1)};
  for (ScreenVertex& v : vertices) v.normal = {0.6f, 0, 0.8f};
  SurfaceLayer layer(9, {0, 9});
  draw_surface({vertices, {{0, 1, 2}}}, layer);
  EXPECT_LT(layer.normal[layer.index(2, 2)][2], 0);
}

TEST(Raster, BandsWithTheirMarginsAreTheRowsOfTheWhole) {
  ScreenSurface surface;
  for (int i = 0; i < 40; ++i) {  // of all sizes, some of them outside
    const auto x = static_cast<float>(i * 7 % 60 - 5), y = static_cast<float>(i * 11 % 70 - 10);
    const auto size = static_cast<float>(1 + i), distance = static_cast<float>(1 + i % 9);
    surface.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    for (const ScreenVertex& v : {corner(x, y, distance), corner(x + size, y, 2), corner(x, y + size / 2, distance)})
      surface.vertices.push_back(v);
  }
  constexpr int kHeight = 50, kMargin = 3;
  for (const int samples : {1, 3}) {
    SurfaceLayer whole(50 * samples, {0, kHeight * samples}, samples);
    draw_surface(surface, whole);
    const SurfaceBands bands(surface, kHeight, 8, kMargin);
    ASSERT_EQ(bands.count(), 7u);
    int rows = 0;
    for (std::size_t band = 0; band < bands.count(); ++band) {
      const Rows own = bands.rows(band);
      rows += own.last - own.first;
      SurfaceLayer layer(50 * samples,
                         {std::max(0, own.first - kMargin) * samples, std::min(kHeight, own.last + kMargin) * samples},
                         samples);
      bands.draw(band, layer);
      EXPECT_FALSE(bands.is_empty(band));
      EXPECT_TRUE(std::equal(layer.distance.begin(), layer.distance.end(),
                             whole.distance.begin() + static_cast<std::ptrdiff_t>(whole.index(0, layer.rows.first))));
      EXPECT_TRUE(std::equal(layer.count.begin(), layer.count.end(),
                             whole.count.begin() + static_cast<std::ptrdiff_t>(whole.index(0, layer.rows.first))));
    }
    EXPECT_EQ(rows, kHeight);
  }
}

TEST(Ink, StrokeIsAsWideAsItsRadiusSays) {
  Image image(40, 20, Rgb::Ones());
  draw_strokes(image, std::vector<Stroke>{{{5, 10}, {35, 10}, 3}}, Rgb::Zero());
  float ink = 0;
  for (int y = 0; y < 20; ++y) ink += 1 - image.at(20, y)[0];
  EXPECT_NEAR(ink, 6, 1e-3f);
  EXPECT_EQ(image.at(20, 2)[0], 1);
}

TEST(Ink, EveryLetterThatLegendsUseIsDrawn) {
  for (const char letter : std::string("abcdefghijklmnopqrstuvwxyz0123456789.,:-+=/[]()")) {
    Image image(40, 40, Rgb::Ones());
    const std::string text(1, letter);
    draw_strokes(image, write_text(text, {12, 26}, 12, 1), Rgb::Zero());
    int dark = 0;
    for (int y = 0; y < 40; ++y) {
      for (int x = 0; x < 40; ++x) dark += image.at(x, y)[0] < 0.5f;
    }
    EXPECT_GT(dark, 2) << letter;
    EXPECT_LT(dark, 200) << letter;
  }
  EXPECT_TRUE(write_text(" ", {0, 0}, 10, 1).empty());
  EXPECT_EQ(write_text("AB", {0, 0}, 10, 1).size(), write_text("ab", {0, 0}, 10, 1).size());
  EXPECT_GT(text_width("depth", 10), text_width("dept", 10));
}

TEST(Legend, MarksAreRoundAndFew) {
  for (const double largest : {1.0, 0.9, 0.21, 3.7, 123.0, 4.5e-7, 9.99e5, 0.0199}) {
    const auto marks = round_marks(largest);
    EXPECT_GE(marks.size(), 3u) << largest;
    EXPECT_LE(marks.size(), 7u) << largest;
    EXPECT_EQ(marks[0], 0);
    EXPECT_LE(marks.back(), largest * (1 + 1e-9));
    EXPECT_GT(marks.back() + marks[1], largest) << largest;
  }
}

struct Box {
  std::vector<Vec3> positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  std::vector<VertexTuple<3>> surface{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  std::vector<double> depth{-1, 0.3, 0.2, 0.1};
  std::vector<DrawnPath> paths{{{0.2, 0.2, 0.2}, {0, 0.2, 0.2}, 0.2}};
  PathsDrawing scene() const { return {positions, surface, {}, depth, paths, "4 triangles"}; }
};

PictureOptions small_picture() {
  PictureOptions options;
  options.width = 160;
  options.height = 100;
  return options;
}

double difference(const Image& a, const Image& b) {
  double sum = 0;
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < a.width(); ++x) sum += (a.at(x, y) - b.at(x, y)).abs().sum();
  }
  return sum;
}

TEST(PathsPicture, SameForAnyNumberOfThreads) {
  const Box box;
  const Image many = draw_paths(box.scene(), small_picture());
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(difference(many, draw_paths(box.scene(), small_picture())), 0);
}

TEST(PathsPicture, DepthsPathsAndCaptionAreSeen) {
  const Box box;
  const Image whole = draw_paths(box.scene(), small_picture());
  const std::vector<double> untouched(4, -1);
  PathsDrawing plain = box.scene(), without_paths = box.scene(), without_caption = box.scene();
  plain.vertex_depth = untouched;
  without_paths.paths = {};
  without_caption.caption = "";
  for (const PathsDrawing& scene : {plain, without_paths, without_caption}) {
    EXPECT_GT(difference(whole, draw_paths(scene, small_picture())), 1);
  }
}

TEST(PathsPicture, PlanarOverlapIsDarker) {
  const std::vector<Vec3> positions{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}};
  const std::vector<VertexTuple<3>> once{{0, 1, 2}, {0, 2, 3}}, twice{{0, 1, 2}, {0, 2, 3}, {0, 1, 2}, {0, 2, 3}};
  const std::vector<VertexTuple<2>> outline{{0, 1}, {1, 2}, {2, 3}, {3, 0}};
  const std::vector<double> depth(4, -1);
  const Image single = draw_paths({positions, once, outline, depth, {}, ""}, small_picture());
  const Image both = draw_paths({positions, twice, outline, depth, {}, ""}, small_picture());
  EXPECT_LT(lightness(both.at(60, 50)), lightness(single.at(60, 50)) - 0.03f);
}

TEST(PathsPicture, EmptySceneAndBadSizesAreRefused) {
  const Box box;
  PathsDrawing empty = box.scene();
  empty.surface = {};
  EXPECT_THROW(draw_paths(empty, small_picture()), Error);
  PictureOptions tiny = small_picture();
  tiny.width = 3;
  EXPECT_THROW(draw_paths(box.scene(), tiny), Error);
}

TEST(Image, FileThatCannotBeWrittenIsAnError) {
  EXPECT_THROW(write_png("/no/such/folder/a.png", Image(64, 64)), Error);
}

}  // namespace
}  // namespace selvage
