#include "simulation/xpbd/project_contacts.h"

#include "core/parallel.h"
#include "simulation/colliders/passage.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace selvage {

namespace {

constexpr std::int64_t kVertexGrain = 1024;
/// Vertices that are passed over together where a collider is far from all of them.
constexpr std::int64_t kVertexRun = 128;
/// Part of a vertex's shortest edge that a point inside a body is sent at a time.
constexpr double kVertexReach = 0.25;
/// How far a vertex moves at most to close a gap of 1. By no more does one whose contact nothing holds and no vertex
/// has on both sides, for of weights that sum to 1 the largest is at most (1 + sqrt 3) / 2 times the sum of their
/// squares.
constexpr double kFarthest = 1.37;

Eigen::Map<Eigen::Vector3d> position(VertexRow& vertex) {
  return Eigen::Map<Eigen::Vector3d>(vertex.position);
}

Eigen::AlignedBox3d box_around(std::span<const VertexRow> vertices) {
  Eigen::AlignedBox3d box;
  for (const VertexRow& vertex : vertices) box.extend(Eigen::Map<const Eigen::Vector3d>(vertex.position));
  return box;
}

/// The vertices of both sides of a contact. Those of one side all count by the mean of their masses, weighed as in the
/// contact: by their own, a light vertex among heavy ones would be thrown many times as far as the contact is deep, and
/// its elements turned inside out; this way nothing moves much farther, and momentum is kept all the same. Nor does
/// what moves a point by little, the others on its side being held or the point and the surface having it in common:
/// such a contact is closed in part only.
class ContactSides {
 public:
  ContactSides(const Contact& contact, std::span<VertexRow> vertices) : contact_(contact), vertices_(vertices) {
    std::array<double, 2> weights{}, masses{};
    for (int i = 0; i < contact.count; ++i) {
      const double inverse_mass = vertices[contact.vertices[i]].inverse_mass;
      if (!(inverse_mass > 0)) continue;
      weights[side(i)] += std::abs(contact.weights[i]);
      masses[side(i)] += std::abs(contact.weights[i]) / inverse_mass;
    }
    for (int s = 0; s < 2; ++s) mobilities_[s] = masses[s] > 0 ? weights[s] / masses[s] : 0;
    double farthest = 0;
    for (int i = 0; i < contact.count; ++i) {
      const double moved = mobility(i) * std::abs(contact.weights[i]);
      mobility_ += moved * std::abs(contact.weights[i]);
      farthest = std::max(farthest, moved);
    }
    mobility_ = std::max(mobility_, farthest / kFarthest);
  }

  bool can_move() const { return mobility_ > 0; }

  /// How far each vertex moves where the offset between the two changes by a vector.
  template <typename Visit>
  void visit_moves(const Vec3& correction, Visit&& visit) const {
    for (int i = 0; i < contact_.count; ++i)
      visit(contact_.vertices[i], mobility(i) * contact_.weights[i] / mobility_ * correction);
  }

  void move_apart(const Vec3& correction) {
    visit_moves(correction, [&](Index v, const Vec3& move) { position(vertices_[v]) += move; });
  }

 private:
  int side(int i) const { return contact_.weights[i] > 0 ? 0 : 1; }
  double mobility(int i) const { return vertices_[contact_.vertices[i]].inverse_mass > 0 ? mobilities_[side(i)] : 0; }

