#pragma once

#include "selvage/core/types.h"
#include "selvage/elasticity/material.h"
#include "selvage/mesh/simplex_mesh.h"

#include <string>

namespace selvage {

/// One deformable body of a model: a range of its vertices and elements.
struct Body {
  std::string name;
  Index first_vertex = 0, vertex_count = 0;
  Index first_element = 0, element_count = 0;
  Material material;
  Vec3 initial_velocity = Vec3::Zero();  ///< [m/s]
};

/// Bodies with their materials: constant during a run.
struct Model {
  TetMesh mesh;                        ///< all bodies in one mesh
  std::vector<Vec3> rest_positions;    ///< (n_vertices) [m]: where no element is stressed
  std::vector<Body> bodies;            ///< in the order of their elements
  std::vector<double> inverse_masses;  ///< (n_vertices) [1/kg]; 0: pinned for ever, or without element
};

/// A model of the bodies: each vertex has a quarter of the mass of its elements.
///
/// @throws Error  when sizes differ, bodies do not cover the elements in order, a vertex of an element is not of the
///                element's body, a material is out of range, or an element is not positive at rest; it names which
Model make_model(TetMesh mesh, std::vector<Vec3> rest_positions, std::vector<Body> bodies);

/// Positions and velocities at a time: the contents of a checkpoint.
struct State {
  std::vector<Vec3> positions;   ///< (n_vertices) [m]
  std::vector<Vec3> velocities;  ///< (n_vertices) [m/s]
  double time = 0;               ///< [s]: steps * time_step
  std::int64_t steps = 0;        ///< done so far
  /// (n_bodies) for how long each body, with all that is near it, has hardly moved [s]; empty: none has. What is moved
  /// by hand between steps wakes where these are cleared, or where it gets a velocity: StepOptions::sleep_speed.
  std::vector<double> rest_times{};
};

/// Whether a position is finite, also in the single precision in which frames hold it.
bool is_in_range(const Vec3& position);

/// The model at time 0 in given positions, its bodies at their initial velocities.
/// @throws Error  when sizes differ or a position is not finite
State make_state(const Model& model, std::vector<Vec3> positions);

}  // namespace selvage
