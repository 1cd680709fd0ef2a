#pragma once

#include "mesh/position_extent.h"
#include "self_collision/surface/box_units.h"
#include "self_collision/surface/leaf_vertices.h"
#include "selvage/mesh/triangle_mesh.h"

namespace selvage {

/// A surface in one pose, as the hierarchy and the filters in single precision see it.
class DeformedSurface {
 public:
  /// Takes positions and the thickness at each vertex (or none) into box units. O(n), parallel.
  void place(const TriangleMesh& mesh, std::span<const Vec3> positions, std::span<const double> thickness,
             const BoxUnits& units);

  std::span<const Vec3> positions() const { return positions_; }

  /// Per vertex its place in box units, each coordinate rounded down to a float (the rest 0).
  std::span<const std::array<float, 4>> rounded() const { return rounded_; }

  /// Per triangle, in box units: its thickness rounded up. Without thickness there is no entry.
  std::span<const float> thickness() const { return thickness_; }

  /// Boxes in box units, around a triangle and its thickness.
  Box box(const TriangleMesh& mesh, Index triangle) const;
  std::vector<Box> boxes(const TriangleMesh& mesh) const;

  /// Refits a hierarchy over the triangles, whose vertices are known as those of its leaves.
  void refit(const TriangleMesh& mesh, std::span<const LeafVertices> leaves, Bvh& bvh) const;

 private:
  std::vector<Vec3> positions_;
  std::vector<std::array<float, 4>> rounded_;
  std::vector<float> thickness_;
};

/// The box units of positions of this extent.
BoxUnits box_units_around(const PositionExtent<3>& extent);

/// @throws Error  when there is neither no thickness nor one per vertex, or one is no length
void check_thickness(const TriangleMesh& mesh, std::span<const double> thickness);

}  // namespace selvage
