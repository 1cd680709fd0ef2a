#pragma once

#include "cli/arguments/checked_surface.h"
#include "cli/program/console.h"
#include "selvage/self_collision/proximity.h"

#include <functional>
#include <optional>
#include <string>

namespace selvage::cli {

/// The questions put to a surface, or to two.
struct CollisionRequest {
  std::string method = "auto";
  double thickness = 0;  ///< 0: pairs that meet; else also those that are nearer [m]
  bool adjacent = false, segments = false;
  PairFilters filters{};
  std::function<void(std::string_view phase, double share)> on_progress{};
};

/// The collisions that `check` found on a surface or between two, in one pose or during a step.
///
/// Vertices, edges and triangles have numbers in `surface`: those of the second mesh follow those of the first.
struct CollisionReport {
  CheckedSurface first;                    ///< without a second mesh its vertices and triangles are moved to `surface`
  std::optional<CheckedSurface> second{};  ///< `--against`: then pairs have one part on each
  std::string end_file{};                  ///< `--to`; empty for one pose
  std::string method{};
  double thickness = 0;

  TriangleMesh surface{};
  std::vector<Vec3> positions{}, end_positions{};

  std::vector<TrianglePair> pairs{};  ///< in one pose
  bool has_segments = false;
  std::vector<CommonSegment> segments{};  ///< of the pairs, where asked for
  SelfCollisionCounters counters{};

  ContinuousPairs moving_pairs{};  ///< during a step, or nearer than the thickness in one pose
  NearPairs near{};                ///< in one pose, nearer than the thickness
  ContinuousCounters moving_counters{};
  double free_step = 1, separated_step = 1;

  bool moves() const { return !end_file.empty(); }
  bool is_clean() const { return pairs.empty() && moving_pairs.empty(); }
  /// Number of vertices and triangles of the first mesh.
  Index first_vertices() const { return surface.vertex_count() - (second ? second->surface.vertex_count() : 0); }
  Index first_triangles() const { return surface.triangle_count() - (second ? second->surface.triangle_count() : 0); }
  bool is_of_second_mesh(Index triangle) const { return second && triangle >= first_triangles(); }
  const CheckedSurface& mesh_of(Index triangle) const { return is_of_second_mesh(triangle) ? *second : first; }
  /// The number of a triangle, and that of its face, in its own file.
  Index number_in_file(Index triangle) const;
  Index face_in_file(Index triangle) const;
  Index vertex_in_file(Index vertex) const {
    return second && vertex >= first_vertices() ? vertex - first_vertices() : vertex;
  }
  /// Whether a file of the report has faces of more than three vertices.
  bool has_polygons() const { return !first.faces.empty() || (second && !second->faces.empty()); }
};

/// Finds all pairs; `watch` gets the phases' times.
/// @param end_file  of `first`, where that moves
/// @throws Error    for an option that does not fit
CollisionReport find_collisions(CheckedSurface first, std::optional<CheckedSurface> second, std::string end_file,
                                CollisionRequest request, Stopwatch& watch);

/// The result as JSON (see the command's help).
std::string print_json(const CollisionReport& report, const Stopwatch& watch);

/// A few lines for people.
void print_summary(const CollisionReport& report, const Stopwatch& watch);

}  // namespace selvage::cli
