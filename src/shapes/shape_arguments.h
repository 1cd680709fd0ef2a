#pragma once

#include "selvage/core/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

namespace selvage {

/// Most elements of a mesh: 4 * element + face must fit in an Index.
inline constexpr double kMaxElementCount = 1 << 29;

/// @throws Error  unless the argument is positive and finite
inline void check_positive(std::string_view name, double value) {
  if (!(value > 0) || !std::isfinite(value)) {
    throw Error(name, fmt::format("{} is not a length", value), "use a positive, finite number");
  }
}

/// @throws Error  when a mesh of so many elements, known or estimated, cannot be indexed
inline void check_element_count(double count) {
  if (!(count <= kMaxElementCount)) {
    const std::string many =
        std::isfinite(count) ? fmt::format("about {:.3g} elements, more than 2^29", count) : "more than 2^29 elements";
    throw Error("", "the mesh would have " + many, "use a larger cell");
  }
}

/// How many cells of about the given size fill a length, at least `minimum`; as a double, for it may be huge.
inline double cell_count(double length, double cell, double minimum = 1) {
  return std::max(minimum, std::round(length / cell));
}

}  // namespace selvage
