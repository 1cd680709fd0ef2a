#pragma once

#include "core/parallel.h"
#include "selvage/core/types.h"

#include <algorithm>
#include <utility>

namespace selvage {

/// For each vertex the tuples that have it, ascending: `items[first[v] .. first[v + 1])`. O(n), parallel where there
/// are many: each piece of the tuples counts on its own, for atomic additions cost five times as much as plain ones,
/// and leave items to be sorted.
template <int N>
void build_vertex_stars(Index vertex_count, std::span<const VertexTuple<N>> tuples, std::vector<Index>& items,
                        std::vector<Index>& first) {
  constexpr std::int64_t kTuplesAtOnce = 1 << 17, kMaxPieces = 8;
  const std::int64_t count = std::ssize(tuples),
                     pieces = std::clamp(count / kTuplesAtOnce, std::int64_t{1}, kMaxPieces);
  first.resize(static_cast<std::size_t>(vertex_count) + 1);
  items.resize(tuples.size() * N);
  std::vector<std::vector<Index>> next(pieces);  // per piece and vertex: how many, then where the next goes
  const auto for_each_tuple = [&](std::int64_t piece, auto&& visit) {
    const std::int64_t end = count * (piece + 1) / pieces;
    for (std::int64_t t = count * piece / pieces; t < end; ++t)
      for (const Index v : tuples[t]) visit(next[piece][v], static_cast<Index>(t));
  };
  parallel_for(pieces, 1, [&](std::int64_t piece) {
    next[piece].assign(vertex_count, 0);
    for_each_tuple(piece, [](Index& number, Index) { ++number; });
  });
  Index place = 0;
  for (Index v = 0; v < vertex_count; ++v) {
    first[v] = place;
    for (std::vector<Index>& of_piece : next) place += std::exchange(of_piece[v], place);
  }
  first[vertex_count] = place;
  parallel_for(pieces, 1, [&](std::int64_t piece) {
    for_each_tuple(piece, [&](Index& where, Index tuple) { items[where++] = tuple; });
  });
}

}  // namespace selvage
