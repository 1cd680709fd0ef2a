#pragma once

#include "core/unset_vector.h"
#include "self_collision/culling/contour_kernel.h"
#include "self_collision/culling/culled_pairs.h"
#include "self_collision/culling/surface_pieces.h"

namespace selvage {

/// The planar embedding test: decides whether the projection of a piece of surface on a plane is certainly one-to-one.
/// Then no two of its triangles meet but in the vertices and edges that they share. It is the surface normal test and
/// the contour test of the normal cone test (NCT), with the condition that several contours need
/// (docs/how_it_works/self_collision_cones.md, theorem 1). With two poses the projection on one plane is one-to-one at
/// all times while vertices move on straight lines from one pose to the other.
///
/// The test is sufficient, and all rounding is bounded: what cannot be decided is "no".
///
/// @tparam kSteps  1: one pose; 2: the two ends of a step
template <int kSteps>
class PlanarEmbeddingTest {
 public:
  using Poses = std::array<std::span<const Vec3>, kSteps>;

  /// Positions of a step in box units; empty for one pose.
  using Rounded = std::span<const MovingVertex>;

  /// Takes new poses: O(n), parallel. Keeps references to its arguments; the contours of a piece are traced when they
  /// are first asked for.
  ///
  /// @param rounded  the poses of a step once more, in box units: optional, and faster
  void place(SurfacePieces& pieces, const Poses& poses, Rounded rounded = {}) {
    take(pieces, poses, rounded);
    measure({0, static_cast<Index>(pieces.triangles().size())});
  }

  /// The same in two parts. Nodes with triangles that have not been measured since poses were taken must not be tested.
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

  /// Whether a node's piece is certainly embedded in the plane across its area vector. O(triangles).
  bool is_embedded(Index node, Workspace& workspace) const;

  /// The plane across the area vector of a node's piece (of both ends together); a zero normal where there is none.
  ProjectionPlane plane_of(Index node) const;

  /// The surface normal test alone: all triangles of the node certainly face along the plane's normal.
  bool do_triangles_face(Index node, const ProjectionPlane& plane) const;

  /// The contour test alone: the contours, projected on the plane, certainly meet nowhere, and wind around no point
  /// twice.
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

/// `CullingMethod::kAuto`: culls the nodes that pass the planar embedding test. No cones: the plane of a node is the
/// one across its area vector. Nodes of few triangles are not tested; nothing is, where a sample shows that it would
/// not pay. Misses no pair.
///
/// @param knows_neighbours  most triangles are known not to meet their neighbours without culling: less is to be gained
template <int kSteps>
CulledPairs cull_by_planar_embedding(const Bvh& bvh, SurfacePieces& pieces,
                                     const typename PlanarEmbeddingTest<kSteps>::Poses& poses,
                                     std::span<const MovingVertex> rounded, bool knows_neighbours,
                                     PlanarEmbeddingTest<kSteps>& test);

}  // namespace selvage
