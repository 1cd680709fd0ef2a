#pragma once

#include "bvh/bvh.h"
#include "self_collision/surface/continuous_input.h"
#include "self_collision/surface/swept_surface.h"
#include "selvage/mesh/triangle_mesh.h"

namespace selvage {

/// The pairs of features that come near one another during a motion, kept from step to step. While no vertex strays
/// from that motion by more than a margin, at either end of a step, no others can meet: each way is straight, so that
/// it strays no farther in between. Vertices that stray get a new motion, and pairs that have one are found again.
class NearFeatures {
 public:
  /// @param mesh  must outlive this
  explicit NearFeatures(const TriangleMesh& mesh);

  /// How far a vertex may stray along each axis [m]: a part of the length of the edges at these positions. O(1).
  double margin_at(std::span<const Vec3> positions) const;

  /// Takes a motion, placed with the margin. All vertices count as strayed, until set_pairs().
  void set_motion(double margin, const SweptSurface& motion);
  void clear() { is_set_ = false; }
  bool is_set() const { return is_set_; }
  double margin() const { return margin_; }

  /// Finds the vertices that stray in a step. O(n), parallel. False: they are too many to be of use, about a quarter.
  bool find_strayed(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1);
  std::int64_t strayed_count() const { return std::ssize(strayed_); }

  /// Lets those that stray in this step move as they do in it. False, and of no use any more: one of them leaves the
  /// range of the box units.
  bool take_strayed(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1);

  /// The motion that vertices may stray from, and its boxes.
  const SweptSurface& motion() const { return motion_; }

  /// Not 0: a vertex that has strayed, a triangle with such vertices; per node the children with such triangles. Until
  /// set_pairs().
  std::span<const std::uint8_t> strayed_vertices() const { return is_strayed_; }
  std::span<const std::uint8_t> strayed_triangles() const { return is_triangle_strayed_; }
  std::span<const std::uint8_t> mark_nodes(std::span<const BvhNode> nodes);

  /// Takes the pairs with strayed vertices that come near, and forgets those of before.
  void set_pairs(std::span<const ContinuousResult> results);

  std::span<const FeaturePair> vertex_face() const { return vertex_face_; }
  std::span<const FeaturePair> edge_edge() const { return edge_edge_; }
  /// Those of all pairs.
  std::span<const Index> vertices() const { return vertices_; }

 private:
  bool strays(Index vertex, std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1) const;

  const TriangleMesh& mesh_;
  bool is_set_ = false;
  double margin_ = 0;
  SweptSurface motion_;
  std::vector<Index> strayed_, strayed_triangles_;
  std::vector<std::uint8_t> is_strayed_, is_triangle_strayed_, node_masks_, is_listed_;
  std::vector<FeaturePair> vertex_face_, edge_edge_;
  std::vector<Index> vertices_;
};

}  // namespace selvage
