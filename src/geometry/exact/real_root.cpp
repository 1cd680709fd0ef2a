#include "geometry/exact/real_root.h"

#include <utility>

namespace selvage {

namespace {

/// -1 for the zero polynomial.
int degree_of(const Cubic& c) {
  int degree = 3;
  while (degree >= 0 && c[degree] == 0) --degree;
  return degree;
}

Cubic derivative(const Cubic& c) {
  Cubic result;
  for (int i = 1; i <= 3; ++i) result[i - 1] = i * c[i];
  return result;
}

struct Division {
  Cubic quotient, remainder;
};

/// Divides a power of the divisor's leading coefficient times the dividend.
Division pseudo_divide(const Cubic& dividend, const Cubic& divisor) {
  Division result{{}, dividend};
  const int low = degree_of(divisor);
  for (int high = degree_of(result.remainder); high >= low; high = degree_of(result.remainder)) {
    const ExactInt lead = result.remainder[high];
    for (int i = 0; i <= 3; ++i) {
      result.remainder[i] *= divisor[low];
      result.quotient[i] *= divisor[low];
    }
    for (int i = 0; i <= low; ++i) result.remainder[high - low + i] -= lead * divisor[i];
    result.quotient[high - low] += lead;
  }
  return result;
}

/// Up to a factor.
Cubic greatest_common_divisor(Cubic a, Cubic b) {
  while (!b.is_zero()) {
    a = pseudo_divide(a, b).remainder;
    std::swap(a, b);
  }
  return a;
}

Cubic without_multiple_roots(const Cubic& polynomial) {
  const Cubic multiple = greatest_common_divisor(polynomial, derivative(polynomial));
  return degree_of(multiple) <= 0 ? polynomial : pseudo_divide(polynomial, multiple).quotient;
}

}  // namespace

void RealRoot::halve_interval() {
  n_ *= 2;
  ++k_;
  if (bernstein_signs(polynomial_, n_, k_).variations() != 0) return;
  n_ += 1;
  is_exact_ = bernstein_signs(polynomial_, n_, k_).at_0() == 0;
}

bool RealRoot::is_root_of(const Cubic& polynomial) {
  const Cubic common = greatest_common_divisor(polynomial_, polynomial);
  if (degree_of(common) <= 0) return false;
  // The common divisor has no multiple roots either, and no other root than this one in the interval; Descartes' count
  // is exact as soon as it is at most 1.
  while (!is_exact_) {
    const int count = bernstein_signs(common, n_, k_).variations();
    if (count <= 1) return count == 1;
    halve_interval();
  }
  return bernstein_signs(common, n_, k_).at_0() == 0;
}

int RealRoot::step(unsigned log) {
  while (!is_exact_ && k_ < log) halve_interval();
  // A root exactly at the end of a step is in the one before the next.
  ExactInt step = n_;
  if (k_ < log) step <<= log - k_;
  if (is_exact_) step -= 1;
  if (k_ > log) step >>= k_ - log;
  return static_cast<int>(step);
}

std::vector<RealRoot> roots_inside_unit_interval(const Cubic& polynomial) {
  const Cubic square_free = without_multiple_roots(polynomial);
  std::vector<RealRoot> roots;
  std::vector<std::pair<ExactInt, unsigned>> pending{{0, 0}};
  while (!pending.empty()) {
    const auto [n, k] = pending.back();
    pending.pop_back();
    // Descartes: no more roots than variations, and as many if 0 or 1.
    const int variations = bernstein_signs(square_free, n, k).variations();
    if (variations == 0) continue;
    if (variations == 1) {
      roots.push_back(RealRoot(square_free, n, k, false));
      continue;
    }
    const ExactInt left = 2 * n, right = 2 * n + 1;
    if (bernstein_signs(square_free, right, k + 1).at_0() == 0)
      roots.push_back(RealRoot(square_free, right, k + 1, true));
    pending.emplace_back(right, k + 1);
    pending.emplace_back(left, k + 1);
  }
  return roots;
}

}  // namespace selvage
