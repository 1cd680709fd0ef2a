#pragma once

#include "core/unset_vector.h"
#include "self_collision/surface/continuous_input.h"
#include "self_collision/surface/deformed_surface.h"

namespace selvage {

/// A surface that moves, as the hierarchy and the filters in single precision see it.
class SweptSurface {
 public:
  /// Takes the positions at both ends of a step, and the thickness at each vertex (or none), into box units. O(n),
  /// parallel.
  ///
  /// @param margin    by which boxes are larger on all sides [m]
  /// @param distance  by half of which they are, besides [m]
  void place(const TriangleMesh& mesh, std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1,
             std::span<const double> thickness, const BoxUnits& units, double margin = 0, double distance = 0);

  /// Takes other positions, of motions that stray by less than the margin, in the same box units. Boxes stay as they
  /// are, and so does rounded() but for some vertices. O(n), parallel.
  void move(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1, std::span<const Index> vertices);

  /// Takes other positions of some vertices, in the same box units, and the boxes of the triangles that have them.
  /// False: one of them lies outside the range of the units, so that nothing here is of use. O(their number).
  /// @param ends  (n_vertices) positions at both ends
  bool replace(const TriangleMesh& mesh, std::span<const Index> vertices, std::span<const std::array<Vec3, 2>> ends,
               std::span<const Index> triangles);

  /// The margin and the distance in box units, rounded up.
  float margin() const { return margin_; }
  float distance() const { return distance_; }

  std::span<const Vec3> positions_t0() const { return positions_t0_; }
  std::span<const Vec3> positions_t1() const { return positions_t1_; }

  /// Per vertex its places in box units.
  std::span<const MovingVertex> rounded() const { return rounded_; }

  /// Per vertex its thickness in box units, rounded up. Without thickness there is no entry.
  std::span<const float> thickness() const { return thickness_; }

  /// Per triangle its box over the step, in box units, with the largest thickness of its vertices around it.
  std::span<const Box> boxes() const { return boxes_; }

  /// There are no boxes any more, until the next place().
  void free_boxes() { boxes_ = {}; }

 private:
  void fit_box(const TriangleMesh& mesh, Index triangle);

  UnsetVector<Vec3> positions_t0_, positions_t1_;
  UnsetVector<MovingVertex> rounded_;
  UnsetVector<float> thickness_;
  UnsetVector<Box> boxes_;
  BoxUnits units_;
  float margin_ = 0, distance_ = 0;
};

}  // namespace selvage
