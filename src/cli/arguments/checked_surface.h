#pragma once

#include "cli/program/console.h"
#include "selvage/io/mesh_file.h"
#include "selvage/mesh/triangle_mesh.h"

#include <string>

namespace selvage::cli {

/// A surface to check, read from a file: its own triangles, or the boundary of a tetrahedral mesh.
struct CheckedSurface {
  std::string file;
  bool is_solid = false;              ///< the boundary of a tetrahedral mesh
  std::vector<Vec3> positions;        ///< [m]
  std::vector<Vec3> end_positions{};  ///< at the end of a step, where there is one
  TriangleMesh surface{};

  std::vector<Index> numbers{};  ///< of each triangle: in the file; empty: the same
  std::vector<Index> faces{};    ///< of each triangle: the file's face; empty: the file has triangles only
  std::vector<Index> groups{};   ///< of each triangle: the file's group; empty: it has none

  bool is_welded = false;
  bool shares_nothing = false;  ///< no two triangles have a vertex in common, but most have some in the same place

  Index number_of(Index triangle) const { return numbers.empty() ? triangle : numbers[triangle]; }
  /// The face of the file that a triangle is a part of.
  Index face_of(Index triangle) const { return faces.empty() ? number_of(triangle) : faces[triangle]; }
};

/// Reads a surface.
///
/// @param end   the same mesh in another pose; empty: none
/// @param weld  join vertices that are in one place, at the end too
/// @param watch gets the times of reading and of the topology
/// @throws Error  as read_mesh(); when the two poses are of different meshes; when a solid is to be welded
CheckedSurface read_checked_surface(const std::string& file, const std::string& end, bool weld, Stopwatch& watch);

/// Groups of the triangles of a surface, see PairFilters.
///
/// @param how     `pieces`: connected pieces; `names`: groups of the file; else a file with a whole number a line for
///                each face of the mesh, -1: in no group
/// @throws Error  when the mesh has no groups, the file cannot be read, or does not fit the mesh
std::vector<Index> read_groups(const std::string& how, const CheckedSurface& surface);

}  // namespace selvage::cli
