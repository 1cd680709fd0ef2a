#include "simulation/time_step/parting.h"

#include "core/union_find.h"

#include <algorithm>

namespace selvage {

namespace {

/// For how long after bodies are out of one another they are damped [s], and how much [1/s].
constexpr double kPartingTime = 0.25, kPartingDamping = 100;
/// Part of a body's size by which its box is larger on all sides: bodies may be out of one another by that way before
/// the last step in which others were inside.
constexpr double kPartingGap = 0.25;
/// See Parting::depth_share(). With twice as much some stay caught in walls on several sides.
constexpr double kDepthShare = 0.05;

}  // namespace

/// Whether it sends a point of a body out of another.
bool Parting::lies_between_bodies(const Contact& contact) const {
  if (contact.kind != ContactKind::kVertexPath && contact.kind != ContactKind::kEdgePath) return false;
  const Index first = contact.vertices[0], last = contact.vertices[contact.count - 1];
  if (std::max(first, last) >= std::ssize(body_of_)) return false;
  return body_of_[first] != kNone && body_of_[last] != kNone && body_of_[first] != body_of_[last];
}

/// The group of each body that parts; kNone: of one that does not.
std::vector<Index> Parting::groups_of(std::span<const Contact> met, const State& state) const {
  const std::size_t count = model_.bodies.size();
  std::vector<Eigen::AlignedBox3d> boxes(count);
  parallel_for(std::ssize(boxes), 1, [&](std::int64_t b) {
    const Body& body = model_.bodies[b];
    if (!(state.rest_times[b] < 0)) return;
    for (Index v = body.first_vertex; v < body.first_vertex + body.vertex_count; ++v)
      boxes[b].extend(state.positions[v]);
    const double gap = kPartingGap * boxes[b].sizes().maxCoeff();
    boxes[b].min().array() -= gap;
    boxes[b].max().array() += gap;
  });
  UnionFind near(count);
  for (std::size_t a = 0; a < count; ++a)
    for (std::size_t b = a + 1; b < count && !boxes[a].isEmpty(); ++b)
      if (!boxes[b].isEmpty() && boxes[a].intersects(boxes[b])) near.join(static_cast<Index>(a), static_cast<Index>(b));
  for (const Contact& contact : met)
    if (lies_between_bodies(contact))
      near.join(body_of_[contact.vertices[0]], body_of_[contact.vertices[contact.count - 1]]);
  std::vector<Index> groups(count, kNone);
  for (Index b = 0; b < std::ssize(groups); ++b)
    if (!boxes[b].isEmpty()) groups[b] = near.lowest(b);
  return groups;
}

bool Parting::is_any(const State& state) const {
  const auto& times = state.rest_times;
  return state.steps == 0 || model_.bodies.empty() ||
         std::any_of(times.begin(), times.end(), [](double time) { return time < 0; });
}

double Parting::depth_share(const State& state) const {
  return is_any(state) ? kDepthShare : 1;
}

void Parting::finish(const Pieces& pieces, std::span<const MomentumSums> start, std::span<const Contact> contacts,
                     std::span<const Index> deep, State& state) const {
  const std::size_t count = model_.bodies.size();
  std::vector<std::uint8_t> is_inside(count, 0);
  for (const Contact& contact : contacts)
    if (lies_between_bodies(contact))
      is_inside[body_of_[contact.vertices[0]]] = is_inside[body_of_[contact.vertices[contact.count - 1]]] = 1;
  for (const Index v : deep)
    if (body_of_[v] != kNone) is_inside[body_of_[v]] = 1;
  bool any_part = false;
  for (std::size_t b = 0; b < count; ++b) {
    const double before = state.rest_times.empty() ? 0 : state.rest_times[b];
    if (is_inside[b] == 0 && !(before < 0)) continue;
    state.rest_times.resize(count, 0);
    state.rest_times[b] = is_inside[b] != 0 ? -kPartingTime : std::min(before + time_step_, 0.0);
    any_part |= state.rest_times[b] < 0;
  }
  if (!any_part) return;

  // Of each piece the first of its group; kNone: its body does not part.
  const std::vector<Index> groups = groups_of(contacts, state);
  std::vector<Index> group_of(pieces.count(), kNone), first_of(count, kNone);
  std::vector<double> kept(pieces.count(), 1);
  for (Index p = 0; p < pieces.count(); ++p) {
    const Index body = pieces.first_vertex(p) == kNone ? kNone : body_of_[pieces.first_vertex(p)];
    if (body == kNone || groups[body] == kNone) continue;
    Index& first = first_of[groups[body]];
    if (first == kNone) first = p;
    group_of[p] = first;
    if (is_inside[body] == 0) kept[p] = 1 / (1 + kPartingDamping * time_step_);
  }
  std::vector<MomentumSums> before(start.begin(), start.end());
  std::vector<MomentumSums> after = pieces.momentum(
      state.positions, [&](Index v) { return state.velocities[v]; }, [&](Index p) { return group_of[p] != kNone; });
  for (Index p = 0; p < pieces.count(); ++p) {
    if (group_of[p] == kNone || group_of[p] == p) continue;
    before[group_of[p]].add(before[p]);
    after[group_of[p]].add(after[p]);
  }
  std::vector<RigidMotion> together(pieces.count());
  std::vector<Vec3> excess(pieces.count(), Vec3::Zero());
  for (Index p = 0; p < pieces.count(); ++p) {
    if (group_of[p] != p) continue;
    together[p] = after[p].motion();
    const double speed = together[p].shift.norm(), most = (before[p].velocity() + gained_).norm();
    if (speed > most) excess[p] = (1 - most / speed) * together[p].shift;
  }
  pieces.visit_vertices([&](Index p, Index v) {
    if (group_of[p] == kNone) return;
    const Vec3 common = together[group_of[p]](state.positions[v]);
    state.velocities[v] = common - excess[group_of[p]] + kept[p] * (state.velocities[v] - common);
  });
}

}  // namespace selvage
