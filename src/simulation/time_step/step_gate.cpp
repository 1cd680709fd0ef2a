#include "simulation/time_step/step_gate.h"

#include "core/parallel.h"
#include "elasticity/deformation_gradient.h"
#include "selvage/geometry/closest_point.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace selvage {

namespace {

/// Parts of its rest volume: below the first an element may lose at most half of its volume in a step, below the second
/// nothing. But after kBaseRounds the third part: where carriers close in, one of them would get into the zone else.
constexpr double kThinVolume = 0.02, kMinVolume = 0.002, kBentLoss = 0.1;
/// Part of its relative motion that a zone with a collapsing element keeps in the first rounds.
constexpr double kCollapseShare = 0.6;
/// Rounds in which a zone's motion is scaled by its first impact; then by kLaterShare; then nothing but its base motion
/// is left; of that the shift alone, with which a zone of a body in flight flies on; then nothing at all.
constexpr int kImpactRounds = 2, kScaledRounds = 4, kBaseRounds = 7, kDriftRounds = 30;
constexpr double kDrifts = -1, kStands = -2, kStandsAlways = -3;
/// Parts of the way out of a collider that a zone goes in the first round, and from round to round: elements beside it
/// may be thin.
constexpr double kPartOut = 0.1, kLaterPartOut = 0.5;
/// Rounds in which a zone is bent between carriers that move apart, or fewer if a round changes nothing. Later the
/// first of them carries it: the rounds end, and where there is no room the others get in a little, but no element
/// inverts.
constexpr int kBentRounds = 20;
/// In folds up to so many elements may be inverted in a step, or so many for each vertex there. Where a whole body is
/// inside itself, ways out lead through four elements for five vertices: all at once they would turn it inside out.
constexpr double kFewInFolds = 64, kFoldShare = 0.6;
/// Where more than one in so many vertices are inside colliders or would enter them, or elements between colliders that
/// move apart would collapse, a body has no room.
constexpr std::int64_t kCrushedShare = 20;
/// Rounding of positions against sizes of elements: farther away than their ratio the sign of a volume means nothing.
constexpr double kRounding = 0x1p-40;
constexpr int kVertexRow = sizeof(StepVertex) / sizeof(double);
constexpr double kImpactShare = 0.9, kLaterShare = 0.25;

/// Where two segments are nearest: the places on both, from 0 to 1. Of parallel ones any.
std::array<double, 2> nearest_places(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = b - a, v = d - c, w = a - c;
  const double uu = u.dot(u), uv = u.dot(v), vv = v.dot(v), uw = u.dot(w), vw = v.dot(w);
  const double sine = uu * vv - uv * uv;
  double s = sine > 0 ? std::clamp((uv * vw - vv * uw) / sine, 0.0, 1.0) : 0.5;
  const double t = vv > 0 ? std::clamp((uv * s + vw) / vv, 0.0, 1.0) : 0.5;
  s = uu > 0 ? std::clamp((uv * t - uw) / uu, 0.0, 1.0) : 0.5;
  return {s, t};
}

}  // namespace

StepGate::StepGate(const Model& model, Index contact_vertex_count, bool is_strict)
    : model_(model), is_strict_(is_strict) {
  const auto elements = model.mesh.elements();
  batches_.resize((elements.size() + kThinBatch - 1) / kThinBatch);
  is_thin_.resize(batches_.size());
  for (ThinBatch& batch : batches_) std::fill_n(batch.least, kThinBatch, -std::numeric_limits<double>::infinity());
  for (std::size_t e = 0; e < elements.size(); ++e) {
    ThinBatch& batch = batches_[e / kThinBatch];
    for (int k = 0; k < 4; ++k) batch.rows[k][e % kThinBatch] = kVertexRow * elements[e][k];
    rest_volumes_.push_back(element_volume(elements[e], model.rest_positions));
    batch.least[e % kThinBatch] = 6 * kThinVolume * rest_volumes_.back();
  }
  const auto count = static_cast<std::size_t>(model.mesh.vertex_count());
  candidate_.resize(contact_vertex_count);
  parents_.assign(count, kNone);
  entered_.assign(count, kNone);
  shares_.assign(count, 1);
  times_.assign(count, 1);
  ways_out_.assign(count, Vec3::Zero());
}

