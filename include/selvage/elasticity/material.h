#pragma once

#include <cstdint>
#include <string_view>

namespace selvage {

enum class MaterialKind : std::uint8_t {
  kMassSpring,  ///< a spring along each edge, and the volume of each element
  kNeoHookean,  ///< Macklin and Mueller 2021: a deviatoric and a hydrostatic constraint an element
};

/// The material of a body.
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
  /// Damping relative to stiffness [s]: stretching at a rate r is resisted like a stretch of damping * r (XPBD,
  /// equation 26), in XPBD of three time steps at most. Acts on the rates of the constraints, so that rigid motion is
  /// not damped.
  double damping = 0;
};

/// Lame's parameters of an isotropic material [Pa].
struct LameParameters {
  double mu;      ///< shear modulus
  double lambda;  ///< first parameter
};

/// Lame's parameters of a Young's modulus [Pa] and a Poisson's ratio below 0.5.
LameParameters lame_parameters(double youngs_modulus, double poisson_ratio);

/// @throws Error  when a number of the material is out of its range or not finite; it names `where` and the number
void check_material(std::string_view where, const Material& material);

}  // namespace selvage
