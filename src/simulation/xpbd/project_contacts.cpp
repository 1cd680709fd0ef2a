#include "simulation/xpbd/project_contacts.h"

#include "contact/input/contact_weights.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace selvage {

namespace {

/// Farthest that a vertex moves to close a gap of 1. A contact without held vertices, and without vertices on both
/// sides, stays below: of weights that sum to 1, the largest is at most (1 + sqrt 3) / 2 times the sum of their
/// squares.
constexpr double kMaxMove = 1.37;

/// The vertices of both sides of a contact. Those of one side all count by the mean of their masses, weighed as in the
/// contact. By their own, a light vertex among heavy ones would be thrown many times as far as the contact is deep, and
/// its elements would be inverted. By the mean, no vertex moves much farther than the contact is deep, and momentum is
/// kept all the same.
///
/// Where vertices move the point by little, since the others on its side are held or since the point and the surface
/// have them in common, the contact is not closed completely.
class ContactSides {
 public:
  ContactSides(const Contact& contact, const ColliderSupports& supports, std::span<StepVertex> vertices)
      : contact_(contact), supports_(supports), vertices_(vertices) {
    std::array<double, 2> weights{}, masses{};
    for (int i = 0; i < contact.count; ++i) {
      const double inverse_mass = vertices[contact.vertices[i]].inverse_mass;
      if (!(inverse_mass > 0)) continue;
      weights[side(i)] += std::abs(contact.weights[i]);
      masses[side(i)] += std::abs(contact.weights[i]) / inverse_mass;
    }
    for (int s = 0; s < 2; ++s) mobilities_[s] = masses[s] > 0 ? weights[s] / masses[s] : 0;
    mobility_ = mobility_along(contact.normal);
  }

  bool can_move() const { return mobility_ > 0; }

  /// How far each vertex moves where the offset between the two changes by a vector.
  template <typename Visit>
  void visit_moves(const Vec3& correction, Visit&& visit) const {
    for (int i = 0; i < contact_.count; ++i) {
      const Vec3 move = mobility(i) * contact_.weights[i] / mobility_ * correction;
      visit(contact_.vertices[i], supports_.free_part(contact_.vertices[i], move));
    }
  }

  void move_apart(const Vec3& correction) { move(correction, mobility_); }

  /// Along the normal, and by friction across it. What colliders keep from moving along the normal may well slide: a
  /// sheet on the floor under a heavy body by itself, where along the normal only the body moves.
  void move_apart(const Vec3& out, const Vec3& slide) {
    if (!is_supported_) return move_apart(out + slide);
    move_apart(out);
    const double length = slide.norm();
    if (const double mobility = length > 0 ? mobility_along(slide / length) : 0; mobility > 0) move(slide, mobility);
  }

 private:
  /// By how much the offset changes along a direction by a push of 1 along it.
  double mobility_along(const Vec3& direction) {
    double sum = 0, max_move = 0;
    for (int i = 0; i < contact_.count; ++i) {
      const double weight = std::abs(contact_.weights[i]), moved = mobility(i) * weight;
      const Vec3 push = contact_.weights[i] > 0 ? direction : Vec3(-direction);
      const Vec3 free = supports_.free_part(contact_.vertices[i], push);
      const bool is_free = free == push;
      is_supported_ |= !is_free;
      sum += moved * weight * (is_free ? 1 : push.dot(free));
      max_move = std::max(max_move, moved * (is_free ? 1 : free.norm()));
    }
    return std::max(sum, max_move / kMaxMove);
  }
  void move(const Vec3& correction, double mobility_of_all) {
    for (int i = 0; i < contact_.count; ++i) {
      const Vec3 moved = mobility(i) * contact_.weights[i] / mobility_of_all * correction;
      position(vertices_[contact_.vertices[i]]) += supports_.take_load(contact_.vertices[i], moved);
    }
  }
  int side(int i) const { return contact_.weights[i] > 0 ? 0 : 1; }
  double mobility(int i) const { return vertices_[contact_.vertices[i]].inverse_mass > 0 ? mobilities_[side(i)] : 0; }

