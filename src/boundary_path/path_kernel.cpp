#include "boundary_path/group_faces.h"
#include "boundary_path/group_guess.h"
#include "boundary_path/group_place.h"

namespace selvage {
inline namespace SELVAGE_ISA {

namespace {

template <int D>
void run_all(const PathScene<D>& scene, PathBatches<D>& batches) {
  PathBatch<D> batch = batches.next();
  if (batch.tasks.empty()) return;
  GroupSearch<D> search(scene);
  for (; !batch.tasks.empty(); batch = batches.next()) {
    const std::size_t count = batch.tasks.size();
    search.forget();
    for (const PathTask<D>& task : batch.tasks) {
      prefetch(scene.elements + task.query.element);
      prefetch(scene.hints + task.query.element);
      prefetch(scene.component_of + task.query.element);
    }
    for (std::size_t i = 0; i < count; i += kPointGroup)
      search.run(batch.tasks.subspan(i, count - i < kPointGroup ? count - i : kPointGroup), batch.results + i,
                 batch.counters != nullptr ? batch.counters + i : nullptr);
  }
}

}  // namespace

void search_paths(const PathScene<2>& scene, PathBatches<2>& batches);
void search_paths(const PathScene<3>& scene, PathBatches<3>& batches);

void search_paths(const PathScene<2>& scene, PathBatches<2>& batches) {
  run_all(scene, batches);
}

void search_paths(const PathScene<3>& scene, PathBatches<3>& batches) {
  run_all(scene, batches);
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
