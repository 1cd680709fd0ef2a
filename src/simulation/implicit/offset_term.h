#pragma once

#include "selvage/contact/contact.h"

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
  double coefficient = 0;      ///< of friction
  Vec3 start = Vec3::Zero();   ///< u at the start of the step, moved along with a collider [m]
  double slip = 0;             ///< sliding at less is resisted by less than all of friction [m]
  double friction_force = 0;   ///< coefficient times normal force, both of the iteration before [N]

  bool is_spring() const { return length >= 0; }
  std::span<const Index> vertex_span() const { return {vertices.data(), static_cast<std::size_t>(count)}; }

  /// Where a vertex of the term stands in it.
  int place_of(Index vertex) const {
    int place = 0;
    while (vertices[place] != vertex) ++place;
    return place;
  }
  Vec3 offset(std::span<const Vec3> positions) const;
  double energy(const Vec3& u) const;
  Derivatives derivatives(const Vec3& u) const;

  /// Force along the normal [N].
  double normal_force(const Vec3& u) const;
  /// Takes over the normal force, for friction in the energies that follow.
  /// @param most  normal force taken over at most [N]
  void renew_friction(const Vec3& u, double most);

 private:
  Vec3 slide(const Vec3& u) const { return u - start - normal.dot(u - start) * normal; }
};

}  // namespace selvage
