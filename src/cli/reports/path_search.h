#pragma once

#include "cli/arguments/points_file.h"
#include "cli/program/console.h"
#include "cli/reports/path_table.h"

#include <optional>

namespace selvage::cli {

/// The questions put to a mesh.
struct SearchRequest {
  std::optional<std::string> points_file;  ///< without it, the penetrating vertices
  PathOptions options;
  bool count = false;  ///< fill the rows' counters
  bool quiet = false;  ///< show no progress
};

/// The answers, and what belongs to the mesh that they are for.
struct SearchResult {
  PathTable table;
  MeshDefects defects;
  std::int64_t element_count = 0;
  std::vector<VertexTuple<3>> surface;  ///< boundary triangles; in the plane, all triangles
  std::vector<VertexTuple<2>> outline;  ///< boundary edges in the plane
};

/// Finds the shortest paths in a mesh in space (D = 3) or in the plane (D = 2); `watch` gets the phases' times.
/// @throws Error  for a mesh or a points file that is not legal
template <int D>
SearchResult search_paths(const IndexedMesh& file, const SearchRequest& request, Stopwatch& watch);

extern template SearchResult search_paths<2>(const IndexedMesh&, const SearchRequest&, Stopwatch&);
extern template SearchResult search_paths<3>(const IndexedMesh&, const SearchRequest&, Stopwatch&);

}  // namespace selvage::cli
