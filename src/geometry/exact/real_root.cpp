#include "geometry/exact/real_root.h"

#include <utility>

namespace selvage {

namespace {

Cubic derivative(const Cubic& c) {
  Cubic result;
  for (int i = 1; i <= 3; ++i) result[i - 1] = i * c[i];
  return result;
}

/// The quotient by a divisor that is no constant, up to a factor: of a power of its leading coefficient times the
/// dividend.
Cubic quotient(Cubic dividend, const Cubic& divisor) {
  Cubic result;
  const int low = divisor.degree();
  for (int high = dividend.degree(); high >= low; high = dividend.degree()) {
    const ExactInt lead = dividend[high];
    for (int i = 0; i <= 3; ++i) {
      dividend[i] *= divisor[low];
      result[i] *= divisor[low];
    }
    for (int i = 0; i <= low; ++i) dividend[high - low + i] -= lead * divisor[i];
    result[high - low] += lead;
  }
  return result;
}

/// Up to a factor; 0 where it is a constant.
Cubic common_divisor(const Cubic& p, const Cubic& q) {
  Cubic result;
  visit_common_divisor(p, q, [&result](const auto& divisor) {
    result = to_cubic(divisor);
    return true;
  });
  return result;
}

Cubic without_multiple_roots(const Cubic& polynomial) {
  const Cubic multiple = common_divisor(polynomial, derivative(polynomial));
  return multiple.degree() == 0 ? polynomial : quotient(polynomial, multiple);
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
  const Cubic common = common_divisor(polynomial_, polynomial);
  if (common.degree() == 0) return false;
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
