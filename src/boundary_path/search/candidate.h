#pragma once

#include "boundary_path/traversal/segment.h"

namespace selvage {
inline namespace SELVAGE_ISA {

/// Closest points of boundary faces to a fixed point, in two steps: a cheap estimate that rejects most faces, and the
/// candidate itself with its feature decided exactly. The candidate depends on its feature alone, not on the face
/// through which it was found, so that faces sharing it agree bit for bit.
template <int D>
class CandidateFactory {
 public:
  /// Relative error bound of s - p above which it is computed in exact arithmetic.
  static constexpr double kPreciseAbove = 4e-13;

  /// Bounds the error of an estimated distance relative to the largest coordinate of the face as seen from p.
  static constexpr double kEstimateError = 1e-12;

  /// Closest point of a face in plain floating point.
  struct Estimate {
    double squared_distance;
    double error;    ///< bounds the error of the distance (not squared); infinite where the face is too thin to tell
    unsigned mask;   ///< vertices that span the feature
    bool ambiguous;  ///< rounding may have chosen a neighbouring feature
  };

  CandidateFactory(const PathInput<D>& input, const Vec<D>& p) : input_(input), p_(p) {}

  Estimate estimate(Index face) const;
  Candidate<D> make(Index face, const Estimate& estimate) const;

  /// Completes a candidate that project_on_triangle() has begun. False when its offset must be computed exactly.
  static bool complete(const PathInput<D>& input, Index face, Candidate<D>& c) {
    c.face = face;
    c.ids = input.face_stars[face].vertices;
    c.target.count = D;
    for (int i = 0; i < D; ++i) c.target.vertices[i] = input.positions[c.ids[i]];
    return is_precise(c);
  }

 private:
  static double dot(const double* a, const double* b) {
    double sum = a[0] * b[0] + a[1] * b[1];
    if constexpr (D == 3) sum += a[2] * b[2];
    return sum;
  }
  static double absolute_dot(const double* a, const double* b) {
    double sum = std::abs(a[0] * b[0]) + std::abs(a[1] * b[1]);
    if constexpr (D == 3) sum += std::abs(a[2] * b[2]);
    return sum;
  }
  static double largest(const double* a) {
    double m = std::max(std::abs(a[0]), std::abs(a[1]));
    if constexpr (D == 3) m = std::max(m, std::abs(a[2]));
    return m;
  }
  static void subtract(const Vec<D>& a, const Vec<D>& b, double* r) {
    for (int i = 0; i < D; ++i) r[i] = a[i] - b[i];
  }
  /// Relative to the distance, not to the size of the target: p may be very close to it.
  static bool is_precise(const Candidate<D>& c) {
    bool proper = true;  // s is inside its feature, and its weights should say so
    for (int i = 0; i < c.target.count; ++i) proper &= c.barycentric[i] > 0;
    return proper && c.offset_error < kPreciseAbove * largest(c.offset);
  }
  void set_offset(Candidate<D>& c) const;
  void project_on_vertex(Candidate<D>& c) const;
  void project_on_edge(Candidate<D>& c) const;
  void project_on_triangle(Candidate<D>& c) const;
  void make_precise(Candidate<D>& c) const;

  const PathInput<D>& input_;
  const Vec<D>& p_;
};

template <>
inline CandidateFactory<2>::Estimate CandidateFactory<2>::estimate(Index face) const {
  const auto& ids = input_.face_stars[face].vertices;
  double a[2], b[2], e[2];
  subtract(input_.positions[ids[0]], p_, a);
  subtract(input_.positions[ids[1]], p_, b);
  subtract(input_.positions[ids[1]], input_.positions[ids[0]], e);
  const double da = dot(a, e), db = dot(b, e);
  const double bound_a = 8 * kUnitRoundoff * absolute_dot(a, e), bound_b = 8 * kUnitRoundoff * absolute_dot(b, e);
  const bool ambiguous = !(std::abs(da) > bound_a + kTrustAbove) || !(std::abs(db) > bound_b + kTrustAbove);
  const double error = kEstimateError * std::max(largest(a), largest(b));
  if (da >= 0) return {dot(a, a), error, 0b01, ambiguous};
  if (db <= 0) return {dot(b, b), error, 0b10, ambiguous};
  const double area = a[0] * b[1] - a[1] * b[0];
  return {area * area / dot(e, e), error, 0b11, ambiguous};
}

template <>
inline CandidateFactory<3>::Estimate CandidateFactory<3>::estimate(Index face) const {
  const auto& ids = input_.face_stars[face].vertices;
  double v[3][3], e[3][3];  // vertices relative to p; edge i is opposite to vertex i
  for (int i = 0; i < 3; ++i) {
    subtract(input_.positions[ids[i]], p_, v[i]);
    subtract(input_.positions[ids[(i + 2) % 3]], input_.positions[ids[(i + 1) % 3]], e[i]);
  }
  // forward[i]: along edge i from its first end a = i+1; negative while it comes closer. backward[i]: at its last end.
  const double size[3] = {largest(v[0]), largest(v[1]), largest(v[2])};
  double forward[3], backward[3];
  bool forward_unsure[3], backward_unsure[3];
  for (int i = 0; i < 3; ++i) {
    const int a = (i + 1) % 3, b = (i + 2) % 3;
    forward[i] = dot(v[a], e[i]);
    backward[i] = dot(v[b], e[i]);
    const double unit = 24 * kUnitRoundoff * largest(e[i]);
    forward_unsure[i] = !(std::abs(forward[i]) > unit * size[a] + kTrustAbove);
    backward_unsure[i] = !(std::abs(backward[i]) > unit * size[b] + kTrustAbove);
  }
  const double error = kEstimateError * std::max(std::max(size[0], size[1]), size[2]);
  // A region whose own inequalities are certain is the right one, whatever the others say.
  for (int i = 0; i < 3; ++i) {
    const int out = (i + 2) % 3, in = (i + 1) % 3;  // the edges that leave and enter vertex i
    if (forward[out] >= 0 && backward[in] <= 0)
      return {dot(v[i], v[i]), error, 1u << i, forward_unsure[out] || backward_unsure[in]};
  }
  // Which side of each edge p lies on, in the triangle's plane.
  const double n[3] = {e[2][1] * -e[1][2] + e[2][2] * e[1][1], e[2][2] * -e[1][0] + e[2][0] * e[1][2],
                       e[2][0] * -e[1][1] + e[2][1] * e[1][0]};
  bool unsure = false;
  for (int i = 0; i < 3; ++i) {
    const double* a = v[(i + 1) % 3];
    const double inward[3] = {n[1] * e[i][2] - n[2] * e[i][1], n[2] * e[i][0] - n[0] * e[i][2],
                              n[0] * e[i][1] - n[1] * e[i][0]};
    const double beyond = dot(a, inward);
    const double bound = 256 * kUnitRoundoff * largest(a) * largest(e[2]) * largest(e[1]) * largest(e[i]);
    const bool beyond_unsure = !(std::abs(beyond) > bound + kTrustAbove);
    if (beyond >= 0 && forward[i] <= 0 && backward[i] >= 0) {
      const double t = -forward[i] / (backward[i] - forward[i]);
      double s[3];
      for (int k = 0; k < 3; ++k) s[k] = a[k] + t * e[i][k];
      return {dot(s, s), error, (1u << (i + 1) % 3) | (1u << (i + 2) % 3),
              beyond_unsure || forward_unsure[i] || backward_unsure[i]};
    }
    unsure |= beyond_unsure;
  }
  // Inside all edges for certain, or for lack of a better region.
  const double height = dot(n, v[0]), squared = dot(n, n);
  const bool thin = !(squared > 1e-4 * dot(e[1], e[1]) * dot(e[2], e[2]));
  return {height * height / squared, thin ? HUGE_VAL : error, 0b111, unsure};
}

template <int D>
Candidate<D> CandidateFactory<D>::make(Index face, const Estimate& estimate) const {
  const auto& ids = input_.face_stars[face].vertices;
  unsigned mask = estimate.mask;
  if (estimate.ambiguous) {
    std::array<Vec<D>, D> points;
    for (int i = 0; i < D; ++i) points[i] = input_.positions[ids[i]];
    mask = exact_closest_mask(p_, points);
  }
  Candidate<D> c;
  c.face = face;
  c.ids.fill(kNone);
  for (int i = 0; i < D; ++i)
    if (mask >> i & 1) c.ids[c.target.count++] = ids[i];
  if (c.target.count == 2 && c.ids[0] > c.ids[1]) std::swap(c.ids[0], c.ids[1]);
  for (int i = 0; i < c.target.count; ++i) c.target.vertices[i] = input_.positions[c.ids[i]];
  set_offset(c);
  return c;
}

template <int D>
void CandidateFactory<D>::set_offset(Candidate<D>& c) const {
  if (c.target.count == 1)
    project_on_vertex(c);
  else if (c.target.count == 2)
    project_on_edge(c);
  else
    project_on_triangle(c);
  if (!is_precise(c)) make_precise(c);
  c.squared_distance = dot(c.offset, c.offset);
}

template <int D>
void CandidateFactory<D>::project_on_vertex(Candidate<D>& c) const {
  subtract(c.target.vertices[0], p_, c.offset);
  std::copy(c.offset, c.offset + D, c.direction);
  c.barycentric[0] = 1;
  c.offset_error = c.direction_error = kUnitRoundoff * largest(c.offset);
}

template <int D>
void CandidateFactory<D>::project_on_edge(Candidate<D>& c) const {
  double a[D], e[D];
  subtract(c.target.vertices[0], p_, a);
  subtract(c.target.vertices[1], c.target.vertices[0], e);
  const double t = -dot(a, e) / dot(e, e);
  for (int i = 0; i < D; ++i) c.direction[i] = c.offset[i] = a[i] + t * e[i];
  c.barycentric[0] = 1 - t;
  c.barycentric[1] = t;
  c.offset_error = c.direction_error = 40 * kUnitRoundoff * (largest(a) + largest(e));
}

template <int D>
void CandidateFactory<D>::project_on_triangle(Candidate<D>& c) const {
  if constexpr (D == 3) {
    double v[3][3], e1[3], e2[3];
    for (int i = 0; i < 3; ++i) subtract(c.target.vertices[i], p_, v[i]);
    subtract(c.target.vertices[1], c.target.vertices[0], e1);
    subtract(c.target.vertices[2], c.target.vertices[0], e2);
    const auto cross = [](const double* x, const double* y, double* r) {
      r[0] = x[1] * y[2] - x[2] * y[1];
      r[1] = x[2] * y[0] - x[0] * y[2];
      r[2] = x[0] * y[1] - x[1] * y[0];
    };
    double* n = c.direction;
    cross(e1, e2, n);
    c.has_normal = true;
    const double* nearest = v[0];
    for (int i = 1; i < 3; ++i)
      if (largest(v[i]) < largest(nearest)) nearest = v[i];
    const double squared = dot(n, n), height = dot(n, nearest) / squared;
    for (int i = 0; i < 3; ++i) c.offset[i] = n[i] * height;
    // Their sum instead of `squared`, so that they add up to 1 however far p is.
    double total = 0;
    for (int i = 0; i < 3; ++i) {
      double w[3];
      cross(v[(i + 1) % 3], v[(i + 2) % 3], w);
      c.barycentric[i] = dot(w, n);
      total += c.barycentric[i];
    }
    for (int i = 0; i < 3; ++i) c.barycentric[i] /= total;
    c.direction_error = 8 * kUnitRoundoff * largest(e1) * largest(e2);
    // The height is known to n's error along `nearest`; its quotient and product add the relative errors of n.
    const double relative = c.direction_error / std::sqrt(squared);
    c.offset_error =
        4 * (relative + kUnitRoundoff) * largest(nearest) + 12 * (relative + kUnitRoundoff) * largest(c.offset);
  }
}

template <int D>
void CandidateFactory<D>::make_precise(Candidate<D>& c) const {
  const PreciseOffset<D> precise = precise_offset<D>(p_, c.target);
  for (int i = 0; i < D; ++i) c.offset[i] = precise.offset[i];
  c.barycentric = precise.barycentric;
  c.offset_error = 2 * kUnitRoundoff * largest(c.offset);
  if (c.target.count < D || D == 2 || (!(c.direction_error < 1e-3 * largest(c.direction)) && c.offset_error > 0)) {
    std::copy(c.offset, c.offset + D, c.direction);
    c.direction_error = c.offset_error;
    c.has_normal = false;
  }
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
