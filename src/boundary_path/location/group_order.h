#pragma once

#include "selvage/core/types.h"

#include <array>

namespace selvage {

/// Queries that descend a hierarchy together.
inline constexpr Index kPacketSize = 16;

/// Sorts numbers of places (the fourth coordinate says nothing) so that each run of kPacketSize of them lies close
/// together. The result depends on nothing else.
void order_in_space(std::span<const std::array<float, 4>> places, std::span<Index> numbers);

/// Two places, of two kinds; the fourth coordinate of each is 0.
using PlacePair = std::array<std::array<float, 4>, 2>;

/// Sorts pairs of places along a curve that fills space: those that follow each other lie close together in both kinds,
/// mostly. The result depends on nothing else.
/// @return  numbers of the pairs
std::vector<Index> order_along_curve(std::span<const PlacePair> places);

inline std::size_t group_count(std::size_t points) {
  return (points + kPacketSize - 1) / kPacketSize;
}

}  // namespace selvage
