// One case of every kind by hand, so that the words of the header have one meaning.
#include "selvage/geometry/triangle_triangle.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace selvage {
namespace {

using Triangle = std::array<Vec3, 3>;
using enum TriangleContact;

const Triangle kFloor{Vec3{0, 0, 0}, Vec3{4, 0, 0}, Vec3{0, 4, 0}};

Triangle segment(const Vec3& p, const Vec3& q) {
  return {p, q, q};
}
Triangle point(const Vec3& p) {
  return {p, p, p};
}

void expect_contact(const Triangle& a, const Triangle& b, TriangleContact expected) {
  EXPECT_EQ(classify_contact(a, b), expected);
  EXPECT_EQ(classify_contact(b, a), expected);
  EXPECT_EQ(triangles_meet(a, b), expected != kDisjoint);
}

TEST(TriangleContact, TrianglesInDifferentPlanes) {
  expect_contact(kFloor, {Vec3{1, 1, -1}, Vec3{1, 1, 1}, Vec3{9, 9, 0}}, kCrossing);
  expect_contact(kFloor, {Vec3{1, 1, 0}, Vec3{1, 1, 1}, Vec3{9, 9, 1}}, kTouching);       // vertex in face
  expect_contact(kFloor, {Vec3{1, 1, 0}, Vec3{2, 1, 0}, Vec3{1, 1, 1}}, kTouching);       // edge in face
  expect_contact(kFloor, {Vec3{1, 0, 1}, Vec3{1, 0, -1}, Vec3{1, -1, 0}}, kTouching);     // edge across edge
  expect_contact(kFloor, {Vec3{1, 0, 0}, Vec3{3, 0, 0}, Vec3{1, 0, 1}}, kTouching);       // edge in edge
  expect_contact(kFloor, {Vec3{0, 0, 0}, Vec3{-1, -1, 1}, Vec3{-1, 0, -1}}, kTouching);   // common vertex
  expect_contact(kFloor, {Vec3{0, 0, 0}, Vec3{1, 1, 1}, Vec3{1, 1, -1}}, kCrossing);      // the same, and more
  expect_contact(kFloor, {Vec3{0, 0, 1e-300}, Vec3{4, 0, 1}, Vec3{0, 4, 1}}, kDisjoint);  // above
  expect_contact(kFloor, {Vec3{5, 5, -1}, Vec3{5, 5, 1}, Vec3{6, 5, 0}}, kDisjoint);      // beside
  expect_contact(kFloor, {Vec3{2, 2, -1}, Vec3{2, 2, 1}, Vec3{3, 3, 0}}, kTouching);      // beside, touching
}

TEST(TriangleContact, TrianglesInOnePlane) {
  expect_contact(kFloor, kFloor, kCoplanarOverlap);
  expect_contact(kFloor, {Vec3{1, 1, 0}, Vec3{2, 1, 0}, Vec3{1, 2, 0}}, kCoplanarOverlap);   // inside
  expect_contact(kFloor, {Vec3{-1, 1, 0}, Vec3{5, 1, 0}, Vec3{5, 2, 0}}, kCoplanarOverlap);  // no vertex inside
  expect_contact(kFloor, {Vec3{0, 0, 0}, Vec3{4, 0, 0}, Vec3{0, -4, 0}}, kTouching);         // common edge
  expect_contact(kFloor, {Vec3{0, 0, 0}, Vec3{4, 0, 0}, Vec3{9, 9, 0}}, kCoplanarOverlap);   // folded
  expect_contact(kFloor, {Vec3{2, 2, 0}, Vec3{4, 2, 0}, Vec3{2, 4, 0}}, kTouching);          // vertex in edge
  expect_contact(kFloor, {Vec3{3, 2, 0}, Vec3{4, 2, 0}, Vec3{3, 4, 0}}, kDisjoint);
}

TEST(TriangleContact, SegmentsAndPoints) {
  expect_contact(kFloor, segment({1, 1, -1}, {1, 1, 1}), kCrossing);
  expect_contact(kFloor, segment({1, 1, 0}, {1, 1, 1}), kTouching);
  expect_contact(kFloor, segment({1, 0, -1}, {1, 0, 1}), kTouching);
  expect_contact(kFloor, segment({1, 1, 1}, {1, 1, 2}), kDisjoint);
  expect_contact(kFloor, segment({3, 3, -1}, {3, 3, 1}), kDisjoint);
  expect_contact(kFloor, segment({1, 1, 0}, {9, 9, 0}), kCoplanarOverlap);
  expect_contact(kFloor, segment({1, 0, 0}, {3, 0, 0}), kTouching);
  expect_contact(kFloor, segment({5, 0, 0}, {0, 5, 0}), kDisjoint);
  expect_contact(kFloor, point({1, 1, 0}), kCoplanarOverlap);
  expect_contact(kFloor, point({2, 2, 0}), kTouching);
  expect_contact(kFloor, point({0, 0, 0}), kTouching);
  expect_contact(kFloor, point({1, 1, 1e-300}), kDisjoint);
  expect_contact(segment({0, 0, 0}, {2, 2, 2}), segment({0, 2, 2}, {2, 0, 0}), kCoplanarOverlap);
  expect_contact(segment({0, 0, 0}, {2, 2, 2}), segment({1, 1, 1}, {5, 0, 0}), kTouching);
  expect_contact(segment({0, 0, 0}, {2, 2, 2}), segment({1, 1, 1}, {3, 3, 3}), kCoplanarOverlap);
  expect_contact(segment({0, 0, 0}, {2, 2, 2}), segment({2, 2, 2}, {3, 3, 3}), kTouching);
  expect_contact(segment({0, 0, 0}, {2, 2, 2}), segment({3, 3, 3}, {4, 4, 4}), kDisjoint);
  expect_contact(segment({0, 0, 0}, {2, 0, 0}), segment({0, 1, 0}, {2, 1, 0}), kDisjoint);   // parallel
  expect_contact(segment({0, 0, 0}, {2, 0, 0}), segment({1, -1, 1}, {1, 1, 1}), kDisjoint);  // skew
  expect_contact(segment({0, 0, 0}, {2, 2, 2}), point({1, 1, 1}), kCoplanarOverlap);
  expect_contact(segment({0, 0, 0}, {2, 2, 2}), point({2, 2, 2}), kTouching);
  expect_contact(point({2, 2, 2}), point({2, 2, 2}), kCoplanarOverlap);
  expect_contact(point({2, 2, 2}), point({2, 2, 3}), kDisjoint);
  // A segment with its vertices in any order.
  expect_contact(kFloor, {Vec3{1, 1, 0}, Vec3{1, 1, 1}, Vec3{1, 1, -1}}, kCrossing);
  expect_contact({Vec3{1, 1, 1}, Vec3{0, 0, 0}, Vec3{2, 2, 2}}, point({0.5, 0.5, 0.5}), kCoplanarOverlap);
}

TEST(MeetBeyondVertex, EveryKind) {
  EXPECT_FALSE(meet_beyond_vertex(kFloor, {Vec3{0, 0, 0}, Vec3{1, 1, 1}, Vec3{2, 1, 1}}));
  EXPECT_TRUE(meet_beyond_vertex(kFloor, {Vec3{0, 0, 0}, Vec3{1, 1, 1}, Vec3{1, 1, -1}}));
  EXPECT_FALSE(meet_beyond_vertex(kFloor, {Vec3{0, 0, 0}, Vec3{-1, -1, 1}, Vec3{-1, -1, -1}}));
  EXPECT_TRUE(meet_beyond_vertex(kFloor, {Vec3{0, 0, 0}, Vec3{9, 9, 0}, Vec3{1, 1, 1}}));     // an edge in the face
  EXPECT_TRUE(meet_beyond_vertex(kFloor, {Vec3{0, 0, 0}, Vec3{9, 0, 0}, Vec3{1, 1, 1}}));     // edge on edge
  EXPECT_FALSE(meet_beyond_vertex(kFloor, {Vec3{0, 0, 0}, Vec3{-9, 0, 0}, Vec3{0, -9, 0}}));  // coplanar, apart
  EXPECT_TRUE(meet_beyond_vertex(kFloor, {Vec3{0, 0, 0}, Vec3{-9, 0, 0}, Vec3{0, 9, 0}}));    // coplanar, edge on edge
  EXPECT_TRUE(meet_beyond_vertex(kFloor, {Vec3{0, 0, 0}, Vec3{-9, 1, 0}, Vec3{9, 1, 0}}));    // coplanar, overlap
  EXPECT_TRUE(meet_beyond_vertex(kFloor, kFloor));
  EXPECT_FALSE(meet_beyond_vertex(kFloor, point({0, 0, 0})));
  EXPECT_TRUE(meet_beyond_vertex(kFloor, segment({0, 0, 0}, {1, 1, 0})));
  EXPECT_FALSE(meet_beyond_vertex(kFloor, segment({0, 0, 0}, {-1, -1, 0})));
  EXPECT_TRUE(meet_beyond_vertex(kFloor, {Vec3{0, 0, 0}, Vec3{-1, -1, 0}, Vec3{1, 1, 0}}));  // through the vertex
  EXPECT_FALSE(meet_beyond_vertex(kFloor, {Vec3{0, 0, 0}, Vec3{-1, 1, 1}, Vec3{1, -1, -1}}));
  EXPECT_TRUE(meet_beyond_vertex(segment({0, 0, 0}, {1, 2, 3}), segment({0, 0, 0}, {2, 4, 6})));
  EXPECT_FALSE(meet_beyond_vertex(segment({0, 0, 0}, {1, 2, 3}), segment({0, 0, 0}, {-2, -4, -6})));
}

TEST(MeetBeyondEdge, EveryKind) {
  EXPECT_FALSE(meet_beyond_edge(kFloor, {Vec3{0, 0, 0}, Vec3{4, 0, 0}, Vec3{0, 4, 1e-300}}));
  EXPECT_TRUE(meet_beyond_edge(kFloor, {Vec3{0, 0, 0}, Vec3{4, 0, 0}, Vec3{9, 1e-300, 0}}));
  EXPECT_FALSE(meet_beyond_edge(kFloor, {Vec3{0, 0, 0}, Vec3{4, 0, 0}, Vec3{0, -4, 0}}));
  EXPECT_FALSE(meet_beyond_edge(kFloor, {Vec3{0, 0, 0}, Vec3{4, 0, 0}, Vec3{9, 0, 0}}));
  EXPECT_TRUE(meet_beyond_edge(kFloor, kFloor));
  const Vec3 start{0, 0, 0}, end{1, 1, 1}, after{2, 2, 2}, far_after{3, 3, 3}, before{-1, -1, -1},
      middle{0.5, 0.5, 0.5};
  EXPECT_TRUE(meet_beyond_edge({start, end, after}, {start, end, far_after}));
  EXPECT_FALSE(meet_beyond_edge({start, end, after}, {start, end, before}));
  EXPECT_FALSE(meet_beyond_edge({start, end, after}, {start, end, middle}));
  EXPECT_FALSE(meet_beyond_edge({start, end, middle}, {start, end, middle}));
  EXPECT_TRUE(meet_beyond_edge({start, start, after}, {start, start, end}));
  EXPECT_FALSE(meet_beyond_edge({start, start, after}, {start, start, before}));
  EXPECT_FALSE(meet_beyond_edge({start, start, after}, {start, start, {1, 0, 0}}));
}

}  // namespace
}  // namespace selvage
