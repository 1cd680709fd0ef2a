#pragma once

#include "core/simd/simd.h"

/// As many doubles as a register holds, by the rules of core/simd.h: 8, 4, 2, or 1 where there are no intrinsics. Code
/// that treats lanes alike, and loops over parts of WideDouble::kLanes, gives the same bits with each.
///
/// `load_rows(rows, offsets, column)` gives four numbers of each lane in columns: lane i of column k is
/// rows[offsets[i] + k]. `store_rows(column, rows, offsets)` is the other way round.
namespace selvage {
inline namespace SELVAGE_ISA {

#if defined(__AVX512BW__) && !defined(SELVAGE_SIMD_SCALAR)

struct WideDouble {
  static constexpr int kLanes = 8;
  __m512d v;

  SELVAGE_INLINE static WideDouble load(const double* p) { return {_mm512_loadu_pd(p)}; }
  SELVAGE_INLINE static WideDouble broadcast(double x) { return {_mm512_set1_pd(x)}; }
  SELVAGE_INLINE void store(double* p) const { _mm512_storeu_pd(p, v); }
};
// Masked by all lanes: of the plain intrinsics GCC 12 says that they read what was never written. So below.
SELVAGE_INLINE WideDouble max(WideDouble a, WideDouble b) {
  return {_mm512_maskz_max_pd(0xff, a.v, b.v)};
}
SELVAGE_INLINE WideDouble sqrt(WideDouble a) {
  return {_mm512_maskz_sqrt_pd(0xff, a.v)};
}

/// a < b ? x : y
SELVAGE_INLINE WideDouble select_less(WideDouble a, WideDouble b, WideDouble x, WideDouble y) {
  return {_mm512_mask_blend_pd(_mm512_cmp_pd_mask(a.v, b.v, _CMP_LT_OQ), y.v, x.v)};
}
/// Whether a < b in some lane.
SELVAGE_INLINE bool any_less(WideDouble a, WideDouble b) {
  return _mm512_cmp_pd_mask(a.v, b.v, _CMP_LT_OQ) != 0;
}

template <typename Offset>
SELVAGE_INLINE void load_rows(const double* rows, const Offset* offsets, WideDouble (&column)[4]) {
  // Rows i and i + 2 in the two halves of a register: then quarters come together in their order.
  const auto load_two = [&](int i) {
    return _mm512_mask_broadcast_f64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(rows + offsets[i])), 0xf0,
                                       _mm256_loadu_pd(rows + offsets[i + 2]));
  };
  const __m512d a = load_two(0), b = load_two(1), c = load_two(4), d = load_two(5);
  const __m512d ab_low = _mm512_maskz_unpacklo_pd(0xff, a, b), ab_high = _mm512_maskz_unpackhi_pd(0xff, a, b);
  const __m512d cd_low = _mm512_maskz_unpacklo_pd(0xff, c, d), cd_high = _mm512_maskz_unpackhi_pd(0xff, c, d);
  column[0].v = _mm512_maskz_shuffle_f64x2(0xff, ab_low, cd_low, 0x88);
  column[1].v = _mm512_maskz_shuffle_f64x2(0xff, ab_high, cd_high, 0x88);
  column[2].v = _mm512_maskz_shuffle_f64x2(0xff, ab_low, cd_low, 0xdd);
  column[3].v = _mm512_maskz_shuffle_f64x2(0xff, ab_high, cd_high, 0xdd);
}
template <typename Offset>
SELVAGE_INLINE void store_rows(const WideDouble (&column)[4], double* rows, const Offset* offsets) {
  const __m512d xy_low = _mm512_maskz_unpacklo_pd(0xff, column[0].v, column[1].v),
                xy_high = _mm512_maskz_unpackhi_pd(0xff, column[0].v, column[1].v);
  const __m512d zw_low = _mm512_maskz_unpacklo_pd(0xff, column[2].v, column[3].v),
                zw_high = _mm512_maskz_unpackhi_pd(0xff, column[2].v, column[3].v);
  // Quarters of one between those of the other, each moved by one quarter: rows i and i + 4.
  const __m512d r[4] = {_mm512_mask_shuffle_f64x2(xy_low, 0xcc, zw_low, zw_low, 0xb1),
                        _mm512_mask_shuffle_f64x2(xy_high, 0xcc, zw_high, zw_high, 0xb1),
                        _mm512_mask_shuffle_f64x2(zw_low, 0x33, xy_low, xy_low, 0xb1),
                        _mm512_mask_shuffle_f64x2(zw_high, 0x33, xy_high, xy_high, 0xb1)};
  for (int i = 0; i < 4; ++i) {
    _mm256_storeu_pd(rows + offsets[i], _mm512_maskz_extractf64x4_pd(0xf, r[i], 0));
    _mm256_storeu_pd(rows + offsets[i + 4], _mm512_maskz_extractf64x4_pd(0xf, r[i], 1));
  }
}

