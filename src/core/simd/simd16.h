#pragma once

#include "core/simd/simd.h"

#if defined(__AVX512BW__) && !defined(SELVAGE_SIMD_SCALAR)
#define SELVAGE_SIMD_AVX512 1
#endif

/// Sixteen floats and eight integers, by the rules of core/simd.h. Comparisons of floats look only at the lanes
/// `among`, at no cost.
namespace selvage {
inline namespace SELVAGE_ISA {

#ifdef SELVAGE_SIMD_AVX512

struct Float16 {
  __m512 v;

  SELVAGE_INLINE static Float16 load(const float* p) { return {_mm512_loadu_ps(p)}; }
  SELVAGE_INLINE static Float16 broadcast(float x) { return {_mm512_set1_ps(x)}; }
  SELVAGE_INLINE static Float16 join(Float8 low, Float8 high) {
    return {_mm512_maskz_insertf32x8(0xffff, _mm512_castps256_ps512(low.v), high.v, 1)};
  }
  /// Entries of a table of sixteen; numbers lie in [0, 16).
  SELVAGE_INLINE static Float16 pick(const float* table, const std::int32_t* numbers) {
    return {_mm512_maskz_permutexvar_ps(0xffff, _mm512_loadu_si512(numbers), _mm512_loadu_ps(table))};
  }
  SELVAGE_INLINE void store(float* p) const { _mm512_storeu_ps(p, v); }
};
SELVAGE_INLINE Float16 operator+(Float16 a, Float16 b) {
  return {_mm512_add_ps(a.v, b.v)};
}
SELVAGE_INLINE Float16 operator-(Float16 a, Float16 b) {
  return {_mm512_sub_ps(a.v, b.v)};
}
SELVAGE_INLINE Float16 operator*(Float16 a, Float16 b) {
  return {_mm512_mul_ps(a.v, b.v)};
}
// Masked by all lanes: of the plain intrinsic GCC 12 says that it reads what was never written.
SELVAGE_INLINE Float16 min(Float16 a, Float16 b) {
  return {_mm512_maskz_min_ps(0xffff, a.v, b.v)};
}
SELVAGE_INLINE Float16 max(Float16 a, Float16 b) {
  return {_mm512_maskz_max_ps(0xffff, a.v, b.v)};
}
SELVAGE_INLINE Float16 operator/(Float16 a, Float16 b) {
  return {_mm512_div_ps(a.v, b.v)};
}
SELVAGE_INLINE Float16 sqrt(Float16 a) {
  return {_mm512_maskz_sqrt_ps(0xffff, a.v)};
}
/// a < b ? x : y
SELVAGE_INLINE Float16 select_less(Float16 a, Float16 b, Float16 x, Float16 y) {
  return {_mm512_mask_blend_ps(_mm512_cmp_ps_mask(a.v, b.v, _CMP_LT_OQ), y.v, x.v)};
}
SELVAGE_INLINE unsigned less_equal(Float16 a, Float16 b, unsigned among = 0xffff) {
  return _mm512_mask_cmp_ps_mask(static_cast<__mmask16>(among), a.v, b.v, _CMP_LE_OQ);
}

SELVAGE_INLINE unsigned equal_bits(Float16 a, Float16 b) {
  return _mm512_cmpeq_epi32_mask(_mm512_castps_si512(a.v), _mm512_castps_si512(b.v));
}
SELVAGE_INLINE Float16 and_bits(Float16 a, Float16 b) {
  return {_mm512_maskz_and_ps(0xffff, a.v, b.v)};
}
/// Lanes whose sign is set, -0 too.
SELVAGE_INLINE unsigned sign_bits(Float16 a) {
  return _mm512_movepi32_mask(_mm512_castps_si512(a.v));
}

// Each in all quarters as for four lanes.
SELVAGE_INLINE Float16 interleave_low(Float16 a, Float16 b) {
  return {_mm512_maskz_unpacklo_ps(0xffff, a.v, b.v)};
}
SELVAGE_INLINE Float16 interleave_high(Float16 a, Float16 b) {
  return {_mm512_maskz_unpackhi_ps(0xffff, a.v, b.v)};
}
SELVAGE_INLINE Float16 join_low(Float16 a, Float16 b) {
  return {_mm512_maskz_shuffle_ps(0xffff, a.v, b.v, 0x44)};
}
SELVAGE_INLINE Float16 join_high(Float16 a, Float16 b) {
  return {_mm512_maskz_shuffle_ps(0xffff, a.v, b.v, 0xee)};
}

#else

struct Float16 {
  Float8 halves[2];

  SELVAGE_INLINE static Float16 load(const float* p) { return {{Float8::load(p), Float8::load(p + 8)}}; }
  SELVAGE_INLINE static Float16 broadcast(float x) { return {{Float8::broadcast(x), Float8::broadcast(x)}}; }
  SELVAGE_INLINE static Float16 join(Float8 low, Float8 high) { return {{low, high}}; }
  /// Entries of a table of sixteen; numbers lie in [0, 16).
  SELVAGE_INLINE static Float16 pick(const float* table, const std::int32_t* numbers) {
#ifdef SELVAGE_SIMD_AVX2
    const auto half = [&](const std::int32_t* p) -> Float8 {
      return {_mm256_i32gather_ps(table, _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p)), 4)};
    };
    return {{half(numbers), half(numbers + 8)}};
#else
    float picked[16];
    for (int i = 0; i < 16; ++i) picked[i] = table[numbers[i]];
    return load(picked);
#endif
  }
  SELVAGE_INLINE void store(float* p) const {
    halves[0].store(p);
    halves[1].store(p + 8);
  }
};
SELVAGE_INLINE Float16 operator+(Float16 a, Float16 b) {
  return {{a.halves[0] + b.halves[0], a.halves[1] + b.halves[1]}};
}
SELVAGE_INLINE Float16 operator-(Float16 a, Float16 b) {
  return {{a.halves[0] - b.halves[0], a.halves[1] - b.halves[1]}};
}
SELVAGE_INLINE Float16 operator*(Float16 a, Float16 b) {
  return {{a.halves[0] * b.halves[0], a.halves[1] * b.halves[1]}};
}
SELVAGE_INLINE Float16 min(Float16 a, Float16 b) {
  return {{min(a.halves[0], b.halves[0]), min(a.halves[1], b.halves[1])}};
}
SELVAGE_INLINE Float16 max(Float16 a, Float16 b) {
  return {{max(a.halves[0], b.halves[0]), max(a.halves[1], b.halves[1])}};
}
SELVAGE_INLINE Float16 operator/(Float16 a, Float16 b) {
  return {{a.halves[0] / b.halves[0], a.halves[1] / b.halves[1]}};
}
SELVAGE_INLINE Float16 sqrt(Float16 a) {
  return {{sqrt(a.halves[0]), sqrt(a.halves[1])}};
}
/// a < b ? x : y
SELVAGE_INLINE Float16 select_less(Float16 a, Float16 b, Float16 x, Float16 y) {
  return {{select_less(a.halves[0], b.halves[0], x.halves[0], y.halves[0]),
           select_less(a.halves[1], b.halves[1], x.halves[1], y.halves[1])}};
}
SELVAGE_INLINE unsigned less_equal(Float16 a, Float16 b, unsigned among = 0xffff) {
  return (less_equal(a.halves[0], b.halves[0]) | (less_equal(a.halves[1], b.halves[1]) << 8)) & among;
}

