#include "boundary_path/group_order.h"

#include "selvage/core/parallel.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace selvage {

namespace {

struct NumberedPlace {
  std::array<float, 4> x;  ///< and one that says nothing
  Index number;
};

int longest_axis(std::span<const NumberedPlace> items) {
  std::array<float, 3> lower, upper;
  lower.fill(HUGE_VALF);
  upper.fill(-HUGE_VALF);
  for (const auto& item : items)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lower[axis] = std::min(lower[axis], item.x[axis]);
      upper[axis] = std::max(upper[axis], item.x[axis]);
    }
  std::size_t longest = 0;
  for (std::size_t axis = 1; axis < 3; ++axis)
    if (upper[axis] - lower[axis] > upper[longest] - lower[longest]) longest = axis;
  return static_cast<int>(longest);
}

/// Halves across the longest axis, down to single groups.
void split_in_halves(std::span<NumberedPlace> items) {
  constexpr std::size_t kParallelAbove = 4096;
  const std::size_t groups = group_count(items.size());
  if (groups <= 1) return;
  const std::size_t half = groups / 2 * kPointGroup;
  const int axis = longest_axis(items);
  std::nth_element(items.begin(), items.begin() + half, items.end(),
                   [axis](const NumberedPlace& a, const NumberedPlace& b) {
                     return a.x[axis] < b.x[axis] || (a.x[axis] == b.x[axis] && a.number < b.number);
                   });
  const auto left = [&] { split_in_halves(items.first(half)); };
  const auto right = [&] { split_in_halves(items.subspan(half)); };
  if (items.size() > kParallelAbove) {
    parallel_invoke(left, right);
  } else {
    left();
    right();
  }
}

/// Bits of a coordinate in a place along the curve, and what lies between two of them.
constexpr int kBits = 10, kAxes = 6;

/// Each number's bits, kAxes apart.
constexpr std::array<std::uint64_t, 1 << kBits> kSpread = [] {
  std::array<std::uint64_t, 1 << kBits> spread{};
  for (std::uint64_t i = 0; i < spread.size(); ++i)
    for (int bit = 0; bit < kBits; ++bit) spread[i] |= (i >> bit & 1) << (kAxes * bit);
  return spread;
}();

struct CurvePlace {
  std::uint64_t along;  ///< Morton's curve
  Index number;
};

/// Digit by digit, the last first. Stable: items at one place stay in their order, for any number of threads. The items
/// of one chunk are parted well enough by the leading half of the bits; few have fewer digits to count.
void sort_along_curve(std::vector<CurvePlace>& items) {
  constexpr std::int64_t kChunk = 1 << 15, kFew = 4096;
  const std::int64_t count = std::ssize(items), chunks = (count + kChunk - 1) / kChunk;
  const auto for_each_chunk = [&](auto&& body) {
    if (chunks == 1)
      body(0);
    else
      parallel_for(chunks, 1, body);
  };
  const int digit_bits = count < kFew ? 6 : 10, digits = 1 << digit_bits;
  std::vector<CurvePlace> sorted(items.size());
  std::vector<Index> places(chunks * digits);  ///< where each chunk's items with a digit go
  const auto visit = [&](std::int64_t chunk, int shift, auto&& take) {
    for (std::int64_t i = chunk * kChunk; i < std::min((chunk + 1) * kChunk, count); ++i)
      take(items[i], places[chunk * digits + static_cast<std::int64_t>(items[i].along >> shift & (digits - 1u))]);
  };
  for (int shift = chunks == 1 ? kBits * kAxes / 2 : 0; shift < kBits * kAxes; shift += digit_bits) {
    for_each_chunk([&](std::int64_t chunk) {
      std::fill_n(places.begin() + chunk * digits, digits, 0);
      visit(chunk, shift, [](const CurvePlace&, Index& number) { ++number; });
    });
    Index before = 0;
    for (int digit = 0; digit < digits; ++digit)
      for (std::int64_t chunk = 0; chunk < chunks; ++chunk)
        before += std::exchange(places[chunk * digits + digit], before);
    for_each_chunk([&](std::int64_t chunk) {
      visit(chunk, shift, [&](const CurvePlace& item, Index& place) { sorted[place++] = item; });
    });
    items.swap(sorted);
  }
}

}  // namespace

void order_in_space(std::span<const std::array<float, 4>> places, std::span<Index> numbers) {
  std::vector<NumberedPlace> items(numbers.size());
  for (std::size_t i = 0; i < items.size(); ++i) items[i] = {places[numbers[i]], numbers[i]};
  split_in_halves(items);
  for (std::size_t i = 0; i < items.size(); ++i) numbers[i] = items[i].number;
}

std::vector<Index> order_along_curve(std::span<const std::array<float, 6>> places) {
  // Places may be anywhere, at infinity too.
  const auto within = [](float x) { return std::clamp(x, -1e30f, 1e30f); };
  std::array<float, kAxes> lower, upper;
  lower.fill(HUGE_VALF);
  upper.fill(-HUGE_VALF);
  for (const auto& x : places)
    for (int axis = 0; axis < kAxes; ++axis) {
      lower[axis] = std::min(lower[axis], within(x[axis]));
      upper[axis] = std::max(upper[axis], within(x[axis]));
    }
  float extent = 1e-30f;
  for (int axis = 0; axis < kAxes; ++axis) extent = std::max(extent, upper[axis] - lower[axis]);
  const float scale = ((1 << kBits) - 1) / extent;
  std::vector<CurvePlace> items(places.size());
  for (std::size_t i = 0; i < items.size(); ++i) {
    std::uint64_t along = 0;
    for (int axis = 0; axis < kAxes; ++axis)
      along |= kSpread[static_cast<int>((within(places[i][axis]) - lower[axis]) * scale)] << axis;
    items[i] = {along, static_cast<Index>(i)};
  }
  sort_along_curve(items);
  std::vector<Index> numbers(items.size());
  for (std::size_t i = 0; i < items.size(); ++i) numbers[i] = items[i].number;
  return numbers;
}

}  // namespace selvage
