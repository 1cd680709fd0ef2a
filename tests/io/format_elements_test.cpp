// Vertex numbers of any kind, the splitting of polygons and strips, and the checks of every element.
#include "io/format_elements.h"

#include "io/format_samples.h"

namespace selvage::format {
namespace {

using Triangles = std::vector<VertexTuple<3>>;

VertexNumbers numbers_of(const std::vector<std::int64_t>& list) {
  VertexNumbers numbers;
  for (const std::int64_t number : list) numbers.add(number);
  EXPECT_FALSE(numbers.finish().first);
  return numbers;
}

TEST(VertexNumbers, FindEachInItsPlaceAndNothingElse) {
  constexpr std::int64_t kLow = std::numeric_limits<std::int64_t>::min(),
                         kHigh = std::numeric_limits<std::int64_t>::max();
  const std::vector<std::vector<std::int64_t>> lists = {
      {0, 1, 2, 3},     {1, 2, 3},          {-5, -4, -3},          {7},
      {3, 2, 1, 0},     {10, 12, 11, 14},   {1, 1000000000000, 5}, {kLow, kHigh},
      {kHigh, kLow, 0}, {kHigh - 1, kHigh}, {kLow, kLow + 1, 4}};
  for (const auto& list : lists) {
    const VertexNumbers numbers = numbers_of(list);
    EXPECT_EQ(numbers.count(), std::ssize(list));
    for (std::size_t i = 0; i < list.size(); ++i) {
      EXPECT_EQ(numbers.find(list[i]), static_cast<Index>(i));
      for (const std::int64_t other : {kLow, kHigh, std::int64_t{-1}, std::int64_t{13}, std::int64_t{999}}) {
        const bool known = std::find(list.begin(), list.end(), other) != list.end();
        EXPECT_EQ(numbers.find(other) != kNone, known) << other;
      }
    }
  }
}

TEST(VertexNumbers, ShuffledNumbersWithGaps) {
  std::mt19937 random(5);
  std::vector<std::int64_t> list;
  for (std::int64_t i = 0; i < 500; ++i) list.push_back(3 * i - 100);
  std::shuffle(list.begin(), list.end(), random);
  const VertexNumbers numbers = numbers_of(list);
  for (std::size_t i = 0; i < list.size(); ++i) {
    EXPECT_EQ(numbers.find(list[i]), static_cast<Index>(i));
    EXPECT_EQ(numbers.find(list[i] + 1), kNone);
  }
}

TEST(VertexNumbers, NumbersGivenTwice) {
  for (const std::vector<std::int64_t>& list :
       {std::vector<std::int64_t>{4, 4}, {1, 2, 3, 2}, {9, 5, 7, 9}, {-1, 0, -1}}) {
    VertexNumbers numbers;
    for (const std::int64_t number : list) numbers.add(number);
    const auto [twice, number] = numbers.finish();
    EXPECT_TRUE(twice);
    EXPECT_EQ(std::count(list.begin(), list.end(), number), 2);
  }
}

TEST(VertexNumbers, DescribeThemselves) {
  EXPECT_EQ(VertexNumbers(1, 8).describe(), "vertices are numbered 1 to 8");
  EXPECT_EQ(VertexNumbers().describe(), "the file has no vertices before it");
  EXPECT_EQ(numbers_of({5, 9}).describe(), "2 other vertices are defined");
}

/// A collector over ten vertices, and the mesh it fills.
struct Collected {
  IndexedMesh mesh;
  VertexNumbers numbers{0, 10};
  Cursor cursor{Source{"", "f"}};
  ElementCollector collector{cursor, mesh, numbers};
};

template <typename Action>
bool is_refused(Action action) {
  try {
    action();
  } catch (const Error&) {
    return true;
  }
  return false;
}

TEST(ElementCollector, RefusesEveryRepeatedPairOfVertices) {
  Collected c;
  c.collector.add_triangle(0, 1, 2);
  c.collector.add_tetrahedron(0, 1, 2, 3);
  for (int i = 0; i < 4; ++i) {
    for (int j = i + 1; j < 4; ++j) {
      std::array<Index, 4> v = {0, 1, 2, 3};
      v[j] = v[i];
      EXPECT_TRUE(is_refused([&] { c.collector.add_tetrahedron(v[0], v[1], v[2], v[3]); })) << i << j;
      if (j == 3) continue;
      EXPECT_TRUE(is_refused([&] { c.collector.add_triangle(v[0], v[1], v[2]); })) << i << j;
    }
  }
  EXPECT_EQ(c.mesh.triangles.size(), 1u);
  EXPECT_EQ(c.mesh.tetrahedra.size(), 1u);
}

TEST(ElementCollector, NamesTheRepeatedVertex) {
  Collected c;
  const auto message = [&](std::array<Index, 4> v) -> std::string {
    try {
      c.collector.add_tetrahedron(v[0], v[1], v[2], v[3]);
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  };
  EXPECT_NE(message({5, 1, 2, 5}).find("vertex 5 from 0"), std::string::npos);
  EXPECT_NE(message({1, 6, 6, 2}).find("vertex 6 from 0"), std::string::npos);
  EXPECT_NE(message({1, 2, 7, 7}).find("vertex 7 from 0"), std::string::npos);
  EXPECT_NE(message({1, 8, 7, 8}).find("vertex 8 from 0"), std::string::npos);
}

TEST(ElementCollector, SplitsPolygonsIntoFansAndStripsWithOneOrientation) {
  Collected c;
  const std::vector<Index> corners = {4, 5, 6, 7, 8};
  c.collector.add_polygon(corners);
  EXPECT_EQ(c.mesh.triangles, (Triangles{{4, 5, 6}, {4, 6, 7}, {4, 7, 8}}));
  c.mesh.triangles.clear();
  c.collector.add_strip(corners);
  EXPECT_EQ(c.mesh.triangles, (Triangles{{4, 5, 6}, {6, 5, 7}, {6, 7, 8}}));
  EXPECT_TRUE(is_refused([&] { c.collector.add_polygon(std::span(corners).first(2)); }));
}

TEST(ElementCollector, KnowsVerticesByNumber) {
  Collected c;
  EXPECT_EQ(c.collector.vertex(9), 9);
  for (const std::int64_t bad : {std::int64_t{-1}, std::int64_t{10}, std::int64_t{1} << 32, std::int64_t{1} << 62}) {
    EXPECT_TRUE(is_refused([&] { c.collector.vertex(bad); })) << bad;
  }
}

TEST(VtkCells, EveryTypeIsReadPassedOverOrRefused) {
  const std::vector<Index> vertices = {0, 1, 2, 3};
  for (int type = -1; type <= 100; ++type) {
    Collected c;
    const bool is_point_or_line = type == 0 || type == 1 || type == 2 || type == 3 || type == 4 || type == 21;
    const std::size_t size = type == 5 ? 3 : 4;
    const bool refused = is_refused([&] { add_vtk_cell(c.collector, type, std::span(vertices).first(size)); });
    EXPECT_EQ(refused, !is_point_or_line && !(type >= 5 && type <= 10)) << type;
    const std::size_t triangles = type == 5 ? 1 : type >= 6 && type <= 9 ? 2 : 0;
    EXPECT_EQ(c.mesh.triangles.size(), triangles) << type;
    EXPECT_EQ(c.mesh.tetrahedra.size(), type == 10 ? 1u : 0u) << type;
  }
}

TEST(VtkCells, PixelsRunInRowsAndSizesMustFit) {
  Collected c;
  const std::vector<Index> vertices = {0, 1, 2, 3};
  add_vtk_cell(c.collector, 8, vertices);
  EXPECT_EQ(c.mesh.triangles, (Triangles{{0, 1, 3}, {0, 3, 2}}));
  for (const int type : {5, 8, 9, 10}) {
    for (const std::size_t size : {0u, 1u, 2u, 3u, 4u}) {
      if (size == (type == 5 ? 3u : 4u)) continue;
      EXPECT_TRUE(is_refused([&] { add_vtk_cell(c.collector, type, std::span(vertices).first(size)); }))
          << type << size;
    }
  }
}

}  // namespace
}  // namespace selvage::format
