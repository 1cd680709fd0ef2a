#pragma once

#include "scene/reading/marks.h"
#include "selvage/simulation/collider.h"

#include <memory>

namespace selvage {

/// A place of a body that touches another body, another part of its own, or a collider.
struct Touch {
  MarkKind kind;                  ///< kVertexFace, kEdgeEdge or kCollider
  std::array<Index, 2> vertices;  ///< of the edge; of a vertex twice the same
  double place;                   ///< along the edge: 0 at the first vertex, 1 at the second
  Vec3 normal;                    ///< unit, out of what is touched
};

/// Finds the touches in the poses of one mesh of tetrahedra.
///
/// A run stores positions, not contacts: what is nearer than kNear of the mean edge touches. Of a vertex the nearest
/// face counts, of edges those whose nearest points lie between their ends, and of colliders the first.
class TouchFinder {
 public:
  /// @throws Error  when a collider is impossible
  TouchFinder(const TetMesh& mesh, std::span<const Vec3> positions, std::span<const Collider> colliders);
  /// @param surface  the boundary, then cloth
  TouchFinder(TriangleMesh surface, std::span<const Vec3> positions, std::span<const Collider> colliders);
  ~TouchFinder();

  /// At most kMaxTouches; first those of colliders, then of vertices and faces, then of edges, each by number.
  /// @param time  [s] at which the colliders are where they are
  std::vector<Touch> find(std::span<const Vec3> positions, double time);

  /// [m]
  double distance() const;

  static constexpr double kNear = 0.02;
  static constexpr std::size_t kMaxTouches = 20'000;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace selvage
