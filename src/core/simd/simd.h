#pragma once

#include "core/isa.h"

#include <bit>
#include <cstdint>

// SELVAGE_SIMD_SCALAR asks for plain C++, so that the fallback can be tested where intrinsics exist.
#if defined(__SSE2__) && !defined(SELVAGE_SIMD_SCALAR)
#include <immintrin.h>
#define SELVAGE_SIMD_SSE2 1
#endif
#if defined(__AVX2__) && !defined(SELVAGE_SIMD_SCALAR)
#define SELVAGE_SIMD_AVX2 1
#endif

#define SELVAGE_INLINE [[gnu::always_inline]] inline

/// The one place with intrinsics. Four and eight floats; every implementation gives the same bits: lane by lane the
/// IEEE operation, min(a, b) is a < b ? a : b, max(a, b) is a > b ? a : b, so that a NaN or two zeros give b. Masks
/// hold lane i in bit i.
namespace selvage {
inline namespace SELVAGE_ISA {

/// Lane of the lowest bit of a mask that is not 0.
SELVAGE_INLINE int lowest_lane(unsigned mask) {
  return __builtin_ctz(mask);
}

/// Number of lanes in a mask of eight.
SELVAGE_INLINE int count_lanes(unsigned mask) {
#ifdef __POPCNT__
  return __builtin_popcount(mask);
#else
  mask -= (mask >> 1) & 0x55u;
  mask = (mask & 0x33u) + ((mask >> 2) & 0x33u);
  return static_cast<int>((mask + (mask >> 4)) & 0x0fu);
#endif
}

/// The same for 64 bits.
SELVAGE_INLINE int lowest_bit(std::uint64_t bits) {
  return __builtin_ctzll(bits);
}
SELVAGE_INLINE int count_bits(std::uint64_t bits) {
  return __builtin_popcountll(bits);
}

#ifdef SELVAGE_SIMD_SSE2

struct Float4 {
  __m128 v;

  SELVAGE_INLINE static Float4 load(const float* p) { return {_mm_loadu_ps(p)}; }
  SELVAGE_INLINE static Float4 broadcast(float x) { return {_mm_set1_ps(x)}; }
  SELVAGE_INLINE void store(float* p) const { _mm_storeu_ps(p, v); }
  /// Truncated towards zero; the lanes must fit.
  SELVAGE_INLINE void store_int(std::int32_t* p) const {
    _mm_storeu_si128(reinterpret_cast<__m128i*>(p), _mm_cvttps_epi32(v));
  }
};
SELVAGE_INLINE Float4 operator+(Float4 a, Float4 b) {
  return {_mm_add_ps(a.v, b.v)};
}
SELVAGE_INLINE Float4 operator-(Float4 a, Float4 b) {
  return {_mm_sub_ps(a.v, b.v)};
}
SELVAGE_INLINE Float4 operator*(Float4 a, Float4 b) {
  return {_mm_mul_ps(a.v, b.v)};
}
SELVAGE_INLINE Float4 operator/(Float4 a, Float4 b) {
  return {_mm_div_ps(a.v, b.v)};
}
SELVAGE_INLINE Float4 min(Float4 a, Float4 b) {
  return {_mm_min_ps(a.v, b.v)};
}
SELVAGE_INLINE Float4 max(Float4 a, Float4 b) {
  return {_mm_max_ps(a.v, b.v)};
}
SELVAGE_INLINE Float4 sqrt(Float4 a) {
  return {_mm_sqrt_ps(a.v)};
}
SELVAGE_INLINE Float4 and_bits(Float4 a, Float4 b) {
  return {_mm_and_ps(a.v, b.v)};
}
SELVAGE_INLINE Float4 or_bits(Float4 a, Float4 b) {
  return {_mm_or_ps(a.v, b.v)};
}
SELVAGE_INLINE unsigned less_equal(Float4 a, Float4 b) {
  return static_cast<unsigned>(_mm_movemask_ps(_mm_cmple_ps(a.v, b.v)));
}
/// Bits compared as signed integers: the order of floats that are not negative, whatever the floating-point mode.
SELVAGE_INLINE unsigned less_bits(Float4 a, Float4 b) {
  return static_cast<unsigned>(
      _mm_movemask_ps(_mm_castsi128_ps(_mm_cmplt_epi32(_mm_castps_si128(a.v), _mm_castps_si128(b.v)))));
}
SELVAGE_INLINE unsigned equal_bits(Float4 a, Float4 b) {
  return static_cast<unsigned>(
      _mm_movemask_ps(_mm_castsi128_ps(_mm_cmpeq_epi32(_mm_castps_si128(a.v), _mm_castps_si128(b.v)))));
}
/// Lanes of ones where a <= b, of zeros elsewhere; combine with and_bits() and or_bits(), read with sign_bits().
SELVAGE_INLINE Float4 less_equal_lanes(Float4 a, Float4 b) {
  return {_mm_cmple_ps(a.v, b.v)};
}
SELVAGE_INLINE Float4 equal_lanes(Float4 a, Float4 b) {
  return {_mm_castsi128_ps(_mm_cmpeq_epi32(_mm_castps_si128(a.v), _mm_castps_si128(b.v)))};
}
SELVAGE_INLINE unsigned sign_bits(Float4 a) {
  return static_cast<unsigned>(_mm_movemask_ps(a.v));
}
/// a < b ? x : y
SELVAGE_INLINE Float4 select_less(Float4 a, Float4 b, Float4 x, Float4 y) {
  const __m128 mask = _mm_cmplt_ps(a.v, b.v);
  return {_mm_or_ps(_mm_and_ps(mask, x.v), _mm_andnot_ps(mask, y.v))};
}
/// (a0, b0, a1, b1)
SELVAGE_INLINE Float4 interleave_low(Float4 a, Float4 b) {
  return {_mm_unpacklo_ps(a.v, b.v)};
}
/// (a2, b2, a3, b3)
SELVAGE_INLINE Float4 interleave_high(Float4 a, Float4 b) {
  return {_mm_unpackhi_ps(a.v, b.v)};
}
/// (a0, a1, b0, b1)
SELVAGE_INLINE Float4 join_low(Float4 a, Float4 b) {
  return {_mm_movelh_ps(a.v, b.v)};
}
/// (a2, a3, b2, b3)
SELVAGE_INLINE Float4 join_high(Float4 a, Float4 b) {
  return {_mm_movehl_ps(b.v, a.v)};
}

SELVAGE_INLINE void prefetch(const void* p) {
  _mm_prefetch(static_cast<const char*>(p), _MM_HINT_T0);
}

#else

struct Float4 {
  float v[4];

  SELVAGE_INLINE static Float4 load(const float* p) { return {{p[0], p[1], p[2], p[3]}}; }
  SELVAGE_INLINE static Float4 broadcast(float x) { return {{x, x, x, x}}; }
  SELVAGE_INLINE void store(float* p) const {
    for (int i = 0; i < 4; ++i) p[i] = v[i];
  }
  /// Truncated towards zero; the lanes must fit.
  SELVAGE_INLINE void store_int(std::int32_t* p) const {
    for (int i = 0; i < 4; ++i) p[i] = static_cast<std::int32_t>(v[i]);
  }
  template <typename Operation>
  SELVAGE_INLINE static Float4 lanes(Operation operation) {
    return {{operation(0), operation(1), operation(2), operation(3)}};
  }
};
SELVAGE_INLINE std::int32_t float_bits(float x) {
  return std::bit_cast<std::int32_t>(x);
}
SELVAGE_INLINE Float4 operator+(const Float4& a, const Float4& b) {
  return Float4::lanes([&](int i) { return a.v[i] + b.v[i]; });
}
SELVAGE_INLINE Float4 operator-(const Float4& a, const Float4& b) {
  return Float4::lanes([&](int i) { return a.v[i] - b.v[i]; });
}
SELVAGE_INLINE Float4 operator*(const Float4& a, const Float4& b) {
  return Float4::lanes([&](int i) { return a.v[i] * b.v[i]; });
}
SELVAGE_INLINE Float4 operator/(const Float4& a, const Float4& b) {
  return Float4::lanes([&](int i) { return a.v[i] / b.v[i]; });
}
SELVAGE_INLINE Float4 min(const Float4& a, const Float4& b) {
  return Float4::lanes([&](int i) { return a.v[i] < b.v[i] ? a.v[i] : b.v[i]; });
}
SELVAGE_INLINE Float4 max(const Float4& a, const Float4& b) {
  return Float4::lanes([&](int i) { return a.v[i] > b.v[i] ? a.v[i] : b.v[i]; });
}
SELVAGE_INLINE Float4 sqrt(const Float4& a) {
  return Float4::lanes([&](int i) { return __builtin_sqrtf(a.v[i]); });
}
SELVAGE_INLINE Float4 and_bits(const Float4& a, const Float4& b) {
  return Float4::lanes([&](int i) { return std::bit_cast<float>(float_bits(a.v[i]) & float_bits(b.v[i])); });
}
SELVAGE_INLINE Float4 or_bits(const Float4& a, const Float4& b) {
  return Float4::lanes([&](int i) { return std::bit_cast<float>(float_bits(a.v[i]) | float_bits(b.v[i])); });
}
SELVAGE_INLINE unsigned less_equal(const Float4& a, const Float4& b) {
  unsigned mask = 0;
  for (int i = 0; i < 4; ++i) mask |= static_cast<unsigned>(a.v[i] <= b.v[i]) << i;
  return mask;
}
/// Bits compared as signed integers: the order of floats that are not negative, whatever the floating-point mode.
SELVAGE_INLINE unsigned less_bits(const Float4& a, const Float4& b) {
  unsigned mask = 0;
  for (int i = 0; i < 4; ++i) mask |= static_cast<unsigned>(float_bits(a.v[i]) < float_bits(b.v[i])) << i;
  return mask;
}
SELVAGE_INLINE unsigned equal_bits(const Float4& a, const Float4& b) {
  unsigned mask = 0;
  for (int i = 0; i < 4; ++i) mask |= static_cast<unsigned>(float_bits(a.v[i]) == float_bits(b.v[i])) << i;
  return mask;
}
/// Lanes of ones where a <= b, of zeros elsewhere; combine with and_bits() and or_bits(), read with sign_bits().
SELVAGE_INLINE Float4 less_equal_lanes(const Float4& a, const Float4& b) {
  return Float4::lanes([&](int i) { return std::bit_cast<float>(a.v[i] <= b.v[i] ? ~0u : 0u); });
}
SELVAGE_INLINE Float4 equal_lanes(const Float4& a, const Float4& b) {
  return Float4::lanes(
      [&](int i) { return std::bit_cast<float>(float_bits(a.v[i]) == float_bits(b.v[i]) ? ~0u : 0u); });
}
SELVAGE_INLINE unsigned sign_bits(const Float4& a) {
  unsigned mask = 0;
  for (int i = 0; i < 4; ++i) mask |= static_cast<unsigned>(float_bits(a.v[i]) < 0) << i;
  return mask;
}
/// a < b ? x : y
SELVAGE_INLINE Float4 select_less(const Float4& a, const Float4& b, const Float4& x, const Float4& y) {
  return Float4::lanes([&](int i) { return a.v[i] < b.v[i] ? x.v[i] : y.v[i]; });
}
/// (a0, b0, a1, b1)
SELVAGE_INLINE Float4 interleave_low(const Float4& a, const Float4& b) {
  return {{a.v[0], b.v[0], a.v[1], b.v[1]}};
}
/// (a2, b2, a3, b3)
SELVAGE_INLINE Float4 interleave_high(const Float4& a, const Float4& b) {
  return {{a.v[2], b.v[2], a.v[3], b.v[3]}};
}
/// (a0, a1, b0, b1)
SELVAGE_INLINE Float4 join_low(const Float4& a, const Float4& b) {
  return {{a.v[0], a.v[1], b.v[0], b.v[1]}};
}
/// (a2, a3, b2, b3)
SELVAGE_INLINE Float4 join_high(const Float4& a, const Float4& b) {
  return {{a.v[2], a.v[3], b.v[2], b.v[3]}};
}

SELVAGE_INLINE void prefetch(const void* p) {
  __builtin_prefetch(p);
}

#endif

#ifdef SELVAGE_SIMD_AVX2

struct Float8 {
  __m256 v;

  SELVAGE_INLINE static Float8 load(const float* p) { return {_mm256_loadu_ps(p)}; }
  SELVAGE_INLINE static Float8 broadcast(float x) { return {_mm256_set1_ps(x)}; }
  SELVAGE_INLINE static Float8 join(Float4 low, Float4 high) { return {_mm256_set_m128(high.v, low.v)}; }
  SELVAGE_INLINE Float4 low() const { return {_mm256_castps256_ps128(v)}; }
  SELVAGE_INLINE Float4 high() const { return {_mm256_extractf128_ps(v, 1)}; }
  SELVAGE_INLINE void store(float* p) const { _mm256_storeu_ps(p, v); }
};
SELVAGE_INLINE Float8 operator+(Float8 a, Float8 b) {
  return {_mm256_add_ps(a.v, b.v)};
}
SELVAGE_INLINE Float8 operator-(Float8 a, Float8 b) {
  return {_mm256_sub_ps(a.v, b.v)};
}
SELVAGE_INLINE Float8 operator*(Float8 a, Float8 b) {
  return {_mm256_mul_ps(a.v, b.v)};
}
SELVAGE_INLINE Float8 operator/(Float8 a, Float8 b) {
  return {_mm256_div_ps(a.v, b.v)};
}
SELVAGE_INLINE Float8 min(Float8 a, Float8 b) {
  return {_mm256_min_ps(a.v, b.v)};
}
SELVAGE_INLINE Float8 max(Float8 a, Float8 b) {
  return {_mm256_max_ps(a.v, b.v)};
}
SELVAGE_INLINE Float8 sqrt(Float8 a) {
  return {_mm256_sqrt_ps(a.v)};
}
SELVAGE_INLINE Float8 and_bits(Float8 a, Float8 b) {
  return {_mm256_and_ps(a.v, b.v)};
}
SELVAGE_INLINE Float8 or_bits(Float8 a, Float8 b) {
  return {_mm256_or_ps(a.v, b.v)};
}
SELVAGE_INLINE Float8 select_less(Float8 a, Float8 b, Float8 x, Float8 y) {
  return {_mm256_blendv_ps(y.v, x.v, _mm256_cmp_ps(a.v, b.v, _CMP_LT_OQ))};
}
SELVAGE_INLINE unsigned less_equal(Float8 a, Float8 b) {
#ifdef __AVX512VL__
  return _mm256_cmp_ps_mask(a.v, b.v, _CMP_LE_OQ);
#else
  return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(a.v, b.v, _CMP_LE_OQ)));
#endif
}
SELVAGE_INLINE unsigned less_bits(Float8 a, Float8 b) {
#ifdef __AVX512VL__
  return _mm256_cmplt_epi32_mask(_mm256_castps_si256(a.v), _mm256_castps_si256(b.v));
#else
  return static_cast<unsigned>(
      _mm256_movemask_ps(_mm256_castsi256_ps(_mm256_cmpgt_epi32(_mm256_castps_si256(b.v), _mm256_castps_si256(a.v)))));
#endif
}

