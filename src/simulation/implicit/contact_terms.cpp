#include "simulation/implicit/contact_terms.h"

#include "simulation/colliders/passage.h"

#include <algorithm>
#include <tuple>

namespace selvage {

namespace {

/// Part of a vertex's largest correction below which sliding in a step is resisted by less than all of friction.
constexpr double kSlip = 4e-3;

/// Part of its thickness by which cloth that is nearer is pushed apart in a step: all at once would throw it.
constexpr double kPush = 0.25;

/// Part of a thickness over which repulsion grows to its stiffness.
constexpr double kRamp = kPush / 2;

/// Stiffness with which all vertices of a term resist; 0 where all are held.
double stiffness_of(const OffsetTerm& term, const IncrementalPotential& potential) {
  double compliance = 0;
  for (int i = 0; i < term.count; ++i)
    compliance += term.weights[i] * term.weights[i] / potential.stiffness(term.vertices[i]);
  return compliance > 0 ? 1 / compliance : 0;
}

bool is_by_ccd(const Contact& contact) {
  return contact.kind == ContactKind::kVertexFace || contact.kind == ContactKind::kEdgeEdge;
}

/// Where the point of a contact is to be at least, along its normal.
/// @param gap   where it is at the start of the step [m]
/// @param most  farthest that it is sent out in a step [m]
double target_of(const Contact& contact, double gap, double most) {
  if (moves_off_collider(contact)) return std::min(gap + kOffCollider * most, contact.distance);
  if (!is_by_ccd(contact)) return std::min(gap + most, contact.distance);
  const double apart = std::max(gap, 0.0);
  return std::max(std::min(apart, kContactGap * most), std::min(apart + kPush * contact.distance, contact.distance));
}

/// A point that is at rest on the surface, as near as friction in a step holds it, sticks; another slips.
/// @param drift  of the point by the velocities at the start of the step, relative to the surface [m]
double coefficient_of(const Friction& friction, const OffsetTerm& term, const Vec3& drift) {
  const double slide = (drift - term.normal.dot(drift) * term.normal).norm();
  return slide <= 2 * term.slip ? friction.static_coefficient : friction.dynamic_coefficient;
}

/// For each contact whether it is the last of its two features: what is found again, on a later way, counts as found
/// there. Ways out are found once.
std::vector<std::uint8_t> mark_last_of_each(std::span<const Contact> contacts) {
  std::vector<std::uint8_t> is_last(contacts.size(), 1);
  std::vector<std::size_t> order;
  for (std::size_t c = 0; c < contacts.size(); ++c)
    if (is_by_ccd(contacts[c])) order.push_back(c);
  const auto features = [&](std::size_t c) { return std::tie(contacts[c].kind, contacts[c].vertices); };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return features(a) < features(b); });
  for (std::size_t i = 0; i + 1 < order.size(); ++i) is_last[order[i]] = features(order[i]) != features(order[i + 1]);
  return is_last;
}

}  // namespace

void append_contact_terms(TimeStep& time_step, const IncrementalPotential& potential, std::vector<OffsetTerm>& terms) {
  const Step& step = time_step.step();
  const auto max_corrections = time_step.max_corrections();
  const std::vector<std::uint8_t> is_last = mark_last_of_each(time_step.contacts());
  for (std::size_t c = 0; c < is_last.size(); ++c) {
    if (is_last[c] == 0) continue;
    const Contact& contact = time_step.contacts()[c];
    OffsetTerm term;
    double most = max_corrections[contact.vertices[0]];
    for (int i = 0; i < contact.count; ++i) {
      const Index v = contact.vertices[i];
      most = std::min(most, max_corrections[v]);
      if (v < potential.vertex_count()) {
        term.vertices[term.count] = v;
        term.weights[term.count++] = contact.weights[i];
      } else {
        term.origin -= contact.weights[i] * position(time_step.contact_vertices()[v]);
      }
    }
    term.normal = contact.normal;
    term.stiffness = kContactStiffness * stiffness_of(term, potential);
    if (!(term.stiffness > 0)) continue;
    term.start = offset_of(contact, step.positions);
    term.target = target_of(contact, term.normal.dot(term.start), most);
    if (is_by_ccd(contact)) term.ramp = kRamp * contact.distance;
    term.slip = kSlip * most;
    term.coefficient =
        coefficient_of(time_step.friction_of(contact), term, step.length() * offset_of(contact, step.velocities));
    terms.push_back(term);
  }
}

void append_collider_terms(const TimeStep& time_step, std::span<const Vec3> x, const IncrementalPotential& potential,
                           std::vector<OffsetTerm>& terms) {
  const Step& step = time_step.step();
  const auto max_corrections = time_step.max_corrections(), half_thickness = time_step.half_thickness();
  for (const PreparedCollider& collider : time_step.colliders()) {
    const RigidTransform start = collider.motion.at(step.start_time), end = collider.motion.at(step.end_time);
    for (Index v = 0; v < potential.vertex_count(); ++v) {
      if (!potential.is_free(v)) continue;
      const Vec3 was = collider.carry(start.invert(step.positions[v])), p = end.invert(x[v]);
      const double half = half_thickness.empty() ? 0 : half_thickness[v];
      const auto hit = std::visit(
          [&](const auto& shape) {
            return half > 0 ? find_hit_on_way(grown_for(shape, half, was), was, p) : find_hit_on_way(shape, was, p);
          },
          collider.shape);
      if (!hit) continue;
      OffsetTerm term;
      term.count = 1;
      term.vertices[0] = v;
      term.weights[0] = 1;
      term.origin = end(p + hit->depth * hit->normal);
      term.normal = end.rotation * hit->normal;
      term.start = end(was) - term.origin;
      term.target = std::min(term.normal.dot(term.start), 0.0);
      term.stiffness = kContactStiffness * potential.stiffness(v);
      term.slip = kSlip * max_corrections[v];
      term.coefficient =
          coefficient_of(collider.friction, term, step.positions[v] + step.length() * step.velocities[v] - end(was));
      terms.push_back(term);
    }
  }
}

}  // namespace selvage
