#include "boundary_path/group_faces.h"
#include "boundary_path/group_guess.h"
#include "boundary_path/group_place.h"

namespace selvage {
inline namespace SELVAGE_ISA {

namespace {

template <int D>
void run_all(const PathScene<D>& scene, std::span<const PathTask<D>> tasks, PathResult<D>* results,
             PathCounters* counters) {
  for (const PathTask<D>& task : tasks) {
    prefetch(scene.elements + task.query.element);
    prefetch(scene.hints + task.query.element);
    prefetch(scene.component_of + task.query.element);
  }
  GroupSearch<D> search(scene);
  for (std::size_t i = 0; i < tasks.size(); i += kPointGroup) {
    const std::size_t left = tasks.size() - i;
    search.run(tasks.subspan(i, left < kPointGroup ? left : kPointGroup), results + i,
               counters != nullptr ? counters + i : nullptr);
  }
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
