#include "simulation/time_step/sleep.h"

#include "core/parallel.h"
#include "core/union_find.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace selvage {

namespace {

/// [s] for which a group is slow before it is damped.
constexpr double kSettleTime = 0.1;
/// A group of several bodies slower than so many times the speed at which they sleep is damped but for its common
/// velocity, and the spin of a body alone on a collider is [1/s].
constexpr double kSettlingSpeeds = 6, kSettlingDamping = 5;
/// Part of a body's mass that may tremble: the pressed rim of a body does while the rest stands.
constexpr double kTremblingPart = 0.02;
/// Part that may be faster than what settles: what iterations leave of their balance throws the pressed vertices of a
/// light body under a heavy one to and fro, and a coarse body has few others.
constexpr double kThrownPart = 0.1;
/// Part of the time that counts, after the first, where more trembles in a group of several bodies; and that counts
/// back where one of them moves as a whole.
constexpr double kTremblingTime = 0.125;
/// Damping of the common velocity of such a group, but for that of its bodies on colliders [1/s]: a tower sways on a
/// foot that stands, and what slides or rolls does so with its foot.
constexpr double kSwayDamping = 2;
/// Part of a body's size by which its box is larger on all sides.
constexpr double kGapPart = 0.01;

double size_of(const Eigen::AlignedBox3d& box) {
  return box.isEmpty() ? 0 : box.sizes().maxCoeff();
}

/// A box around the box in the collider's own coordinates.
Eigen::AlignedBox3d in_coordinates_of(const RigidTransform& collider, const Eigen::AlignedBox3d& box) {
  Eigen::AlignedBox3d own;
  for (int corner = 0; corner < 8; ++corner)
    own.extend(collider.invert(box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner))));
  return own;
}

}  // namespace

/// Bodies near one another.
struct Sleep::Group {
  struct Sum {
    double mass = 0;
    Vec3 momentum = Vec3::Zero();

    void add(double of_mass, const Vec3& velocity) {
      mass += of_mass;
      momentum += of_mass * velocity;
    }
    Vec3 velocity() const { return mass > 0 ? Vec3(momentum / mass) : Vec3(Vec3::Zero()); }
  };

  double time = kSleepTime;  ///< at rest [s]
  int bodies = 0;
  Sum all, carried;  ///< of all bodies; of those that colliders have pushed

  bool settles() const { return time >= kSettleTime; }
};

Sleep::Sleep(const Model& model, double part, const Vec3& gravity)
    : model_(model),
      has_gravity_(!gravity.isZero(0)),
      is_disturbed_(model.bodies.size(), 0),
      is_asleep_(model.bodies.size(), 0),
      body_of_(bodies_of_vertices(model)) {
  for (const Body& body : model.bodies) {
    const double size = size_of(box_of(body, model.rest_positions));
    speeds_.push_back(part * std::sqrt(2 * gravity.norm() * size));
    gaps_.push_back(kGapPart * size);
    double mass = 0;
    for (Index v = body.first_vertex; v < body.first_vertex + body.vertex_count; ++v)
      if (model.inverse_masses[v] > 0) mass += 1 / model.inverse_masses[v];
    masses_.push_back(mass);
  }
}

Eigen::AlignedBox3d Sleep::box_of(const Body& body, std::span<const Vec3> positions) const {
  Eigen::AlignedBox3d box;
  for (const Vec3& p : positions.subspan(body.first_vertex, body.vertex_count)) box.extend(p);
  return box;
}

MomentumSums Sleep::momentum_of(const Body& body, const State& state) const {
  const Index first = body.first_vertex, last = first + body.vertex_count;
  MomentumSums sums(state.positions[first], state.velocities[first]);
  for (Index v = first; v < last; ++v)
    if (model_.inverse_masses[v] > 0) sums.add(1 / model_.inverse_masses[v], state.positions[v], state.velocities[v]);
  return sums;
}

void Sleep::damp_spin(const Body& body, double kept, State& state) const {
  const MomentumSums sums = momentum_of(body, state);
  const RigidMotion lost = sums.turn((1 - kept) * sums.spin());
  for (Index v = body.first_vertex; v < body.first_vertex + body.vertex_count; ++v)
    if (model_.inverse_masses[v] > 0) state.velocities[v] -= lost(state.positions[v]);
}

void Sleep::begin_awake() {
  std::fill(is_disturbed_.begin(), is_disturbed_.end(), 1);
  std::fill(is_asleep_.begin(), is_asleep_.end(), 0);
  asleep_count_ = 0;
}

