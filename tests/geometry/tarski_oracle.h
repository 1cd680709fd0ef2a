#pragma once

#include <array>
#include <utility>
#include <vector>

#include "geometry/contact_oracle.h"

/// An exact decision of continuous contact by Sturm sequences, written apart from the library's: it isolates the roots
/// of all polynomials that could matter and asks at each of them, by Tarski queries, whether 0 is in the hull of the
/// differences of the points.
namespace selvage::test {

/// Coefficients from the constant one on, the last one not 0.
using Polynomial = std::vector<Unlimited>;

inline void trim(Polynomial& p) {
  while (!p.empty() && p.back() == 0) p.pop_back();
}

inline Polynomial sum(const Polynomial& p, const Polynomial& q, int factor) {
  Polynomial r(std::max(p.size(), q.size()));
  for (std::size_t i = 0; i < p.size(); ++i) r[i] = p[i];
  for (std::size_t i = 0; i < q.size(); ++i) r[i] += factor * q[i];
  trim(r);
  return r;
}

inline Polynomial product(const Polynomial& p, const Polynomial& q) {
  if (p.empty() || q.empty()) return {};
  Polynomial r(p.size() + q.size() - 1);
  for (std::size_t i = 0; i < p.size(); ++i)
    for (std::size_t j = 0; j < q.size(); ++j) r[i + j] += p[i] * q[j];
  return r;
}

/// The remainder of p by q, times a positive number.
inline Polynomial remainder(Polynomial p, const Polynomial& q) {
  const Unlimited scale = abs(q.back());
  while (p.size() >= q.size()) {
    const Unlimited lead = q.back() > 0 ? p.back() : Unlimited(-p.back());
    const std::size_t shift = p.size() - q.size();
    for (Unlimited& c : p) c *= scale;
    for (std::size_t i = 0; i < q.size(); ++i) p[shift + i] -= lead * q[i];
    trim(p);
  }
  return p;
}

struct Fraction {
  Unlimited numerator, denominator;  ///< the denominator is positive
};

inline int sign_at(const Polynomial& p, const Fraction& t) {
  Unlimited value = 0, power = 1;
  for (std::size_t i = p.size(); i-- > 0; power *= t.denominator) value = value * t.numerator + p[i] * power;
  return sign(value);
}

/// Over the different roots of p in (low, high), which are no roots themselves: the sum of the signs of q.
inline int tarski_query(const Polynomial& p, const Polynomial& q, const Fraction& low, const Fraction& high) {
  Polynomial derivative;
  for (std::size_t i = 1; i < p.size(); ++i) derivative.push_back(p[i] * i);
  Polynomial previous = p, current = product(derivative, q);
  int variations = 0, at_low = sign_at(p, low), at_high = sign_at(p, high);
  while (!current.empty()) {
    const int next_low = sign_at(current, low), next_high = sign_at(current, high);
    if (next_low != 0) variations += std::exchange(at_low, next_low) == -next_low;
    if (next_high != 0) variations -= std::exchange(at_high, next_high) == -next_high;
    Polynomial next = sum({}, remainder(std::move(previous), current), -1);
    previous = std::exchange(current, std::move(next));
  }
  return variations;
}

/// The only root of a polynomial in (low, high).
struct IsolatedRoot {
  Polynomial polynomial;
  Fraction low, high;
};

/// The roots in (low, high), which are no roots themselves.
inline void isolate_roots(const Polynomial& p, const Fraction& low, const Fraction& high,
                          std::vector<IsolatedRoot>& roots) {
  const int count = tarski_query(p, {1}, low, high);
  if (count == 1) roots.push_back({p, low, high});
  if (count < 2) return;
  for (int part = 2;; ++part) {  // somewhere between, but not at a root
    const Unlimited d = low.denominator * high.denominator;
    const Fraction middle{low.numerator * high.denominator * (part - 1) + high.numerator * low.denominator, d * part};
    if (sign_at(p, middle) == 0) continue;
    isolate_roots(p, low, middle, roots);
    isolate_roots(p, middle, high, roots);
    return;
  }
}

inline std::vector<IsolatedRoot> roots_in_unit_interval(Polynomial p) {
  std::vector<IsolatedRoot> roots;
  if (p.empty()) return roots;
  while (p.front() == 0) p.erase(p.begin());
  while (p.size() > 1 && sign_at(p, {1, 1}) == 0) {  // divide by 1 - t: sums of the first coefficients
    for (std::size_t i = 1; i < p.size(); ++i) p[i] += p[i - 1];
    trim(p);
  }
  isolate_roots(p, {0, 1}, {1, 1}, roots);
  return roots;
}

/// A polynomial's value at a root, known by its sign.
struct ValueAtRoot {
  Polynomial polynomial;
  const IsolatedRoot* root = nullptr;
};
inline ValueAtRoot operator+(const ValueAtRoot& a, const ValueAtRoot& b) {
  return {sum(a.polynomial, b.polynomial, 1), a.root};
}
inline ValueAtRoot operator-(const ValueAtRoot& a, const ValueAtRoot& b) {
  return {sum(a.polynomial, b.polynomial, -1), a.root};
}
inline ValueAtRoot operator*(const ValueAtRoot& a, const ValueAtRoot& b) {
  return {product(a.polynomial, b.polynomial), a.root};
}
inline int sign(const ValueAtRoot& a) {
  if (a.polynomial.size() < 2) return a.polynomial.empty() ? 0 : sign(a.polynomial[0]);
  return tarski_query(a.root->polynomial, a.polynomial, a.root->low, a.root->high);
}

/// Four points as straight lines over [0, 1], exactly.
using ExactMotion = std::array<ExactVec<Polynomial>, 4>;

template <class T>
ExactMotion to_motion(const std::array<ExactVec<T>, 8>& starts_and_ends) {
  ExactMotion motion;
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 3; ++k) {
      const Unlimited start(starts_and_ends[i][k]), end(starts_and_ends[4 + i][k]);
      motion[i][k] = {start, end - start};
      trim(motion[i][k]);
    }
  return motion;
}

