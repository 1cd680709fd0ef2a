#include "scene/reading/touches.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <numbers>

namespace selvage {
namespace {

using Positions = std::vector<Vec3>;

/// A corner of a cube of side 1 whose tip points to x.
Positions corner_at(const Vec3& tip) {
  const auto turn = Eigen::Quaterniond::FromTwoVectors(Vec3(1, 1, 1), Vec3::UnitX());
  return {tip, tip - turn * Vec3::UnitX(), tip - turn * Vec3::UnitY(), tip - turn * Vec3::UnitZ()};
}

const std::vector<VertexTuple<4>> kOne{{0, 2, 1, 3}};
const std::vector<VertexTuple<4>> kTwo{{0, 2, 1, 3}, {4, 6, 5, 7}};

Positions joined(Positions a, const Positions& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// The length of a mean edge of a corner: three of 1, three of sqrt(2).
constexpr double kMeanEdge = (1 + std::numbers::sqrt2) / 2;

std::vector<Touch> touches_of(const Positions& positions, const std::vector<VertexTuple<4>>& elements,
                              const std::vector<Collider>& colliders = {}, double time = 0) {
  const TetMesh mesh(static_cast<Index>(positions.size()), elements);
  TouchFinder finder(mesh, positions, colliders);
  EXPECT_NEAR(finder.distance(), TouchFinder::kNear * kMeanEdge, 1e-12);
  return finder.find(positions, time);
}

/// A cube from -1 to 1 as soup: no two triangles have a vertex in common.
MeshShape cube() {
  MeshShape shape;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      const Vec3 n = side * Vec3::Unit(axis), u = Vec3::Unit((axis + 1) % 3), v = n.cross(u);
      const auto first = static_cast<Index>(shape.positions.size());
      const std::array<Vec3, 6> corners{n - u - v, n + u - v, n + u + v, n - u - v, n + u + v, n - u + v};
      shape.positions.insert(shape.positions.end(), corners.begin(), corners.end());
      for (const Index t : {first, first + 3}) shape.triangles.push_back({t, t + 1, t + 2});
    }
  return shape;
}

TEST(Touches, OfAVertexWithEachKindOfCollider) {
  // All lies at 5 on the x axis and faces the tip, which comes from the left.
  const Vec3 place(5, 0, 0), normal(-1, 0, 0);
  std::vector<Collider> colliders(6);
  colliders[0].shape = PlaneShape{place, normal};
  colliders[1].shape = BoxContainer{{-9, -9, -9}, {5, 9, 9}};
  colliders[2].shape = Bowl{{0, 0, 0}, normal, 5};
  colliders[3].shape = SphereShape{{6, 0, 0}, 1};
  colliders[4].shape = CylinderShape{{7, 0, 0}, Vec3::UnitZ(), 2, 3};
  colliders[5].shape = cube();
  colliders[5].motion.keyframes = {{0, Vec3::Zero(), 0}, {2, Vec3(6, 0, 0), 0}};
  for (std::size_t i = 0; i < colliders.size(); ++i) {
    const auto at = [&](double gap) { return touches_of(corner_at(place + gap * normal), kOne, {colliders[i]}, 2); };
    const auto touches = at(0.01);
    ASSERT_EQ(touches.size(), 1u) << i;
    EXPECT_EQ(touches[0].kind, MarkKind::kCollider);
    EXPECT_EQ(touches[0].vertices, (std::array<Index, 2>{0, 0}));
    EXPECT_NEAR((touches[0].normal - normal).norm(), 0, 1e-6) << i;
    EXPECT_EQ(at(-0.01).size(), 1u) << i;
    EXPECT_EQ(at(0.06).size(), 0u) << i;
  }
  // Before it has moved, the last is elsewhere.
  EXPECT_TRUE(touches_of(corner_at(place - Vec3(0.01, 0, 0)), kOne, {colliders[5]}, 0).empty());
}

auto touches_of(const std::vector<VertexTuple<4>>& elements, const Positions& positions) {
  const TetMesh mesh(static_cast<Index>(positions.size()), elements);
  TouchFinder finder(mesh, positions, {});
  return finder.find(positions, 0);
}

TEST(Touches, OfAVertexWithTheNearestFace) {
  // The tip of the first is below the lowest face of the second, whose normal points down.
  const auto at = [](double gap) {
    const Positions second{{-2, -2, gap}, {2, -2, gap}, {0, 2, gap}, {0, 0, 2}};
    Positions first = corner_at({0, 0, 0});
    for (Vec3& p : first) p = {p[1], p[2], p[0]};
    return touches_of({{0, 2, 1, 3}, {4, 5, 6, 7}}, joined(first, second));
  };
  const auto touches = at(0.01);
  ASSERT_EQ(touches.size(), 1u);
  EXPECT_EQ(touches[0].kind, MarkKind::kVertexFace);
  EXPECT_EQ(touches[0].vertices, (std::array<Index, 2>{0, 0}));
  EXPECT_NEAR((touches[0].normal + Vec3::UnitZ()).norm(), 0, 1e-12);
  EXPECT_TRUE(at(0.2).empty());
}

TEST(Touches, OfTwoEdgesBetweenTheirEnds) {
  // The upper edge runs along y, the lower one along x.
  const auto at = [](double gap) {
    const Positions lower{{-1, 0, 0}, {1, 0, 0}, {0, -0.5, -1}, {0, 0.5, -1}};
    const Positions upper{{0, -1, gap}, {0, 1, gap}, {0.5, 0, 1 + gap}, {-0.5, 0, 1 + gap}};
    return touches_of({{0, 1, 2, 3}, {4, 5, 7, 6}}, joined(lower, upper));
  };
  const auto touches = at(0.01);
  ASSERT_EQ(touches.size(), 1u);
  EXPECT_EQ(touches[0].kind, MarkKind::kEdgeEdge);
  EXPECT_EQ(touches[0].vertices, (std::array<Index, 2>{0, 1}));
  EXPECT_NEAR(touches[0].place, 0.5, 1e-12);
  EXPECT_NEAR((touches[0].normal + Vec3::UnitZ()).norm(), 0, 1e-12);
  EXPECT_TRUE(at(0.2).empty());
}

TEST(Touches, AreNoneOfABodyThatIsAlone) {
  EXPECT_TRUE(touches_of(corner_at({0, 0, 0}), kOne).empty());
  EXPECT_TRUE(touches_of(joined(corner_at({0, 0, 0}), corner_at({3, 0, 0})), kTwo).empty());
}

}  // namespace
}  // namespace selvage
