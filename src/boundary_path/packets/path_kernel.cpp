#include "boundary_path/packets/distance_guess.h"
#include "boundary_path/packets/face_collector.h"
#include "boundary_path/packets/packet_locator.h"
#include "boundary_path/search/find_path_alone.h"

namespace selvage {
inline namespace SELVAGE_ISA {

namespace {

template <int D>
void run_all(const PathInput<D>& input, PathBatches<D>& batches) {
  PathBatch<D> batch = batches.next();
  if (batch.tasks.empty()) return;
  PacketSearch<D> search(input);
  for (; !batch.tasks.empty(); batch = batches.next()) {
    const std::size_t count = batch.tasks.size();
    search.forget();
    for (const PathTask<D>& task : batch.tasks) {
      prefetch(input.elements + task.query.element);
      prefetch(input.hints + task.query.element);
      prefetch(input.component_of + task.query.element);
    }
    for (std::size_t i = 0; i < count; i += kPacketSize)
      search.run(batch.tasks.subspan(i, count - i < kPacketSize ? count - i : kPacketSize), batch.results + i,
                 batch.counters != nullptr ? batch.counters + i : nullptr);
  }
}

template <int D>
void run_all_alone(const PathInput<D>& input, PathBatches<D>& batches) {
  for (PathBatch<D> batch = batches.next(); !batch.tasks.empty(); batch = batches.next())
    for (std::size_t i = 0; i < batch.tasks.size(); ++i)
      batch.results[i] = find_path_alone(input, batch.tasks[i].query);
}

}  // namespace

void search_paths_alone(const PathInput<2>& input, PathBatches<2>& batches);
void search_paths_alone(const PathInput<3>& input, PathBatches<3>& batches);

void search_paths_alone(const PathInput<2>& input, PathBatches<2>& batches) {
  run_all_alone(input, batches);
}

void search_paths_alone(const PathInput<3>& input, PathBatches<3>& batches) {
  run_all_alone(input, batches);
}

void search_paths(const PathInput<2>& input, PathBatches<2>& batches);
void search_paths(const PathInput<3>& input, PathBatches<3>& batches);

void search_paths(const PathInput<2>& input, PathBatches<2>& batches) {
  run_all(input, batches);
}

void search_paths(const PathInput<3>& input, PathBatches<3>& batches) {
  run_all(input, batches);
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
