#pragma once

#include "selvage/core/types.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace selvage::oracle {

/// Closest point of a face in double arithmetic, seen from the query's point.
template <int D>
struct ClosestDouble {
  Vec<D> offset;  ///< closest point minus the query's point
  double squared_distance;
  double size;   ///< largest coordinate of the face, seen from the point
  double error;  ///< bounds the error of the offset's length
  bool trusted;  ///< the face is not so thin that the offset is unreliable
};

template <int D>
Vec<D> closest_on_edge(const Vec<D>& a, const Vec<D>& b) {
  const Vec<D> e = b - a;
  const double length = e.squaredNorm();
  return length > 0 ? Vec<D>(a + std::clamp(-a.dot(e) / length, 0.0, 1.0) * e) : a;
}

template <int D>
ClosestDouble<D> closest_in_doubles(const std::vector<Vec<D>>& positions, const VertexTuple<D>& face,
                                    const Vec<D>& point) {
  std::array<Vec<D>, D> v;
  ClosestDouble<D> result;
  result.size = 0;
  result.trusted = true;
  for (int i = 0; i < D; ++i) {
    v[i] = positions[face[i]] - point;
    result.size = std::max(result.size, v[i].cwiseAbs().maxCoeff());
  }
  // Let u = 2^-53. A coordinate is off by u times the size, an edge by 7 u times it. Along an edge the point may slip,
  // which hardly changes the distance unless the edge is about as long as the size: 20 u in all.
  result.error = 0x1p-46 * result.size;
  result.offset = closest_on_edge<D>(v[0], v[1]);
  if constexpr (D == 3) {
    const Vec3 n = (v[1] - v[0]).cross(v[2] - v[0]);
    const double area = n.squaredNorm();
    const double longest =
        std::max({(v[1] - v[0]).squaredNorm(), (v[2] - v[0]).squaredNorm(), (v[2] - v[1]).squaredNorm()});
    result.trusted = area > 1e-3 * longest * longest;
    // The normal is off by 24 u size longest, and the less it is itself, the more it tilts: that moves the foot of the
    // perpendicular across the edges, and its height, by that share of the size each.
    result.error = area > 0 ? result.error * std::max(1.0, result.size * std::sqrt(longest / area)) : HUGE_VAL;
    if (area > 0 && n.dot(v[0].cross(v[1])) >= 0 && n.dot(v[1].cross(v[2])) >= 0 && n.dot(v[2].cross(v[0])) >= 0) {
      result.offset = n * (n.dot(v[0]) / area);
    } else {
      std::array<Vec3, 3> on_edges{result.offset};
      for (int i = 1; i < 3; ++i) {
        on_edges[i] = closest_on_edge<3>(v[i], v[(i + 1) % 3]);
        if (on_edges[i].squaredNorm() < result.offset.squaredNorm()) result.offset = on_edges[i];
      }
      // Squares hide which of two points is the nearer when both lie at a vertex, one at it and one 1e-9 beside it.
      const double nearest = result.offset.squaredNorm();
      for (const Vec3& other : on_edges) {
        const bool as_near = other.squaredNorm() - nearest <= 1e-14 * result.size * result.size;
        if (as_near && (other - result.offset).norm() > 1e-14 * result.size) result.trusted = false;
      }
    }
  }
  result.squared_distance = result.offset.squaredNorm();
  return result;
}

/// Which faces of an element a line p + u (s - p), u in [first, last], meets: a_i + u c_i is the i-th barycentric
/// coordinate times the volume, known up to `margin`. -1 where the margin does not allow to say.
template <int N>
int met_faces_in_doubles(const std::array<double, N>& a, const std::array<double, N>& c, double margin, int first,
                         int last) {
  int mask = 0;
  for (int i = 0; i < N; ++i) {
    const double begin = a[i] + first * c[i], end = a[i] + last * c[i];
    if ((begin > margin && end > margin) || (begin < -margin && end < -margin)) continue;
    if (std::abs(begin) <= margin || std::abs(end) <= margin) return -1;
    const double u = -a[i] / c[i], blur = margin / std::abs(c[i]);
    bool outside = false, unsure = false;
    for (int j = 0; j < N; ++j) {
      if (j == i) continue;
      const double value = a[j] + u * c[j], bound = (margin + std::abs(c[j]) * blur) * 4;
      outside = outside || value < -bound;
      unsure = unsure || value <= bound;
    }
    if (outside) continue;
    if (unsure) return -1;
    mask |= 1 << i;
  }
  return mask;
}

}  // namespace selvage::oracle
