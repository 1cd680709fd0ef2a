#include "boundary_path/search.h"

namespace selvage {
inline namespace SELVAGE_ISA {

namespace {

template <int D>
void run_all(const PathScene<D>& scene, std::span<const PathTask<D>> tasks, PathResult<D>* results,
             PathCounters* counters) {
  for (std::size_t i = 0; i < tasks.size(); ++i)
    results[i] = Search<D>(scene, tasks[i], counters != nullptr ? counters + i : nullptr).run();
}

}  // namespace

void search_paths(const PathScene<2>& scene, std::span<const PathTask<2>> tasks, PathResult<2>* results,
                  PathCounters* counters);
void search_paths(const PathScene<3>& scene, std::span<const PathTask<3>> tasks, PathResult<3>* results,
                  PathCounters* counters);

void search_paths(const PathScene<2>& scene, std::span<const PathTask<2>> tasks, PathResult<2>* results,
                  PathCounters* counters) {
  run_all(scene, tasks, results, counters);
}

void search_paths(const PathScene<3>& scene, std::span<const PathTask<3>> tasks, PathResult<3>* results,
                  PathCounters* counters) {
  run_all(scene, tasks, results, counters);
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
