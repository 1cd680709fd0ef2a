#pragma once

#include <array>

namespace selvage {

/// Polynomial with integer coefficients, from the constant one on; the leading ones may be 0. `Int` is one that grows,
/// or of fixed size, and then coefficients of products have the size of a product.
template <class Int, int Degree>
struct Polynomial {
  std::array<Int, Degree + 1> coefficients{};

  const Int& operator[](int i) const { return coefficients[i]; }
  Int& operator[](int i) { return coefficients[i]; }
  bool operator==(const Polynomial&) const = default;

  bool is_zero() const {
    for (const Int& c : coefficients)
      if (c.sign() != 0) return false;
    return true;
  }

  /// The power of the leading coefficient that is not 0; 0 where all are.
  int degree() const {
    int result = Degree;
    while (result > 0 && coefficients[result].sign() == 0) --result;
    return result;
  }

  Polynomial& operator+=(const Polynomial& other) {
    for (int i = 0; i <= Degree; ++i) coefficients[i] += other[i];
    return *this;
  }
  Polynomial& operator-=(const Polynomial& other) {
    for (int i = 0; i <= Degree; ++i) coefficients[i] -= other[i];
    return *this;
  }
  Polynomial operator-(const Polynomial& other) const { return Polynomial(*this) -= other; }

  template <class Other, int OtherDegree>
  auto operator*(const Polynomial<Other, OtherDegree>& other) const {
    Polynomial<decltype(Int() * Other()), Degree + OtherDegree> product;
    for (int i = 0; i <= Degree; ++i)
      for (int j = 0; j <= OtherDegree; ++j) product[i + j] += coefficients[i] * other[j];
    return product;
  }
};

/// The line from `start` at 0 to `end` at 1.
template <class Int>
Polynomial<Int, 1> line(const Int& start, const Int& end) {
  return {{start, end - start}};
}

/// Euclid's algorithm, without fractions: what `visit` returns for the greatest common divisor of two polynomials, not
/// both 0, times some number; false where it is a constant. Fixed integers grow with each division, and never overflow.
template <class Int, int Degree, class Other, int OtherDegree, class Visit>
bool visit_common_divisor(const Polynomial<Int, Degree>& p, const Polynomial<Other, OtherDegree>& q, Visit&& visit) {
  if (q.is_zero()) return visit(p);
  const int degree = q.degree();
  if (degree == 0) return false;
  if constexpr (Degree > 0)
    if (degree <= Degree) {
      Polynomial<decltype(Int() * Other()), Degree - 1> rest;
      for (int i = 0; i < Degree; ++i) {
        rest[i] = p[i] * q[degree];
        if (i >= Degree - degree) rest[i] -= p[Degree] * q[i - (Degree - degree)];
      }
      return visit_common_divisor(rest, q, visit);
    }
  if constexpr (Degree < OtherDegree) return visit_common_divisor(q, p, visit);
  return false;
}

/// Twice the words of a fixed integer.
template <class Int>
using Wider = decltype(Int() * Int());

/// The polynomial of s for which t = (n + s) / 2^k, times a power of two.
template <class Int, int Degree, class N>
Polynomial<Wider<Int>, Degree> on_interval(const Polynomial<Int, Degree>& polynomial, const N& n, unsigned k) {
  Polynomial<Wider<Int>, Degree> result;
  for (int i = 0; i <= Degree; ++i) {
    result[i] = Wider<Int>(polynomial[i]);
    result[i] <<= k * static_cast<unsigned>(Degree - i);
  }
  if (n.sign() == 0) return result;
  for (int i = 0; i < Degree; ++i)
    for (int j = Degree - 1; j >= i; --j) result[j] += Wider<Int>(n * result[j + 1]);
  return result;
}

/// Signs of the coefficients in Bernstein form over [0, 1].
template <int Degree>
struct BernsteinSigns {
  std::array<int, Degree + 1> signs;

  int at_0() const { return signs.front(); }
  int at_1() const { return signs.back(); }
  int variations() const {
    int result = 0, last = 0;
    for (const int sign : signs) {
      if (sign == 0) continue;
      result += last == -sign;
      last = sign;
    }
    return result;
  }
  /// The first that is not 0: the sign right after 0.
  int first() const {
    for (const int sign : signs)
      if (sign != 0) return sign;
    return 0;
  }
  /// The sign everywhere in (0, 1) where the coefficients show it, else 0.
  int common() const { return variations() == 0 ? first() : 0; }
};

template <class Int, int Degree>
BernsteinSigns<Degree> bernstein_signs(const Polynomial<Int, Degree>& c) {
  static_assert(Degree <= 3);
  if constexpr (Degree == 0) return {{c[0].sign()}};
  if constexpr (Degree == 1) return {{c[0].sign(), (c[0] + c[1]).sign()}};
  if constexpr (Degree == 2) {
    const Int twice = c[0] + c[0] + c[1];
    return {{c[0].sign(), twice.sign(), (twice - c[0] + c[2]).sign()}};
  }
  if constexpr (Degree == 3) {
    const Int start = c[0] + c[0] + c[0], first = start + c[1], second = first + c[1] + c[2];
    return {{c[0].sign(), first.sign(), second.sign(), (second - c[0] - c[0] - c[1] + c[3]).sign()}};
  }
}

template <class Int, int Degree, class N>
BernsteinSigns<Degree> bernstein_signs(const Polynomial<Int, Degree>& polynomial, const N& n, unsigned k) {
  return bernstein_signs(on_interval(polynomial, n, k));
}

}  // namespace selvage