SELVAGE_INLINE unsigned equal_bits(Float8 a, Float8 b) {
#ifdef __AVX512VL__
  return _mm256_cmpeq_epi32_mask(_mm256_castps_si256(a.v), _mm256_castps_si256(b.v));
#else
  return static_cast<unsigned>(
      _mm256_movemask_ps(_mm256_castsi256_ps(_mm256_cmpeq_epi32(_mm256_castps_si256(a.v), _mm256_castps_si256(b.v)))));
#endif
}
// Cheaper than masks where several are combined, which AVX-512 has to bring over from registers of their own.
SELVAGE_INLINE Float8 less_equal_lanes(Float8 a, Float8 b) {
  return {_mm256_cmp_ps(a.v, b.v, _CMP_LE_OQ)};
}
SELVAGE_INLINE Float8 equal_lanes(Float8 a, Float8 b) {
  return {_mm256_castsi256_ps(_mm256_cmpeq_epi32(_mm256_castps_si256(a.v), _mm256_castps_si256(b.v)))};
}
SELVAGE_INLINE unsigned sign_bits(Float8 a) {
  return static_cast<unsigned>(_mm256_movemask_ps(a.v));
}
// Each in both halves as for four lanes.
SELVAGE_INLINE Float8 interleave_low(Float8 a, Float8 b) {
  return {_mm256_unpacklo_ps(a.v, b.v)};
}
SELVAGE_INLINE Float8 interleave_high(Float8 a, Float8 b) {
  return {_mm256_unpackhi_ps(a.v, b.v)};
}
SELVAGE_INLINE Float8 join_low(Float8 a, Float8 b) {
  return {_mm256_shuffle_ps(a.v, b.v, 0x44)};
}
SELVAGE_INLINE Float8 join_high(Float8 a, Float8 b) {
  return {_mm256_shuffle_ps(a.v, b.v, 0xee)};
}