bool StepGate::is_violated(ContactFinder& finder, const Step& step, std::span<const StepVertex> vertices,
                           bool impacts_known) {
  for (const ZoneLink& link : links_) ways_out_[link.vertex].setZero();
  links_.clear();
  folded_.clear();
  find_collapsing_elements(0, step, vertices);
  if (!is_strict_) let_folds_invert(finder.folded_vertices());
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
  entries_ =
      selvage::find_entries(carriers.colliders, step, carriers.max_corrections, carriers.states, members_, vertices);
}

/// Of an element that is thin at the end of the step.
bool StepGate::is_collapsing(Index element, int round, const Step& step, std::span<const StepVertex> vertices) const {
  const auto& corners = model_.mesh.elements()[element];
  const Vec3 origin = position(vertices[corners[0]]);
  const Vec3 a = position(vertices[corners[1]]) - origin, b = position(vertices[corners[2]]) - origin,
             c = position(vertices[corners[3]]) - origin;
  const double volume = a.cross(b).dot(c) / 6, rest = rest_volumes_[element];
  const double least = round < kBaseRounds ? 1 : 1 - kBentLoss;
  const double kept = volume >= kThinVolume * rest ? 0 : volume >= kMinVolume * rest ? 0.5 : least;
  const double before = element_volume(corners, step.positions);
  return before > 0 && volume < kept * before && origin.cwiseAbs().maxCoeff() * kRounding < std::cbrt(rest);
}

void StepGate::find_collapsing_elements(int round, const Step& step, std::span<const StepVertex> vertices) {
  parallel_ranges(std::ssize(batches_), kGrain / kThinBatch, [&](std::int64_t first, std::int64_t last) {
    SELVAGE_DISPATCH(find_thin_batches, vertices.front().position, batches_.data(), first, last, is_thin_.data());
  });
  collapsing_.clear();
  for (std::size_t n = 0; n < batches_.size(); ++n) {
    if (!is_thin_[n]) continue;
    const auto end = std::min<std::size_t>((n + 1) * kThinBatch, model_.mesh.element_count());
    for (std::size_t e = n * kThinBatch; e < end; ++e)
      if (is_collapsing(static_cast<Index>(e), round, step, vertices) && !is_in_fold(static_cast<Index>(e)))
        collapsing_.push_back(static_cast<Index>(e));
  }
}

bool StepGate::is_in_fold(Index element) const {
  const auto& corners = model_.mesh.elements()[element];
  return !folded_.empty() && std::any_of(corners.begin(), corners.end(), [&](Index v) {
    return std::binary_search(folded_.begin(), folded_.end(), v);
  });
}

/// Of elements that are about to be inverted, leaves those in folds out for the rest of the step, or none.
void StepGate::let_folds_invert(std::span<const Index> folded_vertices) {
  folded_.assign(folded_vertices.begin(), folded_vertices.end());
  std::vector<Index> held;
  for (const Index e : collapsing_)
    if (!is_in_fold(e)) held.push_back(e);
  const double in_folds = static_cast<double>(collapsing_.size() - held.size());
  if (in_folds < std::max(kFewInFolds, kFoldShare * static_cast<double>(folded_.size()))) {
    collapsing_ = std::move(held);
  } else {
    folded_.clear();
  }
}

/// A guarantee asks for a way out as long as there may be one, and else for an end of the run.
bool StepGate::is_crushed(std::int64_t vertices_in_colliders) const {
  return !is_strict_ && kCrushedShare * vertices_in_colliders > model_.mesh.vertex_count();
}

bool StepGate::is_round_crushed() const {
  return (is_crushed_ && !(collapsing_.empty() && entries_.empty())) || is_crushed(std::ssize(entries_)) ||
         (!is_strict_ && is_any_torn_ && kCrushedShare * std::ssize(collapsing_) > model_.mesh.element_count());
}

Index StepGate::root_of(Index vertex) {
  while (parents_[vertex] != vertex) vertex = parents_[vertex] = parents_[parents_[vertex]];
  return vertex;
}

