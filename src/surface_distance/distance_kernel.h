#pragma once

#include "bvh/bvh.h"
#include "core/isa.h"
#include "selvage/geometry/closest_point.h"
#include "selvage/surface_distance/surface_distance.h"

#include <limits>

namespace selvage {

/// Input of the searches.
struct DistanceInput {
  std::span<const BvhNode> nodes;
  const VertexTuple<3>* triangles;
  const Vec3* positions;
};

/// The nearest triangle so far.
struct ClosestTriangle {
  Index triangle = kNone;
  ClosestPoint<3, 3> closest{.point = Vec3::Zero(), .squared_distance = std::numeric_limits<double>::infinity()};
};

// find_closest_triangles: for each of `count` points the nearest triangle.
// find_point_sides: for each of `count` points its side of a closed surface.
#define SELVAGE_DISTANCE_KERNEL                                                                                        \
  void find_closest_triangles(const DistanceInput&, const Vec3* points, std::int64_t count, ClosestTriangle* closest); \
  void find_point_sides(const DistanceInput&, const Vec3* points, std::int64_t count, SurfaceSide* sides);
namespace baseline {
SELVAGE_DISTANCE_KERNEL
}
namespace avx2 {
SELVAGE_DISTANCE_KERNEL
}
namespace avx512 {
SELVAGE_DISTANCE_KERNEL
}
#undef SELVAGE_DISTANCE_KERNEL

/// Takes a triangle if it is nearer than the nearest so far, or as near with a smaller index. Returns the squared
/// distance of the nearest, rounded up. Compiled once, for every x86-64.
float take_if_nearer(const DistanceInput& input, const Vec3& point, Index triangle, ClosestTriangle& nearest);

/// Counts the crossing of a triangle with the ray that goes up from the point along the z axis. Returns false where the
/// point lies on the triangle: then it is on the surface, and no other triangle matters.
///
/// The ray starts from (x + dx, y + dy, z) with infinitesimal dx >> dy > 0 (simulation of simplicity), so that it
/// passes no edge and no vertex, and a triangle that is parallel to it is never crossed.
bool count_crossing(const DistanceInput& input, const Vec3& point, Index triangle, SurfaceSide& side);

}  // namespace selvage
