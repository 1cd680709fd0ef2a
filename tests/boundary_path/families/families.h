#pragma once

#include "selvage/core/types.h"

#include <functional>
#include <string>
#include <vector>

#include "random.h"

namespace selvage::families {

/// Vertices and elements of one mesh.
template <int D>
struct Pieces {
  std::vector<Vec<D>> positions;
  std::vector<VertexTuple<D + 1>> elements;
};

/// A mesh on which the properties of boundary paths are tested, by name.
template <int D>
struct Family {
  std::string name;
  Pieces<D> mesh;
  bool is_exact = false;  ///< small integer coordinates times a power of two: rays run exactly through vertices
};

/// Every planar mesh. Small: 1 to about 1000 elements.
const std::vector<Family<2>>& planar_families();

/// Every solid mesh.
const std::vector<Family<3>>& solid_families();

template <int D>
const std::vector<Family<D>>& all_families() {
  if constexpr (D == 2) {
    return planar_families();
  } else {
    return solid_families();
  }
}

using test::Random;

/// Grid of nx x ny unit squares, each cut in two; with `alternating` the diagonals form diamonds.
Pieces<2> grid(int nx, int ny, bool alternating = false);

/// Grid of nx x ny x nz unit cubes, each cut into six tetrahedra along its diagonal (Kuhn).
Pieces<3> grid(int nx, int ny, int nz);

/// Squares of a walk over the integer lattice, each joined to the one before by an edge only, so that a walk which
/// returns to a place lays a second sheet over it. Steps: E, W, N, S.
Pieces<2> walk(const std::string& steps);

/// The same with cubes, and steps U and D for up and down.
Pieces<3> cube_walk(const std::string& steps);

/// Unit squares (cubes) of an integer set, joined wherever they touch; `#` in row r, column c is the square at (c, r).
Pieces<2> squares(const std::vector<std::string>& rows);

/// The same with cubes at the given lowest corners.
Pieces<3> cubes(const std::vector<std::array<int, 3>>& corners);

/// Triangles around the origin: `count` of them over `turns` turns, in `rings` rings; closed: the last joins the first.
Pieces<2> fan(int count, double turns, bool closed, int rings = 1);

/// A walk of `count` steps over the lattice that never turns straight back.
std::string random_steps(int count, bool in_space, std::uint64_t seed);

/// Positive elements, each put on a random face of those before, with a random vertex or one that is there: they turn
/// by more than 2 pi around inner and boundary ridges, and close around ridges that stay on the boundary elsewhere.
/// With folds: also where elements that so become neighbours lie on one side of their common face.
template <int D>
Pieces<D> grown(int count, std::uint64_t seed, bool with_folds);

/// Prisms over a planar mesh, `layers` of the given height, each cut into three tetrahedra.
Pieces<3> extrude(const Pieces<2>& mesh, int layers, double height);

template <int D>
Pieces<D> moved(Pieces<D> mesh, const std::function<Vec<D>(const Vec<D>&)>& map) {
  for (auto& x : mesh.positions) x = map(x);
  return mesh;
}

template <int D>
Pieces<D> jittered(Pieces<D> mesh, double amount, std::uint64_t seed) {
  Random random(seed);
  for (auto& x : mesh.positions) {
    for (int k = 0; k < D; ++k) x[k] += random.within(-amount, amount);
  }
  return mesh;
}

template <int D>
Pieces<D> together(Pieces<D> a, const Pieces<D>& b) {
  const auto first = static_cast<Index>(a.positions.size());
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  for (auto e : b.elements) {
    for (auto& v : e) v += first;
    a.elements.push_back(e);
  }
  return a;
}

}  // namespace selvage::families
