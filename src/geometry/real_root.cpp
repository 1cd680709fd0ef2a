#include "geometry/real_root.h"

#include <bit>
#include <utility>

namespace selvage {

namespace {

/// Signs of the coefficients in Bernstein form, as many as the degree and one.
struct BernsteinSigns {
  std::array<int, 4> signs{};
  int count = 0;

  int variations() const {
    int result = 0, last = 0;
    for (int i = 0; i < count; ++i) {
      if (signs[i] == 0) continue;
      result += last == -signs[i];
      last = signs[i];
    }
    return result;
  }
  /// The sign on the whole closed interval where the coefficients show it, else 0.
  int common() const {
    for (int i = 1; i < count; ++i)
      if (signs[i] != signs[0]) return 0;
    return signs[0];
  }
};

/// The polynomial of s for which t = (n + s) / 2^k, times a power of two.
Cubic on_interval(const Cubic& polynomial, const ExactInt& n, unsigned k) {
  const int degree = polynomial.degree();
  Cubic result = polynomial;
  for (int i = 0; i < degree; ++i) result[i] <<= k * static_cast<unsigned>(degree - i);
  for (int i = 0; i < degree; ++i)
    for (int j = degree - 1; j >= i; --j) result[j] += n * result[j + 1];
  return result;
}

BernsteinSigns bernstein_signs(const Cubic& c) {
  const int degree = c.degree();
  BernsteinSigns result;
  result.count = degree + 1;
  result.signs[0] = c.sign_at_0();
  if (degree == 2) result.signs[1] = sign_of(2 * c[0] + c[1]);
  if (degree == 3) {
    result.signs[1] = sign_of(3 * c[0] + c[1]);
    result.signs[2] = sign_of(3 * c[0] + 2 * c[1] + c[2]);
  }
  if (degree > 0) result.signs[degree] = c.sign_at_1();
  return result;
}

BernsteinSigns bernstein_signs(const Cubic& polynomial, const ExactInt& n, unsigned k) {
  return bernstein_signs(on_interval(polynomial, n, k));
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
  const int low = divisor.degree();
  for (int high = result.remainder.degree(); high >= low; high = result.remainder.degree()) {
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
  return multiple.degree() <= 0 ? polynomial : pseudo_divide(polynomial, multiple).quotient;
}

}  // namespace

int Cubic::degree() const {
  int degree = 3;
  while (degree >= 0 && coefficients_[degree] == 0) --degree;
  return degree;
}

Cubic Cubic::operator+(const Cubic& other) const {
  Cubic sum;
  for (int i = 0; i <= 3; ++i) sum[i] = coefficients_[i] + other[i];
  return sum;
}

Cubic Cubic::operator-(const Cubic& other) const {
  Cubic difference;
  for (int i = 0; i <= 3; ++i) difference[i] = coefficients_[i] - other[i];
  return difference;
}

Cubic Cubic::operator*(const Cubic& other) const {
  Cubic product;
  const int degree = this->degree(), other_degree = other.degree();
  for (int i = 0; i <= degree; ++i)
    for (int j = 0; j <= other_degree; ++j) product[i + j] += coefficients_[i] * other[j];
  return product;
}

int Cubic::sign_at_1() const {
  return sign_of(coefficients_[0] + coefficients_[1] + coefficients_[2] + coefficients_[3]);
}

void RealRoot::halve_interval() {
  n_ *= 2;
  ++k_;
  if (bernstein_signs(polynomial_, n_, k_).variations() != 0) return;
  n_ += 1;
  is_exact_ = bernstein_signs(polynomial_, n_, k_).signs[0] == 0;
}

bool RealRoot::is_root_of(const Cubic& polynomial) {
  const Cubic common = greatest_common_divisor(polynomial_, polynomial);
  if (common.degree() <= 0) return false;
  // The common divisor has no multiple roots either, and no other root than this one in the interval; Descartes' count
  // is exact as soon as it is at most 1.
  while (!is_exact_) {
    const int count = bernstein_signs(common, n_, k_).variations();
    if (count <= 1) return count == 1;
    halve_interval();
  }
  return bernstein_signs(common, n_, k_).signs[0] == 0;
}

int RealRoot::sign_of_value(const Cubic& polynomial) {
  if (polynomial.is_zero()) return 0;
  // Halving decides nearly everything that is not zero, at less cost than a common divisor.
  constexpr int kHalvings = 8;
  for (int i = 0;; ++i) {
    const BernsteinSigns signs = bernstein_signs(polynomial, n_, k_);
    if (is_exact_) return signs.signs[0];
    if (signs.common() != 0) return signs.common();
    if (i == kHalvings && is_root_of(polynomial)) return 0;
    if (!is_exact_) halve_interval();
  }
}

int RealRoot::first_step_of(int count) {
  const auto log = static_cast<unsigned>(std::countr_zero(static_cast<unsigned>(count)));
  while (!is_exact_ && k_ < log) halve_interval();
  // What is exactly at the end of a step is in the one before the next.
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
    if (bernstein_signs(square_free, right, k + 1).signs[0] == 0)
      roots.push_back(RealRoot(square_free, right, k + 1, true));
    pending.emplace_back(right, k + 1);
    pending.emplace_back(left, k + 1);
  }
  return roots;
}

}  // namespace selvage
