#pragma once

#include "selvage/mesh/simplex_mesh.h"

namespace selvage {

/// Sets of vertices that are connected by elements, each named by its smallest vertex.
class VertexRegions {
 public:
  /// @param vertices  those in any region, in any order
  VertexRegions(const TetMesh& mesh, std::span<const Index> vertices);

  /// The name of the region of one of the vertices.
  Index find(Index vertex) {
    while (parents_[vertex] != vertex) vertex = parents_[vertex] = parents_[parents_[vertex]];
    return vertex;
  }

 private:
  void join(Index a, Index b);

  std::vector<Index> parents_;
};

}  // namespace selvage
