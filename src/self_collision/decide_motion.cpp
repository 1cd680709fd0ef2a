#include "self_collision/continuous_kernel.h"
#include "self_collision/moving_points.h"
#include "self_collision/pair_filter.h"

namespace selvage {

void decide_vertex_face(const ContinuousScene& scene, Index vertex, Index face, bool do_meet,
                        ContinuousResult& result) {
  if (scene.filter != nullptr && !scene.filter->keeps_vertex_face(vertex, face)) return;
  result.counters.exact_tests += !do_meet;
  if (!do_meet && !vertex_meets_face(moving_points(scene, vertex, face))) return;
  result.pairs.vertex_face.push_back({vertex, face});
  if (result.stop != nullptr) result.stop->store(true, std::memory_order_relaxed);
}

void decide_edge_edge(const ContinuousScene& scene, Index first, Index second, bool do_meet, ContinuousResult& result) {
  if (scene.filter != nullptr && !scene.filter->keeps_edges(first, second)) return;
  result.counters.exact_tests += !do_meet;
  if (!do_meet && !edge_meets_edge(moving_edges(scene, first, second))) return;
  result.pairs.edge_edge.push_back({first, second});
  if (result.stop != nullptr) result.stop->store(true, std::memory_order_relaxed);
}

}  // namespace selvage
