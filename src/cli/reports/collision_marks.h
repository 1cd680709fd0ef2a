#pragma once

#include "cli/reports/collision_report.h"
#include "picture/drawing/image.h"
#include "selvage/io/coloured_ply.h"
#include "selvage/io/vtu.h"

namespace selvage::cli {

const char* contact_name(TriangleContact contact);

/// In how many pairs each triangle is; during a step and for distances, each vertex by itself or in an edge.
struct PairCounts {
  std::vector<std::int64_t> of_triangles, of_vertices;

  explicit PairCounts(const CollisionReport& report);
};

/// The corners of the box around all that collides, at the start of the step.
std::pair<Vec3, Vec3> place_of_collisions(const CollisionReport& report);

/// The surface with the number of each triangle's pairs; with the distance of each vertex to its nearest pair, up to
/// the thickness, where there is one; with the file's face of each triangle and the number of its mesh where these say
/// something.
VtkGrid mark_collisions(const CollisionReport& report);

/// The surface, its colours and which triangles they are for.
struct ColouredSurface {
  IndexedMesh mesh;
  std::vector<Colour8> vertices, triangles;
};

/// Vermilion: meets something; yellow: is nearer than the thickness; grey and light blue: the rest of the first and of
/// the second mesh.
ColouredSurface colour_collisions(const CollisionReport& report);

/// A picture in which what collides is vermilion, and shines through what hides it.
Image draw_collisions(const CollisionReport& report);

/// What mends a mesh whose triangles share no vertices; empty where they do.
std::string unshared_hint(const CollisionReport& report);

}  // namespace selvage::cli
