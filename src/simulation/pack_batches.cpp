#include "simulation/material_blocks.h"

#include <bit>

namespace selvage {

/// First fit: a tuple goes to the first batch that has room and none of its vertices. Which those are, one set of bits
/// a vertex tells.
template <std::size_t K>
std::vector<Index> pack_batches(std::span<const std::array<Index, K>> tuples, Index vertex_count) {
  const std::size_t words = tuples.size() / 64 + 1;  // never more batches than tuples
  std::vector<std::uint64_t> holders(words * vertex_count), full(words);
  std::vector<Index> packed;
  std::vector<std::uint8_t> sizes;
  for (Index number = 0; number < std::ssize(tuples); ++number) {
    std::size_t batch = 0;
    for (std::size_t word = 0; word < words; ++word) {
      std::uint64_t closed = full[word];
      for (const Index v : tuples[number]) closed |= holders[words * v + word];
      batch = 64 * word + std::countr_one(closed);
      if (~closed != 0) break;
    }
    if (batch == sizes.size()) {
      sizes.push_back(0);
      packed.resize(packed.size() + kBatch, kNone);
    }
    packed[kBatch * batch + sizes[batch]] = number;
    const std::uint64_t bit = std::uint64_t{1} << (batch % 64);
    for (const Index v : tuples[number]) holders[words * v + batch / 64] |= bit;
    if (++sizes[batch] == kBatch) full[batch / 64] |= bit;
  }
  return packed;
}

template std::vector<Index> pack_batches<2>(std::span<const std::array<Index, 2>>, Index);
template std::vector<Index> pack_batches<4>(std::span<const std::array<Index, 4>>, Index);

}  // namespace selvage