void Sleep::begin(const State& state, double start_time, double end_time, std::vector<std::uint8_t> is_disturbed,
                  std::span<const PreparedCollider> colliders) {
  begin_awake();
  is_disturbed_ = std::move(is_disturbed);
  disturb_near(colliders, state, start_time, end_time);
  if (state.rest_times.empty() || !has_gravity_) return;
  parallel_for(std::ssize(is_asleep_), 1, [&](std::int64_t b) {
    if (is_disturbed_[b] != 0 || state.rest_times[b] < kSleepTime) return;
    const auto velocities =
        std::span(state.velocities).subspan(model_.bodies[b].first_vertex, model_.bodies[b].vertex_count);
    is_asleep_[b] = std::all_of(velocities.begin(), velocities.end(), [](const Vec3& v) { return v.isZero(0); });
  });
  asleep_count_ = std::count(is_asleep_.begin(), is_asleep_.end(), 1);
}

/// Colliders that move disturb what they are near to.
void Sleep::disturb_near(std::span<const PreparedCollider> colliders, const State& state, double start_time,
                         double end_time) {
  for (const PreparedCollider& collider : colliders) {
    if (!collider.moves(start_time, end_time)) continue;
    parallel_for(std::ssize(is_disturbed_), 1, [&](std::int64_t b) {
      if (is_disturbed_[b] != 0) return;
      Eigen::AlignedBox3d box = box_of(model_.bodies[b], state.positions);
      box.min().array() -= gaps_[b];
      box.max().array() += gaps_[b];
      for (const double time : {start_time, end_time}) {
        const Eigen::AlignedBox3d own = in_coordinates_of(collider.motion.at(time), box);
        if (!std::visit([&](const auto& shape) { return is_clear(shape, own); }, collider.shape)) is_disturbed_[b] = 1;
      }
    });
  }
}

Sleep::Pace Sleep::pace_of(Index b, const State& state) const {
  if (is_asleep(b)) return Pace::kSleepy;
  if (is_disturbed_[b] != 0) return Pace::kFast;
  const Body& body = model_.bodies[b];
  double fast = 0, trembling = 0;
  const double sleepy = speeds_[b] * speeds_[b], settling = sleepy * kSettlingSpeeds * kSettlingSpeeds;
  for (Index v = body.first_vertex; v < body.first_vertex + body.vertex_count; ++v) {
    if (!(model_.inverse_masses[v] > 0)) continue;
    const double speed = state.velocities[v].squaredNorm(), mass = 1 / model_.inverse_masses[v];
    if (speed > sleepy) trembling += mass;
    if (speed > settling) fast += mass;
  }
  const double most = kTremblingPart * masses_[b];
  if (fast > kThrownPart * masses_[b]) return Pace::kFast;
  if (!(trembling > most)) return Pace::kSleepy;
  const RigidMotion rigid = momentum_of(body, state).motion();
  double moving = 0;
  for (Index v = body.first_vertex; v < body.first_vertex + body.vertex_count; ++v)
    if (model_.inverse_masses[v] > 0 && rigid(state.positions[v]).squaredNorm() > sleepy)
      moving += 1 / model_.inverse_masses[v];
  return moving > most ? Pace::kSettling : Pace::kTrembling;
}

/// The group of each body: bodies whose boxes, along the way of the next step, overlap, and those that overlap these.
std::vector<Index> Sleep::groups_of(const State& state, double step) const {
  const std::size_t count = model_.bodies.size();
  std::vector<Eigen::AlignedBox3d> boxes(count);
  parallel_for(std::ssize(boxes), 1, [&](std::int64_t b) {
    const Body& body = model_.bodies[b];
    for (Index v = body.first_vertex; v < body.first_vertex + body.vertex_count; ++v) {
      boxes[b].extend(state.positions[v]);
      boxes[b].extend(Vec3(state.positions[v] + step * state.velocities[v]));
    }
    boxes[b].min().array() -= gaps_[b];
    boxes[b].max().array() += gaps_[b];
  });
  std::vector<Index> order(count), groups(count);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return boxes[a].min()[0] < boxes[b].min()[0]; });
  UnionFind near(count);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = i + 1; j < count && boxes[order[j]].min()[0] <= boxes[order[i]].max()[0]; ++j)
      if (boxes[order[i]].intersects(boxes[order[j]])) near.join(order[i], order[j]);
  for (Index b = 0; b < std::ssize(groups); ++b) groups[b] = near.lowest(b);
  return groups;
}

