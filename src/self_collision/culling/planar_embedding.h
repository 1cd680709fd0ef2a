#pragma once

#include "core/unset_vector.h"
#include "self_collision/culling/contour_kernel.h"
#include "self_collision/culling/surface_pieces.h"

namespace selvage {

/// Decides whether pieces of a surface are certainly graphs over a plane: then no two of their triangles meet but in
/// the vertices and edges that they share (docs/self_collision_cones.md, theorem 1). With two poses the piece is a
/// graph over one plane all the time while vertices move on straight lines from one to the other.
///
/// A test is sufficient, never wrong: whatever rounding leaves open is "no".
///
/// @tparam kSteps  1: one pose; 2: the two ends of a step
template <int kSteps>
class PlanarEmbeddingTest {
 public:
  using Poses = std::array<std::span<const Vec3>, kSteps>;

  /// What a step looks like in a frame; nothing for one pose.
  using Rounded = std::span<const MovingRow>;

  /// Takes new poses: O(n), parallel. Keeps references to what it is given; pieces learn their
  /// contours as they are asked for.
  ///
  /// @param rounded  where poses are those of a step, the same in a frame; faster than without
  void place(SurfacePieces& pieces, const Poses& poses, Rounded rounded = {}) {
    take(pieces, poses, rounded);
    measure({0, static_cast<Index>(pieces.triangles().size())});
  }

  /// The same in two parts: what has not been measured since poses were taken must not be asked.
  void take(SurfacePieces& pieces, const Poses& poses, Rounded rounded = {});
  void measure(SurfacePieces::Range places);

  /// Memory of one thread.
  struct Workspace {
    std::vector<char> waiting;  ///< of SurfacePieces::contours()
    std::vector<Index> vertices;
    std::vector<double> exact;  ///< coordinates before they are scaled and rounded
    std::vector<float> coordinates;
    std::vector<EdgeBlock> blocks;
  };

  /// O(triangles).
  bool is_graph(Index node, Workspace& workspace) const;

  /// The plane across the area vector of a node's piece (of both ends together); a zero normal where there is none.
  ProjectionPlane plane_of(Index node) const;

  /// Only the first condition: all triangles of the node certainly face along the plane's normal.
  bool do_triangles_face(Index node, const ProjectionPlane& plane) const;

  /// Only the others: the contours, projected on the plane, certainly meet nowhere, and wind around no point twice.
  bool is_contour_embedded(Index node, const ProjectionPlane& plane, Workspace& workspace,
                           ContourTest test = ContourTest::kMonotoneRuns) const;

 private:
  static constexpr int kCoefficients = 2 * kSteps - 1;
  void compute_areas(Index first, Index last);
  void compute_areas_in_frame(Index first, Index last);
  PlanarLoops<kSteps> project_contours(const SurfacePieces::Contours& contours, const ProjectionPlane& plane,
                                       Workspace& workspace) const;

  SurfacePieces* pieces_ = nullptr;
  Poses poses_;
  Rounded rounded_;
  std::array<std::array<UnsetVector<float>, 4>, kCoefficients> areas_;
  UnsetVector<Vec3> group_areas_;  ///< of consecutive triangles together
};

/// The plane across a vector, which need not have unit length; a zero normal where it has no length.
ProjectionPlane plane_across(const Vec3& direction);

}  // namespace selvage
