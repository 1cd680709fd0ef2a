#pragma once

#include "selvage/mesh/triangle_mesh.h"
#include "selvage/self_collision/continuous_collision.h"
#include "selvage/self_collision/self_collision.h"

#include <optional>

namespace selvage {

/// Which faces may meet at the end of a step, as far as CCD knows already: those that met at its start, and those with
/// features that meet during it. Two triangles without a common vertex that are apart come to meet nowhere but where a
/// vertex and a face, or two edges, do, so that no others meet at its end. Then no search is needed there.
class MetFaces {
 public:
  /// @param surface     must outlive this
  /// @param body_faces  those before the colliders': pairs of two colliders' faces are none
  MetFaces(const TriangleMesh& surface, Index body_faces) : surface_(surface), body_faces_(body_faces) {}

  /// Takes all pairs that meet during a step, and where it ends.
  void note(std::span<const Vec3> positions_t1, const ContinuousPairs& pairs);

  /// Pairs of faces without a common vertex, each once and first < second, ascending: all that meet at these positions,
  /// and more. Nothing where they are not those of the last note(), bit for bit, or where so many meet that a search is
  /// as cheap. What was noted is forgotten, since it is about the next step no more.
  ///
  /// @param at_start  all pairs that met at the start of the step that was noted
  std::optional<std::vector<IndexPair>> take_candidates(std::span<const Vec3> positions,
                                                        std::span<const TrianglePair> at_start);

 private:
  void append(std::span<const Index> first, std::span<const Index> second, std::vector<IndexPair>& candidates) const;

  const TriangleMesh& surface_;
  Index body_faces_;
  bool is_noted_ = false;
  std::vector<Vec3> positions_;
  ContinuousPairs pairs_;
};

}  // namespace selvage
