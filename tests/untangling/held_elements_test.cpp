#include "untangling/solids/held_elements.h"

#include "selvage/shapes/poses.h"
#include "selvage/shapes/shapes.h"

#include <gtest/gtest.h>

#include <numeric>

namespace selvage {
namespace {

/// Two boxes of cells 0.25; the second moved.
struct Boxes {
  IndexedMesh file = concatenate(std::array{make_box(Vec3::Ones(), 0.25), make_box(Vec3::Ones(), 0.25)});
  TetMesh mesh{static_cast<Index>(file.positions.size()), file.tetrahedra};
  Index second = mesh.vertex_count() / 2;  ///< its first vertex

  explicit Boxes(const Vec3& offset) { pose_overlap(file.positions, second, offset); }

  template <typename Which>
  std::vector<Index> held(const Which& is_pinned) const {
    std::vector<Index> pinned;
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      if (is_pinned(v)) pinned.push_back(v);
    return find_held_elements(mesh, file.positions, pinned);
  }

  /// Whether all of an element's vertices are within what the other box fills, or near it.
  bool is_near_overlap(Index element, double from, double to) const {
    const auto& e = mesh.elements()[element];
    return std::all_of(e.begin(), e.end(),
                       [&](Index v) { return file.positions[v][0] > from && file.positions[v][0] < to; });
  }
};

constexpr auto kAll = [](Index) { return true; };

TEST(HeldElements, AreThoseOfFacesThatMeet) {
  const Boxes boxes({0.83, 0.1, 0.07});
  const std::vector<Index> held = boxes.held(kAll);
  ASSERT_FALSE(held.empty());
  EXPECT_TRUE(std::is_sorted(held.begin(), held.end()));
  EXPECT_EQ(std::adjacent_find(held.begin(), held.end()), held.end());
  for (const Index e : held) EXPECT_TRUE(boxes.is_near_overlap(e, 0.7, 1.1)) << e;
}

TEST(HeldElements, AreNoneWhereOneSideMayMove) {
  const Boxes boxes({0.83, 0.1, 0.07});
  EXPECT_TRUE(boxes.held([&](Index v) { return v < boxes.second; }).empty());
  EXPECT_TRUE(boxes.held([&](Index v) { return v >= boxes.second; }).empty());
  EXPECT_TRUE(boxes.held([&](Index v) { return v % 3 == 0; }).empty());
  EXPECT_TRUE(boxes.held([](Index) { return false; }).empty());
}

TEST(HeldElements, AreNoneWhereNothingMeets) {
  const Boxes boxes({1.01, 0, 0});
  EXPECT_TRUE(boxes.held(kAll).empty());
  // Pins that end within a box make faces of inner ones.
  EXPECT_TRUE(boxes.held([&](Index v) { return boxes.file.positions[v][1] < 0.6; }).empty());
  EXPECT_TRUE(boxes.held([&](Index v) { return (boxes.file.positions[v] - Vec3(1, 0.5, 0.5)).norm() < 0.6; }).empty());
}

// Nothing of the boundary meets, and of the box inside no face is pinned but its own.
TEST(HeldElements, MayBeInsideOfOthers) {
  IndexedMesh file = concatenate(std::array{make_box(Vec3::Ones(), 1), make_box(Vec3::Constant(0.1), 0.1)});
  const auto count = static_cast<Index>(file.positions.size());
  pose_overlap(file.positions, count - 8, {0.3, 0.42, 0.81});
  const TetMesh mesh(count, file.tetrahedra);
  std::vector<Index> pinned(count);
  std::iota(pinned.begin(), pinned.end(), 0);
  EXPECT_FALSE(find_held_elements(mesh, file.positions, pinned).empty());
  // All elements of a single cell have its first corner.
  pinned.erase(pinned.begin());
  EXPECT_TRUE(find_held_elements(mesh, file.positions, pinned).empty());
  EXPECT_TRUE(find_held_elements(mesh, file.positions, std::span(pinned).last(8)).empty());
}

TEST(HeldElements, AreHeldByFacesAlone) {
  // Two elements that cross; of each the face is pinned that goes through the other's.
  const std::vector<Vec3> positions{{0, 0, 0},      {1, 0, 0},     {0, 1, 0},      {0, 0, 1},
                                    {0.2, 0.2, -1}, {0.3, 0.2, 1}, {0.2, 0.35, 1}, {-1, -1, 0.5}};
  std::vector<VertexTuple<4>> elements{{0, 1, 2, 3}, {4, 5, 6, 7}};
  const TetMesh mesh(8, elements);
  EXPECT_EQ(find_held_elements(mesh, positions, std::array<Index, 6>{0, 1, 2, 4, 5, 6}), (std::vector<Index>{0, 1}));
  EXPECT_TRUE(find_held_elements(mesh, positions, std::array<Index, 5>{0, 1, 4, 5, 6}).empty());
}

TEST(HeldElements, MayBeInverted) {
  Boxes boxes({2, 0, 0});
  const auto& e = boxes.mesh.elements()[17];
  std::swap(boxes.file.positions[e[0]], boxes.file.positions[e[1]]);
  const std::vector<Index> held = boxes.held(kAll);
  EXPECT_TRUE(std::binary_search(held.begin(), held.end(), 17));
  EXPECT_TRUE(boxes.held([&](Index v) { return v != e[0] && v != e[1]; }).empty());
}

}  // namespace
}  // namespace selvage
