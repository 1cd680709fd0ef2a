#pragma once

#include "bvh/overlap.h"
#include "selvage/mesh/triangle_mesh.h"

#include <memory>

namespace selvage::bench {

/// How Embree brings its hierarchy to a new pose.
enum class ColliderTree {
  kRefitted,  ///< built once, then refitted
  kRebuilt,   ///< surface area heuristic, binned
  kMorton,    ///< rebuilt along a space-filling curve
};

/// rtcCollide of Embree 3 on a user geometry with one box a triangle, and our exact predicate on the pairs that it
/// finds: the fastest hierarchy that others could pick, without culling by normals.
class EmbreeCollider {
 public:
  EmbreeCollider(const TriangleMesh& mesh, std::span<const Vec3> positions, ColliderTree tree);
  ~EmbreeCollider();
  EmbreeCollider(const EmbreeCollider&) = delete;
  EmbreeCollider& operator=(const EmbreeCollider&) = delete;

  /// Takes a pose: builds or refits.
  void update(std::span<const Vec3> positions);

  /// All pairs of triangles that share no vertex and meet, in no order; each once, smaller number first. On all threads
  /// that oneTBB may use.
  std::vector<IndexPair> find_pairs() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace selvage::bench
