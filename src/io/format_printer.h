#pragma once

#include "io/format_cursor.h"
#include "selvage/core/error.h"

#include <fmt/format.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>

namespace selvage::format {

/// Builds a file's content in memory: text with the shortest digits that read back as the same number, and binary.
class Printer {
 public:
  explicit Printer(std::endian order = std::endian::little) : swap_(order != std::endian::native) {}

  Printer& text(std::string_view s) {
    bytes_.append(s);
    return *this;
  }

  template <typename T>
  Printer& number(T value) {
    char digits[32];
    const auto result = std::to_chars(digits, digits + sizeof(digits), value);
    bytes_.append(digits, static_cast<std::size_t>(result.ptr - digits));
    return *this;
  }

  /// Numbers separated by blanks.
  template <typename Numbers>
  Printer& numbers(const Numbers& values) {
    bool first = true;
    for (const auto value : values) {
      if (!first) bytes_.push_back(' ');
      number(value);
      first = false;
    }
    return *this;
  }

  /// The numbers of an element, counted from `first`.
  template <std::size_t N>
  Printer& element(const std::array<Index, N>& vertices, Index first) {
    std::array<std::int64_t, N> shifted;
    for (std::size_t i = 0; i < N; ++i) shifted[i] = std::int64_t{vertices[i]} + first;
    return numbers(shifted);
  }

  template <typename T>
  Printer& binary(T value) {
    if (swap_) value = swap_bytes(value);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
    return *this;
  }

  /// The coordinates of a vertex as binary floats.
  /// @throws Error  when one is too large for a float
  Printer& floats(const Vec3& p, Index vertex) {
    for (const double x : p) {
      if (std::abs(x) > std::numeric_limits<float>::max()) {
        throw Error(fmt::format("vertex {}", vertex), "a coordinate does not fit in the floats of this binary format",
                    "write ASCII, or .ply");
      }
      binary(static_cast<float>(x));
    }
    return *this;
  }

  void reserve(std::size_t size) { bytes_.reserve(size); }
  std::size_t size() const { return bytes_.size(); }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
  bool swap_;
};

}  // namespace selvage::format
