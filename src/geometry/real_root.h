#pragma once

#include <array>
#include <vector>

#include "geometry/exact_integer.h"

namespace selvage {

/// Polynomial of at most degree 3 with integer coefficients, from the constant one on; exact.
class Cubic {
 public:
  Cubic() = default;
  explicit Cubic(const ExactInt& constant) : coefficients_{constant} {}
  /// The line from `start` at 0 to `end` at 1.
  Cubic(const ExactInt& start, const ExactInt& end) : coefficients_{start, end - start} {}

  const ExactInt& operator[](int i) const { return coefficients_[i]; }
  ExactInt& operator[](int i) { return coefficients_[i]; }

  /// -1 for the zero polynomial.
  int degree() const;
  bool is_zero() const { return degree() < 0; }

  Cubic operator+(const Cubic& other) const;
  Cubic operator-(const Cubic& other) const;
  /// The degrees must add up to 3 at most.
  Cubic operator*(const Cubic& other) const;

  int sign_at_0() const { return sign_of(coefficients_[0]); }
  int sign_at_1() const;

 private:
  std::array<ExactInt, 4> coefficients_{};
};

/// A real root in (0, 1) of a polynomial without multiple roots: the only one inside the interval from n / 2^k to
/// (n + 1) / 2^k, or n / 2^k itself.
class RealRoot {
 public:
  /// The sign of a polynomial at the root.
  int sign_of_value(const Cubic& polynomial);

  /// The first of so many equal steps of [0, 1], a power of two of them, that holds the root, ends included.
  int first_step_of(int count);

 private:
  friend std::vector<RealRoot> roots_inside_unit_interval(const Cubic& polynomial);

  RealRoot(const Cubic& square_free, const ExactInt& n, unsigned k, bool is_exact)
      : polynomial_(square_free), n_(n), k_(k), is_exact_(is_exact) {}
  void halve_interval();
  bool is_root_of(const Cubic& polynomial);

  Cubic polynomial_;
  ExactInt n_;
  unsigned k_;
  bool is_exact_;
};

/// The different real roots in (0, 1) of a polynomial that is not zero.
std::vector<RealRoot> roots_inside_unit_interval(const Cubic& polynomial);

}  // namespace selvage
