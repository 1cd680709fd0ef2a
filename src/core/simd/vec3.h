#pragma once

#include "core/simd/simd.h"

#include <bit>
#include <cstddef>

/// Vectors of three (or two) numbers, a point or a direction in each lane. `Lanes` is Float8, Float16 or WideDouble;
/// every operation is the IEEE operation lane by lane, so that all instruction sets give the same bits.
namespace selvage {
inline namespace SELVAGE_ISA {

/// A row of lanes for each axis.
template <typename Lanes, int D>
struct LaneVec {
  Lanes at[D];

  SELVAGE_INLINE const Lanes& operator[](int axis) const { return at[axis]; }
  SELVAGE_INLINE Lanes& operator[](int axis) { return at[axis]; }
};
template <typename Lanes>
using LaneVec3 = LaneVec<Lanes, 3>;
template <typename Lanes>
using LaneVec2 = LaneVec<Lanes, 2>;

/// |x| of each lane of floats; simd_double.h has that of doubles.
template <typename Lanes>
requires requires(Lanes a) {
  and_bits(a, a);
}
SELVAGE_INLINE Lanes abs(const Lanes& a) {
  return and_bits(a, Lanes::broadcast(std::bit_cast<float>(0x7fffffff)));
}
/// 0 - x of each lane: +0 where x is either zero.
template <typename Lanes>
SELVAGE_INLINE Lanes negate(const Lanes& a) {
  return Lanes::broadcast(0) - a;
}

// Written out, not in loops: compilers keep arrays that are indexed in loops in memory.

template <typename Lanes, int D>
SELVAGE_INLINE LaneVec<Lanes, D> operator+(const LaneVec<Lanes, D>& a, const LaneVec<Lanes, D>& b) {
  if constexpr (D == 2)
    return {{a[0] + b[0], a[1] + b[1]}};
  else
    return {{a[0] + b[0], a[1] + b[1], a[2] + b[2]}};
}
template <typename Lanes, int D>
SELVAGE_INLINE LaneVec<Lanes, D> operator-(const LaneVec<Lanes, D>& a, const LaneVec<Lanes, D>& b) {
  if constexpr (D == 2)
    return {{a[0] - b[0], a[1] - b[1]}};
  else
    return {{a[0] - b[0], a[1] - b[1], a[2] - b[2]}};
}
template <typename Lanes, int D>
SELVAGE_INLINE LaneVec<Lanes, D> operator*(const Lanes& s, const LaneVec<Lanes, D>& a) {
  if constexpr (D == 2)
    return {{s * a[0], s * a[1]}};
  else
    return {{s * a[0], s * a[1], s * a[2]}};
}

/// Summed from the first axis on.
template <typename Lanes, int D>
SELVAGE_INLINE Lanes dot(const LaneVec<Lanes, D>& a, const LaneVec<Lanes, D>& b) {
  if constexpr (D == 2)
    return a[0] * b[0] + a[1] * b[1];
  else
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <typename Lanes>
SELVAGE_INLINE LaneVec<Lanes, 3> cross(const LaneVec<Lanes, 3>& a, const LaneVec<Lanes, 3>& b) {
  return {{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
}
/// In the plane: the z coordinate of the product in space.
template <typename Lanes>
SELVAGE_INLINE Lanes cross(const LaneVec<Lanes, 2>& a, const LaneVec<Lanes, 2>& b) {
  return a[0] * b[1] - a[1] * b[0];
}

/// Sum of |x| over the axes.
template <typename Lanes, int D>
SELVAGE_INLINE Lanes abs_sum(const LaneVec<Lanes, D>& a) {
  if constexpr (D == 2)
    return abs(a[0]) + abs(a[1]);
  else
    return abs(a[0]) + abs(a[1]) + abs(a[2]);
}
/// Largest |x| of the axes.
template <typename Lanes, int D>
SELVAGE_INLINE Lanes abs_max(const LaneVec<Lanes, D>& a) {
  if constexpr (D == 2)
    return max(abs(a[0]), abs(a[1]));
  else
    return max(max(abs(a[0]), abs(a[1])), abs(a[2]));
}

/// The first lanes of the rows of three axes.
template <typename Lanes, typename Number, std::size_t N>
SELVAGE_INLINE LaneVec3<Lanes> load_axes(const Number (&rows)[3][N]) {
  return {{Lanes::load(rows[0]), Lanes::load(rows[1]), Lanes::load(rows[2])}};
}
/// One column of the rows of three axes, in all lanes.
template <typename Lanes, typename Number, std::size_t N>
SELVAGE_INLINE LaneVec3<Lanes> broadcast_axes(const Number (&rows)[3][N], int column) {
  return {{Lanes::broadcast(rows[0][column]), Lanes::broadcast(rows[1][column]), Lanes::broadcast(rows[2][column])}};
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
