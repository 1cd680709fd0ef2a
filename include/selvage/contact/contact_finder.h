#pragma once

#include "selvage/boundary_path/boundary_path.h"
#include "selvage/contact/contact.h"
#include "selvage/self_collision/continuous_collision.h"

#include <functional>
#include <memory>

namespace selvage {

/// Counts of the search for penetrating vertices and edges. The same for any number of threads.
struct PenetrationCounters {
  std::int64_t features = 0;         ///< boundary vertices and edges asked about
  std::int64_t searched = 0;         ///< those near a crossing of the boundary with itself, which were located
  std::int64_t elements_tested = 0;  ///< elements compared with an edge
  std::int64_t crossings = 0;        ///< pairs of boundary faces that meet

  PenetrationCounters& operator+=(const PenetrationCounters& other);
};

/// Counts and times of one step's detection, from begin_step() to the end of find_contacts(). All but the seconds are
/// the same for any number of threads.
struct ContactStatistics {
  std::array<std::int64_t, kContactKinds> contacts{};  ///< by ContactKind

  /// At the start of the step, for kHybrid; all others are free.
  std::int64_t penetrating_vertices = 0;
  std::int64_t penetrating_edges = 0;
  /// Likewise: vertices where bodies penetrate, which find_impacts() leaves to contacts. Without any, all is guarded.
  std::int64_t unguarded_vertices = 0;

  /// Penetrating vertices and edges that have no turn in this step: ContactOptions::take_turns.
  std::int64_t off_turn = 0;

  std::int64_t waiting_points = 0;  ///< pairs of a point and an element, left out by ContactOptions::wait_for_inverted,
                                    ///< or choose_ways_off()
  std::int64_t path_queries = 0;    ///< pairs of a point and an element that were asked for a way out
  std::int64_t blocked_paths = 0;   ///< those without one
  std::int64_t pose_updates = 0;    ///< refits of the hierarchies over all elements and faces
  PathCounters paths;
  PenetrationCounters penetrations;
  ContinuousCounters continuous;

  double seconds_split = 0;  ///< [s] of DCD at the start of the step
  double seconds_dcd = 0;    ///< [s] of DCD at its end
  double seconds_refit = 0;  ///< [s] of pose updates
  double seconds_paths = 0;  ///< [s] of shortest paths
  double seconds_ccd = 0;    ///< [s] of CCD with times of impact
};

/// Pairs that meet on the straight way from the start of a step to its end.
struct StepImpacts {
  ContinuousPairs pairs;
  std::vector<double> face_times, edge_times;  ///< of the pairs: see ContinuousCollisionFinder::find_impact_times()
};

/// Cloth among the bodies of a ContactFinder.
struct ContactCloth {
  std::span<const VertexTuple<3>> triangles{};  ///< on vertices of the mesh that no element has
  /// (n_vertices) half of the thickness at each, 0 where there is no cloth; empty: none [m]. Contacts hold what is near
  /// to cloth off by it, and by twice of it cloth from cloth. What is as near at rest is left alone.
  std::span<const double> thickness{};
};

/// How a connected piece of the mesh that colliders stand deep in gets off them: as a whole, in one direction.
struct PieceWayOff {
  Index vertex;    ///< one of the piece's
  Vec3 direction;  ///< unit
  double way;      ///< the longest of a collider's point out of the piece, the other way [m]
};

/// Contacts of a tetrahedral mesh with itself during a step: of its objects with one another and each with itself; and
/// those of its faces, edges and elements with the vertices and edges of colliders.
///
/// Colliders are surfaces that move as their positions say, whatever meets them; they do not meet one another. Their
/// vertices follow those of the mesh in all positions. What is found: their vertices and edges inside elements, their
/// vertices that run into faces, and their edges that run into edges. A vertex of the mesh that runs into a face of an
/// collider is not: keep it out by the shape that the surface stands for.
///
/// Cloth has no inside. Its vertices and edges are found inside elements, and all that it runs into by CCD, from both
/// of its sides.
///
/// A step is begin_step() with the positions that it starts from, then find_contacts() with those that the solver of
/// the material proposes. Any sequence of positions is legal, tangled and inverted meshes too.
/// A point is not compared with elements that share a vertex with it: neighbours that touch are no contact.
///
/// Source: Chen, Diaz, Yuksel 2023 (SPB), section 4 and supplement, algorithm 5. Beyond it, in kHybrid with shortest
/// paths: where the ways out of a tangle of two connected pieces disagree, as where a rod runs right through another,
/// they would pull to both sides for ever. All its points then leave straight in one direction, in that one of some
/// directions in which the pieces part soonest.
///
/// Example, built and run by the tests:
/// @include contact_finder.cpp
class ContactFinder {
 public:
  /// @param mesh            topology, all objects in one; must outlive the finder
  /// @param rest_positions  (n_vertices x 3) for ClosestPointRule::kRestPose; may be empty with the other rules [m]
  /// @param positions       (n_vertices + n_collider_vertices) where the first step starts [m]; so for each step
  /// @param vertex_objects  (n_vertices) number of the object that each vertex belongs to, for
  ///                        ClosestPointRule::kEuclidean; empty: connected components
  /// @param colliders       triangles of colliders, outward, on vertices from n_vertices on
  /// @param cloth           with a thickness it needs rest positions
  /// @throws Error          when sizes differ, a position is not finite, the rule lacks what it needs, a collider has a
  ///                        vertex of the mesh, or cloth one of an element
  ContactFinder(const TetMesh& mesh, std::span<const Vec3> rest_positions, std::span<const Vec3> positions,
                std::span<const Index> vertex_objects = {}, ContactOptions options = {},
                std::span<const VertexTuple<3>> colliders = {}, ContactCloth cloth = {});
  ContactFinder(const TetMesh&& mesh, std::span<const Vec3> rest_positions, std::span<const Vec3> positions,
                std::span<const Index> vertex_objects = {}, ContactOptions options = {},
                std::span<const VertexTuple<3>> colliders = {}, ContactCloth cloth = {}) = delete;
  ~ContactFinder();
  ContactFinder(ContactFinder&&) noexcept;
  ContactFinder& operator=(ContactFinder&&) noexcept;

