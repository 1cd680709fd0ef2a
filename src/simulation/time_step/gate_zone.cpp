#include "simulation/time_step/gate_zone.h"

#include "simulation/rigid_motion.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <map>

namespace selvage {

namespace {

/// Sweeps over the touches of a zone that is bent.
constexpr int kSweeps = 30;
/// Touches of a carrier that lead the vertices around them: of more, evenly chosen ones do, or the cost of a body that
/// is pressed from all sides would grow with the square of its vertices.
constexpr int kMaxLeaders = 32;

/// Largest strain of a zone in a step, and times the longest way of what touches it that a vertex may go.
constexpr double kMaxStrain = 0.5, kMaxBeyond = 2;
/// Cosine of ways out of a collider above which they lead to one side.
constexpr double kOneSided = 0.5;
/// Part of a contact's gap by which touches may be off their ways.
constexpr double kOffWay = 0.5;
/// Square of the extent in a direction, against that of the widest, below which points do not tell a strain there.
constexpr double kFlat = 1e-12;

RigidMotion motion_of(const RigidTransform& carrier) {
  return {
      .linear = carrier.rotation - Eigen::Matrix3d::Identity(), .centre = Vec3::Zero(), .shift = carrier.translation};
}

/// The rigid displacement nearest to those of some vertices, with weights.
template <typename Mass, typename Way>
RigidMotion rigid_motion(std::span<const Index> vertices, const Step& step, Mass&& mass, Way&& way) {
  MomentumSums sums(step.positions[vertices.front()], way(vertices.front()));
  for (const Index v : vertices) sums.add(mass(v), step.positions[v], way(v));
  return sums.motion();
}

}  // namespace

Vec3 Carriers::way(Index carrier, const Step& step, const Vec3& place) const {
  const PreparedCollider* collider = keyframed(carrier);
  if (collider == nullptr) return motion_of(motions[carrier])(place);
  const Vec3 start = collider->motion.at(step.start_time).invert(place);
  return collider->motion.at(step.end_time)(collider->carry(start)) - place;
}

ZoneTouch touch_of_vertex(Index vertex, Index carrier, const Step& step, const Carriers& carriers) {
  const Vec3& place = step.positions[vertex];
  return {.count = 1,
          .vertices = {vertex},
          .weights = {1},
          .carrier = carrier,
          .point = place,
          .way = carriers.way(carrier, step, place)};
}

void GateZone::add(const ZoneTouch& touch) {
  touches_.push_back(touch);
  if (carrier_ == kNone || touch.carrier < carrier_) carrier_ = touch.carrier;
}

Vec3 GateZone::way_out(const Step& step, const Carriers& carriers) const {
  const Index collider = carrier_ == kNone ? kNone : carrier_ - carriers.of_collider(0);
  if (collider < 0) return Vec3::Zero();
  std::vector<Vec3> ways;
  for (const ZoneTouch& touch : touches_) {
    if (touch.carrier != carrier_) return Vec3::Zero();
    if (touch.count > 1) continue;
    const ColliderContactState& state = carriers.states[touch.vertices[0] * carriers.colliders.size() + collider];
    if (state.acts(step) && !state.waits && state.start_depth > 0)
      ways.push_back((state.start_depth - state.depth_left) * state.way_out);
  }
  Vec3 longest = Vec3::Zero();
  for (const Vec3& way : ways)
    if (way.norm() > longest.norm()) longest = way;
  const bool is_split = std::any_of(ways.begin(), ways.end(), [&](const Vec3& way) {
    return way.dot(longest) < kOneSided * way.norm() * longest.norm();
  });
  return is_split ? Vec3(Vec3::Zero()) : longest;
}

bool GateZone::is_torn(const Step& step, const Carriers& carriers, double least) const {
  return std::any_of(touches_.begin(), touches_.end(), [&](const ZoneTouch& touch) {
    if (touch.carrier == carrier_) return false;
    const Vec3 apart = touch.way - carriers.way(carrier_, step, touch.point);
    return apart.norm() > least * kContactGap * carriers.max_corrections[touch.vertices[0]];
  });
}

std::vector<GateZone::Leader> GateZone::leaders() const {
  std::map<Index, Index> counts;
  for (const ZoneTouch& touch : touches_) ++counts[touch.carrier];
  std::map<Index, Index> seen;
  std::vector<Leader> result;
  for (const ZoneTouch& touch : touches_) {
    const Index each = (counts[touch.carrier] + kMaxLeaders - 1) / kMaxLeaders;
    if (seen[touch.carrier]++ % each == 0) result.push_back({touch.point, touch.way, static_cast<double>(each)});
  }
  return result;
}

/// The affine displacement nearest to the ways of the touches, if these follow it: between two plates that close in,
/// say. However near to one another vertices of the zone are, it lets none meet.
std::optional<std::vector<Vec3>> GateZone::affine_ways(const Step& step, const Carriers& carriers) const {
  Vec3 centre = Vec3::Zero(), shift = Vec3::Zero();
  for (const ZoneTouch& touch : touches_) {
    centre += touch.point / static_cast<double>(touches_.size());
    shift += touch.way / static_cast<double>(touches_.size());
  }
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero(), moved = Eigen::Matrix3d::Zero();
  double longest = 0;
  for (const ZoneTouch& touch : touches_) {
    const Vec3 arm = touch.point - centre, way = touch.way - shift;
    spread += arm * arm.transpose();
    moved += way * arm.transpose();
    longest = std::max(longest, touch.way.norm());
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);
  Eigen::Matrix3d strain = Eigen::Matrix3d::Zero();
  for (int k = 0; k < 3; ++k) {
    const Vec3 axis = axes.eigenvectors().col(k);
    if (axes.eigenvalues()[k] > kFlat * axes.eigenvalues()[2])
      strain += moved * axis * axis.transpose() / axes.eigenvalues()[k];
  }
  const auto way_of = [&](const Vec3& place) { return Vec3(shift + strain * (place - centre)); };
  if (!(strain.norm() < kMaxStrain)) return {};
  for (const ZoneTouch& touch : touches_)
    if (!((way_of(touch.point) - touch.way).norm() <
          kOffWay * kContactGap * carriers.max_corrections[touch.vertices[0]]))
      return {};
  std::vector<Vec3> ways;
  for (const Index v : vertices) {
    ways.push_back(way_of(step.positions[v]));
    if (!(ways.back().norm() <= kMaxBeyond * longest)) return {};
  }
  return ways;
}

/// Vertices go with the touches around them, the nearest most. Some side by side, as sums of this many terms take long.
std::vector<Vec3> GateZone::led_ways(const Step& step, const Carriers& carriers) const {
  constexpr std::size_t kAtOnce = 8;
  const std::vector<Leader> leading = leaders();
  std::vector<Vec3> ways;
  for (std::size_t first = 0; first < vertices.size(); first += kAtOnce) {
    double at[3][kAtOnce], least[kAtOnce], sums[3][kAtOnce] = {}, weights[kAtOnce] = {};
    for (std::size_t i = 0; i < kAtOnce; ++i) {
      const Index v = vertices[std::min(first + i, vertices.size() - 1)];
      for (int k = 0; k < 3; ++k) at[k][i] = step.positions[v][k];
      least[i] = kContactGap * carriers.max_corrections[v];
    }
    for (const Leader& leader : leading)
      for (std::size_t i = 0; i < kAtOnce; ++i) {
        const double x = at[0][i] - leader.point[0], y = at[1][i] - leader.point[1], z = at[2][i] - leader.point[2];
        const double weight = leader.weight / std::max(x * x + y * y + z * z, least[i] * least[i]);
        for (int k = 0; k < 3; ++k) sums[k][i] += weight * leader.way[k];
        weights[i] += weight;
      }
    for (std::size_t i = 0; i < std::min(kAtOnce, vertices.size() - first); ++i)
      ways.emplace_back(sums[0][i] / weights[i], sums[1][i] / weights[i], sums[2][i] / weights[i]);
  }
  return ways;
}

/// Where no affine displacement does, vertices are led; then the touches are closed in turn.
std::vector<Vec3> GateZone::bent_ways(const Model& model, const Step& step, const Carriers& carriers) const {
  if (auto affine = affine_ways(step, carriers)) return *std::move(affine);
  std::vector<Vec3> ways = led_ways(step, carriers);
  std::vector<std::array<std::size_t, 3>> places;  // in `vertices`, of those that each touch names
  for (const ZoneTouch& touch : touches_) {
    std::array<std::size_t, 3>& place = places.emplace_back();
    for (int k = 0; k < touch.count; ++k)
      place[k] = std::lower_bound(vertices.begin(), vertices.end(), touch.vertices[k]) - vertices.begin();
  }
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (std::size_t i = 0; i < touches_.size(); ++i) {
      const ZoneTouch& touch = touches_[i];
      Vec3 error = touch.way;
      double squares = 0;
      for (int k = 0; k < touch.count; ++k) {
        error -= touch.weights[k] * ways[places[i][k]];
        if (model.inverse_masses[touch.vertices[k]] > 0) squares += touch.weights[k] * touch.weights[k];
      }
      for (int k = 0; k < touch.count; ++k)
        if (model.inverse_masses[touch.vertices[k]] > 0) ways[places[i][k]] += touch.weights[k] / squares * error;
    }
  return ways;
}

std::vector<Vec3> GateZone::base_ways(const Model& model, const Step& step, const Carriers& carriers,
                                      std::span<const Vec3> targets, ZoneBase base) const {
  std::vector<Vec3> ways;
  const auto carried = [&](Index v) { return carriers.way(carrier_, step, step.positions[v]); };
  RigidMotion motion;
  if (carrier_ != kNone && carriers.keyframed(carrier_) != nullptr) {
    if (base != ZoneBase::kRigid) {
      for (const Index v : vertices) ways.push_back(carried(v));
      return ways;
    }
    motion = rigid_motion(
        vertices, step, [](Index) { return 1.0; }, carried);
  } else if (carrier_ != kNone) {
    motion = motion_of(carriers.motions[carrier_]);
  } else if (base != ZoneBase::kStands) {
    motion = rigid_motion(
        vertices, step, [&](Index v) { return 1 / model.inverse_masses[v]; },
        [&](Index v) { return Vec3(targets[v] - step.positions[v]); });
    if (base == ZoneBase::kDrifts) motion.linear.setZero();
  }
  for (const Index v : vertices) ways.push_back(motion(step.positions[v]));
  return ways;
}

}  // namespace selvage
