#include "contact/impacts/near_contacts.h"

#include "contact/input/contact_weights.h"
#include "selvage/geometry/predicates.h"

#include <algorithm>
#include <cmath>

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

/// Part of a distance by which that of the nearest points may differ from it. Where only rounding is between these it
/// differs by more, and their difference says nothing of the direction.
constexpr double kSameDistance = 0.01;

/// From the nearest point of the second to that of the first, of length 1; across both where these are too near.
/// @param across  at right angles to both features, of any length
/// @param side    1: it points from the second to the first, -1: back, 0: they meet
template <typename Near, typename Side>
std::optional<Vec3> normal_between(const Near& near, const Vec3& across, Side&& side) {
  const Vec3 between = near.nearest[0] - near.nearest[1];
  if (std::abs(between.norm() - near.distance) <= kSameDistance * near.distance) return Vec3(between / near.distance);
  const Vec3 normal = side() * across;
  const double length = normal.norm();
  if (!(length > 0)) return {};
  return Vec3(normal / length);
}

/// Without its vertices.
template <typename Near>
Contact held_apart(ContactKind kind, const Near& near, const Vec3& normal, double distance,
                   const std::array<Index, 2>& features) {
  Contact contact;
  contact.kind = kind;
  contact.normal = normal;
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

std::optional<Contact> NearSearch::contact_of(const NearVertexFace& near, std::span<const Vec3> positions) const {
  const auto& face = surface_.triangles()[near.face];
  const double distance = thickness_[near.vertex] + thickness_of(face);
  if (!(near.distance > 0) || near.distance > kReach * distance) return {};
  const Vec3 &a = positions[face[0]], &b = positions[face[1]], &c = positions[face[2]];
  const std::optional<Vec3> normal = normal_between(
      near, (b - a).cross(c - a), [&] { return static_cast<double>(orient3d(a, b, c, positions[near.vertex])); });
  if (!normal) return {};
  Contact contact = held_apart(ContactKind::kVertexFace, near, *normal, distance, {near.vertex, near.face});
  add_weight(contact, near.vertex, 1);
  for (int i = 0; i < 3; ++i) add_weight(contact, face[i], -near.barycentric[i]);
  return contact;
}

std::optional<Contact> NearSearch::contact_of(const NearEdges& near, std::span<const Vec3> positions) const {
  const auto &a = surface_.edges()[near.first], &b = surface_.edges()[near.second];
  const double distance = thickness_of(a) + thickness_of(b);
  // At an end it is a pair of a vertex.
  const auto is_inside = [](double place) { return place > 0 && place < 1; };
  if (!(near.distance > 0) || near.distance > kReach * distance || !is_inside(near.place[0]) ||
      !is_inside(near.place[1]))
    return {};
  const Vec3 &a0 = positions[a[0]], &a1 = positions[a[1]], &b0 = positions[b[0]], &b1 = positions[b[1]];
  const std::optional<Vec3> normal =
      normal_between(near, (a1 - a0).cross(b1 - b0), [&] { return static_cast<double>(orient3d(a0, a1, b0, b1)); });
  if (!normal) return {};
  Contact contact = held_apart(ContactKind::kEdgeEdge, near, *normal, distance, {near.first, near.second});
  for (int i = 0; i < 2; ++i) add_weight(contact, a[i], i == 0 ? 1 - near.place[0] : near.place[0]);
  for (int i = 0; i < 2; ++i) add_weight(contact, b[i], i == 0 ? near.place[1] - 1 : -near.place[1]);
  return contact;
}

void NearSearch::append_contacts(std::span<const Vec3> positions, std::vector<Contact>& contacts) {
  finder_.update(positions);
  const NearPairs pairs = finder_.find_pairs();
  const auto append = [&](const auto& near) {
    std::optional<Contact> contact = contact_of(near, positions);
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
