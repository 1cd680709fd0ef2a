#include "contact/impacts/impact_search.h"

#include "contact/input/collider_triangles.h"
#include "core/parallel.h"

#include <algorithm>

namespace selvage {

namespace {

constexpr std::int64_t kContactGrain = 1024;
/// Where more than one vertex in so many has moved, all is searched.
constexpr std::int64_t kMaxMovedShare = 8, kSample = 64;

template <typename Pair>
void insert_sorted(std::vector<Pair>& pairs, const std::vector<Pair>& more) {
  const auto middle = pairs.insert(pairs.end(), more.begin(), more.end());
  std::inplace_merge(pairs.begin(), middle, pairs.end());
}

template <typename Pair, typename Make>
void append_impacts(std::span<const Pair> pairs, std::span<const double> times, std::span<const Index> kept,
                    std::vector<Contact>& contacts, Make&& make) {
  std::vector<std::optional<Contact>> made(kept.size());
  parallel_for(std::ssize(kept), kContactGrain,
               [&](std::int64_t i) { made[i] = make(pairs[kept[i]], times[kept[i]]); });
  for (const auto& contact : made)
    if (contact) contacts.push_back(*contact);
}

}  // namespace

/// Of a sample.
bool ImpactSearch::have_most_moved(std::span<const Vec3> positions_t1) const {
  const auto count = std::ssize(positions_t1), asked = std::min<std::int64_t>(count, kSample);
  std::int64_t moved = 0;
  for (std::int64_t i = 0; i < asked; ++i) {
    const std::int64_t v = i * count / asked;
    moved += !(positions_t1[v] == last_ends_[v]);
  }
  return 2 * moved > asked;
}

/// Ascending.
std::vector<Index> ImpactSearch::list_moved(std::span<const Vec3> positions_t1) const {
  struct Moved {
    std::vector<Index> vertices;
    void add(const Moved& other) { vertices.insert(vertices.end(), other.vertices.begin(), other.vertices.end()); }
  };
  std::vector<Index> moved =
      parallel_reduce<Moved>(std::ssize(positions_t1), kGrain, [&](std::int64_t first, std::int64_t last, Moved& some) {
        for (std::int64_t v = first; v < last; ++v)
          if (!(positions_t1[v] == last_ends_[v])) some.vertices.push_back(static_cast<Index>(v));
      }).vertices;
  std::sort(moved.begin(), moved.end());
  return moved;
}

/// Of the pairs of the last call.
void ImpactSearch::keep_unmoved(std::span<const Index> moved) {
  has_moved_.resize(surface_.vertex_count());
  for (const Index v : moved) has_moved_[v] = 1;
  const auto any_moved = [&](std::span<const Index> vertices) {
    return std::any_of(vertices.begin(), vertices.end(), [&](Index v) { return has_moved_[v] != 0; });
  };
  std::erase_if(last_pairs_.vertex_face, [&](const VertexFacePair& p) {
    return has_moved_[p.vertex] != 0 || any_moved(surface_.triangles()[p.face]);
  });
  std::erase_if(last_pairs_.edge_edge, [&](const EdgeEdgePair& p) {
    return any_moved(surface_.edges()[p.first]) || any_moved(surface_.edges()[p.second]);
  });
  for (const Index v : moved) has_moved_[v] = 0;
}

ContinuousPairs ImpactSearch::find_pairs(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1,
                                         ContinuousCounters& counters) {
  if (is_known_ && !have_most_moved(positions_t1)) {
    const std::vector<Index> moved = list_moved(positions_t1);
    if (kMaxMovedShare * std::ssize(moved) <= surface_.vertex_count()) {
      if (moved.empty()) return last_pairs_;
      const ContinuousPairs found = finder_->move_ends(moved, positions_t1, &counters);
      keep_unmoved(moved);
      insert_sorted(last_pairs_.vertex_face, found.vertex_face);
      insert_sorted(last_pairs_.edge_edge, found.edge_edge);
      for (const Index v : moved) last_ends_[v] = positions_t1[v];
      return last_pairs_;
    }
  }
  if (finder_) {
    finder_->update(positions_t0, positions_t1);
  } else {
    finder_.emplace(surface_, positions_t0, positions_t1, options_with_colliders(body_faces_, surface_));
  }
  last_pairs_ = finder_->find_pairs(&counters);
  last_ends_.assign(positions_t1.begin(), positions_t1.end());
  is_known_ = true;
  return last_pairs_;
}

StepImpacts ImpactSearch::with_times(ContinuousPairs pairs) const {
  StepImpacts found;
  found.face_times = finder_->find_impact_times(pairs.vertex_face);
  found.edge_times = finder_->find_impact_times(pairs.edge_edge);
  found.pairs = std::move(pairs);
  return found;
}

void append_impact_contacts(const SurfaceStep& step, const StepImpacts& found, std::vector<Contact>& contacts) {
  const auto& [vertex_face, edge_edge] = found.pairs;
  append_impacts<VertexFacePair>(vertex_face, found.face_times, first_impacts(vertex_face, found.face_times), contacts,
                                 [&](auto pair, double time) { return vertex_face_contact(step, pair, time); });
  append_impacts<EdgeEdgePair>(edge_edge, found.edge_times,
                               first_impacts(edge_edge, found.edge_times, step.surface.edge_count()), contacts,
                               [&](auto pair, double time) { return edge_edge_contact(step, pair, time); });
}

}  // namespace selvage
