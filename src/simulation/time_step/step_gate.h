#pragma once

#include "selvage/contact/contact_finder.h"
#include "selvage/simulation/model.h"
#include "simulation/time_step/gate_zone.h"
#include "simulation/time_step/thin_kernel.h"

namespace selvage {

/// Counts of one step.
struct GateStatistics {
  std::int64_t rounds = 0;              ///< in which vertices were held back
  std::int64_t held_back_vertices = 0;  ///< that end the step elsewhere than the solver left them
  std::int64_t impacts_met = 0;         ///< pairs that met before anything was held back
  std::int64_t collapsing = 0;          ///< elements that were about to be inverted then
  std::int64_t impacts_left = 0;        ///< pairs that still meet when the last round is over
  std::int64_t entries_left = 0;        ///< vertices that were held back, and enter a collider all the same
  /// Of the first pair that is left, or the vertex that entered a collider; kNone after the last.
  std::array<Index, 4> left{kNone, kNone, kNone, kNone};
};

/// A vertex that has been held back together with another one; kNone: with a collider, or it stands.
struct ZoneLink {
  Index vertex, other;
};

/// Holds vertices back at the end of a step, so that nothing that was free at its start meets on the straight way to
/// its end, no element is inverted that was not, and no vertex that is moved for that enters a collider. Where a step
/// ends so by itself, nothing is changed.
///
/// Primitives that meet, and elements about to be inverted, form zones: those with a common vertex are in one. A zone
/// has a base motion: that of the handle that holds one of its vertices, or of the collider that one touches; else the
/// rigid motion that keeps the zone's momentum and angular momentum. The motion of its vertices relative to the base is
/// scaled down, more from round to round; under the base motion alone, which is affine, nothing in the zone can meet.
/// A key-framed collider carries a zone by the rigid motion nearest to that of its surface around; in the last rounds
/// each vertex by that of the place nearest to it. What several carriers with different motions touch is bent between
/// them.
/// A zone that started the step inside a collider comes out of it as a whole, unless that makes something meet.
/// Zones that meet others are merged. In later rounds the base motion is the shift alone that keeps the zone's
/// momentum, in the last ones none, or that of what carries the zone; the rounds end when nothing meets, or a round
/// changes nothing. They do end: zones only grow, and there are only so many.
///
/// Where a piece is folded into itself, ways out lead through its elements. While these are few against
/// ContactFinder::folded_vertices(), they may be inverted: held back, the fold would stay for ever.
///
/// Exact: what meets is decided by ContinuousCollisionFinder. Vertices that penetrate at the start of the step, or
/// belong to an inverted element, are left to contacts. The same bits for any number of threads.
///
/// Sources: Bridson, Fedkiw, Anderson 2002 (rigid impact zones); Harmon et al. 2008, Robust treatment of simultaneous
/// collisions (zones that slide).
class StepGate {
 public:
  /// @param model                 must outlive this
  /// @param contact_vertex_count  vertices of the model and, after them, of colliders: see TimeStep::contact_vertices()
  /// @param is_strict             where zones that move with what carries them meet all the same, they stand, too
  StepGate(const Model& model, Index contact_vertex_count, bool is_strict = false);

  /// Whether a body has no room, by the number of its vertices that are inside colliders. It goes through many rounds,
  /// and impacts, which take longest to find, are looked for only in those in which all else holds.
  bool is_crushed(std::int64_t vertices_in_colliders) const;

  /// Whether an element is about to be inverted, or something meets.
  /// @param impacts_known  nothing meets: that has been asked since the vertices were last moved
  bool is_violated(ContactFinder& finder, const Step& step, std::span<const StepVertex> vertices, bool impacts_known);

  /// Moves vertices until is_violated() no longer holds, after it held; but elements that are almost flat may lose a
  /// tenth of their volume where no motion of their zone spares them.
  /// @param is_crushed  is_crushed() of the vertices that started the step inside
  GateStatistics hold_back(ContactFinder& finder, const Step& step, const Carriers& carriers, bool is_crushed,
                           std::span<StepVertex> vertices);

  /// By the last is_violated() and hold_back(): what has moved together.
  std::span<const ZoneLink> links() const { return links_; }

  /// Likewise by how far a vertex has moved for its zone to leave a collider, which gives it no speed [m].
  const Vec3& way_out_of(Index vertex) const { return ways_out_[vertex]; }

 private:
  bool is_collapsing(Index element, int round, const Step& step, std::span<const StepVertex> vertices) const;
  void find_collapsing_elements(int round, const Step& step, std::span<const StepVertex> vertices);
  bool is_in_fold(Index element) const;
  void let_folds_invert(std::span<const Index> folded_vertices);
  void find_impacts(ContactFinder& finder, std::span<const StepVertex> vertices);
  void find_entries(const Step& step, const Carriers& carriers, std::span<const StepVertex> vertices);
  bool is_round_crushed() const;
  bool has_violations() const { return !impacts_.pairs.empty() || !collapsing_.empty() || !entries_.empty(); }
  void join_violations(const TriangleMesh& surface, const Step& step, const Carriers& carriers,
                       std::span<const StepVertex> positions);
  void touch(std::span<const Index> vertices, std::span<const double> weights, const Step& step,
             const Carriers& carriers, std::span<const StepVertex> positions);
  bool stop_drifting();
  bool stop_carried_zones(const TriangleMesh& surface);
  void report_left(const TriangleMesh& surface, GateStatistics& statistics) const;
  void join(std::span<const Index> vertices, double time);
  bool is_of_model(Index vertex) const { return vertex < model_.mesh.vertex_count(); }
  Index root_of(Index vertex);
  void scale_zones(int round);
  bool move_zones(int round, bool may_bend, const Step& step, const Carriers& carriers, std::span<StepVertex> vertices);

  const Model& model_;
  bool is_strict_;
  std::vector<double> rest_volumes_;    ///< of elements [m^3]
  std::vector<ThinBatch> batches_;      ///< all elements in their order
  std::vector<unsigned char> is_thin_;  ///< (n_batches)

  std::vector<Vec3> candidate_;  ///< (n_contact_vertices) end of the step as it stands
  StepImpacts impacts_;
  std::vector<Index> collapsing_;       ///< elements, ascending
  std::vector<Index> folded_;           ///< vertices of folds whose elements may be inverted in this step, ascending
  std::vector<ColliderEntry> entries_;  ///< of vertices that have been held back

  std::vector<Vec3> targets_;       ///< (n_vertices) end of the step as the solver left it
  std::vector<Index> parents_;      ///< (n_vertices) of the union-find over vertices in zones; kNone: in none
  std::vector<Index> entered_;      ///< (n_vertices) the carrier that a vertex was last found to enter; kNone: none
  std::vector<double> shares_;      ///< (n_vertices) of a root: the part of its zone's relative motion that is kept;
                                    ///< kDrifts, kStands: as ZoneBase; kStandsAlways: nothing carries it
  std::vector<double> times_;       ///< (n_vertices) of a root: the first impact in this round; 1: none
  std::vector<Vec3> ways_out_;      ///< (n_vertices) see way_out_of()
  std::vector<Index> members_;      ///< vertices in zones
  std::vector<ZoneTouch> touches_;  ///< of zones by what carries them
  bool is_any_torn_ = false;        ///< a zone has been bent in this step
  bool is_crushed_ = false;         ///< see hold_back()
  std::vector<ZoneLink> links_;
};

}  // namespace selvage
