#pragma once

#include "geometry/exact/expansion.h"

namespace selvage {

/// The sum of two doubles, the second below half a unit in the last place of the first: some 106 bits. Sums and
/// products have relative errors below 2^-100, unless something overflows or a product is below 2^-900. Additions whose
/// terms cancel lose what every floating-point number loses.
/// Source: Dekker 1971; Joldes, Muller and Popescu 2017, algorithms 6 and 11.
struct DoubleDouble {
  double high = 0, low = 0;
};

/// Exact.
inline DoubleDouble difference(double a, double b) {
  const RoundedAndTail d = two_sum(a, -b);
  return {d.rounded, d.tail};
}

inline DoubleDouble operator-(const DoubleDouble& a) {
  return {-a.high, -a.low};
}

inline DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
  const RoundedAndTail highs = two_sum(a.high, b.high), lows = two_sum(a.low, b.low);
  const RoundedAndTail sum = fast_two_sum(highs.rounded, highs.tail + lows.rounded);
  const RoundedAndTail result = fast_two_sum(sum.rounded, sum.tail + lows.tail);
  return {result.rounded, result.tail};
}
inline DoubleDouble operator-(const DoubleDouble& a, const DoubleDouble& b) {
  return a + -b;
}

inline DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
  const RoundedAndTail product = two_product(a.high, b.high);
  const RoundedAndTail result = fast_two_sum(product.rounded, product.tail + (a.high * b.low + a.low * b.high));
  return {result.rounded, result.tail};
}

/// a / b, to one unit in the last place.
inline double quotient(const DoubleDouble& a, const DoubleDouble& b) {
  const double first = a.high / b.high;
  const DoubleDouble rest = a - DoubleDouble{first, 0} * b;
  return first + rest.high / b.high;
}

}  // namespace selvage
