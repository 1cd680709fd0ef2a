#pragma once

#include "selvage/core/types.h"

#include <cstring>

namespace selvage {

/// Whether two lists of positions are the same bit for bit: zeros of different sign differ.
inline bool are_same_bits(std::span<const Vec3> a, std::span<const Vec3> b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

}  // namespace selvage
