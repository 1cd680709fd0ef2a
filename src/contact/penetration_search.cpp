#include "contact/penetration_search.h"

#include "contact/clearance.h"
#include "contact/contact_parts.h"
#include "contact/edge_part.h"
#include "selvage/core/parallel.h"
#include "selvage/geometry/predicates.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

namespace selvage {

namespace {

constexpr std::int64_t kGroupsAtOnce = 16;
constexpr std::int64_t kFeaturesAtOnce = 64;

/// What a pose must cost in searches that a younger reference would spare, in features of the surface, to be worth one.
constexpr std::int64_t kPatience = 6;

/// Of the largest clearance that is looked for.
constexpr double kLeastClearance = 0.125;

}  // namespace

PenetrationSearch::PenetrationSearch(const TetMesh& mesh, const TriangleMesh& surface, bool with_edges,
                                     std::span<const Vec3> positions)
    : mesh_(mesh),
      surface_(surface),
      vertex_count_(static_cast<Index>(mesh.boundary_vertices().size())),
      positions_(positions.begin(), positions.end()),
      blocks_(mesh, positions) {
  for (const Index v : mesh.boundary_vertices()) features_.push_back({v, v});
  if (with_edges) features_.insert(features_.end(), surface.edges().begin(), surface.edges().end());
  clearances_.resize(features_.size());
  group_features();
  take_reference();
}

/// By the block of an element at the feature: what is in one group is near in space, and moves alike.
void PenetrationSearch::group_features() {
  const auto home = [&](Index f) {
    const Index face =
        is_edge(f) ? surface_.edge_triangles(edge_of(f)).front() : mesh_.vertex_boundary_faces(vertex_of(f)).front();
    return blocks_.block_of(mesh_.boundary_owners()[face].element());
  };
  members_first_.assign(blocks_.count() + 1, 0);
  for (Index f = 0; f < feature_count(); ++f) ++members_first_[home(f) + 1];
  std::partial_sum(members_first_.begin(), members_first_.end(), members_first_.begin());
  members_.resize(features_.size());
  std::vector<Index> next(members_first_);
  for (Index f = 0; f < feature_count(); ++f) members_[next[home(f)]++] = f;
}

std::span<Index> PenetrationSearch::members_of(Index group) {
  return std::span(members_).subspan(members_first_[group], members_first_[group + 1] - members_first_[group]);
}

std::span<const Index> PenetrationSearch::members_of(Index group) const {
  return std::span(members_).subspan(members_first_[group], members_first_[group + 1] - members_first_[group]);
}

void PenetrationSearch::place(std::span<const Vec3> positions) {
  positions_.assign(positions.begin(), positions.end());
  if (avoidable_ > kPatience * feature_count()) {
    take_reference();
  } else {
    blocks_.place(positions);
  }
}

void PenetrationSearch::take_reference() {
  blocks_.take_reference(positions_);
  parallel_for(feature_count(), kFeaturesAtOnce,
               [&](std::int64_t i) { clearances_[members_[i]] = clearance_of(members_[i]); });
  parallel_for(blocks_.count(), 64, [&](std::int64_t b) {
    const auto members = members_of(static_cast<Index>(b));
    std::sort(members.begin(), members.end(),
              [&](Index f, Index g) { return std::pair(clearances_[f], f) < std::pair(clearances_[g], g); });
  });
  avoidable_ = 0;
  ++references_;
}

/// No more than half of an edge there, so that few elements need be looked at; and 0 where it is so little that the
/// feature would soon be searched for again, whatever the reference.
float PenetrationSearch::clearance_of(Index feature) const {
  const auto& ends = features_[feature];
  const auto& face = mesh_.boundary_faces()[mesh_.vertex_boundary_faces(ends[0]).front()];
  const Index other = is_edge(feature) ? ends[1] : face[0] == ends[0] ? face[1] : face[0];
  const double most = (positions_[other] - positions_[ends[0]]).norm() / 2;
  if (!std::isfinite(most)) return 0;
  double clearance = most;
  const auto segment = corners_of(ends, positions_);
  const Range range = range_of(feature).grown(clearance);
  blocks_.visit_near(range, [&](Index block) {
    if (!(clearance > kLeastClearance * most)) return;
    blocks_.visit_elements(block, blocks_.in_reference(block, segment).grown(clearance), [&](Index element) {
      const auto& corners = mesh_.elements()[element];
      if (!(clearance > kLeastClearance * most) || share_vertex(ends, corners)) return;
      const double slack = blocks_.slack(block);
      clearance =
          std::min(clearance, distance_bound(segment, corners_of(corners, positions_), clearance + slack) - slack);
    });
  });
  return clearance > kLeastClearance * most ? round_down(clearance) : 0;
}

Range PenetrationSearch::range_of(Index feature) const {
  Range range;
  for (const Index v : features_[feature]) range.add(positions_[v]);
  return range;
}

std::vector<Penetration> PenetrationSearch::find_all(PenetrationCounters& counters) {
  std::vector<Findings> pieces((blocks_.count() + kGroupsAtOnce - 1) / kGroupsAtOnce);
  parallel_for(std::ssize(pieces), 1, [&](std::int64_t k) {
    const std::int64_t last = std::min<std::int64_t>((k + 1) * kGroupsAtOnce, blocks_.count());
    Scratch scratch;
    for (std::int64_t group = k * kGroupsAtOnce; group < last; ++group)
      search_group(static_cast<Index>(group), scratch, pieces[k]);
  });
  for (const Findings& findings : pieces) avoidable_ += findings.avoidable;
  counters.features += feature_count();
  counters.references_taken += std::exchange(references_, 0);
  return merge(pieces, counters);
}

std::vector<Penetration> PenetrationSearch::find(std::span<const Index> features, PenetrationCounters& counters) const {
  std::vector<Findings> pieces((features.size() + kFeaturesAtOnce - 1) / kFeaturesAtOnce);
  parallel_for(std::ssize(pieces), 1, [&](std::int64_t k) {
    const std::size_t last = std::min<std::size_t>((k + 1) * kFeaturesAtOnce, features.size());
    for (std::size_t i = k * kFeaturesAtOnce; i < last; ++i) search_near(features[i], pieces[k]);
  });
  counters.features += std::ssize(features);
  return merge(pieces, counters);
}

/// All features of a group are on the group's block, and move as that does: those whose clearance is more than that
/// differs from another block need not be looked at. Of the others, eight at a time, those that are near the block.
void PenetrationSearch::search_group(Index group, Scratch& scratch, Findings& findings) const {
  const auto members = members_of(group);
  if (members.empty()) return;
  scratch.near.clear();
  blocks_.visit_near(blocks_.extent(group), [&](Index block) {
    scratch.near.push_back({block, count_below(members, blocks_.difference_bound(group, block))});
  });
  Index most = 0;
  for (const auto& [block, count] : scratch.near) most = std::max(most, count);
  scratch.boxes.resize((most + 7) / 8);
  for (Index i = 0; i < most; ++i) scratch.boxes[i / 8].set(i % 8, range_of(members[i]).box());
  for (const auto& [block, count] : scratch.near) {
    const traversal::WideBox extent(blocks_.extent(block).box());
    for (Index first = 0; first < count; first += 8)
      for (unsigned rest = scratch.boxes[first / 8].meeting(0, extent); rest != 0; rest &= rest - 1)
        if (const Index i = first + lowest_lane(rest); i < count) search_block(members[i], block, findings);
  }
}

/// How many of a group's features, which are sorted, are not certainly clear of what has moved differently by a bound.
Index PenetrationSearch::count_below(std::span<const Index> members, double bound) const {
  const auto place =
      std::partition_point(members.begin(), members.end(), [&](Index f) { return !(bound < clearances_[f]); });
  return static_cast<Index>(place - members.begin());
}

void PenetrationSearch::search_near(Index feature, Findings& findings) const {
  blocks_.visit_near(range_of(feature), [&](Index block) { search_block(feature, block, findings); });
}

void PenetrationSearch::search_block(Index feature, Index block, Findings& findings) const {
  const float clearance = clearances_[feature];
  if (clearance > 0 && blocks_.difference_bound(features_[feature], positions_, block) < clearance) return;
  ++findings.counters.searched;
  findings.avoidable += clearance > 0;
  blocks_.visit_elements(block, blocks_.in_reference(block, corners_of(features_[feature], positions_)),
                         [&](Index element) {
                           if (!share_vertex(features_[feature], mesh_.elements()[element]))
                             test(feature, element, findings);
                         });
}

void PenetrationSearch::test(Index feature, Index element, Findings& findings) const {
  ++findings.counters.elements_tested;
  const auto corners = corners_of(mesh_.elements()[element], positions_);
  double middle = 0;
  if (is_edge(feature)) {
    const auto found = middle_of_part(corners_of(features_[feature], positions_), corners);
    if (!found) return;
    middle = *found;
  } else if (!locate_in_simplex<3>(corners, positions_[vertex_of(feature)]).inside) {
    return;
  }
  const auto& across = mesh_.neighbours()[element];
  const bool on_boundary = std::any_of(across.begin(), across.end(), [](Index n) { return n < 0; });
  if (on_boundary && orientation(corners) < 0) return;
  findings.found.push_back({feature, element, middle});
}

/// In order, and of an edge only the part closest to its middle; of equally close ones the first.
std::vector<Penetration> PenetrationSearch::merge(std::vector<Findings>& pieces, PenetrationCounters& counters) const {
  std::vector<Penetration> all;
  for (const Findings& findings : pieces) {
    counters += findings.counters;
    all.insert(all.end(), findings.found.begin(), findings.found.end());
  }
  const auto key = [&](const Penetration& p) { return std::tuple(p.feature, std::abs(p.middle - 0.5), p.element); };
  std::sort(all.begin(), all.end(), [&](const Penetration& a, const Penetration& b) { return key(a) < key(b); });
  const auto same_edge = [&](const Penetration& a, const Penetration& b) {
    return a.feature == b.feature && is_edge(a.feature);
  };
  all.erase(std::unique(all.begin(), all.end(), same_edge), all.end());
  return all;
}

}  // namespace selvage
