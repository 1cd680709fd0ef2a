#include "self_collision/swept_pose.h"

#include "selvage/core/parallel.h"

namespace selvage {

namespace {

constexpr std::int64_t kGrain = 4096;

}  // namespace

void SweptPose::place(const TriangleMesh& mesh, std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1,
                      const PoseFrame& frame) {
  const std::size_t count = positions_t0.size();
  positions_t0_.resize(count);
  positions_t1_.resize(count);
  rounded_t0_.resize(count);
  rounded_t1_.resize(count);
  vertex_boxes_.resize(count);
  parallel_for(mesh.vertex_count(), kGrain, [&](std::int64_t v) {
    positions_t0_[v] = positions_t0[v];
    positions_t1_[v] = positions_t1[v];
    const Vec3 start = frame.map(positions_t0[v]), end = frame.map(positions_t1[v]);
    SweptBox box{};
    for (int k = 0; k < 3; ++k) {
      rounded_t0_[v][k] = round_down(start[k]);
      rounded_t1_[v][k] = round_down(end[k]);
      box.lower[k] = std::min(rounded_t0_[v][k], rounded_t1_[v][k]);
      box.upper[k] = round_up(std::max(start[k], end[k]));
    }
    vertex_boxes_[v] = box;
  });
  triangle_boxes_.resize(mesh.triangle_count());
  boxes_.resize(mesh.triangle_count());
  parallel_for(mesh.triangle_count(), kGrain, [&](std::int64_t t) {
    const auto& [a, b, c] = mesh.triangles()[t];
    SweptBox swept{};
    for (int k = 0; k < 3; ++k) {
      swept.lower[k] = std::min({vertex_boxes_[a].lower[k], vertex_boxes_[b].lower[k], vertex_boxes_[c].lower[k]});
      swept.upper[k] = std::max({vertex_boxes_[a].upper[k], vertex_boxes_[b].upper[k], vertex_boxes_[c].upper[k]});
      boxes_[t].lower[k] = swept.lower[k];
      boxes_[t].upper[k] = swept.upper[k];
    }
    triangle_boxes_[t] = swept;
  });
}

}  // namespace selvage
