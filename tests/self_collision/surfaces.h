#pragma once

#include "selvage/mesh/triangle_mesh.h"

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

}  // namespace selvage::surfaces
