#pragma once

#include "core/parallel.h"
#include "core/unset_vector.h"
#include "self_collision/surface/continuous_input.h"
#include "selvage/core/error.h"
#include "selvage/mesh/triangle_mesh.h"

#include <fmt/format.h>

namespace selvage {

/// Makes the first triangle of every vertex and every edge its representative.
inline UnsetVector<MovingTriangle> assign_representatives(const TriangleMesh& mesh) {
  UnsetVector<MovingTriangle> triangles(mesh.triangle_count());
  parallel_for(mesh.triangle_count(), kGrain, [&](std::int64_t t) {
    MovingTriangle& triangle = triangles[t];
    triangle = {mesh.triangles()[t], 0};
    for (int i = 0; i < 3; ++i) {
      triangle.represented |= (mesh.vertex_triangles(triangle.vertices[i]).front() == t) << i;
      const HalfFace across = mesh.neighbours()[t][i];
      const bool is_first =
          across.exists() ? t < across.element() : mesh.edge_triangles(mesh.triangle_edges()[t][i]).front() == t;
      triangle.represented |= is_first << (3 + i);
    }
  });
  return triangles;
}

inline void check_index(const char* what, Index i, Index count) {
  if (i < 0 || i >= count)
    throw Error(fmt::format("{} {}", what, i), "is out of range", fmt::format("give one in [0, {})", count));
}

inline void check_pairs(const TriangleMesh& mesh, std::span<const VertexFacePair> pairs) {
  for (const VertexFacePair& pair : pairs) {
    check_index("vertex", pair.vertex, mesh.vertex_count());
    check_index("face", pair.face, mesh.triangle_count());
  }
}

inline void check_pairs(const TriangleMesh& mesh, std::span<const EdgeEdgePair> pairs) {
  for (const EdgeEdgePair& pair : pairs) {
    check_index("edge", pair.first, mesh.edge_count());
    check_index("edge", pair.second, mesh.edge_count());
  }
}

}  // namespace selvage