#else

struct Float8 {
  Float4 halves[2];

  SELVAGE_INLINE static Float8 load(const float* p) { return {{Float4::load(p), Float4::load(p + 4)}}; }
  SELVAGE_INLINE static Float8 broadcast(float x) { return {{Float4::broadcast(x), Float4::broadcast(x)}}; }
  SELVAGE_INLINE static Float8 join(Float4 low, Float4 high) { return {{low, high}}; }
  SELVAGE_INLINE Float4 low() const { return halves[0]; }
  SELVAGE_INLINE Float4 high() const { return halves[1]; }
  SELVAGE_INLINE void store(float* p) const {
    low().store(p);
    high().store(p + 4);
  }
};
SELVAGE_INLINE Float8 operator+(Float8 a, Float8 b) {
  return {{a.low() + b.low(), a.high() + b.high()}};
}
SELVAGE_INLINE Float8 operator-(Float8 a, Float8 b) {
  return {{a.low() - b.low(), a.high() - b.high()}};
}
SELVAGE_INLINE Float8 operator*(Float8 a, Float8 b) {
  return {{a.low() * b.low(), a.high() * b.high()}};
}
SELVAGE_INLINE Float8 operator/(Float8 a, Float8 b) {
  return {{a.low() / b.low(), a.high() / b.high()}};
}
SELVAGE_INLINE Float8 min(Float8 a, Float8 b) {
  return {{min(a.low(), b.low()), min(a.high(), b.high())}};
}
SELVAGE_INLINE Float8 max(Float8 a, Float8 b) {
  return {{max(a.low(), b.low()), max(a.high(), b.high())}};
}
SELVAGE_INLINE Float8 sqrt(Float8 a) {
  return {{sqrt(a.low()), sqrt(a.high())}};
}
SELVAGE_INLINE Float8 and_bits(Float8 a, Float8 b) {
  return {{and_bits(a.low(), b.low()), and_bits(a.high(), b.high())}};
}
SELVAGE_INLINE Float8 or_bits(Float8 a, Float8 b) {
  return {{or_bits(a.low(), b.low()), or_bits(a.high(), b.high())}};
}
SELVAGE_INLINE Float8 select_less(Float8 a, Float8 b, Float8 x, Float8 y) {
  return {{select_less(a.low(), b.low(), x.low(), y.low()), select_less(a.high(), b.high(), x.high(), y.high())}};
}
SELVAGE_INLINE unsigned less_equal(Float8 a, Float8 b) {
  return less_equal(a.low(), b.low()) | (less_equal(a.high(), b.high()) << 4);
}
SELVAGE_INLINE unsigned less_bits(Float8 a, Float8 b) {
  return less_bits(a.low(), b.low()) | (less_bits(a.high(), b.high()) << 4);
}
SELVAGE_INLINE unsigned equal_bits(Float8 a, Float8 b) {
  return equal_bits(a.low(), b.low()) | (equal_bits(a.high(), b.high()) << 4);
}
SELVAGE_INLINE Float8 less_equal_lanes(Float8 a, Float8 b) {
  return {{less_equal_lanes(a.low(), b.low()), less_equal_lanes(a.high(), b.high())}};
}
SELVAGE_INLINE Float8 equal_lanes(Float8 a, Float8 b) {
  return {{equal_lanes(a.low(), b.low()), equal_lanes(a.high(), b.high())}};
}
SELVAGE_INLINE unsigned sign_bits(Float8 a) {
  return sign_bits(a.low()) | (sign_bits(a.high()) << 4);
}
// Each in both halves as for four lanes.
SELVAGE_INLINE Float8 interleave_low(Float8 a, Float8 b) {
  return {{interleave_low(a.low(), b.low()), interleave_low(a.high(), b.high())}};
}
SELVAGE_INLINE Float8 interleave_high(Float8 a, Float8 b) {
  return {{interleave_high(a.low(), b.low()), interleave_high(a.high(), b.high())}};
}
SELVAGE_INLINE Float8 join_low(Float8 a, Float8 b) {
  return {{join_low(a.low(), b.low()), join_low(a.high(), b.high())}};
}
SELVAGE_INLINE Float8 join_high(Float8 a, Float8 b) {
  return {{join_high(a.low(), b.low()), join_high(a.high(), b.high())}};
}

