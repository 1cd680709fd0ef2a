#include "self_collision/continuous/continuous_kernel.h"
#include "self_collision/surface/moving_points.h"
#include "self_collision/surface/pair_filter.h"

#include "selvage/geometry/moving_distance.h"

namespace selvage {

namespace {

bool do_meet_or_near(const ContinuousInput& input, Index vertex, Index face) {
  const MovingPoints points = moving_points(input, vertex, face);
  return vertex_meets_face(points) || vertex_comes_near_face(points, thickness_of(input, vertex, face));
}

bool do_edges_meet_or_near(const ContinuousInput& input, Index first, Index second) {
  const MovingPoints points = moving_edges(input, first, second);
  return edge_meets_edge(points) || edge_comes_near_edge(points, thickness_of_edges(input, first, second));
}

}  // namespace

void decide_vertex_face(const ContinuousInput& input, Index vertex, Index face, bool do_meet,
                        ContinuousResult& result) {
  if (input.filter != nullptr && !input.filter->keeps_vertex_face(vertex, face)) return;
  result.counters.exact_tests += !do_meet;
  if (!do_meet && !do_meet_or_near(input, vertex, face)) return;
  result.pairs.vertex_face.push_back({vertex, face});
  if (result.stop != nullptr) result.stop->store(true, std::memory_order_relaxed);
}

void append_near(ContinuousResult& result, int first_count, const FeaturePair& pair) {
  (first_count == 1 ? result.near_vertex_face : result.near_edge_edge).push_back(pair);
}

void decide_edge_edge(const ContinuousInput& input, Index first, Index second, bool do_meet, ContinuousResult& result) {
  if (input.filter != nullptr && !input.filter->keeps_edges(first, second)) return;
  result.counters.exact_tests += !do_meet;
  if (!do_meet && !do_edges_meet_or_near(input, first, second)) return;
  result.pairs.edge_edge.push_back({first, second});
  if (result.stop != nullptr) result.stop->store(true, std::memory_order_relaxed);
}

}  // namespace selvage
