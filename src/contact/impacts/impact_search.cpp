#include "contact/impacts/impact_search.h"

#include "contact/input/collider_triangles.h"
#include "core/parallel.h"

namespace selvage {

namespace {

constexpr std::int64_t kContactGrain = 1024;

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

ContinuousPairs ImpactSearch::find_pairs(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1,
                                         ContinuousCounters& counters) {
  if (finder_) {
    finder_->update(positions_t0, positions_t1);
  } else {
    finder_.emplace(surface_, positions_t0, positions_t1, options_with_colliders(body_faces_, surface_));
  }
  return finder_->find_pairs(&counters);
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