SELVAGE_INLINE unsigned equal_bits(Float16 a, Float16 b) {
  return equal_bits(a.halves[0], b.halves[0]) | (equal_bits(a.halves[1], b.halves[1]) << 8);
}
SELVAGE_INLINE Float16 and_bits(Float16 a, Float16 b) {
  return {{and_bits(a.halves[0], b.halves[0]), and_bits(a.halves[1], b.halves[1])}};
}
/// Lanes whose sign is set, -0 too.
SELVAGE_INLINE unsigned sign_bits(Float16 a) {
  return sign_bits(a.halves[0]) | (sign_bits(a.halves[1]) << 8);
}

// Each in all quarters as for four lanes.
SELVAGE_INLINE Float16 interleave_low(Float16 a, Float16 b) {
  return {{interleave_low(a.halves[0], b.halves[0]), interleave_low(a.halves[1], b.halves[1])}};
}
SELVAGE_INLINE Float16 interleave_high(Float16 a, Float16 b) {
  return {{interleave_high(a.halves[0], b.halves[0]), interleave_high(a.halves[1], b.halves[1])}};
}
SELVAGE_INLINE Float16 join_low(Float16 a, Float16 b) {
  return {{join_low(a.halves[0], b.halves[0]), join_low(a.halves[1], b.halves[1])}};
}
SELVAGE_INLINE Float16 join_high(Float16 a, Float16 b) {
  return {{join_high(a.halves[0], b.halves[0]), join_high(a.halves[1], b.halves[1])}};
}

