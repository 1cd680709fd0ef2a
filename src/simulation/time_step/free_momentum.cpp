#include "simulation/time_step/free_momentum.h"

namespace selvage {

FreeMomentum::FreeMomentum(const Model& model)
    : pieces_(model),
      fixed_groups_(static_cast<std::size_t>(pieces_.count()) + 1),
      groups_(fixed_groups_),
      group_of_(pieces_.count(), kNone) {
  const auto join_all = [&](std::span<const Index> vertices) {
    for (const Index v : vertices) {
      fixed_groups_.join(node_of(vertices[0]), node_of(v));
      if (!(model.inverse_masses[v] > 0)) fixed_groups_.join(node_of(v), outside());
    }
  };
  for (const auto& element : model.mesh.elements()) join_all(element);
  for (const auto& triangle : model.triangles) join_all(triangle);
}

void FreeMomentum::join(std::span<const Contact> contacts) {
  for (const Contact& contact : contacts)
    for (int i = 1; i < contact.count; ++i) groups_.join(node_of(contact.vertices[0]), node_of(contact.vertices[i]));
}

void FreeMomentum::join(std::span<const ZoneLink> links) {
  for (const auto& [vertex, other] : links) groups_.join(node_of(vertex), node_of(other));
}

/// False: all is held.
bool FreeMomentum::find_free() {
  bool any_free = false;
  for (Index p = 0; p < pieces_.count(); ++p) {
    const bool is_held = groups_.lowest(p) == groups_.lowest(outside());
    group_of_[p] = is_held ? kNone : groups_.lowest(p);
    any_free |= !is_held;
  }
  return any_free;
}

/// Of a group at its first piece.
void FreeMomentum::add_up(std::span<MomentumSums> of_pieces) const {
  for (Index p = 0; p < pieces_.count(); ++p)
    if (group_of_[p] != kNone && group_of_[p] != p) of_pieces[group_of_[p]].add(of_pieces[p]);
}

void FreeMomentum::restore(std::span<const MomentumSums> start, const Vec3& gained, double kept,
                           std::span<const Vec3> positions, std::span<Vec3> velocities) {
  if (!find_free()) return;
  std::vector<MomentumSums> before(start.begin(), start.end());
  std::vector<MomentumSums> after = pieces_.momentum(
      positions, [&](Index v) { return velocities[v]; }, [&](Index piece) { return group_of_[piece] != kNone; });
  add_up(before);
  add_up(after);
  std::vector<RigidMotion> missing(pieces_.count());
  for (Index p = 0; p < pieces_.count(); ++p) {
    if (group_of_[p] != p) continue;
    missing[p] = after[p].turn(kept * before[p].spin() - after[p].spin());
    missing[p].shift = kept * (before[p].velocity() + gained) - after[p].velocity();
  }
  pieces_.visit_vertices([&](Index piece, Index v) {
    if (group_of_[piece] != kNone) velocities[v] += missing[group_of_[piece]](positions[v]);
  });
}

}  // namespace selvage
