#pragma once

#include "cli/console.h"
#include "selvage/mesh/mesh_file.h"
#include "selvage/self_collision/self_collision.h"

#include <string>

namespace selvage::cli {

/// What `check` found on a surface.
struct CollisionReport {
  std::string mesh, method;
  bool solid = false;  ///< the surface is the boundary of a tetrahedral mesh
  std::vector<Vec3> positions;
  std::vector<VertexTuple<3>> triangles;
  std::vector<TrianglePair> pairs;
  SelfCollisionCounters counters;
};

/// The result as JSON (see the command's help).
std::string print_json(const CollisionReport& report, const Stopwatch& watch);

/// The surface with the number of each triangle's pairs.
VtkGrid mark_collisions(const CollisionReport& report);

/// A few lines for people.
void print_summary(const CollisionReport& report, const Stopwatch& watch);

}  // namespace selvage::cli
