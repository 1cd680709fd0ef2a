#pragma once

#include "boundary_path/location/group_order.h"
#include "boundary_path/traversal/segment.h"
#include "core/simd/simd_double.h"

namespace selvage {
inline namespace SELVAGE_ISA {

/// Sixteen times CandidateFactory::aim_at_triangle(), side by side: the same bits.
class TriangleAims {
 public:
  /// p, and the triangle inside which the closest point lies.
  SELVAGE_INLINE void set(int lane, const Vec<3>& p, const Vec<3>& a, const Vec<3>& b, const Vec<3>& c) {
    for (int i = 0; i < 3; ++i) {
      p_[i][lane] = p[i];
      corners_[0][i][lane] = a[i];
      corners_[1][i][lane] = b[i];
      corners_[2][i][lane] = c[i];
    }
  }

  SELVAGE_INLINE void aim() {
    for (int lane = 0; lane < kPacketSize; lane += WideDouble::kLanes) aim(lane);
  }

  /// Sets what aim_at_triangle() does, and the distance.
  SELVAGE_INLINE void get(int lane, Candidate<3>& c) const {
    for (int i = 0; i < 3; ++i) {
      c.direction[i] = direction_[i][lane];
      c.offset[i] = offset_[i][lane];
      c.barycentric[static_cast<std::size_t>(i)] = barycentric_[i][lane];
    }
    c.direction_error = direction_error_[lane];
    c.offset_error = offset_error_[lane];
    c.squared_distance = squared_distance_[lane];
    c.has_normal = true;
  }

 private:
  using Rows = double[3][kPacketSize];
  using Wide3 = WideDouble[3];

  SELVAGE_INLINE static WideDouble dot(const Wide3& a, const Wide3& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  }
  SELVAGE_INLINE static void cross(const Wide3& a, const Wide3& b, Wide3& r) {
    r[0] = a[1] * b[2] - a[2] * b[1];
    r[1] = a[2] * b[0] - a[0] * b[2];
    r[2] = a[0] * b[1] - a[1] * b[0];
  }
  SELVAGE_INLINE static WideDouble largest(const Wide3& a) {
    const WideDouble zero = WideDouble::broadcast(0);
    const auto size = [&](int i) { return max(a[i], zero - a[i]); };
    return max(max(size(0), size(1)), size(2));
  }

  SELVAGE_INLINE void aim(int lane) {
    const WideDouble unit = WideDouble::broadcast(kUnitRoundoff);
    Wide3 v[3], e1, e2, n, nearest, offset, weight;
    for (int i = 0; i < 3; ++i) {
      const WideDouble p = WideDouble::load(p_[i] + lane), a = WideDouble::load(corners_[0][i] + lane),
                       b = WideDouble::load(corners_[1][i] + lane), c = WideDouble::load(corners_[2][i] + lane);
      nearest[i] = v[0][i] = a - p;
      v[1][i] = b - p;
      v[2][i] = c - p;
      e1[i] = b - a;
      e2[i] = c - a;
    }
    cross(e1, e2, n);
    WideDouble least = largest(v[0]);
    for (int k = 1; k < 3; ++k) {
      const WideDouble size = largest(v[k]);
      for (int i = 0; i < 3; ++i) nearest[i] = select_less(size, least, v[k][i], nearest[i]);
      least = select_less(size, least, size, least);
    }
    const WideDouble squared = dot(n, n), height = dot(n, nearest) / squared;
    for (int i = 0; i < 3; ++i) offset[i] = n[i] * height;
    WideDouble total = WideDouble::broadcast(0);
    for (int k = 0; k < 3; ++k) {
      Wide3 w;
      cross(v[(k + 1) % 3], v[(k + 2) % 3], w);
      weight[k] = dot(w, n);
      total = total + weight[k];
    }
    const WideDouble direction_error = WideDouble::broadcast(8 * kUnitRoundoff) * largest(e1) * largest(e2);
    const WideDouble relative = direction_error / sqrt(squared) + unit;
    const WideDouble offset_error =
        WideDouble::broadcast(4) * relative * least + WideDouble::broadcast(12) * relative * largest(offset);
    for (int i = 0; i < 3; ++i) {
      n[i].store(direction_[i] + lane);
      offset[i].store(offset_[i] + lane);
      (weight[i] / total).store(barycentric_[i] + lane);
    }
    direction_error.store(direction_error_ + lane);
    offset_error.store(offset_error_ + lane);
    dot(offset, offset).store(squared_distance_ + lane);
  }

  alignas(64) Rows p_ = {}, corners_[3] = {};
  alignas(64) Rows direction_, offset_, barycentric_;
  alignas(64) double direction_error_[kPacketSize], offset_error_[kPacketSize], squared_distance_[kPacketSize];
};

}  // namespace SELVAGE_ISA
}  // namespace selvage