#endif

/// Replaces the lowest three bits of every lane by the lane's number: lanes become distinct, and change by at most
/// seven units in the last place.
SELVAGE_INLINE Float8 tag_lanes(Float8 a) {
  alignas(32) static constexpr std::uint32_t kLanes[8] = {0, 1, 2, 3, 4, 5, 6, 7};
  const Float8 lanes = Float8::load(reinterpret_cast<const float*>(kLanes));
  return or_bits(and_bits(a, Float8::broadcast(std::bit_cast<float>(0xfffffff8u))), lanes);
}

/// Keeps the first `count` lanes, 0 <= count <= 8, and clears the others.
SELVAGE_INLINE Float8 keep_first(Float8 a, int count) {
  alignas(32) static constexpr std::uint32_t kOnesThenZeros[16] = {~0u, ~0u, ~0u, ~0u, ~0u, ~0u, ~0u, ~0u};
  return and_bits(a, Float8::load(reinterpret_cast<const float*>(kOnesThenZeros + 8 - count)));
}

/// Keeps the lanes of a mask of eight, and clears the others.
SELVAGE_INLINE Float8 keep_lanes(Float8 a, unsigned mask) {
#if defined(SELVAGE_SIMD_AVX2) && defined(__AVX512VL__)
  return {_mm256_maskz_mov_ps(static_cast<__mmask8>(mask), a.v)};
#elif defined(SELVAGE_SIMD_AVX2)
  const __m256i lanes = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
  const __m256i kept = _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(static_cast<int>(mask)), lanes), lanes);
  return {_mm256_and_ps(a.v, _mm256_castsi256_ps(kept))};