#endif

#ifdef SELVAGE_SIMD_AVX2

struct Int8 {
  __m256i v;

  SELVAGE_INLINE static Int8 load(const std::int32_t* p) {
    return {_mm256_loadu_si256(reinterpret_cast<const __m256i*>(p))};
  }
  /// Eight words, without sign.
  SELVAGE_INLINE static Int8 load(const std::uint16_t* p) {
    return {_mm256_cvtepu16_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(p)))};
  }
  SELVAGE_INLINE static Int8 broadcast(std::int32_t x) { return {_mm256_set1_epi32(x)}; }
  /// Eight bytes, without sign, the lowest first.
  SELVAGE_INLINE static Int8 from_bytes(std::uint64_t bytes) {
    return {_mm256_cvtepu8_epi32(_mm_cvtsi64_si128(static_cast<long long>(bytes)))};
  }
  SELVAGE_INLINE void store(std::int32_t* p) const { _mm256_storeu_si256(reinterpret_cast<__m256i*>(p), v); }
};
SELVAGE_INLINE Int8 operator&(Int8 a, Int8 b) {
  return {_mm256_and_si256(a.v, b.v)};
}
SELVAGE_INLINE Int8 operator|(Int8 a, Int8 b) {
  return {_mm256_or_si256(a.v, b.v)};
}
SELVAGE_INLINE Int8 operator~(Int8 a) {
  return {_mm256_xor_si256(a.v, _mm256_set1_epi32(-1))};
}
/// Without sign.
template <int kBits>
SELVAGE_INLINE Int8 shift_right(Int8 a) {
  return {_mm256_srli_epi32(a.v, kBits)};
}
/// The lanes of these numbers; only their lowest three bits count.
SELVAGE_INLINE Float8 pick_lanes(Float8 a, Int8 numbers) {
  return {_mm256_permutevar8x32_ps(a.v, numbers.v)};
}
SELVAGE_INLINE unsigned negative(Int8 a) {
  return static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(a.v)));
}
SELVAGE_INLINE unsigned zero(Int8 a) {
  return static_cast<unsigned>(
      _mm256_movemask_ps(_mm256_castsi256_ps(_mm256_cmpeq_epi32(a.v, _mm256_setzero_si256()))));
}

#else

struct Int8 {
  std::int32_t v[8];