  const Contact& contact_;
  std::span<VertexRow> vertices_;
  std::array<double, 2> mobilities_{};  ///< of the point, of the surface
  double mobility_ = 0;
};

bool is_path(ContactKind kind) {
  return kind == ContactKind::kVertexPath || kind == ContactKind::kEdgePath || kind == ContactKind::kCentroidPath;
}

Vec3 offset_of_rows(const Contact& contact, std::span<VertexRow> vertices) {
  Vec3 offset = Vec3::Zero();
  for (int i = 0; i < contact.count; ++i) offset += contact.weights[i] * position(vertices[contact.vertices[i]]);
  return offset;
}

void project_contact(const Contact& contact, const Step& step, std::span<const double> reaches,
                     const Friction& friction, FrictionState& grip, std::span<Vec3> sent,
                     std::span<VertexRow> vertices) {
  const Vec3 offset = offset_of_rows(contact, vertices);
  double depth = -contact.normal.dot(offset);
  if (!(depth > 0)) return;
  double reach = reaches[contact.vertices[0]];
  for (int i = 1; i < contact.count; ++i) reach = std::min(reach, reaches[contact.vertices[i]]);
  if (is_path(contact.kind)) {
    depth = std::min(depth, reach);
  } else {
    depth += std::clamp(gap_of(contact, step.positions), 0.0, kContactGap * reach);
  }
  ContactSides sides(contact, vertices);
  if (!sides.can_move()) return;
  const Vec3 out = depth * contact.normal;
  const Vec3 displacement = offset + out - offset_of(contact, step.positions);
  const Vec3 drift = step.length() * offset_of(contact, step.velocities);
  sides.move_apart(out + friction_correction(displacement, drift, contact.normal, depth, friction, grip));
  if (is_path(contact.kind)) sides.visit_moves(out, [&](Index v, const Vec3& move) { sent[v] += move; });
}

/// A collider and where it is at the ends of a step.
struct MovingCollider {
  const PreparedCollider& collider;
  RigidTransform from, to;
  bool is_still = collider.motion.keyframes.empty();

  /// In the collider's own coordinates, at the end of the step.
  Vec3 place(VertexRow& vertex) const { return is_still ? Vec3(position(vertex)) : to.invert(position(vertex)); }

  /// @param surface  what starts the step no deeper inside lies on the surface [m]; infinite: all does
  template <typename Shape>
  ColliderContacts push_out(const Shape& shape, const Step& step, std::int64_t v, double surface, const Vec3& sent,
                            ColliderGrip& grip, VertexRow& vertex) const {
    const Vec3 p = place(vertex);
    const Vec3 was = from.invert(step.positions[v]);
    const std::optional<Hit> hit = find_hit_on_way(shape, was, p);
    if (!hit) return {};
    ColliderContacts contacts{1, 0};
    if (grip.step != step.number) {
      grip = {};
      grip.step = step.number;
      const std::optional<Hit> buried = std::isfinite(surface) ? find_hit(shape, was) : std::optional<Hit>();
      if (buried && buried->depth > surface) {
        grip.way_out = to.rotation * buried->normal;
        grip.buried = buried->depth;
        contacts.buried = 1;
      }
    }
    const Vec3 outside = p + hit->depth * hit->normal;
    const Vec3 moved = outside - was - to.rotation.transpose() * sent;
    const Vec3 drift = to.invert(step.positions[v] + step.length() * step.velocities[v]) - was;
    const Vec3 slide = friction_correction(moved, drift, hit->normal, hit->depth, collider.friction, grip.grip);
    position(vertex) = to(outside + slide);
    return contacts;
  }

  /// Moves a vertex that friction has held back inside, or beyond, to the surface once more.
  void set_on_surface(const Step& step, std::int64_t v, VertexRow& vertex) const {
    const Vec3 p = place(vertex);
    const Vec3 was = from.invert(step.positions[v]);
    const std::optional<Hit> hit =
        std::visit([&](const auto& shape) { return find_hit_on_way(shape, was, p); }, collider.shape);
    if (hit) position(vertex) = to(p + hit->depth * hit->normal);
  }
};

}  // namespace

std::vector<double> reaches_of(const Model& model) {
  std::vector<double> reaches(model.mesh.vertex_count(), 0);
  for (const auto& element : model.mesh.elements())
    for (const Index v : element)
      for (const Index w : element) {
        if (v == w) continue;
        const double reach = kVertexReach * (model.rest_positions[v] - model.rest_positions[w]).norm();
        if (reaches[v] == 0 || reach < reaches[v]) reaches[v] = reach;
      }
  return reaches;
}

