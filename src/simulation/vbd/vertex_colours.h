#pragma once

#include "selvage/simulation/model.h"

namespace selvage {

/// Vertices by colour; no two of one colour are of one element, triangle of cloth or hinge over which cloth bends.
struct VertexColours {
  std::vector<Index> vertices;   ///< of elements or cloth; colour by colour, ascending in each
  std::vector<Index> first;      ///< (n_colours + 1) into `vertices`
  std::vector<Index> of_vertex;  ///< (n_vertices) kNone: of neither

  Index colour_count() const { return static_cast<Index>(first.size()) - 1; }
};

/// Greedy, vertices of most elements, triangles and hinges first. Deterministic.
VertexColours colour_vertices(const Model& model);

}  // namespace selvage
