#pragma once

#include "selvage/boundary_path/boundary_path.h"
#include "selvage/self_collision/self_collision.h"

namespace selvage {

/// A point inside with its shortest way out.
struct MarkedPath {
  Index vertex;  ///< of the mesh; kNone: a free point
  Vec3 from, to;
  double depth;  ///< negative: there is no way out
};

/// How two marked triangles meet, or a body touches something. The first four are TriangleContact's.
enum class MarkKind : std::int32_t { kNear, kTouching, kCrossing, kCoplanar, kVertexFace, kEdgeEdge, kCollider };

struct MarkedPair {
  std::array<Index, 2> triangles;
  MarkKind kind;
  std::array<Index, 4> features{kNone, kNone, kNone,
                                kNone};  ///< during a step: vertex and face, or two edges' vertices
};

/// All that is marked in one pose.
struct Marks {
  std::vector<MarkedPath> paths;
  std::vector<MarkedPair> pairs;

  bool empty() const { return paths.empty() && pairs.empty(); }
};

/// Finds the marks of the poses of one mesh of tetrahedra: boundary vertices inside an element that is not theirs, with
/// the longest of their ways out, and the first kMaxPairs pairs of boundary triangles that cross.
class MarkFinder {
 public:
  /// @param mesh  must outlive the finder
  MarkFinder(const TetMesh& mesh, std::span<const Vec3> positions);
  /// @param surface  the boundary, then cloth
  MarkFinder(const TetMesh& mesh, std::vector<VertexTuple<3>> surface, std::span<const Vec3> positions);
  Marks find(std::span<const Vec3> positions);

  /// More than one can look at, and than a page of many poses should hold.
  static constexpr std::size_t kMaxPairs = 20'000;

 private:
  TriangleMesh surface_;
  BoundaryPathFinder<3> paths_;
  SelfCollisionFinder pairs_;
};

}  // namespace selvage