  template <typename Integer>
  SELVAGE_INLINE static Int8 load(const Integer* p) {
    return {{p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7]}};
  }
  SELVAGE_INLINE static Int8 broadcast(std::int32_t x) { return {{x, x, x, x, x, x, x, x}}; }
  /// Eight bytes, without sign, the lowest first.
  SELVAGE_INLINE static Int8 from_bytes(std::uint64_t bytes) {
    Int8 a;
    for (int i = 0; i < 8; ++i) a.v[i] = static_cast<std::int32_t>(bytes >> 8 * i & 0xff);
    return a;
  }
  SELVAGE_INLINE void store(std::int32_t* p) const {
    for (int i = 0; i < 8; ++i) p[i] = v[i];
  }
};
SELVAGE_INLINE Int8 operator&(Int8 a, const Int8& b) {
  for (int i = 0; i < 8; ++i) a.v[i] &= b.v[i];
  return a;
}
SELVAGE_INLINE Int8 operator|(Int8 a, const Int8& b) {
  for (int i = 0; i < 8; ++i) a.v[i] |= b.v[i];
  return a;
}
SELVAGE_INLINE Int8 operator~(Int8 a) {
  for (int i = 0; i < 8; ++i) a.v[i] = ~a.v[i];
  return a;
}
/// Without sign.
template <int kBits>
SELVAGE_INLINE Int8 shift_right(Int8 a) {
  for (int i = 0; i < 8; ++i) a.v[i] = static_cast<std::int32_t>(static_cast<std::uint32_t>(a.v[i]) >> kBits);
  return a;
}
/// The lanes of these numbers; only their lowest three bits count.
SELVAGE_INLINE Float8 pick_lanes(const Float8& a, const Int8& numbers) {
  float all[8], picked[8];
  a.store(all);
  for (int i = 0; i < 8; ++i) picked[i] = all[numbers.v[i] & 7];
  return Float8::load(picked);
}
SELVAGE_INLINE unsigned negative(const Int8& a) {
  unsigned mask = 0;
  for (int i = 0; i < 8; ++i) mask |= static_cast<unsigned>(a.v[i] < 0) << i;
  return mask;
}
SELVAGE_INLINE unsigned zero(const Int8& a) {
  unsigned mask = 0;
  for (int i = 0; i < 8; ++i) mask |= static_cast<unsigned>(a.v[i] == 0) << i;
  return mask;
}

#endif

/// Stores the lanes of a mask one after the other; what lies behind them, up to eight lanes in all, is overwritten.
SELVAGE_INLINE void store_packed(Int8 a, unsigned lanes, std::int32_t* p) {
#ifdef SELVAGE_SIMD_AVX512
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(p), _mm256_maskz_compress_epi32(static_cast<__mmask8>(lanes), a.v));
#elif defined(SELVAGE_SIMD_AVX2)
  // The numbers of the lanes, a byte for each.
  const std::uint64_t kept = _pdep_u64(lanes, 0x0101010101010101u) * 0xff;
  const __m128i numbers = _mm_cvtsi64_si128(static_cast<long long>(_pext_u64(0x0706050403020100u, kept)));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(p), _mm256_permutevar8x32_epi32(a.v, _mm256_cvtepu8_epi32(numbers)));
#else
  std::int32_t all[8];
  a.store(all);
  for (; lanes != 0; lanes &= lanes - 1) *p++ = all[lowest_lane(lanes)];
#endif
}

/// Stores the numbers of the bits, the lowest first; what lies behind them, up to 16 more than there are, is
/// overwritten. Returns how many there are.
SELVAGE_INLINE int store_bit_numbers(std::uint64_t bits, std::int32_t* p) {
  int count = 0;
#ifdef SELVAGE_SIMD_AVX512
  __m512i numbers = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  for (int i = 0; i < 64; i += 16) {
    const auto sixteen = static_cast<__mmask16>(bits >> i);
    _mm512_storeu_si512(p + count, _mm512_maskz_compress_epi32(sixteen, numbers));
    count += count_lanes(sixteen);
    numbers = _mm512_add_epi32(numbers, _mm512_set1_epi32(16));
  }
#else
  alignas(32) static constexpr std::int32_t kLaneNumbers[8] = {0, 1, 2, 3, 4, 5, 6, 7};
  const Int8 lanes = Int8::load(kLaneNumbers);
  for (int i = 0; i < 64; i += 8) {
    const auto eight = static_cast<unsigned>(bits >> i) & 0xffu;
    store_packed(lanes | Int8::broadcast(i), eight, p + count);
    count += count_lanes(eight);
  }
#endif
  return count;
}

/// Eight numbers for each axis.
using AxisRows = float[3][8];

