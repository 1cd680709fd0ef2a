#pragma once

#include "core/parallel.h"
#include "selvage/core/error.h"
#include "selvage/core/types.h"

#include <fmt/format.h>

#include <cmath>
#include <span>

namespace selvage {

/// Least and greatest coordinates of positions; of none, the least are greater. NaN does not count.
template <int D>
struct PositionExtent {
  Vec<D> lower = Vec<D>::Constant(HUGE_VAL), upper = -lower;
  bool finite = true;  ///< whether all coordinates are

  double diagonal() const { return (upper - lower).norm(); }
  void add(const Vec<D>& x) {
    lower = lower.cwiseMin(x);
    upper = upper.cwiseMax(x);
    finite = finite && x.allFinite();
  }
  void add(const PositionExtent& other) {
    lower = lower.cwiseMin(other.lower);
    upper = upper.cwiseMax(other.upper);
    finite = finite && other.finite;
  }
};

template <int D>
PositionExtent<D> extent_of(std::span<const Vec<D>> positions) {
  return parallel_reduce<PositionExtent<D>>(std::ssize(positions), kGrain,
                                            [&](std::int64_t first, std::int64_t last, PositionExtent<D>& extent) {
                                              for (std::int64_t v = first; v < last; ++v) extent.add(positions[v]);
                                            });
}

/// The extent of the positions that a mesh is asked about.
/// @throws Error  when there is not one for each vertex, or a coordinate is not finite
template <int D>
PositionExtent<D> check_positions(std::span<const Vec<D>> positions, Index vertex_count,
                                  const char* name = "positions") {
  if (std::ssize(positions) != vertex_count)
    throw Error(name, fmt::format("{} positions for {} vertices", positions.size(), vertex_count),
                "give one position per vertex");
  PositionExtent<D> extent = extent_of(positions);
  if (!extent.finite)
    for (std::size_t v = 0; v < positions.size(); ++v)
      if (!positions[v].allFinite())
        throw Error(fmt::format("vertex {}", v), "a coordinate is not finite", "remove NaN and infinity");
  return extent;
}

}  // namespace selvage