#elif defined(SELVAGE_SIMD_AVX2)

struct WideDouble {
  static constexpr int kLanes = 4;
  __m256d v;

  SELVAGE_INLINE static WideDouble load(const double* p) { return {_mm256_loadu_pd(p)}; }
  SELVAGE_INLINE static WideDouble broadcast(double x) { return {_mm256_set1_pd(x)}; }
  SELVAGE_INLINE void store(double* p) const { _mm256_storeu_pd(p, v); }
};
SELVAGE_INLINE WideDouble max(WideDouble a, WideDouble b) {
  return {_mm256_max_pd(a.v, b.v)};
}
SELVAGE_INLINE WideDouble sqrt(WideDouble a) {
  return {_mm256_sqrt_pd(a.v)};
}
SELVAGE_INLINE WideDouble select_less(WideDouble a, WideDouble b, WideDouble x, WideDouble y) {
  return {_mm256_blendv_pd(y.v, x.v, _mm256_cmp_pd(a.v, b.v, _CMP_LT_OQ))};
}
SELVAGE_INLINE bool any_less(WideDouble a, WideDouble b) {
  return _mm256_movemask_pd(_mm256_cmp_pd(a.v, b.v, _CMP_LT_OQ)) != 0;
}

/// Its own inverse.
SELVAGE_INLINE void transpose_rows(const __m256d (&r)[4], __m256d (&c)[4]) {
  const __m256d ab_low = _mm256_unpacklo_pd(r[0], r[1]), ab_high = _mm256_unpackhi_pd(r[0], r[1]);
  const __m256d cd_low = _mm256_unpacklo_pd(r[2], r[3]), cd_high = _mm256_unpackhi_pd(r[2], r[3]);
  c[0] = _mm256_permute2f128_pd(ab_low, cd_low, 0x20);
  c[1] = _mm256_permute2f128_pd(ab_high, cd_high, 0x20);
  c[2] = _mm256_permute2f128_pd(ab_low, cd_low, 0x31);
  c[3] = _mm256_permute2f128_pd(ab_high, cd_high, 0x31);
}
template <typename Offset>
SELVAGE_INLINE void load_rows(const double* rows, const Offset* offsets, WideDouble (&column)[4]) {
  __m256d r[4], c[4];
  for (int i = 0; i < 4; ++i) r[i] = _mm256_loadu_pd(rows + offsets[i]);
  transpose_rows(r, c);
  for (int k = 0; k < 4; ++k) column[k].v = c[k];
}
template <typename Offset>
SELVAGE_INLINE void store_rows(const WideDouble (&column)[4], double* rows, const Offset* offsets) {
  __m256d r[4];
  const __m256d c[4] = {column[0].v, column[1].v, column[2].v, column[3].v};
  transpose_rows(c, r);
  for (int i = 0; i < 4; ++i) _mm256_storeu_pd(rows + offsets[i], r[i]);
}

#elif defined(SELVAGE_SIMD_SSE2)

struct WideDouble {
  static constexpr int kLanes = 2;
  __m128d v;

  SELVAGE_INLINE static WideDouble load(const double* p) { return {_mm_loadu_pd(p)}; }
  SELVAGE_INLINE static WideDouble broadcast(double x) { return {_mm_set1_pd(x)}; }
  SELVAGE_INLINE void store(double* p) const { _mm_storeu_pd(p, v); }
};
SELVAGE_INLINE WideDouble max(WideDouble a, WideDouble b) {
  return {_mm_max_pd(a.v, b.v)};
}
SELVAGE_INLINE WideDouble sqrt(WideDouble a) {
  return {_mm_sqrt_pd(a.v)};
}
SELVAGE_INLINE WideDouble select_less(WideDouble a, WideDouble b, WideDouble x, WideDouble y) {
  const __m128d less = _mm_cmplt_pd(a.v, b.v);
  return {_mm_or_pd(_mm_and_pd(less, x.v), _mm_andnot_pd(less, y.v))};
}
SELVAGE_INLINE bool any_less(WideDouble a, WideDouble b) {
  return _mm_movemask_pd(_mm_cmplt_pd(a.v, b.v)) != 0;
}

