#pragma once

#include "bvh/bvh.h"

namespace selvage {

/// Sums over many queries, so that nothing is optimized away.
struct QuerySums {
  double squared_distances = 0;
  std::int64_t nodes = 0;
  std::int64_t primitives = 0;
};

#define SELVAGE_BENCH_QUERIES                                                                                 \
  QuerySums find_nearest_points(const Bvh& bvh, std::span<const Vec3> points, std::span<const Vec3> queries); \
  QuerySums find_overlaps(const Bvh& bvh, std::span<const Box> queries);
namespace baseline {
SELVAGE_BENCH_QUERIES
}
namespace avx2 {
SELVAGE_BENCH_QUERIES
}
namespace avx512 {
SELVAGE_BENCH_QUERIES
}
#undef SELVAGE_BENCH_QUERIES

}  // namespace selvage
