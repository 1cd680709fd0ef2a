#include "contact/impacts/near_contacts.h"

#include "contact/input/contact_weights.h"

#include <algorithm>

namespace selvage {

namespace {

/// Distance within which pairs are contacts, over that which they are to keep: what comes nearer in the step is known
/// before.
constexpr double kReach = 1.5;

PairFilters filters_for(const SurfaceStep& step, std::vector<Vec3> rest_positions, double rest_distance) {
  constexpr std::uint32_t kCloth = 1, kOthers = 2;
  PairFilters filters;
  for (Index t = 0; t < step.surface.triangle_count(); ++t) {
    filters.layers.push_back(step.is_cloth(t) ? kCloth : kOthers);
    filters.seen_layers.push_back(step.is_cloth(t) ? kCloth | kOthers : kCloth);
  }
  filters.rest_positions = std::move(rest_positions);
  filters.rest_distance = rest_distance;
  return filters;
}

double largest(std::span<const double> thickness) {
  return *std::max_element(thickness.begin(), thickness.end());
}

/// Without its vertices.
template <typename Near>
Contact held_apart(ContactKind kind, const Near& near, double distance, const std::array<Index, 2>& features) {
  Contact contact;
  contact.kind = kind;
  contact.normal = (near.nearest[0] - near.nearest[1]) / near.distance;
  contact.point = near.nearest[1];
  contact.distance = distance;
  contact.point_feature = features[0];
  contact.surface_feature = features[1];
  return contact;
}

}  // namespace

NearSearch::NearSearch(const SurfaceStep& step, std::vector<Vec3> rest_positions, std::vector<double> thickness)
    : surface_(step.surface),
      thickness_(std::move(thickness)),
      finder_(step.surface, step.positions_t0, 2 * kReach * largest(thickness_),
              filters_for(step, std::move(rest_positions), 2 * kReach * largest(thickness_))) {}

double NearSearch::thickness_of(std::span<const Index> vertices) const {
  double most = 0;
  for (const Index v : vertices) most = std::max(most, thickness_[v]);
  return most;
}

std::optional<Contact> NearSearch::contact_of(const NearVertexFace& near) const {
  const auto& face = surface_.triangles()[near.face];
  const double distance = thickness_[near.vertex] + thickness_of(face);
  if (!(near.distance > 0) || near.distance > kReach * distance) return {};
  Contact contact = held_apart(ContactKind::kVertexFace, near, distance, {near.vertex, near.face});
  add_weight(contact, near.vertex, 1);
  for (int i = 0; i < 3; ++i) add_weight(contact, face[i], -near.barycentric[i]);
  return contact;
}

std::optional<Contact> NearSearch::contact_of(const NearEdges& near) const {
  const auto &a = surface_.edges()[near.first], &b = surface_.edges()[near.second];
  const double distance = thickness_of(a) + thickness_of(b);
  // At an end it is a pair of a vertex.
  const auto is_inside = [](double place) { return place > 0 && place < 1; };
  if (!(near.distance > 0) || near.distance > kReach * distance || !is_inside(near.place[0]) ||
      !is_inside(near.place[1]))
    return {};
  Contact contact = held_apart(ContactKind::kEdgeEdge, near, distance, {near.first, near.second});
  for (int i = 0; i < 2; ++i) add_weight(contact, a[i], i == 0 ? 1 - near.place[0] : near.place[0]);
  for (int i = 0; i < 2; ++i) add_weight(contact, b[i], i == 0 ? near.place[1] - 1 : -near.place[1]);
  return contact;
}

void NearSearch::append_contacts(std::span<const Vec3> positions, std::vector<Contact>& contacts) {
  finder_.update(positions);
  const NearPairs pairs = finder_.find_pairs();
  const auto append = [&](const auto& near) {
    std::optional<Contact> contact = contact_of(near);
    if (!contact) return;
    remove_zero_weights(*contact);
    contacts.push_back(*contact);
  };
  for (const NearVertexFace& near : pairs.vertex_face) append(near);
  for (const NearEdges& near : pairs.edge_edge) append(near);
}

std::vector<Vec3> separated_at_rest(std::span<const Vec3> rest_positions, std::span<const Index> objects, Index count) {
  double extent = 1;
  for (const Vec3& p : rest_positions) extent = std::max(extent, p.cwiseAbs().maxCoeff());
  std::vector<Vec3> separated(rest_positions.begin(), rest_positions.end());
  Index last = 0;
  for (std::size_t v = 0; v < objects.size(); ++v) {
    if (objects[v] == kNone) continue;
    separated[v][0] += 4 * extent * objects[v];
    last = std::max(last, objects[v]);
  }
  separated.resize(count, Vec3(4 * extent * (last + 1), 0, 0));
  return separated;
}

}  // namespace selvage
