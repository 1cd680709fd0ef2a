#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <optional>

#include "geometry/exact/fixed_integer.h"
#include "geometry/exact/polynomial.h"

namespace selvage {

/// The time from n / 2^k to (n + 1) / 2^k.
struct DyadicPart {
  std::int64_t n;
  unsigned k;

  FixedInt<1> number() const { return FixedInt<1>(n); }
};

/// The largest k: coefficients of a polynomial of degree d have 60 d + 5 bits more in a part of time, for which
/// `Wider` has at least d words more.
inline constexpr unsigned kFinestPart = 60;

/// A simple real root of a polynomial with coefficients of fixed size: the only one inside a part of time that is so
/// small that most other polynomials have one sign in it, or exactly where the part begins. Where that is not enough,
/// answers say so, and `RealRoot` knows more.
template <class Int, int Degree>
class FixedRoot {
 public:
  /// The only root inside the part.
  FixedRoot(const Polynomial<Int, Degree>& polynomial, const DyadicPart& part, int sign_before)
      : polynomial_(polynomial), part_(part) {
    narrow(sign_before);
  }
  FixedRoot(const Polynomial<Int, Degree>& polynomial, const DyadicPart& begins_at_root)
      : polynomial_(polynomial), part_(begins_at_root), is_exact_(true) {}

  /// The sign of a polynomial at the root, where that shows.
  template <class Other, int OtherDegree>
  std::optional<int> sign_of_value(const Polynomial<Other, OtherDegree>& other) const {
    if (other.is_zero()) return 0;
    if constexpr (std::same_as<Polynomial<Other, OtherDegree>, Polynomial<Int, Degree>>)
      if (other == polynomial_) return 0;
    const auto signs = bernstein_signs(other, part_.number(), part_.k);
    if (is_exact_) return signs.at_0();
    if (signs.common() != 0) return signs.common();
    // A common divisor's root in the part is this one: as where a vertex in the plane of a face crosses its edge.
    const auto has_root = [this](const auto& divisor) {
      return bernstein_signs(divisor, part_.number(), part_.k).variations() == 1;
    };
    return visit_common_divisor(polynomial_, other, has_root) ? std::optional(0) : std::nullopt;
  }

  /// The first of 2^log equal steps of [0, 1] that holds the root, ends included, where that shows.
  std::optional<int> step(unsigned log) const {
    if (is_exact_ && part_.k < log) return static_cast<int>(part_.n << (log - part_.k)) - 1;
    if (part_.k < log) return std::nullopt;
    return static_cast<int>((part_.n - is_exact_) >> (part_.k - log));
  }

 private:
  Polynomial<Int, Degree> polynomial_;
  DyadicPart part_;
  bool is_exact_ = false;

  /// Where floating point finds the root in the part.
  double estimate(int sign_before) const {
    std::array<double, Degree + 1> c;
    for (int i = 0; i <= Degree; ++i) c[i] = static_cast<double>(polynomial_[i]);
    const auto value_at = [&c](double t) {
      double value = c[Degree];
      for (int i = Degree; i > 0; --i) value = value * t + c[i - 1];
      return value;
    };
    const auto slope_at = [&c](double t) {
      double slope = Degree * c[Degree];
      for (int i = Degree; i > 1; --i) slope = slope * t + (i - 1) * c[i - 1];
      return slope;
    };
    const double unit = std::ldexp(1.0, -static_cast<int>(part_.k));
    double low = static_cast<double>(part_.n) * unit, high = low + unit;
    const double at_low = value_at(low), at_high = value_at(high);
    // Newton's method, kept inside.
    constexpr int kMaxIterations = 100;  // it halves the way to a tiny root that is nearly a double one
    double t = low, next = low + unit * (at_low / (at_low - at_high));
    for (int i = 0; i < kMaxIterations; ++i) {
      t = next > low && next < high ? next : low + (high - low) / 2;
      const double value = value_at(t);
      (value * sign_before > 0 ? low : high) = t;
      next = t - value / slope_at(t);
      if (std::abs(next - t) <= 0x1p-50 * t) break;
    }
    return t;
  }

  /// Guesses a part around the root, and takes it if that proves true.
  void narrow(int sign_before) {
    const double t = estimate(sign_before);
    const int zeros = t > 0 ? -std::ilogb(t) : static_cast<int>(kFinestPart);
    for (int bits = 46; bits > 0; bits -= 15) {
      const unsigned k = std::clamp<int>(bits + zeros, 0, kFinestPart);
      if (k <= part_.k) return;
      const std::int64_t first = part_.n << (k - part_.k), end = (part_.n + 1) << (k - part_.k);
      const auto guess = static_cast<std::int64_t>(std::ldexp(t, static_cast<int>(k)));
      const DyadicPart part{std::clamp(guess, first, end - 1), k};
      const auto signs = bernstein_signs(polynomial_, part.number(), k);
      const bool at_start = signs.at_0() == 0 && part.n > first, at_end = signs.at_1() == 0 && part.n + 1 < end;
      if (at_start || at_end || signs.variations() == 1) {
        part_ = {part.n + (at_end && !at_start), k};
        is_exact_ = at_start || at_end;
        return;
      }
    }
  }
};

/// Calls `visit(root)` for the different real roots in (0, 1) of a polynomial that is not zero.
/// @return whether these are all; else there are multiple roots or such as lie too close to each other
template <class Int, int Degree, class Visit>
bool visit_roots(const Polynomial<Int, Degree>& polynomial, Visit&& visit) {
  constexpr unsigned kJump = 12;
  std::array<DyadicPart, kFinestPart + 1> pending{DyadicPart{0, 0}};
  for (std::size_t count = 1; count > 0;) {
    const DyadicPart part = pending[--count];
    const auto signs = bernstein_signs(polynomial, part.number(), part.k);
    // Descartes: no more roots than variations, and as many if 0 or 1.
    const int variations = signs.variations();
    if (variations == 0) continue;
    if (variations == 1) {
      visit(FixedRoot<Int, Degree>(polynomial, part, signs.first()));
      continue;
    }
    if (part.k + kJump > kFinestPart) return false;
    // Mostly they lie near the beginning: what touches does so at the beginning of a step. Parts share the variations.
    const DyadicPart beginning{part.n << kJump, part.k + kJump};
    if (bernstein_signs(polynomial, beginning.number(), beginning.k).variations() == variations) {
      pending[count++] = beginning;
      continue;
    }
    const DyadicPart left{2 * part.n, part.k + 1}, right{2 * part.n + 1, part.k + 1};
    if (bernstein_signs(polynomial, right.number(), right.k).at_0() == 0)
      visit(FixedRoot<Int, Degree>(polynomial, right));
    pending[count++] = right;
    pending[count++] = left;
  }
  return true;
}

}  // namespace selvage
