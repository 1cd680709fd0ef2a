#pragma once

#include <vector>

#include "geometry/exact/exact_integer.h"
#include "geometry/exact/polynomial.h"

namespace selvage {

using Cubic = Polynomial<ExactInt, 3>;

template <int Degree>
Cubic to_cubic(const Polynomial<ExactInt, Degree>& polynomial) {
  Cubic cubic;
  for (int i = 0; i <= Degree; ++i) cubic[i] = polynomial[i];
  return cubic;
}

/// A real root in (0, 1) of a polynomial without multiple roots: the only one inside the interval from n / 2^k to
/// (n + 1) / 2^k, or n / 2^k itself.
class RealRoot {
 public:
  RealRoot(const Cubic& square_free, const ExactInt& n, unsigned k, bool is_exact)
      : polynomial_(square_free), n_(n), k_(k), is_exact_(is_exact) {}

  /// The sign of a polynomial at the root.
  template <int Degree>
  int sign_of_value(const Polynomial<ExactInt, Degree>& polynomial) {
    if (polynomial.is_zero()) return 0;
    // Halving decides nearly everything that is not zero, at less cost than a common divisor.
    constexpr int kHalvings = 8;
    for (int i = 0;; ++i) {
      const BernsteinSigns<Degree> signs = bernstein_signs(polynomial, n_, k_);
      if (is_exact_) return signs.at_0();
      if (signs.common() != 0) return signs.common();
      if (i == kHalvings && is_root_of(to_cubic(polynomial))) return 0;
      if (!is_exact_) halve_interval();
    }
  }

  /// The first of 2^log equal steps of [0, 1] that holds the root, ends included.
  int step(unsigned log);

 private:
  void halve_interval();
  bool is_root_of(const Cubic& polynomial);

  Cubic polynomial_;
  ExactInt n_;
  unsigned k_;
  bool is_exact_;
};

/// The different real roots in (0, 1) of a polynomial that is not zero.
std::vector<RealRoot> roots_inside_unit_interval(const Cubic& polynomial);

/// Calls `visit(root)` for each of them.
/// @return true: these are all
template <int Degree, class Visit>
bool visit_roots(const Polynomial<ExactInt, Degree>& polynomial, Visit&& visit) {
  for (RealRoot& root : roots_inside_unit_interval(to_cubic(polynomial))) visit(root);
  return true;
}

}  // namespace selvage