  const Contact& contact_;
  const ColliderSupports& supports_;
  std::span<StepVertex> vertices_;
  std::array<double, 2> mobilities_{};  ///< of the point, of the surface
  double mobility_ = 0;                 ///< along the normal
  bool is_supported_ = false;           ///< some vertex, by a collider
};

/// By DCD: what was on the wrong side is sent out.
bool is_path(ContactKind kind) {
  return kind != ContactKind::kVertexFace && kind != ContactKind::kEdgeEdge;
}

/// As offset_of(), here so that it is inlined.
Vec3 offset_between(const Contact& contact, std::span<const Vec3> positions) {
  return weighted_sum(contact, [&](Index v) { return positions[v]; });
}

Vec3 offset_between(const Contact& contact, std::span<StepVertex> vertices) {
  return weighted_sum(contact, [&](Index v) { return position(vertices[v]); });
}

/// Part of what two are too near by which they are pushed apart in a step: all at once would throw them.
constexpr double kSpread = 0.02;

/// Gap of a contact by CCD, or of what is near to cloth, at the end of a step.
/// @param before  the gap at its start [m]
double gap_to_keep(const Contact& contact, double before, double max_correction) {
  const double gap = std::clamp(before, 0.0, std::max(kContactGap * max_correction, contact.distance));
  return contact.distance > gap ? gap + kSpread * (contact.distance - gap) : gap;
}

void project_contact(const Contact& contact, const Step& step, std::span<const double> max_corrections,
                     const ColliderSupports& supports, ContactFriction& friction, std::span<Vec3> ejected,
                     std::span<StepVertex> vertices) {
  const Vec3 offset = offset_between(contact, vertices);
  double depth = -contact.normal.dot(offset);
  if (!(depth > 0) && !(contact.distance > 0)) return;
  double max_correction = max_corrections[contact.vertices[0]];
  for (int i = 1; i < contact.count; ++i)
    max_correction = std::min(max_correction, max_corrections[contact.vertices[i]]);
  if (is_path(contact.kind)) {
    depth = std::min(depth + contact.distance, max_correction);
    if (moves_off_collider(contact)) {
      const double gained = contact.normal.dot(offset - offset_between(contact, step.positions));
      depth = std::min(depth, kOffCollider * max_correction - gained);
    }
  } else {
    depth += gap_to_keep(contact, contact.normal.dot(offset_between(contact, step.positions)), max_correction);
  }
  if (!(depth > 0)) return;
  ContactSides sides(contact, supports, vertices);
  if (!sides.can_move()) return;
  const Vec3 out = depth * contact.normal;
  const Vec3 displacement = offset + out - offset_between(contact, step.positions);
  const Vec3 drift = step.length() * offset_between(contact, step.velocities);
  sides.move_apart(
      out, friction_correction(displacement, drift, contact.normal, depth, friction.coefficients, friction.state));
  if (is_path(contact.kind)) sides.visit_moves(out, [&](Index v, const Vec3& move) { ejected[v] += move; });
}

}  // namespace

void project_contacts(std::span<const Contact> contacts, const Step& step, std::span<const double> max_corrections,
                      const ColliderSupports& supports, std::span<ContactFriction> frictions, std::span<Vec3> ejected,
                      std::span<StepVertex> vertices) {
  for (std::size_t i = 0; i < contacts.size(); ++i)
    project_contact(contacts[i], step, max_corrections, supports, frictions[i], ejected, vertices);
}

void push_apart(std::span<const Contact> contacts, const Push& push, std::span<StepVertex> vertices) {
  for (const Contact& contact : contacts) {
    const double gap = contact.normal.dot(offset_between(contact, vertices));
    const double depth = std::min(push.clearance - gap, push.max_correction);
    const ColliderSupports none{};
    ContactSides sides(contact, none, vertices);
    if (depth > 0 && sides.can_move()) sides.move_apart(depth * contact.normal);
  }
}

}  // namespace selvage
