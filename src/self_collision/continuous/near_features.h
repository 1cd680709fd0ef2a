#pragma once

#include "self_collision/continuous/marked_vertices.h"
#include "self_collision/surface/continuous_input.h"
#include "self_collision/surface/swept_surface.h"
#include "selvage/mesh/triangle_mesh.h"

namespace selvage {

/// The pairs of features that come near one another during a motion, kept from step to step. The motion is straight and
/// lasts for some steps. While no vertex strays from it by more than a margin, at either end of a step, no others can
/// meet: each way is straight, so that it strays no farther in between. Vertices that stray get a new motion, and pairs
/// that have one are found again.
class NearFeatures {
 public:
  /// @param mesh  must outlive this
  explicit NearFeatures(const TriangleMesh& mesh);

  /// How far a vertex may stray along each axis [m]: a part of the length of the edges at these positions. O(1).
  double margin_at(std::span<const Vec3> positions) const;

  /// For how many steps like this one a motion may last: by how long the last ones did, and not so long that boxes
  /// around it grow by more than elements. 1 where vertices do not move as they did in the last step. 0: it will not
  /// serve the step after this one. O(1).
  int choose_steps(double margin, std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1,
                   const SweptSurface& last) const;
  /// Whether most vertices move so little that none would stray for many steps. O(1).
  bool nearly_rests(double margin, std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1) const;
  /// Lets the next motions last for fewer steps.
  void shorten() { steps_wanted_ = std::max(1, steps_wanted_ / 2); }

  /// Takes a motion over some steps, placed with the margin. All vertices count as strayed, until set_pairs().
  void set_motion(double margin, int steps, const SweptSurface& motion);
  void clear();
  bool is_set() const { return is_set_; }
  double margin() const { return margin_; }

  /// Finds the vertices that stray in a step. O(n), parallel. False: they are too many to be of use, about a quarter.
  bool find_strayed(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1);
  std::span<const Index> strayed() const { return strayed_; }
  /// Whether so many have strayed since the motion was set that listing all pairs anew costs no more.
  bool is_worn() const;
  /// Whether the list has cost less than the searches that it served would have.
  bool has_paid(std::int64_t searches) const;

  /// Lets those that stray in this step move on as they do in it. False, and of no use any more: one of them leaves the
  /// range of the box units.
  bool take_strayed(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1);

  /// The motion that vertices may stray from, and its boxes.
  const SweptSurface& motion() const { return motion_; }

  /// Those taken, until set_pairs().
  MarkedVertices& taken() { return taken_; }

  /// Takes the pairs with strayed vertices that come near, and forgets those of before.
  void set_pairs(std::span<const ContinuousResult> results);

  std::span<const FeaturePair> vertex_face() const { return vertex_face_; }
  std::span<const FeaturePair> edge_edge() const { return edge_edge_; }
  /// Those of all pairs.
  std::span<const Index> vertices() const { return vertices_; }

 private:
  Vec3 place_of(Index vertex, int step) const;
  bool strays(Index vertex, const Vec3& position_t0, const Vec3& position_t1) const;
  void find_step(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1);

  const TriangleMesh& mesh_;
  bool is_set_ = false;
  double margin_ = 0;
  int steps_ = 1;                 ///< that the motion lasts for
  int step_ = 0;                  ///< of these, the one in which positions are
  int steps_wanted_ = 8;          ///< that the next motion is to last for
  std::int64_t strayed_sum_ = 0;  ///< since the motion was set
  SweptSurface motion_;
  std::vector<Index> strayed_;
  MarkedVertices taken_;
  std::vector<std::array<Vec3, 2>> strayed_ends_;
  std::vector<std::uint8_t> is_listed_;
  std::vector<FeaturePair> vertex_face_, edge_edge_;
  std::vector<Index> vertices_;
};

/// Where points come to that move on for some steps as they do in one.
void move_on(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1, int steps,
             std::vector<Vec3>& positions);

}  // namespace selvage
