#include "simulation/time_step/step_gate.h"

#include "core/parallel.h"
#include "elasticity/deformation_gradient.h"
#include "simulation/rigid_motion.h"

#include <algorithm>
#include <map>

namespace selvage {

namespace {

/// Parts of its rest volume: below the first an element may lose at most half of its volume in a step, below the second
/// nothing.
constexpr double kThinVolume = 0.02, kMinVolume = 0.002;
/// Part of its relative motion that a zone with a collapsing element keeps in the first rounds.
constexpr double kCollapseShare = 0.6;
/// Rounds in which a zone's motion is scaled by its first impact; then by kLaterShare; then nothing but its base motion
/// is left; then nothing at all.
constexpr int kImpactRounds = 2, kScaledRounds = 4, kBaseRounds = 7;
constexpr double kStands = -1, kStandsAlways = -2;
/// Rounding of positions against sizes of elements: farther away than their ratio the sign of a volume means nothing.
constexpr double kRounding = 0x1p-40;
constexpr double kImpactShare = 0.9, kLaterShare = 0.25;

RigidMotion motion_of(const RigidTransform& carrier) {
  return {
      .linear = carrier.rotation - Eigen::Matrix3d::Identity(), .centre = Vec3::Zero(), .shift = carrier.translation};
}

}  // namespace

/// Sums over the vertices of a zone.
struct StepGate::Zone {
  Index carrier = kNone;  ///< the least
  std::vector<Index> vertices;

  void follow(Index other) {
    if (other != kNone && (carrier == kNone || other < carrier)) carrier = other;
  }

  /// The rigid displacement with the zone's momentum and angular momentum.
  RigidMotion free_motion(const Model& model, const Step& step, std::span<const Vec3> targets) const {
    const Index first = vertices.front();
    MomentumSums sums(step.positions[first], targets[first] - step.positions[first]);
    for (const Index v : vertices)
      sums.add(1 / model.inverse_masses[v], step.positions[v], targets[v] - step.positions[v]);
    return sums.motion();
  }

