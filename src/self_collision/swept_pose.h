#pragma once

#include "self_collision/continuous_scene.h"
#include "self_collision/surface_pose.h"

namespace selvage {

/// A surface that moves, as the hierarchy and the filters in single precision see it.
class SweptPose {
 public:
  /// Takes the positions at both ends of a step into a frame. O(n), parallel.
  void place(const TriangleMesh& mesh, std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1,
             const PoseFrame& frame);

  std::span<const Vec3> positions_t0() const { return positions_t0_; }
  std::span<const Vec3> positions_t1() const { return positions_t1_; }

  /// Per vertex its places in the frame, each coordinate rounded down to a float (the rest 0).
  std::span<const std::array<float, 4>> rounded_t0() const { return rounded_t0_; }
  std::span<const std::array<float, 4>> rounded_t1() const { return rounded_t1_; }

  /// Boxes over the step, in the frame; of triangles in two forms.
  std::span<const SweptBox> vertex_boxes() const { return vertex_boxes_; }
  std::span<const SweptBox> triangle_boxes() const { return triangle_boxes_; }
  std::span<const Box> boxes() const { return boxes_; }

 private:
  std::vector<Vec3> positions_t0_, positions_t1_;
  std::vector<std::array<float, 4>> rounded_t0_, rounded_t1_;
  std::vector<SweptBox> vertex_boxes_, triangle_boxes_;
  std::vector<Box> boxes_;
};

}  // namespace selvage
