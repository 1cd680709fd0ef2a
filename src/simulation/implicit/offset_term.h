#pragma once

#include "selvage/contact/contact.h"

#include <algorithm>

namespace selvage {

/// An energy of one weighted sum of vertices, u = sum of weights[i] * x[vertices[i]] - origin: a spring, or a contact
/// with a body or a collider. Its gradient at vertex i is weights[i] times that by u, and the block of its Hessian for
/// vertices i and j is weights[i] * weights[j] times that by u.
struct OffsetTerm {
  static constexpr int kMaxVertices = Contact::kMaxVertices;

  /// Value and derivatives by u.
  struct Derivatives {
    Eigen::Vector3d gradient;
    /// Positive semi-definite. Of friction near rest the secant: at least the exact one, so that no step runs past
    /// rest.
    Eigen::Matrix3d hessian;
  };

  int count = 0;
  std::array<Index, kMaxVertices> vertices{};
  std::array<double, kMaxVertices> weights{};
  Vec3 origin = Vec3::Zero();  ///< [m]
  double stiffness = 0;        ///< [N/m]

  /// A spring: its length without force [m]; negative: a contact.
  double length = -1;

  // A contact.
  Vec3 normal = Vec3::Zero();  ///< unit
  double target = 0;           ///< where normal . u is to be at least [m]
  /// Depth below the target up to which stiffness grows from 0 to all of it, so that the energy is C2; 0: the energy is
  /// stiffness / 2 times the depth squared, which is C1 [m].
  double ramp = 0;
  double coefficient = 0;     ///< of friction
  Vec3 start = Vec3::Zero();  ///< u at the start of the step, moved along with a collider [m]
  double slip = 0;            ///< sliding at less is resisted by less than all of friction [m]
  double friction_force = 0;  ///< coefficient times normal force, both of the iteration before [N]

  bool is_spring() const { return length >= 0; }
  std::span<const Index> vertex_span() const { return {vertices.data(), static_cast<std::size_t>(count)}; }

  /// Where a vertex of the term stands in it.
  int place_of(Index vertex) const {
    int place = 0;
    while (vertices[place] != vertex) ++place;
    return place;
  }
  Vec3 offset(std::span<const Vec3> positions) const {
    Vec3 u = -origin;
    for (int i = 0; i < count; ++i) u += weights[i] * positions[vertices[i]];
    return u;
  }
  double energy(const Vec3& u) const;
  Derivatives derivatives(const Vec3& u) const;
  /// The first of them.
  Eigen::Vector3d gradient(const Vec3& u) const;

  /// How far a contact misses its target; 0 where it does not.
  double depth(const Vec3& u) const { return std::max(target - normal.dot(u), 0.0); }
  /// Of a contact by its depth, without friction.
  double energy_at(double depth) const;
  /// Along the normal [N]: the derivative of energy_at().
  double force_at(double depth) const;
  /// The derivative of force_at() [N/m].
  double stiffness_at(double depth) const;
  /// Takes over the normal force, for friction in the energies that follow.
  /// @param most  normal force taken over at most [N]
  void renew_friction(const Vec3& u, double most);

 private:
  /// Slips from which on friction does not depend on how far a point slides, for the Hessian.
  static constexpr double kClearlySliding = 10;

  Vec3 slide(const Vec3& u) const { return u - start - normal.dot(u - start) * normal; }
  /// Of friction by the slide, which near rest is not divided by it.
  double secant_at(double slips) const { return friction_force / slip * (slips < 1 ? 2 - slips : 1 / slips); }
  double spring_energy(const Vec3& u) const;
  Derivatives spring_derivatives(const Vec3& u) const;
};

// Inline, as a sweep of vertex block descent has nothing else to do at a contact. Friction: force f1(y) with y the
// slide by the slip, f1 = 2 y - y^2 up to 1, where it stays.

inline double OffsetTerm::energy_at(double depth) const {
  if (!(ramp > 0)) return stiffness / 2 * depth * depth;
  if (depth < ramp) return stiffness / 6 * depth * depth * depth / ramp;
  const double beyond = depth - ramp / 2;
  return stiffness * (beyond * beyond / 2 + ramp * ramp / 24);
}

inline double OffsetTerm::force_at(double depth) const {
  return stiffness * (depth < ramp ? depth * depth / (2 * ramp) : depth - ramp / 2);
}

inline double OffsetTerm::stiffness_at(double depth) const {
  return depth < ramp ? stiffness * depth / ramp : stiffness;
}

inline double OffsetTerm::energy(const Vec3& u) const {
  if (is_spring()) return spring_energy(u);
  double energy = energy_at(depth(u));
  if (friction_force > 0) {
    const double y = slide(u).norm() / slip;
    energy += friction_force * slip * (y < 1 ? y * y - y * y * y / 3 : y - 1.0 / 3);
  }
  return energy;
}

inline Eigen::Vector3d OffsetTerm::gradient(const Vec3& u) const {
  if (is_spring()) return spring_derivatives(u).gradient;
  Eigen::Vector3d result = Eigen::Vector3d::Zero();
  if (const double deep = depth(u); deep > 0) result = -force_at(deep) * normal;
  if (friction_force > 0) {
    const Vec3 across = slide(u);
    result += secant_at(across.norm() / slip) * across;
  }
  return result;
}

inline OffsetTerm::Derivatives OffsetTerm::derivatives(const Vec3& u) const {
  if (is_spring()) return spring_derivatives(u);
  Derivatives result{gradient(u), Eigen::Matrix3d::Zero()};
  if (const double deep = depth(u); deep > 0) result.hessian = stiffness_at(deep) * normal * normal.transpose();
  if (friction_force > 0) {
    const Vec3 across = slide(u);
    const double y = across.norm() / slip, secant = secant_at(y);
    result.hessian += secant * (Eigen::Matrix3d::Identity() - normal * normal.transpose());
    if (y > kClearlySliding) result.hessian -= secant / across.squaredNorm() * across * across.transpose();
  }
  return result;
}

}  // namespace selvage