/// The paces of bodies in a step that has ended.
std::vector<Sleep::Pace> Sleep::paces_of(std::span<const Index> penetrating, const State& state) const {
  std::vector<Pace> paces(model_.bodies.size());
  parallel_for(std::ssize(paces), 1, [&](std::int64_t b) { paces[b] = pace_of(static_cast<Index>(b), state); });
  for (const Index v : penetrating)
    if (body_of_[v] != kNone) paces[body_of_[v]] = Pace::kFast;
  for (std::size_t b = 0; b < paces.size(); ++b)
    if (state.rest_times[b] < 0) paces[b] = Pace::kFast;
  return paces;
}

/// For how long a body has been at rest, if its group has.
double Sleep::rest_time_of(Index b, Pace pace, bool is_alone, double step, const State& state) const {
  const bool was_woken = !is_asleep(b) && state.rest_times[b] >= kSleepTime;
  const double before = was_woken ? 0 : std::max(state.rest_times[b], 0.0);
  if (pace == Pace::kFast) return 0;
  if (pace == Pace::kSleepy) return before + step;
  if (before < kSettleTime) return std::min(before + step, kSettleTime);
  if (is_alone) return kSettleTime;
  const double counted = kTremblingTime * step;
  return pace == Pace::kTrembling ? before + counted : std::max(before - counted, kSettleTime);
}

/// Adds up what moves in groups that settle.
void Sleep::add_up(std::span<const std::uint8_t> is_carried, std::span<const Index> of_body, const State& state,
                   std::span<Group> groups) const {
  std::vector<Vec3> velocities(of_body.size(), Vec3::Zero());
  parallel_for(std::ssize(velocities), 1, [&](std::int64_t b) {
    if (groups[of_body[b]].settles()) velocities[b] = momentum_of(model_.bodies[b], state).velocity();
  });
  for (std::size_t b = 0; b < velocities.size(); ++b) {
    groups[of_body[b]].all.add(masses_[b], velocities[b]);
    if (is_carried[b] != 0) groups[of_body[b]].carried.add(masses_[b], velocities[b]);
  }
}

void Sleep::finish(double step, std::span<const Index> penetrating, std::span<const Index> carried,
                   State& state) const {
  const std::size_t count = model_.bodies.size();
  state.rest_times.resize(count, 0);
  const std::vector<Pace> paces = paces_of(penetrating, state);
  if (std::all_of(paces.begin(), paces.end(), [](Pace pace) { return pace == Pace::kFast; })) {
    for (double& time : state.rest_times) time = std::min(time, 0.0);
    return;
  }
  const std::vector<Index> of_body = groups_of(state, step);
  std::vector<Group> groups(count);  // by their first bodies
  for (const Index g : of_body) ++groups[g].bodies;
  for (Index b = 0; b < std::ssize(of_body); ++b) {
    Group& group = groups[of_body[b]];
    group.time = std::min(group.time, rest_time_of(b, paces[b], group.bodies == 1, step, state));
  }
  std::vector<std::uint8_t> is_carried(count, 0);
  for (const Index v : carried)
    if (body_of_[v] != kNone) is_carried[body_of_[v]] = 1;
  add_up(is_carried, of_body, state, groups);
  parallel_for(std::ssize(paces), 1, [&](std::int64_t b) {
    const Group& group = groups[of_body[b]];
    const bool was_asleep = state.rest_times[b] >= kSleepTime && is_asleep_[b] != 0;
    if (state.rest_times[b] < 0) return;
    state.rest_times[b] = group.time;
    if (was_asleep || !group.settles()) return;
    const auto velocities =
        std::span(state.velocities).subspan(model_.bodies[b].first_vertex, model_.bodies[b].vertex_count);
    const double kept = 1 / (1 + kSettlingDamping * step);
    if (group.time >= kSleepTime) {
      std::fill(velocities.begin(), velocities.end(), Vec3::Zero());
    } else if (group.bodies > 1) {
      const Vec3 common = group.all.velocity(), of_feet = group.carried.mass > 0 ? group.carried.velocity() : common;
      const Vec3 left = of_feet + (common - of_feet) / (1 + kSwayDamping * step);
      for (Vec3& v : velocities) v = left + kept * (v - common);
    } else if (is_carried[b] != 0) {
      damp_spin(model_.bodies[b], kept, state);
    }
  });
}

}  // namespace selvage
