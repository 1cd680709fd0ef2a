#pragma once

#include "boundary_path/oracle/exact_integers.h"
#include "boundary_path/oracle/oracle.h"

namespace selvage::oracle {

/// The line from a query's point p to its closest point s on a boundary face: p + u (s - p), u in [first, last].
template <int D>
struct Oracle<D>::Segment {
  Vec<D> point;      ///< p, scaled like the mesh
  Vec<D> direction;  ///< s - p, rounded
  bool trusted;      ///< the rounded direction is good to about 1e-12 of the size of things
  Index face;
  int first, last;
  bool is_exact = false;
  int bits = 0;                   ///< integers count in 2^-bits
  IntegerVec<D> exact_point;      ///< p
  IntegerVec<D> exact_direction;  ///< (s - p) * weight
  Integer weight;
};

}  // namespace selvage::oracle
