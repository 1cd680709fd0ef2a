#pragma once

#include "bvh/overlap.h"
#include "selvage/mesh/triangle_mesh.h"

#include <memory>

namespace selvage::bench {

/// Polygon_mesh_processing's self_intersections of CGAL on a Surface_mesh, with exact predicates: boxes of all faces
/// swept anew for each pose, as CGAL keeps no hierarchy.
class CgalCollider {
 public:
  explicit CgalCollider(const TriangleMesh& mesh);
  ~CgalCollider();
  CgalCollider(const CgalCollider&) = delete;
  CgalCollider& operator=(const CgalCollider&) = delete;

  /// Whether CGAL takes the mesh: manifold, and consistently oriented.
  bool takes_mesh() const;

  /// Pairs of triangles as CGAL finds them, in no order; each once, smaller number first. Unlike ours they include
  /// triangles that share a vertex or an edge and meet elsewhere; a degenerate triangle meets itself and no other.
  std::vector<IndexPair> find_pairs(std::span<const Vec3> positions, bool in_parallel);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace selvage::bench