/// Puts vertices into one zone, in which something happens at a time. Those of colliders are not in it: two zones that
/// touch one collider stay two.
void StepGate::join(std::span<const Index> all, double time) {
  std::array<Index, 4> of_model{};
  int count = 0;
  for (const Index v : all)
    if (is_of_model(v)) of_model[count++] = v;
  const auto vertices = std::span(of_model).first(count);
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

/// Notes where two primitives, with weights of 1 in the first and -1 in the second together, touch.
void StepGate::touch(std::span<const Index> vertices, std::span<const double> weights, const Step& step,
                     const Carriers& carriers, std::span<const StepVertex> positions) {
  if (std::all_of(vertices.begin(), vertices.end(), [&](Index v) { return is_of_model(v); })) return;
  ZoneTouch touch;
  double of_model = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Index v = vertices[i];
    if (is_of_model(v)) {
      touch.vertices[touch.count] = v;
      touch.weights[touch.count++] = weights[i];
      of_model += weights[i];
    } else {
      touch.carrier = carriers.of_vertex[v];
      touch.point -= weights[i] * step.positions[v];
      touch.way -= weights[i] * (position(positions[v]) - step.positions[v]);
    }
  }
  if (of_model < 0) {
    touch.point = -touch.point;
    touch.way = -touch.way;
    for (double& w : touch.weights) w = -w;
  }
  touches_.push_back(touch);
}

void StepGate::join_violations(const TriangleMesh& surface, const Step& step, const Carriers& carriers,
                               std::span<const StepVertex> positions) {
  const auto at = [&](Index v, double time) {
    return Vec3(step.positions[v] + time * (candidate_[v] - step.positions[v]));
  };
  for (std::size_t i = 0; i < impacts_.pairs.vertex_face.size(); ++i) {
    const auto& [vertex, face] = impacts_.pairs.vertex_face[i];
    const auto& t = surface.triangles()[face];
    const std::array all{vertex, t[0], t[1], t[2]};
    const double time = impacts_.face_times[i];
    join(all, kImpactShare * time);
    const auto closest = closest_point_on_triangle(at(vertex, time), at(t[0], time), at(t[1], time), at(t[2], time));
    touch(all, std::array{1.0, -closest.barycentric[0], -closest.barycentric[1], -closest.barycentric[2]}, step,
          carriers, positions);
  }
  for (std::size_t i = 0; i < impacts_.pairs.edge_edge.size(); ++i) {
    const auto& a = surface.edges()[impacts_.pairs.edge_edge[i].first];
    const auto& b = surface.edges()[impacts_.pairs.edge_edge[i].second];
    const std::array all{a[0], a[1], b[0], b[1]};
    const double time = impacts_.edge_times[i];
    join(all, kImpactShare * time);
    const auto [s, t] = nearest_places(at(a[0], time), at(a[1], time), at(b[0], time), at(b[1], time));
    touch(all, std::array{1 - s, s, t - 1, -t}, step, carriers, positions);
  }
  for (const Index e : collapsing_) join(model_.mesh.elements()[e], kCollapseShare);
  for (const auto& [vertex, collider] : entries_) {
    join(std::array{vertex}, kCollapseShare);
    const Index carrier = carriers.of_collider(collider);
    if (carrier == carriers.of_vertex[vertex] || carrier == entered_[vertex]) continue;  // it is a touch already
    entered_[vertex] = carrier;
    touches_.push_back(touch_of_vertex(vertex, carrier, step, carriers));
  }
}

void StepGate::scale_zones(int round) {
  for (const Index v : members_) {
    if (parents_[v] != v || times_[v] == 1) continue;
    if (shares_[v] >= 0)
      shares_[v] *= round < kImpactRounds ? std::min(times_[v], kImpactShare) : round < kScaledRounds ? kLaterShare : 0;
    if (round >= kBaseRounds) shares_[v] = std::min(shares_[v], round < kDriftRounds ? kDrifts : kStands);
    times_[v] = 1;
  }
}

