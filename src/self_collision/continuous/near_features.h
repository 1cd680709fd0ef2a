#pragma once

#include "self_collision/continuous/marked_vertices.h"
#include "self_collision/surface/continuous_input.h"
#include "self_collision/surface/swept_surface.h"
#include "selvage/mesh/triangle_mesh.h"

namespace selvage {

/// When a list of near features pays: by how dear a search is without.
struct ListPays {
  /// It has to serve so many searches, and no more than one vertex in so many may stray in each of them.
  std::int64_t min_searches = 4, max_strayed_rate = 64;
  /// Steps, half of those that wait for the next try after a list that has not.
  int first_wait = 16;
};

/// The pairs of features that come near one another during a motion, kept from step to step. The motion is straight and
/// lasts for some steps. While no vertex strays from it by more than a margin, at either end of a step, no others can
/// meet: each way is straight, so that it strays no farther in between. Vertices that stray get a new motion, and pairs
/// that have one are found again.
class NearFeatures {
 public:
  /// @param mesh  must outlive this
  explicit NearFeatures(const TriangleMesh& mesh, const ListPays& pays = {});

  /// How far a vertex may stray along each axis [m]: a part of the length of the edges at these positions. O(1).
  double margin_at(std::span<const Vec3> positions) const;

  /// For how many steps like this one a motion may last: by how long the last ones did, and not so long that boxes
  /// around it grow by more than elements. 1 where vertices do not move as they did in the last step. 0: it will not
  /// serve the step after this one. O(1).
  ///
  /// @param last_t0, last_t1  positions at both ends of the last step
  int choose_steps(double margin, std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1,
                   std::span<const Vec3> last_t0, std::span<const Vec3> last_t1) const;
  /// Whether most vertices move so little that none would stray for many steps. O(1).
  bool nearly_rests(double margin, std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1) const;
  /// Lets the next motions last for fewer steps.
  void shorten() { steps_wanted_ = std::max(1, steps_wanted_ / 2); }

  /// Takes a motion over some steps, placed with the margin. All vertices count as strayed, until set_pairs().
  void set_motion(double margin, int steps, const SweptSurface& motion);
  void clear();
  bool is_set() const { return is_set_; }

  /// Counts a search by the list.
  void count_use() { ++uses_; }
  /// Ends the list, and counts whether it has paid.
  void end();
  /// Counts one that cannot be made.
  void count_failure();
  /// Whether to list pairs in this step. Where lists do not pay, ever fewer steps try again.
  bool is_due();
  double margin() const { return margin_; }

  /// Finds the vertices that stray in a step. O(n), parallel. False: they are too many to be of use, about a quarter.
  bool find_strayed(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1);
  std::span<const Index> strayed() const { return strayed_; }
  /// Whether so many have strayed since the motion was set that listing all pairs anew costs no more.
  bool is_worn() const;

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
  bool has_paid() const;
  Vec3 place_of(Index vertex, int step) const;
  bool strays(Index vertex, const Vec3& position_t0, const Vec3& position_t1) const;
  void find_step(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1);

  const TriangleMesh& mesh_;
  ListPays pays_;
  bool is_set_ = false;
  double margin_ = 0;
  int steps_ = 1;                 ///< that the motion lasts for
  int step_ = 0;                  ///< of these, the one in which positions are
  int steps_wanted_ = 8;          ///< that the next motion is to last for
  std::int64_t strayed_sum_ = 0;  ///< since the motion was set
  std::int64_t uses_ = 0;         ///< since then
  int failures_ = 0, steps_without_ = 0;
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