void project_contacts(std::span<const Contact> contacts, const Step& step, std::span<const double> reaches,
                      const Friction& friction, std::span<FrictionState> grips, std::span<Vec3> sent,
                      std::span<VertexRow> vertices) {
  for (std::size_t i = 0; i < contacts.size(); ++i)
    project_contact(contacts[i], step, reaches, friction, grips[i], sent, vertices);
}

void push_apart(std::span<const Contact> contacts, const Push& push, std::span<VertexRow> vertices) {
  for (const Contact& contact : contacts) {
    const double gap = contact.normal.dot(offset_of_rows(contact, vertices));
    const double depth = std::min(push.clearance - gap, push.at_most);
    ContactSides sides(contact, vertices);
    if (depth > 0 && sides.can_move()) sides.move_apart(depth * contact.normal);
  }
}

ColliderContacts project_colliders(std::span<const PreparedCollider> colliders, const Step& step,
                                   std::span<const double> reaches, std::span<const Vec3> sent,
                                   std::span<ColliderGrip> grips, std::span<VertexRow> vertices) {
  if (colliders.empty()) return {};
  std::vector<MovingCollider> moving;
  bool any_far_side = false;
  for (const PreparedCollider& collider : colliders) {
    moving.push_back({collider, collider.motion.at(step.from), collider.motion.at(step.to)});
    any_far_side |= std::visit([](const auto& s) { return kHasFarSide<std::decay_t<decltype(s)>>; }, collider.shape);
  }
  const std::size_t count = moving.size();
  // To find a box takes half as long as to ask one collider of every vertex.
  const bool pays_box = count > 1;
  const std::int64_t run = pays_box ? kVertexRun : std::ssize(vertices);
  const auto surface_of = [&](std::int64_t v) { return reaches.empty() ? HUGE_VAL : kContactGap * reaches[v]; };
  const auto project = [&](std::int64_t first, std::int64_t last, ColliderContacts& hits) {
    std::vector<std::int64_t> pushed;
    Eigen::AlignedBox3d box, ways;
    const auto place_boxes = [&] {
      ways = box = box_around(vertices.subspan(first, last - first));
      if (!any_far_side) return;
      for (std::int64_t v = first; v < last; ++v) ways.extend(step.positions[v]);
    };
    if (pays_box) place_boxes();
    for (std::size_t o = 0; o < count; ++o)
      std::visit(
          [&](const auto& shape) {
            constexpr bool kByWays = kHasFarSide<std::decay_t<decltype(shape)>>;
            if (pays_box && moving[o].is_still && is_clear(shape, kByWays ? ways : box)) return;
            const std::int64_t before = hits.count;
            for (std::int64_t v = first; v < last; ++v) {
              if (!(vertices[v].inverse_mass > 0)) continue;
              const auto hit =
                  moving[o].push_out(shape, step, v, surface_of(v), sent[v], grips[v * count + o], vertices[v]);
              if (hit.count > 0) pushed.push_back(v);
              hits.add(hit);
            }
            if (pays_box && hits.count > before) place_boxes();
          },
          colliders[o].shape);
    // What friction holds back from sliding along one wall, it holds back from leaving another, and the same one where
    // that is hollow.
    for (const std::int64_t v : pushed)
      for (const MovingCollider& collider : moving) collider.set_on_surface(step, v, vertices[v]);
  };
  return parallel_reduce<ColliderContacts>(std::ssize(vertices), kVertexGrain,
                                           [&](std::int64_t first, std::int64_t last, ColliderContacts& hits) {
                                             for (; first < last; first += run)
                                               project(first, std::min(first + run, last), hits);
                                           });
}

}  // namespace selvage
