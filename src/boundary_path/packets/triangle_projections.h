#pragma once

#include "boundary_path/location/group_order.h"
#include "boundary_path/traversal/segment.h"
#include "core/simd/simd_double.h"
#include "core/simd/vec3.h"

namespace selvage {
inline namespace SELVAGE_ISA {

/// Sixteen times CandidateFactory::project_on_triangle(), side by side: the same bits.
class TriangleProjections {
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

  SELVAGE_INLINE void project() {
    for (int lane = 0; lane < kPacketSize; lane += WideDouble::kLanes) project(lane);
  }

  /// Sets what project_on_triangle() does, and the distance.
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
  using Vector = LaneVec3<WideDouble>;

  SELVAGE_INLINE void project(int lane) {
    const WideDouble unit = WideDouble::broadcast(kUnitRoundoff);
    const auto load = [&](const Rows& rows) -> Vector {
      return {{WideDouble::load(rows[0] + lane), WideDouble::load(rows[1] + lane), WideDouble::load(rows[2] + lane)}};
    };
    const Vector p = load(p_), a = load(corners_[0]), b = load(corners_[1]), c = load(corners_[2]);
    const Vector v[3] = {a - p, b - p, c - p}, e1 = b - a, e2 = c - a, n = cross(e1, e2);
    Vector nearest = v[0], weight;
    WideDouble least = abs_max(v[0]);
    for (int k = 1; k < 3; ++k) {
      const WideDouble size = abs_max(v[k]);
      for (int i = 0; i < 3; ++i) nearest[i] = select_less(size, least, v[k][i], nearest[i]);
      least = select_less(size, least, size, least);
    }
    const WideDouble squared = dot(n, n), height = dot(n, nearest) / squared;
    const Vector offset = height * n;
    WideDouble total = WideDouble::broadcast(0);
    for (int k = 0; k < 3; ++k) {
      weight[k] = dot(cross(v[(k + 1) % 3], v[(k + 2) % 3]), n);
      total = total + weight[k];
    }
    const WideDouble direction_error = WideDouble::broadcast(8 * kUnitRoundoff) * abs_max(e1) * abs_max(e2);
    const WideDouble relative = direction_error / sqrt(squared) + unit;
    const WideDouble offset_error =
        WideDouble::broadcast(4) * relative * least + WideDouble::broadcast(12) * relative * abs_max(offset);
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
