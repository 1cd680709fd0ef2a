#include "boundary_path/group_faces.h"
#include "boundary_path/group_guess.h"
#include "boundary_path/group_place.h"

namespace selvage {
inline namespace SELVAGE_ISA {

namespace {

template <int D>
void run_all(const PathScene<D>& scene, std::span<const PathTask<D>> tasks, std::size_t batch_size,
             PathResult<D>* results, PathCounters* counters) {
  GroupSearch<D> search(scene);
  for (std::size_t first = 0; first < tasks.size(); first += batch_size) {
    const std::size_t end = tasks.size() - first < batch_size ? tasks.size() : first + batch_size;
    search.forget();
    for (std::size_t i = first; i < end; ++i) {
      const Index element = tasks[i].query.element;
      prefetch(scene.elements + element);
      prefetch(scene.hints + element);
      prefetch(scene.component_of + element);
    }
    for (std::size_t i = first; i < end; i += kPointGroup)
      search.run(tasks.subspan(i, end - i < kPointGroup ? end - i : kPointGroup), results + i,
                 counters != nullptr ? counters + i : nullptr);
  }
}

}  // namespace

void search_paths(const PathScene<2>& scene, std::span<const PathTask<2>> tasks, std::size_t batch_size,
                  PathResult<2>* results, PathCounters* counters);
void search_paths(const PathScene<3>& scene, std::span<const PathTask<3>> tasks, std::size_t batch_size,
                  PathResult<3>* results, PathCounters* counters);

void search_paths(const PathScene<2>& scene, std::span<const PathTask<2>> tasks, std::size_t batch_size,
                  PathResult<2>* results, PathCounters* counters) {
  run_all(scene, tasks, batch_size, results, counters);
}

void search_paths(const PathScene<3>& scene, std::span<const PathTask<3>> tasks, std::size_t batch_size,
                  PathResult<3>* results, PathCounters* counters) {
  run_all(scene, tasks, batch_size, results, counters);
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
