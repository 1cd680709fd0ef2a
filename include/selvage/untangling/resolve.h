#pragma once

#include "selvage/mesh/simplex_mesh.h"

#include <functional>
#include <limits>

namespace selvage {

/// Tangles of a mesh before an iteration.
struct ResolveIteration {
  int iteration = 0;
  std::int64_t triangle_pairs = 0;  ///< of the boundary that meet (SelfCollisionFinder)
  /// Points inside an element that is not theirs: boundary and inner vertices, boundary edges by the middle of the part
  /// that is inside, centroids of elements.
  std::int64_t penetrating_vertices = 0, penetrating_edges = 0, penetrating_centroids = 0;
  std::int64_t blocked_points = 0;  ///< pairs of a point and an element that have no way out
  /// Such pairs at inverted elements: not counted above, for a point has no way out there.
  std::int64_t waiting_points = 0;
  std::int64_t inverted_elements = 0;
  double deepest = 0;               ///< longest way out [m]
  double total_depth = 0;           ///< sum over all points of their ways out [m]
  std::int64_t awake_vertices = 0;  ///< that may move
  double max_displacement = 0;      ///< of a vertex from where it was in the input [m]

  bool is_clean() const {
    return triangle_pairs + penetrating_vertices + penetrating_edges + penetrating_centroids + blocked_points +
               inverted_elements ==
           0;
  }
};

struct ResolveOptions {
  std::vector<Vec3> rest_positions{};  ///< (n_vertices) shape without stress [m]; empty: the input
  /// Use `rest_positions` near the tangle alone, with the surroundings in their places; elsewhere the input is without
  /// stress, and so the mesh keeps its pose as far as nothing meets. False: the whole mesh is drawn towards the rest.
  bool keep_pose = false;
  std::vector<Index> pinned{};                                        ///< vertices that must stay where they are
  double max_displacement = std::numeric_limits<double>::infinity();  ///< of each vertex, in all [m]
  /// How close surfaces that met may come again once all is out, as a part of the boundary's mean edge length at rest.
  double clearance = 0.05;
  int max_iterations = 2000;
  int patience = 60;  ///< iterations without progress after which the mesh counts as stuck
  std::function<void(const ResolveIteration&)> on_iteration{};
};

enum class ResolveOutcome : std::uint8_t {
  kResolved,  ///< nothing meets, nothing penetrates, no element is inverted
  kStuck,     ///< no progress for ResolveOptions::patience iterations
  kGaveUp,    ///< ResolveOptions::max_iterations did not suffice
  kHeld,      ///< impossible: pinned elements collide or are inverted; nothing was moved
};

struct ResolveReport {
  ResolveOutcome outcome = ResolveOutcome::kResolved;
  std::vector<ResolveIteration> iterations;  ///< from the input, which is iteration 0, to the result
  /// Unless resolved: elements that collide or are inverted; for kHeld, those that pinned vertices keep so. Ascending.
  std::vector<Index> tangled_elements;
  std::vector<Index> holding_vertices;  ///< pinned vertices of these elements and of their contacts; ascending
  std::int64_t moved_vertices = 0;
  double max_displacement = 0, mean_displacement = 0;  ///< over all vertices [m]
  double volume_before = 0, volume_after = 0;          ///< of all elements, inverted ones negative [m^3]
  double volume_at_rest = 0;                           ///< of `rest_positions`, or of the input [m^3]
  /// Against the shape that is taken to be without stress. Neo-Hookean, of Poisson's ratio 0.45 and a Young's modulus
  /// of 1 Pa [J].
  double elastic_energy_before = 0, elastic_energy_after = 0;
};

/// Moves a tangled mesh, at rest, to a state without self-collision.
///
/// Every vertex, edge and centroid that is inside an element takes the shortest path to the boundary while an elastic
/// material keeps the shape (SPB section 5.2: no CCD, all points). All contacts of one crossing push to one side.
/// Elements that this inverts are restored at once. Then the material relaxes as far as no collision comes back. There
/// are no velocities: each iteration starts from where vertices are. Only vertices near a tangle move; where they have
/// moved, the next iteration moves their neighbours too. All others, and so every vertex of a mesh that is not tangled,
/// keep their positions bit for bit. The same bits for any number of threads.
///
/// @param mesh       topology, all objects in one
/// @param positions  (n_vertices x 3) [m]; moved, also where the mesh is not resolved
/// @throws Error     when sizes differ, a position is not finite, an element is not positive at rest, or an option is
///                   impossible; it names which
///
/// Source: Chen, Diaz, Yuksel 2023 (SPB), section 5.2; for inverted elements Garanzha et al. 2021, Foldover-free maps.
///
/// Example, built and run by the tests:
/// @include resolve_collisions.cpp
ResolveReport resolve_collisions(const TetMesh& mesh, std::vector<Vec3>& positions, const ResolveOptions& options = {});

}  // namespace selvage
