#include "simulation/xpbd/material_blocks.h"

#include <algorithm>
#include <random>

namespace selvage {

namespace {

/// Numbers from 0 on in descending order of their keys, equal ones in ascending order: places in `sorted`.
void sort_by_key(std::span<const Index> numbers, std::span<const Index> keys, std::vector<Index>& counts,
                 std::vector<Index>& sorted) {
  counts.assign(keys.empty() ? 1 : *std::max_element(keys.begin(), keys.end()) + 2, 0);
  const auto largest = static_cast<Index>(counts.size()) - 2;
  for (const Index key : keys) ++counts[largest - key + 1];
  for (std::size_t k = 1; k < counts.size(); ++k) counts[k] += counts[k - 1];
  sorted.resize(numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) sorted[counts[largest - keys[i]]++] = numbers[i];
}

/// Brings batches into a random order, the same in every run. In the order of packing, with the busiest vertices first,
/// a stiff beam in large steps has a quarter more energy left after three iterations of Gauss-Seidel.
void shuffle_batches(std::vector<Index>& packed) {
  std::mt19937 random;
  for (std::size_t left = packed.size() / kBatch; left > 1; --left) {
    const std::size_t chosen = random() % left;
    std::swap_ranges(packed.begin() + kBatch * chosen, packed.begin() + kBatch * (chosen + 1),
                     packed.begin() + kBatch * (left - 1));
  }
}

}  // namespace

/// Fills batch after batch, tuples of the busiest vertices first. A vertex with most tuples left needs a place in
/// almost every batch; left to the end, its tuples would each need a batch of their own.
template <std::size_t K>
std::vector<Index> pack_batches(std::span<const std::array<Index, K>> tuples, Index vertex_count) {
  std::vector<Index> load(vertex_count, 0), last_batch(vertex_count, kNone);
  for (const auto& tuple : tuples)
    for (const Index v : tuple) ++load[v];
  std::vector<Index> left(tuples.size()), packed, keys, counts, sorted;
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = static_cast<Index>(i);
  for (Index batch = 0; !left.empty(); ++batch) {
    keys.clear();
    for (const Index number : left) {
      Index key = 0;
      for (const Index v : tuples[number]) key += load[v];
      keys.push_back(key);
    }
    sort_by_key(left, keys, counts, sorted);
    left.clear();
    int size = 0;
    packed.resize(packed.size() + kBatch, kNone);
    for (const Index number : sorted) {
      const auto& tuple = tuples[number];
      if (size == kBatch || std::any_of(tuple.begin(), tuple.end(), [&](Index v) { return last_batch[v] == batch; })) {
        left.push_back(number);
        continue;
      }
      packed[kBatch * batch + size++] = number;
      for (const Index v : tuple) {
        last_batch[v] = batch;
        --load[v];
      }
    }
  }
  shuffle_batches(packed);
  return packed;
}

template std::vector<Index> pack_batches<2>(std::span<const std::array<Index, 2>>, Index);
template std::vector<Index> pack_batches<4>(std::span<const std::array<Index, 4>>, Index);

}  // namespace selvage
