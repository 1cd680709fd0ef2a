#pragma once

#include "selvage/core/types.h"
#include "shapes/cell_splits.h"

#include <algorithm>

namespace selvage {

/// A lattice tetrahedron to be trimmed: vertices in positive order, each inside (+1), on (0) or outside (-1) the solid.
struct LatticeTet {
  std::array<int, 4> sign;
  std::array<std::array<Index, 3>, 4> half_cells;
};

namespace stuffing {

/// Long edges join vertices of the same kind (corner or centre), short edges vertices of different kinds.
inline bool is_long(const LatticeTet& tet, int a, int b) {
  return ((tet.half_cells[a][0] ^ tet.half_cells[b][0]) & 1) == 0;
}

/// Which diagonal cuts the quadrilateral left of a face with a and b inside and n outside: true for the one from a to
/// the cut of (b, n). It depends on the face alone, so that both tetrahedra at the face agree.
///
/// A cut of a long edge gets the diagonal; where both cuts are of short edges, the parity rule of the paper decides:
/// from a where a even number of a's coordinates are larger than n's, which holds for exactly one of a and b.
inline bool diagonal_leaves(const LatticeTet& tet, int a, int b, int n) {
  if (!is_long(tet, a, b)) return is_long(tet, b, n);
  int larger = 0;
  for (int axis = 0; axis < 3; ++axis) larger += tet.half_cells[a][axis] > tet.half_cells[n][axis];
  return larger % 2 == 0;
}

/// Numbers of the tetrahedron's vertices, those inside first, then those on, then those outside; an even permutation
/// wherever two have the same sign, as in every case that cuts quadrilaterals.
inline std::array<int, 4> by_sign(const LatticeTet& tet) {
  std::array<int, 4> order = {0, 1, 2, 3};
  bool odd = false;
  for (int pass = 0; pass < 3; ++pass) {
    for (int i = 0; i < 3; ++i) {
      if (tet.sign[order[i]] < tet.sign[order[i + 1]]) {
        std::swap(order[i], order[i + 1]);
        odd = !odd;
      }
    }
  }
  if (odd) std::swap(order[0], order[1]);
  return order;
}

}  // namespace stuffing

/// Fills what lies inside of a lattice tetrahedron, with at least one vertex inside (Labelle and Shewchuk 2007, figure
/// of stencils).
///
/// @param vertex  `vertex(i)` gives the output number of vertex i, inside or on
/// @param cut     `cut(i, n)` gives the output number of the cut between vertex i inside and vertex n outside
/// @param emit    called with each VertexTuple<4>, positive
template <typename Vertex, typename Cut, typename Emit>
void trim_tetrahedron(const LatticeTet& tet, Vertex&& vertex, Cut&& cut, Emit&& emit) {
  using stuffing::diagonal_leaves;
  const auto inside = std::count(tet.sign.begin(), tet.sign.end(), 1);
  const auto outside = std::count(tet.sign.begin(), tet.sign.end(), -1);
  if (outside == 0 || inside == 1) {
    const auto in = static_cast<int>(std::find(tet.sign.begin(), tet.sign.end(), 1) - tet.sign.begin());
    VertexTuple<4> corners;
    for (int i = 0; i < 4; ++i) corners[i] = tet.sign[i] < 0 ? cut(in, i) : vertex(i);
    emit(corners);
    return;
  }
  const auto [a, b, c, d] = stuffing::by_sign(tet);
  if (inside == 2 && outside == 1) {  // A pyramid over the quadrilateral a, b, cut of b, cut of a; c is its tip.
    if (diagonal_leaves(tet, a, b, d)) {
      emit({vertex(a), vertex(b), vertex(c), cut(b, d)});
      emit({vertex(a), cut(b, d), vertex(c), cut(a, d)});
    } else {
      emit({vertex(a), vertex(b), vertex(c), cut(a, d)});
      emit({cut(a, d), vertex(b), vertex(c), cut(b, d)});
    }
  } else if (inside ==
             2) {  // A prism from a to b. The side that is the surface takes the diagonal that closes no ring.
    const int rank_c = diagonal_leaves(tet, a, b, c) ? 1 : -1, rank_d = diagonal_leaves(tet, a, b, d) ? 1 : -1;
    split_prism<int>({vertex(a), cut(a, c), cut(a, d)}, {vertex(b), cut(b, c), cut(b, d)}, {0, 2 * rank_c, 3 * rank_d},
                     emit);
  } else {  // A prism from the face a, b, c towards d.
    const bool ab = diagonal_leaves(tet, a, b, d), bc = diagonal_leaves(tet, b, c, d),
               ca = diagonal_leaves(tet, c, a, d);
    split_prism<int>({vertex(a), vertex(b), vertex(c)}, {cut(a, d), cut(b, d), cut(c, d)},
                     {!ab + ca, !bc + ab, !ca + bc}, emit);
  }
}

}  // namespace selvage