#else
  alignas(32) float kept[8];
  for (unsigned i = 0; i < 8; ++i) kept[i] = std::bit_cast<float>(0u - ((mask >> i) & 1u));
  return and_bits(a, Float8::load(kept));
#endif
}

/// Smallest lane of each: (min a, min b, min c, min d).
SELVAGE_INLINE Float4 reduce_min(Float4 a, Float4 b, Float4 c, Float4 d) {
  const Float4 ab = min(interleave_low(a, b), interleave_high(a, b));
  const Float4 cd = min(interleave_low(c, d), interleave_high(c, d));
  return min(join_low(ab, cd), join_high(ab, cd));
}

/// Largest lane of each: (max a, max b, max c, max d).
SELVAGE_INLINE Float4 reduce_max(Float4 a, Float4 b, Float4 c, Float4 d) {
  const Float4 ab = max(interleave_low(a, b), interleave_high(a, b));
  const Float4 cd = max(interleave_low(c, d), interleave_high(c, d));
  return max(join_low(ab, cd), join_high(ab, cd));
}

/// Transposes four rows in place; of eight lanes each half for itself.
template <typename Row>
SELVAGE_INLINE void transpose(Row& a, Row& b, Row& c, Row& d) {
  const Row ab_low = interleave_low(a, b), ab_high = interleave_high(a, b);
  const Row cd_low = interleave_low(c, d), cd_high = interleave_high(c, d);
  a = join_low(ab_low, cd_low);
  b = join_high(ab_low, cd_low);
  c = join_low(ab_high, cd_high);
  d = join_high(ab_high, cd_high);
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
