#pragma once

#include "contact/ways_out/path_contact.h"

namespace selvage {

/// One way out for all points of a tangle of two pieces, or of two parts of one, where their own disagree.
///
/// A rod that runs right through another has points whose shortest paths lead up, and others whose lead down: they pull
/// against one another, and hold the rods in each other for ever. All these points then leave in one direction, each
/// straight to where it meets the boundary: in that one of some directions in which what is in the other piece, and
/// what follows it, has the shortest way.
///
/// Points are in a tangle where a point shares a vertex, or a vertex of the element that it is in, with another. Those
/// of one piece leave in a direction, those of the other against it. In one piece, the vertices of a point are of one
/// part and those of the element that it is in of the other; where that contradicts itself, in a fold, points keep
/// their shortest paths. So do those of cloth and colliders, and those whose straight way ends nowhere.
///
/// A sheet that runs right through itself has two ends and a loop between them. No direction is taken that presses the
/// shorter end on, even where the ways out agree: the loop, which would be drawn through instead, has no way but to
/// turn inside out, and where one happens beside the other, the sheet cannot part.
class CommonWaysOut {
 public:
  explicit CommonWaysOut(const TetMesh& mesh);

  /// Replaces the ways out of tangles whose own disagree. O(points), some hundred elements each.
  /// @param positions  (n_vertices) of the mesh, then of colliders [m]
  /// @param points     each in its element
  /// @param paths      (n_points) their shortest paths; updated
  void apply(std::span<const Vec3> positions, std::span<const PenetratingPoint> points,
             std::span<BoundaryPath<3>> paths) const;

  /// Vertices of points in folds, and of the elements that these points are in; ascending. Of pieces in which no
  /// other is: bodies that come out of each other bend so much that they cross themselves, and part sooner held in
  /// shape.
  std::vector<Index> vertices_in_folds(std::span<const PenetratingPoint> points) const;

 private:
  /// A point of a tangle: on its way by `side` times the tangle's direction.
  struct Member {
    Index tangle, point;
    double side;
  };

  bool is_of_collider(const PenetratingPoint& point) const { return point.vertices[0] >= mesh_.vertex_count(); }
  /// The connected piece that a point is of; kNone: of a collider or cloth.
  Index piece_of(const PenetratingPoint& point) const;
  std::vector<Member> members_of(std::span<const PenetratingPoint> points) const;
  void append_members_in_own_piece(std::span<const PenetratingPoint> points, std::span<const Index> in_own_piece,
                                   std::vector<Member>& members) const;
  double length_behind(std::span<const Vec3> positions, const PenetratingPoint& point, const Vec3& direction) const;
  std::vector<Vec3> ways_of_ends(std::span<const Vec3> positions, std::span<const PenetratingPoint> points,
                                 std::span<const std::span<const Member>> tangles) const;
  Vec3 best_direction(std::span<const Vec3> positions, std::span<const PenetratingPoint> points,
                      std::span<const BoundaryPath<3>> paths, std::span<const Member> members,
                      const Vec3& way_of_end) const;

  const TetMesh& mesh_;
  std::vector<Index> pieces_;  ///< (n_elements)
};

}  // namespace selvage
