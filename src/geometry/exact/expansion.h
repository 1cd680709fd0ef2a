#pragma once

#include <array>
#include <cmath>

namespace selvage {

/// Exact sum of doubles that do not overlap, in increasing magnitude and without zeros (Shewchuk 1997). Capacity is a
/// type's matter, so that an expression of known size allocates nothing.
///
/// Exact as long as nothing overflows and no product underflows: see `kExpansionExponentLimit`.
template <int Capacity>
struct Expansion {
  std::array<double, Capacity> terms;
  int size = 0;

  void push_unless_zero(double term) {
    if (term != 0) terms[size++] = term;
  }
  int sign() const { return size == 0 ? 0 : terms[size - 1] > 0 ? 1 : -1; }
};

/// Products of three differences of coordinates are exact when each coordinate is 0 or has a magnitude in
/// [2^-300, 2^300]: every partial product is then a multiple of 2^(-3 (300 + 52)) > 2^-1074 and is below 2^910.
inline constexpr int kExpansionExponentLimit = 300;

struct RoundedAndTail {
  double rounded, tail;
};

/// a + b = rounded + tail, exactly.
inline RoundedAndTail two_sum(double a, double b) {
  const double sum = a + b;
  const double b_part = sum - a;
  const double a_part = sum - b_part;
  return {sum, (a - a_part) + (b - b_part)};
}

/// The same, for |a| >= |b|.
inline RoundedAndTail fast_two_sum(double a, double b) {
  const double sum = a + b;
  return {sum, b - (sum - a)};
}

/// a * b = rounded + tail, exactly (Dekker's splitting: the baseline instruction set has no fused multiply-add).
inline RoundedAndTail two_product(double a, double b) {
  constexpr double kSplitter = 0x1p27 + 1;
  const double a_scaled = kSplitter * a, b_scaled = kSplitter * b;
  const double a_high = a_scaled - (a_scaled - a), b_high = b_scaled - (b_scaled - b);
  const double a_low = a - a_high, b_low = b - b_high;
  const double product = a * b;
  return {product, a_low * b_low - (((product - a_high * b_high) - a_low * b_high) - a_high * b_low)};
}

inline Expansion<2> exact_difference(double a, double b) {
  const RoundedAndTail difference = two_sum(a, -b);
  Expansion<2> result;
  result.push_unless_zero(difference.tail);
  result.push_unless_zero(difference.rounded);
  return result;
}

template <int N>
Expansion<N> operator-(Expansion<N> e) {
  for (int i = 0; i < e.size; ++i) e.terms[i] = -e.terms[i];
  return e;
}

template <int N, int M>
Expansion<N + M> operator+(const Expansion<N>& e, const Expansion<M>& f) {
  Expansion<N + M> result;
  int i = 0, j = 0;
  const auto next_smallest = [&] {
    const bool from_e = j == f.size || (i < e.size && std::abs(e.terms[i]) < std::abs(f.terms[j]));
    return from_e ? e.terms[i++] : f.terms[j++];
  };
  if (e.size + f.size == 0) return result;
  double accumulated = next_smallest();
  for (int remaining = e.size + f.size - 1; remaining > 0; --remaining) {
    const RoundedAndTail sum = two_sum(accumulated, next_smallest());
    result.push_unless_zero(sum.tail);
    accumulated = sum.rounded;
  }
  result.push_unless_zero(accumulated);
  return result;
}

template <int N>
Expansion<2 * N> operator*(const Expansion<N>& e, double factor) {
  Expansion<2 * N> result;
  if (e.size == 0) return result;
  RoundedAndTail product = two_product(e.terms[0], factor);
  double accumulated = product.rounded;
  result.push_unless_zero(product.tail);
  for (int i = 1; i < e.size; ++i) {
    product = two_product(e.terms[i], factor);
    const RoundedAndTail low = two_sum(accumulated, product.tail);
    result.push_unless_zero(low.tail);
    const RoundedAndTail high = fast_two_sum(product.rounded, low.rounded);
    result.push_unless_zero(high.tail);
    accumulated = high.rounded;
  }
  result.push_unless_zero(accumulated);
  return result;
}

template <int N>
Expansion<4 * N> operator*(const Expansion<N>& e, const Expansion<2>& f) {
  Expansion<4 * N> result;
  if (f.size == 0) return result;
  const Expansion<2 * N> first = e * f.terms[0];
  return first + (f.size == 2 ? e * f.terms[1] : Expansion<2 * N>{});
}

}  // namespace selvage
