#pragma once

#include "mesh/position_extent.h"
#include "self_collision/pose_frame.h"
#include "selvage/mesh/triangle_mesh.h"

namespace selvage {

/// A surface in one pose, as the hierarchy and the filters in single precision see it.
class SurfacePose {
 public:
  /// Takes positions and the thickness at each vertex (or none) into a frame. O(n), parallel.
  void place(const TriangleMesh& mesh, std::span<const Vec3> positions, std::span<const double> thickness,
             const PoseFrame& frame);

  std::span<const Vec3> positions() const { return positions_; }

  /// Per vertex its place in the frame, each coordinate rounded down to a float (the rest 0).
  std::span<const std::array<float, 4>> rounded() const { return lower_; }

  /// Per triangle, in the frame: its box, and its thickness rounded up, around which the box lies. Without thickness
  /// there is no entry.
  std::span<const Box> boxes() const { return boxes_; }
  std::span<const float> thickness() const { return thickness_; }

 private:
  std::vector<Vec3> positions_;
  std::vector<std::array<float, 4>> lower_, upper_;
  std::vector<Box> boxes_;
  std::vector<float> thickness_;
};

/// The frame of positions of this extent.
PoseFrame frame_around(const PositionExtent<3>& extent);

/// @throws Error  when there is neither no thickness nor one per vertex, or one is no length
void check_thickness(const TriangleMesh& mesh, std::span<const double> thickness);

}  // namespace selvage
