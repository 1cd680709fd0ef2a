#pragma once

#include "elasticity/simplex_element.h"
#include "elasticity/triangles/bending.h"
#include "selvage/simulation/model.h"

namespace selvage {

/// A triangle of cloth, and its rest shape with the warp along the first axis.
struct ClothTriangle {
  VertexTuple<3> vertices;
  Index body;
  RestSimplex<2> rest;
};

/// Two triangles of one body with a common edge, over which cloth bends.
struct ClothHinge {
  VertexTuple<4> vertices;  ///< see HingePositions
  Index body;
  bool is_flat;             ///< at rest: then by `flat`, else by `bent`
  QuadraticBending flat{};  ///< also of a hinge that is not, as if it were
  HingeBending bent{};
};

std::vector<ClothTriangle> list_cloth_triangles(const Model& model);

/// (n_vertices) half of the thickness of cloth at each; empty where none is thick [m].
std::vector<double> half_thickness_of(const Model& model);

/// Of all edges between two triangles, but of bodies that do not resist bending. Where more than two triangles share
/// an edge, between each and the next.
std::vector<ClothHinge> list_cloth_hinges(const Model& model);

}  // namespace selvage
