#pragma once

#include "cli/program/console.h"
#include "selvage/io/vtu.h"
#include "selvage/self_collision/continuous_collision.h"

#include <string>

namespace selvage::cli {

/// The collisions that `check` found on a surface, in one pose or during a step.
struct CollisionReport {
  std::string mesh, end_mesh, method;  ///< end_mesh is empty for one pose
  bool solid = false;                  ///< the surface is the boundary of a tetrahedral mesh
  std::vector<Vec3> positions;         ///< at the start
  TriangleMesh surface;

  std::vector<TrianglePair> pairs;  ///< in one pose
  bool has_segments = false;
  std::vector<CommonSegment> segments;  ///< of the pairs, where asked for
  SelfCollisionCounters counters;

  ContinuousPairs moving_pairs;  ///< during a step
  ContinuousCounters moving_counters;
  double free_step = 1;

  bool is_clean() const { return pairs.empty() && moving_pairs.empty(); }
};

/// The result as JSON (see the command's help).
std::string print_json(const CollisionReport& report, const Stopwatch& watch);

/// The surface with the number of each triangle's pairs.
VtkGrid mark_collisions(const CollisionReport& report);

/// A few lines for people.
void print_summary(const CollisionReport& report, const Stopwatch& watch);

}  // namespace selvage::cli
