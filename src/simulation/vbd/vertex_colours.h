#pragma once

#include "selvage/mesh/simplex_mesh.h"

namespace selvage {

/// Vertices by colour; no two of one colour are of one element.
struct VertexColours {
  std::vector<Index> vertices;   ///< of elements; colour by colour, ascending in each
  std::vector<Index> first;      ///< (n_colours + 1) into `vertices`
  std::vector<Index> of_vertex;  ///< (n_vertices) kNone: of no element

  Index colour_count() const { return static_cast<Index>(first.size()) - 1; }
};

/// Greedy, vertices of most elements first. Deterministic.
VertexColours colour_vertices(const TetMesh& mesh);

}  // namespace selvage