  /// The rigid displacement of a zone that a key-framed collider carries along.
  template <typename Carry>
  RigidMotion carried_motion(const Step& step, Carry&& carry) const {
    const Vec3& first = step.positions[vertices.front()];
    MomentumSums sums(first, carry(first) - first);
    for (const Index v : vertices) sums.add(1, step.positions[v], carry(step.positions[v]) - step.positions[v]);
    return sums.motion();
  }
};

StepGate::StepGate(const Model& model, Index contact_vertex_count, bool is_strict)
    : model_(model), is_strict_(is_strict) {
  rest_volumes_.reserve(model.mesh.element_count());
  for (const auto& element : model.mesh.elements())
    rest_volumes_.push_back(element_volume(element, model.rest_positions));
  const auto count = static_cast<std::size_t>(model.mesh.vertex_count());
  candidate_.resize(contact_vertex_count);
  parents_.assign(count, kNone);
  shares_.assign(count, 1);
  times_.assign(count, 1);
}

bool StepGate::is_violated(ContactFinder& finder, const Step& step, std::span<const StepVertex> vertices,
                           bool impacts_known) {
  find_collapsing_elements(step, vertices);
  if (impacts_known) {
    impacts_ = {};
  } else {
    find_impacts(finder, vertices);
  }
  return has_violations();
}

void StepGate::find_impacts(ContactFinder& finder, std::span<const StepVertex> vertices) {
  parallel_for(std::ssize(vertices), kGrain, [&](std::int64_t v) { candidate_[v] = position(vertices[v]); });
  impacts_ = finder.find_impacts(candidate_);
}

void StepGate::find_entries(const Step& step, const Carriers& carriers, std::span<const StepVertex> vertices) {
  entries_ = selvage::find_entries(carriers.colliders, step, carriers.max_corrections, members_, vertices);
}

void StepGate::find_collapsing_elements(const Step& step, std::span<const StepVertex> vertices) {
  const auto elements = model_.mesh.elements();
  struct Found {
    std::vector<Index> elements;
    void add(const Found& other) { elements.insert(elements.end(), other.elements.begin(), other.elements.end()); }
  };
  Found found =
      parallel_reduce<Found>(std::ssize(elements), kGrain, [&](std::int64_t first, std::int64_t last, Found& result) {
        for (std::int64_t e = first; e < last; ++e) {
          const auto& element = elements[e];
          const Vec3 origin = position(vertices[element[0]]);
          const Vec3 a = position(vertices[element[1]]) - origin, b = position(vertices[element[2]]) - origin,
                     c = position(vertices[element[3]]) - origin;
          const double volume = a.cross(b).dot(c) / 6;
          if (volume >= kThinVolume * rest_volumes_[e]) continue;
          const double before = element_volume(element, step.positions);
          const double kept = volume >= kMinVolume * rest_volumes_[e] ? 0.5 : 1;
          const bool collapses = before > 0 && volume < kept * before;
          if (collapses && origin.cwiseAbs().maxCoeff() * kRounding < std::cbrt(rest_volumes_[e]))
            result.elements.push_back(static_cast<Index>(e));
        }
      });
  std::sort(found.elements.begin(), found.elements.end());
  collapsing_ = std::move(found.elements);
}

Index StepGate::root_of(Index vertex) {
  while (parents_[vertex] != vertex) vertex = parents_[vertex] = parents_[parents_[vertex]];
  return vertex;
}

/// Puts vertices into one zone, in which something happens at a time. Those of colliders are not in it: two zones that
/// touch one collider stay two.
void StepGate::join(std::span<const Index> all, double time, const Carriers& carriers) {
  std::array<Index, 4> of_model{};
  int count = 0;
  for (const Index v : all)
    if (is_of_model(v)) of_model[count++] = v;
  const auto vertices = std::span(of_model).first(count);
  for (const Index v : all)
    if (!is_of_model(v)) touched_.push_back({vertices.front(), carriers.of_vertex[v]});
  for (const Index v : vertices) {
    if (parents_[v] != kNone) continue;
    parents_[v] = v;
    shares_[v] = times_[v] = 1;
    members_.push_back(v);
  }
  const Index root = root_of(vertices.front());
  for (const Index v : vertices) {
    const Index other = root_of(v);
    if (other == root) continue;
    parents_[other] = root;
    shares_[root] = std::min(shares_[root], shares_[other]);
    times_[root] = std::min(times_[root], times_[other]);
  }
  times_[root] = std::min(times_[root], time);
}

void StepGate::join_violations(const TriangleMesh& surface, const Carriers& carriers) {
  for (std::size_t i = 0; i < impacts_.pairs.vertex_face.size(); ++i) {
    const auto& [vertex, face] = impacts_.pairs.vertex_face[i];
    const auto& t = surface.triangles()[face];
    join(std::array{vertex, t[0], t[1], t[2]}, kImpactShare * impacts_.face_times[i], carriers);
  }
  for (std::size_t i = 0; i < impacts_.pairs.edge_edge.size(); ++i) {
    const auto& a = surface.edges()[impacts_.pairs.edge_edge[i].first];
    const auto& b = surface.edges()[impacts_.pairs.edge_edge[i].second];
    join(std::array{a[0], a[1], b[0], b[1]}, kImpactShare * impacts_.edge_times[i], carriers);
  }
  for (const Index e : collapsing_) join(model_.mesh.elements()[e], kCollapseShare, carriers);
  for (const auto& [vertex, collider] : entries_) {
    join(std::array{vertex}, kCollapseShare, carriers);
    touched_.push_back({vertex, carriers.of_collider(collider)});
  }
}

void StepGate::scale_zones(int round) {
  for (const Index v : members_) {
    if (parents_[v] != v || times_[v] == 1) continue;
    if (shares_[v] >= 0)
      shares_[v] *= round < kImpactRounds ? std::min(times_[v], kImpactShare) : round < kScaledRounds ? kLaterShare : 0;
    if (round >= kBaseRounds) shares_[v] = std::min(shares_[v], kStands);
    times_[v] = 1;
  }
}

/// False: no vertex has moved.
bool StepGate::move_zones(const Step& step, const Carriers& carriers, std::span<StepVertex> vertices) {
  std::map<Index, Zone> zones;
  for (const Index v : members_) {
    Zone& zone = zones[root_of(v)];
    zone.vertices.push_back(v);
    zone.follow(carriers.of_vertex[v]);
  }
  for (const auto& [v, carrier] : touched_) zones[root_of(v)].follow(carrier);
  bool any_moved = false;
  for (const auto& [root, zone] : zones) {
    const bool stands = shares_[root] < 0;
    const double share = std::max(shares_[root], 0.0);
    RigidMotion base;
    const bool is_carried = zone.carrier != kNone && shares_[root] != kStandsAlways;
    const PreparedCollider* keyframed = is_carried ? carriers.keyframed(zone.carrier) : nullptr;
    const auto carry = [&](const Vec3& p) {
      return keyframed->motion.at(step.end_time)(keyframed->carry(keyframed->motion.at(step.start_time).invert(p)));
    };
    if (keyframed != nullptr) {
      base = zone.carried_motion(step, carry);
    } else if (is_carried) {
      base = motion_of(carriers.motions[zone.carrier]);
    } else if (!stands) {
      base = zone.free_motion(model_, step, targets_);
    }
    for (const Index v : zone.vertices) {
      if (!(vertices[v].inverse_mass > 0)) continue;
      const Vec3 from =
          keyframed != nullptr && stands ? carry(step.positions[v]) : Vec3(step.positions[v] + base(step.positions[v]));
      const Vec3 to = from + share * (targets_[v] - from);
      any_moved |= position(vertices[v]) != to;
      for (int i = 0; i < 3; ++i) vertices[v].position[i] = to[i];
    }
  }
  return any_moved;
}

/// Lets zones in which something meets, or that enter colliders, stand always. False: all do already.
bool StepGate::stop_carried_zones(const TriangleMesh& surface) {
  bool any = false;
  const auto stop = [&](std::span<const Index> vertices) {
    for (const Index v : vertices) {
      if (!is_of_model(v) || parents_[v] == kNone) continue;
      double& share = shares_[root_of(v)];
      any |= share != kStandsAlways;
      share = kStandsAlways;
    }
  };
  for (const auto& [vertex, face] : impacts_.pairs.vertex_face) {
    stop({&vertex, 1});
    stop(surface.triangles()[face]);
  }
  for (const auto& [first, second] : impacts_.pairs.edge_edge) {
    stop(surface.edges()[first]);
    stop(surface.edges()[second]);
  }
  for (const ColliderEntry& entry : entries_) stop({&entry.vertex, 1});
  return any;
}

void StepGate::report_left(const TriangleMesh& surface, GateStatistics& statistics) const {
  const auto& [vertex_face, edge_edge] = impacts_.pairs;
  statistics.impacts_left = std::ssize(vertex_face) + std::ssize(edge_edge);
  statistics.entries_left = std::ssize(entries_);
  if (!vertex_face.empty()) {
    const auto& t = surface.triangles()[vertex_face[0].face];
    statistics.left = {vertex_face[0].vertex, t[0], t[1], t[2]};
  } else if (!edge_edge.empty()) {
    const auto &a = surface.edges()[edge_edge[0].first], &b = surface.edges()[edge_edge[0].second];
    statistics.left = {a[0], a[1], b[0], b[1]};
  } else if (!entries_.empty()) {
    statistics.left[0] = entries_[0].vertex;
  }
}

GateStatistics StepGate::hold_back(ContactFinder& finder, const Step& step, const Carriers& carriers,
                                   std::span<StepVertex> vertices) {
  GateStatistics statistics;
  statistics.impacts_met = std::ssize(impacts_.pairs.vertex_face) + std::ssize(impacts_.pairs.edge_edge);
  statistics.collapsing = std::ssize(collapsing_);
  targets_.resize(vertices.size());
  parallel_for(std::ssize(vertices), kGrain, [&](std::int64_t v) { targets_[v] = position(vertices[v]); });
  for (; has_violations(); ++statistics.rounds) {
    join_violations(finder.surface(), carriers);
    scale_zones(static_cast<int>(statistics.rounds));
    const bool any_moved = move_zones(step, carriers, vertices);
    if (!any_moved && statistics.rounds > kBaseRounds &&
        !(is_strict_ && stop_carried_zones(finder.surface()) && move_zones(step, carriers, vertices)))
      break;
    find_collapsing_elements(step, vertices);
    find_impacts(finder, vertices);
    find_entries(step, carriers, vertices);
  }
  report_left(finder.surface(), statistics);
  entries_.clear();
  for (const Index v : members_) {
    statistics.held_back_vertices += position(vertices[v]) != targets_[v];
    parents_[v] = kNone;
  }
  members_.clear();
  touched_.clear();
  return statistics;
}

}  // namespace selvage
