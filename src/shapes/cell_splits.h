#pragma once

#include "selvage/core/types.h"

#include <utility>

namespace selvage {

/// Cuts a hexahedral cell into the six tetrahedra around its diagonal (Kuhn). Cells side by side with parallel axes
/// meet face to face. Positive where the axes are right-handed.
///
/// @param corner  vertex of the corner (i, j, k), each 0 or 1, at 4 i + 2 j + k
/// @param emit    called with each VertexTuple<4>
template <typename Emit>
void split_hexahedron(const std::array<Index, 8>& corner, Emit&& emit) {
  static constexpr int kPaths[6][2] = {{4, 6}, {2, 3}, {1, 5}, {4, 5}, {2, 6}, {1, 3}};
  for (int p = 0; p < 6; ++p) {
    VertexTuple<4> tet = {corner[0], corner[kPaths[p][0]], corner[kPaths[p][1]], corner[7]};
    if (p >= 3) std::swap(tet[1], tet[2]);
    emit(tet);
  }
}

/// Cuts a triangular prism into three tetrahedra. The diagonal of the side over (i, j) runs from bottom i to top j
/// where rank[i] < rank[j], so that prisms side by side meet face to face when they agree on the ranks of shared
/// vertices. Positive where bottom is counter-clockwise seen from the top.
template <typename Rank, typename Emit>
void split_prism(VertexTuple<3> bottom, VertexTuple<3> top, std::array<Rank, 3> rank, Emit&& emit) {
  bool odd = false;
  const auto order = [&](int i, int j) {
    if (rank[i] < rank[j]) return;
    std::swap(rank[i], rank[j]);
    std::swap(bottom[i], bottom[j]);
    std::swap(top[i], top[j]);
    odd = !odd;
  };
  order(0, 1);
  order(1, 2);
  order(0, 1);
  const auto emit_positive = [&](VertexTuple<4> tet) {
    if (odd) std::swap(tet[2], tet[3]);
    emit(tet);
  };
  emit_positive({bottom[0], bottom[1], bottom[2], top[2]});
  emit_positive({bottom[0], bottom[1], top[2], top[1]});
  emit_positive({bottom[0], top[0], top[1], top[2]});
}

}  // namespace selvage
