#include "boundary_path/group_order.h"

#include "selvage/core/parallel.h"

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

template <std::size_t K>
struct NumberedPlace {
  std::array<float, K> x;
  Index number;
};

template <std::size_t K>
int longest_axis(std::span<const NumberedPlace<K>> items) {
  std::array<float, K> lower, upper;
  lower.fill(HUGE_VALF);
  upper.fill(-HUGE_VALF);
  for (const auto& item : items)
    for (std::size_t axis = 0; axis < K; ++axis) {
      lower[axis] = std::min(lower[axis], item.x[axis]);
      upper[axis] = std::max(upper[axis], item.x[axis]);
    }
  std::size_t longest = 0;
  for (std::size_t axis = 1; axis < K; ++axis)
    if (upper[axis] - lower[axis] > upper[longest] - lower[longest]) longest = axis;
  return static_cast<int>(longest);
}

/// Halves across the longest axis, down to single groups.
template <std::size_t K>
void split_in_halves(std::span<NumberedPlace<K>> items) {
  constexpr std::size_t kParallelAbove = 4096;
  const std::size_t groups = group_count(items.size());
  if (groups <= 1) return;
  const std::size_t half = groups / 2 * kPointGroup;
  const int axis = longest_axis<K>(items);
  std::nth_element(items.begin(), items.begin() + half, items.end(),
                   [axis](const NumberedPlace<K>& a, const NumberedPlace<K>& b) {
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

}  // namespace

template <std::size_t K>
void order_in_space(std::span<const std::array<float, K>> places, std::span<Index> numbers) {
  std::vector<NumberedPlace<K>> items(numbers.size());
  for (std::size_t i = 0; i < items.size(); ++i) items[i] = {places[numbers[i]], numbers[i]};
  split_in_halves<K>(items);
  for (std::size_t i = 0; i < items.size(); ++i) numbers[i] = items[i].number;
}

template void order_in_space<4>(std::span<const std::array<float, 4>>, std::span<Index>);
template void order_in_space<6>(std::span<const std::array<float, 6>>, std::span<Index>);

}  // namespace selvage
