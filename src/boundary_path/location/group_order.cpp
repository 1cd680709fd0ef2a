#include "boundary_path/location/group_order.h"

#include "core/parallel.h"
#include "core/simd/simd.h"
#include "core/sort_by_digit.h"

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
  const std::size_t half = groups / 2 * kPacketSize;
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

/// The bits of each number of half the length, kAxes apart.
constexpr std::array<std::uint32_t, 1 << kBits / 2> kSpread = [] {
  std::array<std::uint32_t, 1 << kBits / 2> spread{};
  for (std::uint32_t i = 0; i < spread.size(); ++i)
    for (int bit = 0; bit < kBits / 2; ++bit) spread[i] |= (i >> bit & 1) << (kAxes * bit);
  return spread;
}();

/// Items that one task sorts; so few are parted well enough by the leading half of the bits.
constexpr std::int64_t kChunk = 1 << 15;

/// Digit by digit, the last first. Stable: items at one place stay in their order.
/// @param items  each with half the bits of its place along the curve above its number
template <int kDigitBits>
void sort_few(std::vector<std::uint64_t>& items) {
  constexpr int kDigits = kBits * kAxes / 2 / kDigitBits, kSize = 1 << kDigitBits;
  std::array<std::array<Index, kSize>, kDigits> places{};  ///< where items with a digit go
  const auto digit = [](std::uint64_t item, int k) { return item >> (32 + k * kDigitBits) & (kSize - 1); };
  for (const std::uint64_t item : items)
    for (int k = 0; k < kDigits; ++k) ++places[k][digit(item, k)];
  std::vector<std::uint64_t> sorted(items.size());
  for (int k = 0; k < kDigits; ++k) {
    Index before = 0;
    for (Index& place : places[k]) before += std::exchange(place, before);
    for (const std::uint64_t item : items) sorted[places[k][digit(item, k)]++] = item;
    items.swap(sorted);
  }
}

struct CurvePlace {
  std::uint64_t along;  ///< Morton's curve
  Index number;
};

/// The same for any number of threads.
void sort_many(std::vector<CurvePlace>& items) {
  constexpr int kDigitBits = 10;
  constexpr std::uint32_t kDigits = 1u << kDigitBits;
  std::vector<CurvePlace> sorted(items.size());
  for (int shift = 0; shift < kBits * kAxes; shift += kDigitBits) {
    sort_by_digit(items, sorted, kDigits, [&](const CurvePlace& item) {
      return static_cast<std::uint32_t>(item.along >> shift) & (kDigits - 1);
    });
    items.swap(sorted);
  }
}

/// The grid through whose cells the curve goes.
class CurveGrid {
 public:
  explicit CurveGrid(std::span<const PlacePair> places) {
    Float4 upper[2];
    for (int kind = 0; kind < 2; ++kind) {
      lower_[kind] = Float4::broadcast(kFar);
      upper[kind] = Float4::broadcast(-kFar);
    }
    for (const PlacePair& x : places)
      for (int kind = 0; kind < 2; ++kind) {
        lower_[kind] = min(within(x[kind]), lower_[kind]);
        upper[kind] = max(within(x[kind]), upper[kind]);
      }
    std::array<float, 4> extents;
    max(upper[0] - lower_[0], upper[1] - lower_[1]).store(extents.data());
    const float extent = std::max({1e-30f, extents[0], extents[1], extents[2]});
    scale_ = Float4::broadcast(((1 << kBits) - 1) / extent);
  }

  /// Half of the bits of a pair's place along the curve: those that lead, or the rest.
  std::uint32_t along(const PlacePair& x, bool leading) const {
    std::uint32_t along = 0;
    for (int kind = 0; kind < 2; ++kind) {
      std::array<std::int32_t, 4> cell;
      ((within(x[kind]) - lower_[kind]) * scale_).store_int(cell.data());
      for (int axis = 0; axis < 3; ++axis)
        along |= kSpread[leading ? cell[axis] >> kBits / 2 : cell[axis] & ((1 << kBits / 2) - 1)] << (3 * kind + axis);
    }
    return along;
  }

 private:
  static constexpr float kFar = 1e30f;

  /// Places may be anywhere, at infinity too.
  static Float4 within(const std::array<float, 4>& x) {
    return max(min(Float4::load(x.data()), Float4::broadcast(kFar)), Float4::broadcast(-kFar));
  }

  Float4 lower_[2], scale_;
};

}  // namespace

void order_in_space(std::span<const std::array<float, 4>> places, std::span<Index> numbers) {
  std::vector<NumberedPlace> items(numbers.size());
  for (std::size_t i = 0; i < items.size(); ++i) items[i] = {places[numbers[i]], numbers[i]};
  split_in_halves(items);
  for (std::size_t i = 0; i < items.size(); ++i) numbers[i] = items[i].number;
}

std::vector<Index> order_along_curve(std::span<const PlacePair> places) {
  constexpr std::size_t kMinForLongDigits = 2048;
  const CurveGrid grid(places);
  std::vector<Index> numbers(places.size());
  if (std::ssize(places) > kChunk) {
    std::vector<CurvePlace> items(places.size());
    for (std::size_t i = 0; i < items.size(); ++i)
      items[i] = {std::uint64_t{grid.along(places[i], true)} << kBits * kAxes / 2 | grid.along(places[i], false),
                  static_cast<Index>(i)};
    sort_many(items);
    for (std::size_t i = 0; i < items.size(); ++i) numbers[i] = items[i].number;
    return numbers;
  }
  std::vector<std::uint64_t> items(places.size());
  for (std::size_t i = 0; i < items.size(); ++i) items[i] = std::uint64_t{grid.along(places[i], true)} << 32 | i;
  if (items.size() < kMinForLongDigits)
    sort_few<6>(items);
  else
    sort_few<10>(items);
  for (std::size_t i = 0; i < items.size(); ++i) numbers[i] = static_cast<Index>(items[i] & 0xffffffffu);
  return numbers;
}

}  // namespace selvage
