#pragma once

#include "selvage/core/types.h"

#include <array>

namespace selvage {

/// Queries that walk down a hierarchy together.
inline constexpr Index kPointGroup = 16;

/// Sorts numbers of places so that each run of kPointGroup of them lies close together. The result depends on nothing
/// else.
///
/// @param places  of each number; of 4 coordinates, or of 6: places of two kinds, close in both
template <std::size_t K>
void order_in_space(std::span<const std::array<float, K>> places, std::span<Index> numbers);

extern template void order_in_space<4>(std::span<const std::array<float, 4>>, std::span<Index>);
extern template void order_in_space<6>(std::span<const std::array<float, 6>>, std::span<Index>);

inline std::size_t group_count(std::size_t points) {
  return (points + kPointGroup - 1) / kPointGroup;
}

}  // namespace selvage
