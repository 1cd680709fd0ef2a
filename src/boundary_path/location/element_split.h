#pragma once

#include "boundary_path/location/containment_kernel.h"
#include "core/simd/simd16.h"
#include "core/simd/vec3.h"

namespace selvage {
inline namespace SELVAGE_ISA {

/// Where points lie, as far as single precision tells: `unsure` may be in the element or not, what is in neither mask
/// is outside.
struct PointSides {
  unsigned inside;
  unsigned unsure;
};

/// Eight elements, made ready to be compared with many points each.
///
/// A point q, relative to vertex 0, splits an element into parts, one for each vertex that it replaces; their signed
/// volumes (times D!) are linear in q: normal[k] . q for vertex k + 1, and what these leave of the whole volume for
/// vertex 0. The point is inside when no part is turned against the whole.
template <int D>
class ElementSplits {
 public:
  static constexpr int kSize = 8;

  SELVAGE_INLINE ElementSplits(const RoundedPosition* rounded, float rounding,
                               const VertexTuple<D + 1>* const (&elements)[kSize]) {
    Vector x[D + 1], edge[D], normal[D], extent;
    for (int k = 0; k <= D; ++k) x[k] = gather(rounded, elements, k);
    for (int i = 0; i < D; ++i) {
      Lanes low = x[0][i], high = low;
      for (int k = 0; k < D; ++k) {
        edge[k][i] = x[k + 1][i] - x[0][i];
        low = min(low, x[k + 1][i]);
        high = max(high, x[k + 1][i]);
      }
      extent[i] = high - low + Lanes::broadcast(8 * rounding);
      x[0][i].store(corner_[i]);
    }
    set_normals(edge, normal);
    const Lanes volume = dot(normal[0], edge[0]);
    error_bound(extent, rounding).store(bound_);
    const Lanes sign = or_bits(and_bits(volume, Lanes::broadcast(-0.0f)), Lanes::broadcast(1));
    (volume * sign).store(volume_);
    for (int k = 0; k < D; ++k)
      for (int i = 0; i < D; ++i) (normal[k][i] * sign).store(normal_[k][i]);
  }

  /// Compares some of sixteen points, whose boxes meet that of element e, with the element.
  SELVAGE_INLINE PointSides sides(int e, const Float16* points, unsigned among) const {
    const float bound = bound_[e];
    if (!(volume_[e] > bound)) return {0, among};
    Float16 q[D];
    for (int i = 0; i < D; ++i) q[i] = points[i] - Float16::broadcast(corner_[i][e]);
    Float16 rest = Float16::broadcast(volume_[e]), least = rest;
    for (int k = 0; k < D; ++k) {
      Float16 part = q[0] * Float16::broadcast(normal_[k][0][e]);
      for (int i = 1; i < D; ++i) part = part + q[i] * Float16::broadcast(normal_[k][i][e]);
      least = min(least, part);
      rest = rest - part;
    }
    least = min(least, rest);
    const unsigned inside = less_equal(Float16::broadcast(bound), least, among);
    return {inside, less_equal(Float16::broadcast(-bound), least, among) & ~inside};
  }

 private:
  using Lanes = Float8;
  using Vector = LaneVec<Lanes, D>;

  SELVAGE_INLINE static Vector gather(const RoundedPosition* rounded,
                                      const VertexTuple<D + 1>* const (&elements)[kSize], int k) {
    Float4 row[kSize];
    for (int e = 0; e < kSize; ++e) row[e] = Float4::load(rounded[(*elements[e])[k]].data());
    transpose(row[0], row[1], row[2], row[3]);
    transpose(row[4], row[5], row[6], row[7]);
    Vector x;
    for (int i = 0; i < D; ++i) x[i] = Lanes::join(row[i], row[4 + i]);
    return x;
  }

  SELVAGE_INLINE static void set_normals(const LaneVec2<Lanes> (&edge)[2], LaneVec2<Lanes> (&normal)[2]) {
    normal[0] = {{edge[1][1], negate(edge[1][0])}};
    normal[1] = {{negate(edge[0][1]), edge[0][0]}};
  }
  SELVAGE_INLINE static void set_normals(const LaneVec3<Lanes> (&edge)[3], LaneVec3<Lanes> (&normal)[3]) {
    for (int k = 0; k < 3; ++k) normal[k] = cross(edge[(k + 1) % 3], edge[(k + 2) % 3]);
  }

  /// More than the error of a part or of the volume. Each is a sum of D! products of D factors, one from each axis and
  /// below the extent there; a factor is off by two roundings of positions (`rounding` each) and one of a difference
  /// (2^-24 of it), a product by five more roundings. The last part is off by the errors of all the others and of its
  /// own three differences: by 48 `rounding` times the products without one axis, and by 270 times 2^-24 of the product
  /// of all. What underflow adds is far below the last term.
  SELVAGE_INLINE static Lanes error_bound(const Vector& extent, float rounding) {
    Lanes whole = extent[0], without_one = Lanes::broadcast(1);
    for (int i = 1; i < D; ++i) {
      without_one = without_one * extent[i] + whole;
      whole = whole * extent[i];
    }
    return whole * Lanes::broadcast(0x1p-15f) + without_one * Lanes::broadcast(64 * rounding) +
           Lanes::broadcast(1e-35f);
  }

  alignas(32) float corner_[D][kSize];
  alignas(32) float normal_[D][D][kSize];
  alignas(32) float volume_[kSize];
  alignas(32) float bound_[kSize];
};

}  // namespace SELVAGE_ISA
}  // namespace selvage
