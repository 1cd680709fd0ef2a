#pragma once

#include "boundary_path/traversal/segment.h"
#include "bvh/traverse.h"
#include "selvage/geometry/predicates.h"

#include <cmath>
#include <limits>

namespace selvage {
inline namespace SELVAGE_ISA {

/// The query point p in its element, and how far from it the theorems of SPB section 3.2 hold.
template <int D>
class QueryPoint {
 public:
  QueryPoint(const PathInput<D>& input, const PathQuery<D>& query) : input_(input), query_(query) {}

  /// False when p does not lie in its element.
  /// @param is_inside  p certainly lies strictly inside
  bool locate(bool is_inside);

  /// The defect of p's component that is nearest to p bounds how long paths may be that the theorems hold for.
  /// @param squared_reach  a defect farther than this counts as one at this distance [(scaled m)^2]
  /// @param look           false: there is none within the reach
  void find_defects(float squared_reach, bool look);

  const PathQuery<D>& query() const { return query_; }
  bool is_inside() const { return is_inside_; }
  /// p lies on no face of its element.
  bool is_strictly_inside() const { return is_strictly_inside_; }
  ComponentState component_state() const { return state_; }
  /// No path up to this long can meet a defect: theorems 1 and 2 hold for it. 0 where they never do.
  double safe_distance() const { return safe_distance_; }

  /// Boundary faces that have all the vertices on which p lies: they contain p, and are no candidates.
  bool is_excluded(Index face) const {
    if (query_.source[0] == kNone) return false;
    const auto& ids = input_.face_stars[face].vertices;
    return contains(ids, query_.source[0]) && (query_.source[1] == kNone || contains(ids, query_.source[1]));
  }
  /// Whether a face may be the answer, wherever it lies.
  bool may_end_at(Index face) const {
    return input_.face_stars[face].component == component_ && !is_excluded(face) && !input_.inverted_owner[face];
  }
  /// Whether excluded faces may prove that others are none: see docs/how_it_works/boundary_path.md.
  bool may_cull_towards_source() const { return is_at_source_; }
  /// Whether a path of this length may meet inverted elements, so that the rules of SPB section 3.5 hold.
  bool follows_inverted_rules(double squared_distance) const {
    return state_ == ComponentState::kInverted && !(std::sqrt(squared_distance) < defect_distance_);
  }

 private:
  const PathInput<D>& input_;
  const PathQuery<D>& query_;
  bool is_inside_ = false, is_strictly_inside_ = false;
  bool is_on_own_ = false;     ///< p may lie on its own element's boundary
  bool is_at_source_ = false;  ///< p is where the vertex is that it comes from
  Index component_ = 0;
  ComponentState state_ = ComponentState::kImmersed;
  double safe_distance_ = 0;
  double defect_distance_ = 0;  ///< the same, but for p's own position on the boundary
};

template <int D>
bool QueryPoint<D>::locate(bool is_inside) {
  is_inside_ = is_strictly_inside_ = is_inside;
  if (!is_inside) {
    std::array<Vec<D>, D + 1> corners;
    for (int i = 0; i <= D; ++i) corners[i] = input_.positions[input_.elements[query_.element].vertices[i]];
    const Containment at = locate_in_simplex<D>(corners, query_.point);
    is_inside_ = at.inside;
    if (!is_inside_) return false;
    is_strictly_inside_ = at.zero_mask == 0;
  }
  component_ = input_.component_of[query_.element];
  state_ = input_.component_state[component_];
  // Faces that contain p materially are no candidates, which the theorems do not know: rely on them only where p is
  // known to be off the boundary, or is a vertex that came from elsewhere.
  const auto& vertices = input_.elements[query_.element].vertices;
  is_on_own_ = query_.source[0] == kNone ? !is_strictly_inside_
                                         : contains(vertices, query_.source[0]) || contains(vertices, query_.source[1]);
  is_at_source_ = is_strictly_inside_ && query_.source[0] != kNone && query_.source[1] == kNone &&
                  query_.point == input_.positions[query_.source[0]];
  return true;
}

/// The rules for inverted elements look along the line up to twice a candidate's distance beyond it: three times that
/// distance from p.
template <int D>
void QueryPoint<D>::find_defects(float squared_reach, bool look) {
  float nearest = squared_reach;
  if (look) {
    const Box box = input_.box_origin.around_point(query_.point);
    visit_nearest(input_.defect_nodes, box, nearest, [&](Index defect, float squared_distance) {
      if (input_.defects[defect].component == component_ && squared_distance < nearest) nearest = squared_distance;
      return nearest;
    });
  }
  defect_distance_ = std::sqrt(double(nearest)) * (state_ == ComponentState::kInverted ? 0.333 : 1.0);
  safe_distance_ = is_on_own_ ? 0 : defect_distance_;
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