template <typename Offset>
SELVAGE_INLINE void load_rows(const double* rows, const Offset* offsets, WideDouble (&column)[4]) {
  const double* const a = rows + offsets[0];
  const double* const b = rows + offsets[1];
  for (int k = 0; k < 4; k += 2) {
    const __m128d of_a = _mm_loadu_pd(a + k), of_b = _mm_loadu_pd(b + k);
    column[k].v = _mm_unpacklo_pd(of_a, of_b);
    column[k + 1].v = _mm_unpackhi_pd(of_a, of_b);
  }
}
template <typename Offset>
SELVAGE_INLINE void store_rows(const WideDouble (&column)[4], double* rows, const Offset* offsets) {
  double* const a = rows + offsets[0];
  double* const b = rows + offsets[1];
  for (int k = 0; k < 4; k += 2) {
    _mm_storeu_pd(a + k, _mm_unpacklo_pd(column[k].v, column[k + 1].v));
    _mm_storeu_pd(b + k, _mm_unpackhi_pd(column[k].v, column[k + 1].v));
  }
}

#else

struct WideDouble {
  static constexpr int kLanes = 1;
  double v;

  SELVAGE_INLINE static WideDouble load(const double* p) { return {*p}; }
  SELVAGE_INLINE static WideDouble broadcast(double x) { return {x}; }
  SELVAGE_INLINE void store(double* p) const { *p = v; }
};
SELVAGE_INLINE WideDouble max(WideDouble a, WideDouble b) {
  return {a.v > b.v ? a.v : b.v};
}
SELVAGE_INLINE WideDouble sqrt(WideDouble a) {
  return {__builtin_sqrt(a.v)};
}
SELVAGE_INLINE WideDouble select_less(WideDouble a, WideDouble b, WideDouble x, WideDouble y) {
  return a.v < b.v ? x : y;
}
SELVAGE_INLINE bool any_less(WideDouble a, WideDouble b) {
  return a.v < b.v;
}
template <typename Offset>
SELVAGE_INLINE void load_rows(const double* rows, const Offset* offsets, WideDouble (&column)[4]) {
  for (int k = 0; k < 4; ++k) column[k].v = rows[offsets[0] + k];
}
template <typename Offset>
SELVAGE_INLINE void store_rows(const WideDouble (&column)[4], double* rows, const Offset* offsets) {
  for (int k = 0; k < 4; ++k) rows[offsets[0] + k] = column[k].v;
}

#endif

/// Four doubles, whatever the width of registers.
#if defined(SELVAGE_SIMD_AVX2)

struct Double4 {
  __m256d v;

  SELVAGE_INLINE static Double4 load_floats(const float* p) { return {_mm256_cvtps_pd(_mm_loadu_ps(p))}; }
  SELVAGE_INLINE static Double4 broadcast(double x) { return {_mm256_set1_pd(x)}; }
  SELVAGE_INLINE void store(double* p) const { _mm256_storeu_pd(p, v); }
};
SELVAGE_INLINE Double4 operator+(Double4 a, Double4 b) {
  return {a.v + b.v};
}
SELVAGE_INLINE Double4 operator*(Double4 a, Double4 b) {
  return {a.v * b.v};
}

#else

struct Double4 {
  double v[4];

  SELVAGE_INLINE static Double4 load_floats(const float* p) { return {{p[0], p[1], p[2], p[3]}}; }
  SELVAGE_INLINE static Double4 broadcast(double x) { return {{x, x, x, x}}; }
  SELVAGE_INLINE void store(double* p) const {
    for (int i = 0; i < 4; ++i) p[i] = v[i];
  }
};
SELVAGE_INLINE Double4 operator+(Double4 a, Double4 b) {
  return {{a.v[0] + b.v[0], a.v[1] + b.v[1], a.v[2] + b.v[2], a.v[3] + b.v[3]}};
}
SELVAGE_INLINE Double4 operator*(Double4 a, Double4 b) {
  return {{a.v[0] * b.v[0], a.v[1] * b.v[1], a.v[2] * b.v[2], a.v[3] * b.v[3]}};
}

#endif

// The compilers' own operators of registers, which is also what the intrinsics are made of.
SELVAGE_INLINE WideDouble operator+(WideDouble a, WideDouble b) {
  return {a.v + b.v};
}
SELVAGE_INLINE WideDouble operator-(WideDouble a, WideDouble b) {
  return {a.v - b.v};
}
SELVAGE_INLINE WideDouble operator*(WideDouble a, WideDouble b) {
  return {a.v * b.v};
}
SELVAGE_INLINE WideDouble operator/(WideDouble a, WideDouble b) {
  return {a.v / b.v};
}
SELVAGE_INLINE WideDouble abs(WideDouble a) {
  return max(a, WideDouble::broadcast(0) - a);
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
