#pragma once

#include "selvage/core/types.h"
#include "selvage/mesh/simplex_mesh.h"

#include <limits>
#include <string>

namespace selvage {

enum class MaterialKind : std::uint8_t {
  kMassSpring,  ///< a spring along each edge, and the volume of each element
  kNeoHookean,  ///< Macklin and Mueller 2021: a deviatoric and a hydrostatic constraint an element
};

/// What a body is made of.
///
/// Neo-Hookean: the energy per rest volume is mu/2 (|F|^2 - 3) + (lambda + mu)/2 (det F - 1 - mu / (lambda + mu))^2, up
/// to a constant, where lambda and mu follow from Young's modulus and Poisson's ratio; small strains are Hooke's law
/// with these. The energy of Macklin and Mueller 2021, split so that both constraints are satisfied at rest:
/// C_D = sqrt(|F|^2 + det(F)^2 - 4 det F) of compliance 1 / (mu V), C_H = det F - 1 of compliance 1 / (lambda V). An
/// element that is flat or inverted recovers; one that has shrunk to a line or a point may not.
struct Material {
  MaterialKind kind = MaterialKind::kNeoHookean;
  double density = 1000;         ///< [kg/m^3], positive
  double youngs_modulus = 1e5;   ///< Neo-Hookean [Pa], positive
  double poisson_ratio = 0.45;   ///< Neo-Hookean, in [0, 0.5)
  double edge_compliance = 0;    ///< mass-spring [m/N], 0: rigid
  double volume_compliance = 0;  ///< mass-spring [m^6/J], 0: incompressible
  /// Damping relative to stiffness [s]: what stretches at the rate of 1/s is damped as if it were stretched by so much
  /// (XPBD, equation 26). Acts on the constraints' own rates, so that rigid motion is free.
  double damping = 0;
};

/// One deformable body of a model: a range of its vertices and elements.
struct Body {
  std::string name;
  Index first_vertex = 0, vertex_count = 0;
  Index first_element = 0, element_count = 0;
  Material material;
  Vec3 initial_velocity = Vec3::Zero();  ///< [m/s]
};

/// What stays the same during a run.
struct Model {
  /// @cond
  TetMesh mesh;  ///< all bodies in one mesh
  /// @endcond
  std::vector<Vec3> rest_positions;     ///< (n_vertices) [m]: where no element is stressed
  std::vector<Body> bodies;             ///< in the order of their elements
  std::vector<double> inverse_masses;   ///< (n_vertices) [1/kg]; 0: pinned for ever, or without element
  std::vector<Vec3> external_forces{};  ///< (n_vertices) [N] besides gravity, or empty
};

/// A model of the bodies: each vertex has a quarter of the mass of its elements.
///
/// @throws Error  when sizes differ, bodies do not cover the elements in order, a vertex of an element is not of the
///                element's body, a material is out of range, or an element is not positive at rest; it names which
Model make_model(TetMesh mesh, std::vector<Vec3> rest_positions, std::vector<Body> bodies);

/// What changes during a run: what a checkpoint holds.
struct State {
  std::vector<Vec3> positions;   ///< (n_vertices) [m]
  std::vector<Vec3> velocities;  ///< (n_vertices) [m/s]
  double time = 0;               ///< [s]: steps * time_step
  std::int64_t steps = 0;        ///< done so far
};

/// Whether a position is finite, also in the single precision in which frames hold it.
inline bool is_in_range(const Vec3& position) {
  return (position.array().abs() <= std::numeric_limits<float>::max()).all();
}

/// The model at time 0 in given positions, its bodies at their initial velocities.
/// @throws Error  when sizes differ or a position is not finite
State make_state(const Model& model, std::vector<Vec3> positions);

}  // namespace selvage