/// Which of eight boxes meet which of eight others, borders included: bit 8 i + k stands for box i of the first and box
/// k of the others.
SELVAGE_INLINE std::uint64_t pairs_that_meet(const AxisRows& lower_a, const AxisRows& upper_a, const AxisRows& lower_b,
                                             const AxisRows& upper_b) {
  std::uint64_t bits = 0;
#ifdef SELVAGE_SIMD_AVX512
  // Two boxes of the first at once: as a pair of floats again and again, beside each of the others twice.
  const __m512i twice = _mm512_setr_epi32(0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7);
  __m512 lower[3], upper[3];
  for (int axis = 0; axis < 3; ++axis) {
    const auto load_twice = [&](const float* row) {
      return _mm512_maskz_permutexvar_ps(0xffff, twice, _mm512_maskz_broadcast_f32x8(0xffff, _mm256_loadu_ps(row)));
    };
    lower[axis] = load_twice(lower_b[axis]);
    upper[axis] = load_twice(upper_b[axis]);
  }
  for (int i = 0; i < 8; i += 2) {
    const auto two = [&](const float* row) {
      return _mm512_castsi512_ps(_mm512_set1_epi64(_mm_cvtsi128_si64(_mm_loadu_si64(row + i))));
    };
    __mmask16 meet = 0xffff;
    for (int axis = 0; axis < 3; ++axis) {
      meet = _mm512_mask_cmp_ps_mask(meet, lower[axis], two(upper_a[axis]), _CMP_LE_OQ);
      meet = _mm512_mask_cmp_ps_mask(meet, two(lower_a[axis]), upper[axis], _CMP_LE_OQ);
    }
    bits |= std::uint64_t{meet} << 8 * i;
  }
  return _pdep_u64(_pext_u64(bits, 0x5555555555555555), 0x00ff00ff00ff00ff) |
         _pdep_u64(_pext_u64(bits, 0xaaaaaaaaaaaaaaaa), 0xff00ff00ff00ff00);
#else
  Float8 lower[3], upper[3];
  for (int axis = 0; axis < 3; ++axis) {
    lower[axis] = Float8::load(lower_b[axis]);
    upper[axis] = Float8::load(upper_b[axis]);
  }
  for (int i = 0; i < 8; ++i) {
    const auto meet_along = [&](int axis) {
      return and_bits(less_equal_lanes(lower[axis], Float8::broadcast(upper_a[axis][i])),
                      less_equal_lanes(Float8::broadcast(lower_a[axis][i]), upper[axis]));
    };
    bits |= std::uint64_t{sign_bits(and_bits(and_bits(meet_along(0), meet_along(1)), meet_along(2)))} << 8 * i;
  }
  return bits;
#endif
}

/// A table of 32 masks for each axis.
using AxisMasks = std::uint16_t[3][32];

/// The masks that all axes have at `lower`, less those that any has at `upper`. Places are truncated; they lie in
/// [0, 32).
SELVAGE_INLINE Int8 masks_between(const AxisMasks& masks, const Float8 (&lower)[3], const Float8 (&upper)[3]) {
#ifdef SELVAGE_SIMD_AVX512
  const auto at = [&](int axis, Float8 place) {
    return _mm512_maskz_permutexvar_epi16(~__mmask32{0}, _mm512_castsi256_si512(_mm256_cvttps_epi32(place.v)),
                                          _mm512_loadu_si512(masks[axis]));
  };
  __m512i all = _mm512_set1_epi32(0xffff);
  for (int axis = 0; axis < 3; ++axis)
    all = _mm512_and_si512(
        all, _mm512_and_si512(at(axis, lower[axis]), _mm512_xor_si512(at(axis, upper[axis]), _mm512_set1_epi32(-1))));
  return {_mm512_maskz_extracti64x4_epi64(0xf, all, 0)};
#else
  std::int32_t all[8] = {0xffff, 0xffff, 0xffff, 0xffff, 0xffff, 0xffff, 0xffff, 0xffff};
  for (int axis = 0; axis < 3; ++axis) {
    std::int32_t from[8], to[8];
    lower[axis].low().store_int(from);
    lower[axis].high().store_int(from + 4);
    upper[axis].low().store_int(to);
    upper[axis].high().store_int(to + 4);
    for (int i = 0; i < 8; ++i) all[i] &= masks[axis][from[i]] & ~masks[axis][to[i]];
  }
  return Int8::load(all);
#endif
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
