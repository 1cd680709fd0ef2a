#include "self_collision/swept_pose.h"

#include "selvage/core/parallel.h"

namespace selvage {

void SweptPose::place(const TriangleMesh& mesh, std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1,
                      std::span<const double> thickness, const PoseFrame& frame) {
  const std::size_t count = positions_t0.size();
  positions_t0_.resize(count);
  positions_t1_.resize(count);
  rounded_.resize(count);
  thickness_.resize(thickness.size());
  vertex_boxes_.resize(count);
  parallel_for(mesh.vertex_count(), kGrain, [&](std::int64_t v) {
    positions_t0_[v] = positions_t0[v];
    positions_t1_[v] = positions_t1[v];
    const Vec3 start = frame.map(positions_t0[v]), end = frame.map(positions_t1[v]);
    for (int k = 0; k < 3; ++k) {
      const float low_start = rounded_[v].coordinates[k] = round_down(start[k]);
      const float low_end = rounded_[v].coordinates[4 + k] = round_down(end[k]);
      vertex_boxes_[v].lower[k] = std::min(low_start, low_end);
      vertex_boxes_[v].upper[k] = round_up(std::max(start[k], end[k]));
    }
    // A little more than asked, for the rounding of map_length(); what is too much is told apart later.
    if (!thickness.empty()) thickness_[v] = round_up(frame.map_length(thickness[v]) * (1 + 0x1p-19));
  });
  boxes_.resize(mesh.triangle_count());
  parallel_for(mesh.triangle_count(), kGrain, [&](std::int64_t t) {
    const auto& [a, b, c] = mesh.triangles()[t];
    boxes_[t] = vertex_boxes_[a];
    boxes_[t].merge(vertex_boxes_[b]);
    boxes_[t].merge(vertex_boxes_[c]);
    if (thickness.empty()) return;
    const double largest = std::max({thickness_[a], thickness_[b], thickness_[c]});
    for (int k = 0; k < 3; ++k) {
      boxes_[t].lower[k] = round_down(boxes_[t].lower[k] - largest);
      boxes_[t].upper[k] = round_up(boxes_[t].upper[k] + largest);
    }
  });
}

}  // namespace selvage
