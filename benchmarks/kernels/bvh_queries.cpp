#include "kernels/bvh_queries.h"

#include "bvh/traverse.h"

namespace selvage {
inline namespace SELVAGE_ISA {

/// The nearest of `points`, one in each primitive's box, for each query.
QuerySums find_nearest_points(const Bvh& bvh, std::span<const Vec3> points, std::span<const Vec3> queries) {
  QuerySums sums;
  for (const Vec3& query : queries) {
    double nearest = std::numeric_limits<double>::infinity();
    visit_nearest(
        bvh.nodes(), enclosing_box<3>(query, query), std::numeric_limits<float>::infinity(),
        [&](Index primitive, float) {
          ++sums.primitives;
          const double distance = (points[primitive] - query).squaredNorm();
          nearest = distance < nearest ? distance : nearest;
          return round_up(nearest);
        },
        sums.nodes);
    sums.squared_distances += nearest;
  }
  return sums;
}

QuerySums find_overlaps(const Bvh& bvh, std::span<const Box> queries) {
  QuerySums sums;
  for (const Box& query : queries)
    visit_overlaps(
        bvh.nodes(), query, [&](Index) { ++sums.primitives; }, sums.nodes);
  return sums;
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