/// False: no vertex has moved.
bool StepGate::move_zones(int round, bool may_bend, const Step& step, const Carriers& carriers,
                          std::span<StepVertex> vertices) {
  std::map<Index, GateZone> zones;
  std::sort(members_.begin(), members_.end());
  for (const Index v : members_) zones[root_of(v)].vertices.push_back(v);
  for (auto& [root, zone] : zones) {
    if (shares_[root] == kStandsAlways) continue;
    for (const Index v : zone.vertices)
      if (carriers.of_vertex[v] != kNone) zone.add(touch_of_vertex(v, carriers.of_vertex[v], step, carriers));
  }
  for (const ZoneTouch& touch : touches_) {
    const Index root = root_of(touch.vertices[0]);
    if (shares_[root] != kStandsAlways) zones[root].add(touch);
  }
  const double part_out = kPartOut * std::pow(kLaterPartOut, std::min(round, kScaledRounds));
  bool any_moved = false;
  for (const auto& [root, zone] : zones) {
    const double share_of_root = shares_[root], share = std::max(share_of_root, 0.0);
    const ZoneBase base = share_of_root >= 0         ? ZoneBase::kRigid
                          : share_of_root == kDrifts ? ZoneBase::kDrifts
                                                     : ZoneBase::kStands;
    // What still meets in late rounds does so however little carriers move apart.
    const bool bends = may_bend && zone.is_torn(step, carriers, round < kBaseRounds ? 1 : 0);
    is_any_torn_ |= bends;
    const auto ways =
        bends ? zone.bent_ways(model_, step, carriers) : zone.base_ways(model_, step, carriers, targets_, base);
    const Vec3 out = base == ZoneBase::kStands ? Vec3(Vec3::Zero()) : Vec3(part_out * zone.way_out(step, carriers));
    for (std::size_t i = 0; i < ways.size(); ++i) {
      const Index v = zone.vertices[i];
      if (!(vertices[v].inverse_mass > 0)) continue;
      ways_out_[v] = out;
      const Vec3 from = step.positions[v] + ways[i] + out;
      const Vec3 to = from + share * (targets_[v] - from);
      any_moved |= position(vertices[v]) != to;
      for (int k = 0; k < 3; ++k) vertices[v].position[k] = to[k];
    }
  }
  return any_moved;
}

/// False: no zone drifts.
bool StepGate::stop_drifting() {
  bool any = false;
  for (const Index v : members_) {
    any |= shares_[v] == kDrifts;
    if (shares_[v] == kDrifts) shares_[v] = kStands;
  }
  return any;
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

GateStatistics StepGate::hold_back(ContactFinder& finder, const Step& step, const Carriers& carriers, bool is_crushed,
                                   std::span<StepVertex> vertices) {
  GateStatistics statistics;
  statistics.impacts_met = std::ssize(impacts_.pairs.vertex_face) + std::ssize(impacts_.pairs.edge_edge);
  statistics.collapsing = std::ssize(collapsing_);
  targets_.resize(vertices.size());
  parallel_for(std::ssize(vertices), kGrain, [&](std::int64_t v) { targets_[v] = position(vertices[v]); });
  bool are_impacts_known = true;
  is_any_torn_ = false;
  is_crushed_ = is_crushed;
  for (bool may_bend = true; has_violations(); ++statistics.rounds) {
    const auto round = static_cast<int>(statistics.rounds);
    join_violations(finder.surface(), step, carriers, vertices);
    scale_zones(round);
    may_bend &= round < kBentRounds && !(round > kImpactRounds && is_round_crushed());
    bool any_moved = move_zones(round, may_bend, step, carriers, vertices);
    if (!any_moved && round > kBaseRounds && stop_drifting())
      any_moved = move_zones(round, may_bend, step, carriers, vertices);
    if (!any_moved && round > kBaseRounds && are_impacts_known) {
      may_bend &= is_strict_;
      if (!is_strict_ || stop_carried_zones(finder.surface()))
        any_moved = move_zones(round, may_bend, step, carriers, vertices);
      if (!any_moved) break;
    }
    find_collapsing_elements(round, step, vertices);
    find_entries(step, carriers, vertices);
    are_impacts_known = !any_moved || !is_round_crushed();
    impacts_ = {};
    if (are_impacts_known) find_impacts(finder, vertices);
  }
  report_left(finder.surface(), statistics);
  entries_.clear();
  for (const Index v : members_) links_.push_back({v, shares_[root_of(v)] <= kStands ? kNone : root_of(v)});
  for (const ZoneTouch& touch : touches_) links_.push_back({touch.vertices[0], kNone});
  for (const Index v : members_) {
    statistics.held_back_vertices += position(vertices[v]) != targets_[v];
    parents_[v] = entered_[v] = kNone;
  }
  members_.clear();
  touches_.clear();
  return statistics;
}

}  // namespace selvage
