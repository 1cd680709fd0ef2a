// One case of every kind by hand. The face lies in the plane z = 0 at time 0.
#include "selvage/geometry/continuous.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "geometry/continuous_pairs.h"
#include "geometry/exact/continuous_exact.h"

namespace selvage {
namespace {

using test::impact;
using test::kEdgeEdge;
using test::kVertexFace;
using test::meet;

using Four = std::array<Vec3, 4>;

void expect_meet(ContinuousPair pair, const Four& t0, const Four& t1, bool expected) {
  EXPECT_EQ(meet(pair, {t0, t1}), expected);
  EXPECT_EQ(meet(pair, {t1, t0}), expected);
  EXPECT_EQ(meets_exactly(pair, {t0, t1}), expected);
  EXPECT_EQ(impact(pair, {t0, t1}).has_value(), expected);
}

Four vertex_and_floor(const Vec3& vertex) {
  return {vertex, Vec3{0, 0, 0}, Vec3{4, 0, 0}, Vec3{0, 4, 0}};
}

TEST(VertexFace, ThroughAndBeside) {
  expect_meet(kVertexFace, vertex_and_floor({1, 1, 1}), vertex_and_floor({1, 1, -1}), true);
  expect_meet(kVertexFace, vertex_and_floor({3, 3, 1}), vertex_and_floor({3, 3, -1}), false);
  expect_meet(kVertexFace, vertex_and_floor({2, 2, 1}), vertex_and_floor({2, 2, -1}), true);  // through an edge
  expect_meet(kVertexFace, vertex_and_floor({0, 0, 1}), vertex_and_floor({0, 0, -1}), true);  // through a vertex
  expect_meet(kVertexFace, vertex_and_floor({1, 1, 1}), vertex_and_floor({1, 1, 0}), true);   // just reached
  expect_meet(kVertexFace, vertex_and_floor({1, 1, 1}), vertex_and_floor({1, 1, 1e-300}), false);
  EXPECT_EQ(vertex_face_impact({vertex_and_floor({1, 1, 1}), vertex_and_floor({1, 1, 0})}), 1 - 0x1p-20);
  EXPECT_EQ(vertex_face_impact({vertex_and_floor({1, 1, 0}), vertex_and_floor({1, 1, 1})}), 0);
}

TEST(VertexFace, NoMotion) {
  for (const auto& [place, expected] :
       {std::pair{Vec3{1, 1, 0}, true}, {Vec3{0, 2, 0}, true}, {Vec3{3, 3, 0}, false}, {Vec3{1, 1, 1}, false}})
    expect_meet(kVertexFace, vertex_and_floor(place), vertex_and_floor(place), expected);
}

TEST(VertexFace, AlwaysInOnePlane) {
  expect_meet(kVertexFace, vertex_and_floor({9, 1, 0}), vertex_and_floor({-9, 1, 0}), true);  // across
  expect_meet(kVertexFace, vertex_and_floor({9, 0, 0}), vertex_and_floor({-9, 0, 0}), true);  // along an edge
  expect_meet(kVertexFace, vertex_and_floor({5, 0, 0}), vertex_and_floor({9, 0, 0}), false);
  expect_meet(kVertexFace, vertex_and_floor({0, 8, 0}), vertex_and_floor({8, 0, 0}), false);
  expect_meet(kVertexFace, vertex_and_floor({8, -4, 0}), vertex_and_floor({0, 4, 0}), true);  // ends at a vertex
  expect_meet(kVertexFace, vertex_and_floor({5, -1, 0}), vertex_and_floor({3, 1, 0}), true);  // grazes a vertex
}

TEST(VertexFace, TouchesForASingleInstant) {
  // The vertex sinks to the floor and the floor's far end turns away below it: the volume is a multiple of (1 - 2 t)^2.
  const auto at = [](double t) {
    return Four{Vec3{1, 0, 1 - 2 * t}, Vec3{0, -1, 0}, Vec3{0, 1, 0}, Vec3{1 - 2 * t + 1, 0, 1 - 2 * t}};
  };
  expect_meet(kVertexFace, at(0), at(1), true);
  // The same, past the face.
  Four start = at(0), end = at(1);
  start[0][0] = end[0][0] = 3;
  expect_meet(kVertexFace, start, end, false);
}

TEST(VertexFace, MovingTogether) {
  for (const auto& [place, expected] : {std::pair{Vec3{1, 1, 0}, true}, {Vec3{1, 1, 1e-200}, false}}) {
    const Four t0 = vertex_and_floor(place);
    Four t1 = t0, larger = t0;
    for (Vec3& p : t1) p += Vec3{3, 5, 0};
    for (Vec3& p : larger) p *= 2;
    expect_meet(kVertexFace, t0, t1, expected);
    expect_meet(kVertexFace, t0, larger, expected);
  }
}

TEST(VertexFace, DegenerateFaces) {
  const auto with_segment = [](const Vec3& p) { return Four{p, Vec3{0, 0, 0}, Vec3{4, 0, 0}, Vec3{2, 0, 0}}; };
  const auto with_point = [](const Vec3& p) { return Four{p, Vec3{1, 1, 1}, Vec3{1, 1, 1}, Vec3{1, 1, 1}}; };
  expect_meet(kVertexFace, with_segment({1, 0, 1}), with_segment({1, 0, -1}), true);
  expect_meet(kVertexFace, with_segment({1, 1, 1}), with_segment({1, -1, -1}), true);
  expect_meet(kVertexFace, with_segment({1, 1, 1}), with_segment({1, -1, 0}), false);
  expect_meet(kVertexFace, with_segment({5, 0, 0}), with_segment({4, 0, 0}), true);
  expect_meet(kVertexFace, with_segment({9, 0, 0}), with_segment({5, 0, 0}), false);
  expect_meet(kVertexFace, with_point({0, 0, 0}), with_point({2, 2, 2}), true);
  expect_meet(kVertexFace, with_point({0, 0, 0}), with_point({2, 2, 3}), false);
  expect_meet(kVertexFace, with_point({1, 1, 1}), with_point({1, 1, 1}), true);
  // Flat only for one instant, and met then.
  expect_meet(kVertexFace, {Vec3{5, 0, 0}, Vec3{0, 0, 0}, Vec3{4, 0, 0}, Vec3{0, 2, 0}},
              {Vec3{-5, 0, 0}, Vec3{0, 0, 0}, Vec3{4, 0, 0}, Vec3{0, -2, 0}}, true);
}

Four edges(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1) {
  return {a0, a1, b0, b1};
}

TEST(EdgeEdge, ThroughAndBeside) {
  const Vec3 left{-1, 0, 0}, right{1, 0, 0};
  const auto at = [&](double y, double z) { return edges(left, right, {0, y - 1, z}, {0, y + 1, z}); };
  expect_meet(kEdgeEdge, at(0, 1), at(0, -1), true);
  expect_meet(kEdgeEdge, at(2, 1), at(2, -1), false);
  expect_meet(kEdgeEdge, at(1, 1), at(1, -1), true);  // an end touches
  expect_meet(kEdgeEdge, at(0, 1), at(0, 0), true);   // just reached
  expect_meet(kEdgeEdge, at(0, 1), at(0, 1e-300), false);
  expect_meet(kEdgeEdge, at(5, 0), at(-5, 0), true);  // always in one plane
  expect_meet(kEdgeEdge, at(0, 0), at(0, 0), true);   // no motion
  expect_meet(kEdgeEdge, at(3, 0), at(2, 0), false);
}

TEST(EdgeEdge, ParallelCollinearAndDegenerate) {
  const auto along = [](double x, double y) { return edges({-1, 0, 0}, {1, 0, 0}, {x, y, 0}, {x + 1, y, 0}); };
  expect_meet(kEdgeEdge, along(0, 1), along(0, -1), true);   // parallel, through each other
  expect_meet(kEdgeEdge, along(2, 1), along(2, -1), false);  // past each other
  expect_meet(kEdgeEdge, along(1, 1), along(1, -1), true);   // end past end
  expect_meet(kEdgeEdge, along(5, 0), along(2, 0), false);   // on one line
  expect_meet(kEdgeEdge, along(5, 0), along(1, 0), true);
  expect_meet(kEdgeEdge, along(5, 0), along(-5, 0), true);
  const auto point = [](const Vec3& p) { return edges({-1, 0, 0}, {1, 0, 0}, p, p); };
  expect_meet(kEdgeEdge, point({0, 1, 1}), point({0, -1, -1}), true);
  expect_meet(kEdgeEdge, point({0, 1, 1}), point({0, -1, 1}), false);
  const auto points = [](const Vec3& p, const Vec3& q) { return edges(p, p, q, q); };
  expect_meet(kEdgeEdge, points({0, 0, 0}, {1, 0, 0}), points({1, 0, 0}, {0, 0, 0}), true);
  expect_meet(kEdgeEdge, points({0, 0, 0}, {1, 0, 0}), points({1, 1, 0}, {0, 0, 0}), false);
}

TEST(EdgeEdge, TouchesForASingleInstant) {
  // Two edges that turn in opposite directions and come into one plane at 1/2 with a volume that does not change sign.
  const Four t0 = edges({-1, -1, 0}, {1, 1, 0}, {-1, 1, 1}, {1, -1, 1});
  const Four t1 = edges({-1, 1, 0}, {1, -1, 0}, {-1, -1, -1}, {1, 1, -1});
  expect_meet(kEdgeEdge, t0, t1, true);
}

}  // namespace
}  // namespace selvage
