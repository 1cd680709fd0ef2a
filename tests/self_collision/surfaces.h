#pragma once

#include "selvage/mesh/triangle_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>

#include "random.h"

namespace selvage::surfaces {

using test::Random;

/// A surface in one pose.
struct Surface {
  std::vector<Vec3> positions;
  std::vector<VertexTuple<3>> triangles;

  TriangleMesh mesh() const { return TriangleMesh(static_cast<Index>(positions.size()), triangles); }
};

/// A kind of surface on which every property is tested; small: up to about a hundred triangles.
struct Family {
  std::string name;
  std::function<Surface(Random&)> make;
};

/// Crumpled, folded, rolled, torn, of several components, non-manifold, closed, on integer grids, ...
const std::vector<Family>& families();

/// (n x m cells) [0, n] x [0, m] in the plane z = 0, each cell cut in two along a random diagonal.
Surface sheet(Index n, Index m, Random& random);

/// Each coordinate moved by up to `amount`.
Surface jittered(Surface surface, double amount, Random& random);

Surface together(Surface a, const Surface& b);

/// Coordinates rounded to multiples of 2^-bits.
Surface snapped(Surface surface, int bits);

inline bool has_vertex(std::span<const Index> vertices, Index v) {
  return std::find(vertices.begin(), vertices.end(), v) != vertices.end();
}

/// Calls `visit(v, f)` for every vertex of a surface with every triangle that it is no vertex of.
template <typename Visit>
void visit_vertex_faces(const TriangleMesh& mesh, Visit&& visit) {
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    for (Index f = 0; f < mesh.triangle_count(); ++f)
      if (!mesh.vertex_triangles(v).empty() && !has_vertex(mesh.triangles()[f], v)) visit(v, f);
}

/// Calls `visit(e, f)` for every two edges e < f that share no vertex.
template <typename Visit>
void visit_edge_pairs(const TriangleMesh& mesh, Visit&& visit) {
  for (Index e = 0; e < mesh.edge_count(); ++e)
    for (Index f = e + 1; f < mesh.edge_count(); ++f) {
      const auto& other = mesh.edges()[f];
      if (!has_vertex(mesh.edges()[e], other[0]) && !has_vertex(mesh.edges()[e], other[1])) visit(e, f);
    }
}

/// The largest thickness of some vertices; 0 where there is no thickness.
inline double thickest(const std::vector<double>& thickness, std::span<const Index> vertices) {
  double largest = 0;
  if (!thickness.empty())
    for (const Index v : vertices) largest = std::max(largest, thickness[v]);
  return largest;
}

/// For INSTANTIATE_TEST_SUITE_P.
inline std::string name_of(const testing::TestParamInfo<Family>& family) {
  return family.param.name;
}

}  // namespace selvage::surfaces
