#pragma once

#include "selvage/core/types.h"
#include "selvage/elasticity/cloth_material.h"
#include "selvage/elasticity/material.h"
#include "selvage/mesh/simplex_mesh.h"
#include "selvage/mesh/triangle_mesh.h"

#include <string>

namespace selvage {

/// One deformable body of a model: a range of its vertices, and of its elements or, for cloth, of its triangles.
struct Body {
  std::string name;
  Index first_vertex = 0, vertex_count = 0;
  Index first_element = 0, element_count = 0;
  Material material;
  Vec3 initial_velocity = Vec3::Zero();  ///< [m/s]
  Index first_triangle = 0, triangle_count = 0;
  ClothMaterial cloth{};  ///< in place of `material`, where it has triangles

  bool is_cloth() const { return triangle_count > 0; }
};

/// Bodies with their materials: constant during a run.
struct Model {
  TetMesh mesh;                        ///< all bodies of elements in one mesh, on the vertices of all
  std::vector<Vec3> rest_positions;    ///< (n_vertices) [m]: where no element is stressed
  std::vector<Body> bodies;            ///< in the order of their elements, and of their triangles
  std::vector<double> inverse_masses;  ///< (n_vertices) [1/kg]; 0: pinned for ever, or without element and triangle
  std::vector<VertexTuple<3>> triangles{};  ///< of all cloth
};

/// A model of the bodies: each vertex has a quarter of the mass of its elements, or a third of that of its triangles.
///
/// @param mesh       where all is cloth, TetMesh::without_elements()
/// @param triangles  of cloth
/// @throws Error  when sizes differ, bodies do not cover elements and triangles in order or a body has both, a vertex
///                is not of its element's or triangle's body, a material is out of range, an element is not positive at
///                rest, a triangle has no area there, or cloth is thicker than its triangles are long; it names which
Model make_model(TetMesh mesh, std::vector<Vec3> rest_positions, std::vector<Body> bodies,
                 std::vector<VertexTuple<3>> triangles = {});

/// All triangles that are seen and that collide: boundary faces of elements, then cloth.
std::vector<VertexTuple<3>> surface_triangles(const Model& model);
/// The same as a surface.
TriangleMesh surface_of(const Model& model);

/// (n_vertices) the body of each vertex; kNone: of none.
std::vector<Index> bodies_of_vertices(const Model& model);

/// Mean length at rest of the edges of a body's elements or triangles, each edge as often as it has one [m].
double mean_edge_of(const Model& model, const Body& body);

/// Positions and velocities at a time: the contents of a checkpoint.
struct State {
  std::vector<Vec3> positions;   ///< (n_vertices) [m]
  std::vector<Vec3> velocities;  ///< (n_vertices) [m/s]
  double time = 0;               ///< [s]: steps * time_step
  std::int64_t steps = 0;        ///< done so far
  /// (n_bodies) for how long each body, with all that is near it, has hardly moved [s]; empty: none has. What is moved
  /// by hand between steps wakes where these are cleared, or where it gets a velocity: StepOptions::sleep_speed. Below
  /// 0: for how much longer a body that was in another, or in a collider, is damped.
  std::vector<double> rest_times{};
};

/// Whether a position is finite, also in the single precision in which frames hold it.
bool is_in_range(const Vec3& position);

/// The model at time 0 in given positions, its bodies at their initial velocities.
/// @throws Error  when sizes differ or a position is not finite
State make_state(const Model& model, std::vector<Vec3> positions);

}  // namespace selvage