  /// Start of a step: splits boundary vertices and edges into penetrating and free ones.
  /// @param step    its number: whose turn it is by ContactOptions::take_turns. By DCD alone, where points inside their
  ///                own connected piece are joined by vertices and a vertex is among them, the edges among them have no
  ///                contacts in the last 8 of 64 steps: contacts of edges and of vertices may hold a fold for ever
  /// @throws Error  when the size differs or a position is not finite; so does find_contacts()
  void begin_step(std::span<const Vec3> positions_t0, std::int64_t step = 0);

  /// To be called, if at all, between begin_step() and find_contacts().
  /// Chooses for each connected piece of the mesh in which colliders stand deeper than a quarter of an edge, in
  /// whatever direction, the one in which it gets off them soonest, of some thirty and of those that are not blocked.
  /// In the rest of the step the contacts of the colliders' points in the piece lead straight that way; points in
  /// elements that are pressed flat have none, as these would be pressed on. For kHybrid with shortest paths and rest
  /// positions; else there are none. O(elements) where there are any, and some thousand elements for each point inside.
  /// @param is_blocked  by a vertex of the piece and the way by which the piece would move [m]
  /// @throws Error      before the first begin_step()
  std::vector<PieceWayOff> choose_ways_off(const std::function<bool(Index, const Vec3&)>& is_blocked);

  /// To be called, if at all, between begin_step() and choose_ways_off(), where that may be called.
  /// In the rest of the step a connected piece of the mesh and connected parts of colliders' surfaces do not meet: no
  /// contact and no impact is between them. O(vertices), and O(pieces let in) for each point inside.
  /// @param of_piece      a vertex of the piece
  /// @param of_colliders  vertices of colliders
  /// @throws Error        before the first begin_step(); when a vertex is not of the mesh, or not of a collider
  void let_in(Index of_piece, std::span<const Index> of_colliders);

  /// Contacts of the step that ends at the given positions, sorted by kind, then by what penetrates: for each point
  /// that is inside an element its way out; for each free vertex its first impact on a face; pairs of free edges that
  /// are the first impact of one of the two. After all of these what is near to thick cloth at the start of the step.
  /// Parallel; the same bits for any number of threads.
  /// @throws Error  also before the first begin_step()
  void find_contacts(std::span<const Vec3> positions_t1, std::vector<Contact>& contacts);

  /// All pairs of features that meet on the way to the given positions, for the modes with CCD; for kHybrid but where
  /// bodies penetrate at the start of the step (no vertex of the pair may be inside, or belong to an edge that is, or
  /// to a face that meets another), and of vertices of inverted elements none where ContactOptions::wait_for_inverted.
  /// With ContactOptions::guarantee vertices of inverted elements count as others do, and so do vertices of the mesh
  /// that run into faces of colliders.
  /// Exact; parallel; the same for any number of threads.
  /// @throws Error  as find_contacts()
  StepImpacts find_impacts(std::span<const Vec3> positions_t1);

  /// Appends contacts of the first impacts among those of find_impacts() with the same positions, in its order.
  void append_contacts(const StepImpacts& impacts, std::span<const Vec3> positions_t1, std::vector<Contact>& contacts);

  /// Of the last step.
  const ContactStatistics& statistics() const;

  /// The boundary's faces, then cloth, then the colliders' faces, and edges of all, by whose numbers contacts name
  /// them.
  const TriangleMesh& surface() const;

  /// Vertices and edges of the boundary and of colliders that are inside an element at the start of the step,
  /// ascending; for kHybrid.
  std::span<const Index> penetrating_vertices() const;
  std::span<const Index> penetrating_edges() const;

  /// For kHybrid, ascending: vertices where bodies penetrate at the start of the step, which find_impacts() leaves to
  /// contacts, and those of inverted elements where ContactOptions::wait_for_inverted.
  std::vector<Index> unguarded_vertices() const;

  /// For kHybrid, by the last find_contacts() of the step, ascending: vertices of folds, where a connected piece is
  /// inside itself, and no other piece with it, without two sides that one direction would part, as two arms that run
  /// through each other have. Ways out lead through its elements there, some of which may have to be inverted for a
  /// while.
  std::span<const Index> folded_vertices() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace selvage