/// All differences of the first `Count` points and the others.
template <int Count, class T>
bool sets_meet(const std::array<ExactVec<T>, 4>& points) {
  constexpr int kOthers = 4 - Count;
  std::array<ExactVec<T>, Count * kOthers> differences;
  for (int i = 0; i < Count; ++i)
    for (int j = 0; j < kOthers; ++j) differences[kOthers * i + j] = points[i] - points[Count + j];
  return HullOfPoints<T, Count * kOthers>(differences).has_zero();
}

/// Whether the first `Count` points (1: a vertex and a face, 2: two edges) and the others ever meet.
template <int Count>
bool ever_meet_by_definition(const ExactMotion& motion) {
  for (int t : {0, 1}) {
    std::array<ExactVec<Unlimited>, 4> points;
    for (int i = 0; i < 4; ++i)
      for (int k = 0; k < 3; ++k)
        for (std::size_t c = 0; c < motion[i][k].size() && (c == 0 || t == 1); ++c) points[i][k] += motion[i][k][c];
    if (sets_meet<Count>(points)) return true;
  }
  const auto value = [&](int i, int k) { return ValueAtRoot{motion[i][k], nullptr}; };
  std::vector<Polynomial> conditions;
  std::array<ExactVec<ValueAtRoot>, 4> edges;
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 3; ++k) edges[i][k] = value(i, k) - value(0, k);
  conditions.push_back(dot(cross(edges[1], edges[2]), edges[3]).polynomial);
  if (conditions[0].empty()) {  // always in one plane: whatever can change the answer
    for (int i = 0; i < 4; ++i)
      for (int j = i + 1; j < 4; ++j)
        for (int k = 0; k < 3; ++k) {
          conditions.push_back((value(i, k) - value(j, k)).polynomial);
          for (int m = j + 1; m < 4; ++m)
            conditions.push_back(cross(edges[j] - edges[i], edges[m] - edges[i])[k].polynomial);
        }
  }
  for (const Polynomial& condition : conditions)
    for (const IsolatedRoot& root : roots_in_unit_interval(condition)) {
      std::array<ExactVec<ValueAtRoot>, 4> points;
      for (int i = 0; i < 4; ++i)
        for (int k = 0; k < 3; ++k) points[i][k] = {motion[i][k], &root};
      if (sets_meet<Count>(points)) return true;
    }
  return false;
}

}  // namespace selvage::test
