#pragma once

#include "selvage/io/mesh_file.h"
#include "selvage/mesh/simplex_mesh.h"

#include <functional>
#include <string>

#include "random.h"

namespace selvage::solids {

using test::Random;

/// A solid in one pose.
struct Solid {
  std::vector<Vec3> positions;
  std::vector<VertexTuple<4>> elements;

  TetMesh mesh() const { return TetMesh(static_cast<Index>(positions.size()), elements); }
};

Solid of(const IndexedMesh& file);

/// Several as one mesh.
Solid together(const std::vector<Solid>& parts);

/// Box from a corner to the opposite one, in cells of about the given edge.
Solid box(const Vec3& lower, const Vec3& upper, double cell);

/// The tetrahedron of these corners.
Solid tetrahedron(const std::array<Vec3, 4>& corners);

/// A kind of solid on which every property is tested; small: up to a few hundred elements.
struct Family {
  std::string name;
  std::function<Solid(Random&)> make;
};

/// Apart, overlapping, tangled with themselves, inverted, on integer grids, ...
const std::vector<Family>& families();

/// How a pose goes over into the next, by name.
struct Motion {
  std::string name;
  std::function<void(std::vector<Vec3>&, Random&)> move;
};

/// None, little by little, far and together, around, in jumps, ...
const std::vector<Motion>& motions();

}  // namespace selvage::solids
