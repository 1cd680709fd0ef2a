#include "surface_distance/distance_kernel.h"

#include "bvh/traverse.h"

namespace selvage {
inline namespace SELVAGE_ISA {

void find_closest_triangles(const DistanceInput& input, const Vec3* points, std::int64_t count,
                            ClosestTriangle* closest) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (std::int64_t i = 0; i < count; ++i)
    visit_nearest(input.nodes, enclosing_box<3>(points[i], points[i]), kInfinity,
                  [&](Index triangle, float) { return take_if_nearer(input, points[i], triangle, closest[i]); });
}

void find_point_sides(const DistanceInput& input, const Vec3* points, std::int64_t count, SurfaceSide* sides) {
  for (std::int64_t i = 0; i < count; ++i) {
    Box above = enclosing_box<3>(points[i], points[i]);
    above.upper[2] = std::numeric_limits<float>::infinity();
    visit_overlaps(input.nodes, above,
                   [&](Index triangle) { return count_crossing(input, points[i], triangle, sides[i]); });
  }
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
