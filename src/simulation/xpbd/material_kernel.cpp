#include "simulation/xpbd/material_kernel.h"

#include "simulation/xpbd/element_solver.h"

namespace selvage {
inline namespace SELVAGE_ISA {

namespace {

/// XPBD's distance constraints.
template <bool kDamped, bool kFirst>
SELVAGE_INLINE void solve_springs(BlockVertices& copies, const MaterialStep& step, EdgeBatch& batch, int lane) {
  WideDouble a[4], b[4];
  load_rows(copies.of_now(), batch.offsets[0] + lane, a);
  load_rows(copies.of_now(), batch.offsets[1] + lane, b);
  const Wide3 edge = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  const WideDouble length = sqrt(dot(edge, edge)), divisor = max(length, constant(kMinDenominator));
  WideDouble residual = length - WideDouble::load(batch.length + lane);
  if constexpr (!kFirst) residual = residual + constant(step.edge) * WideDouble::load(batch.multiplier + lane);
  WideDouble weight = a[3] + b[3];
  if constexpr (kDamped) {
    WideDouble from[4], to[4];
    load_rows(copies.of_start(), batch.offsets[0] + lane, from);
    load_rows(copies.of_start(), batch.offsets[1] + lane, to);
    const Wide3 moved = {edge[0] - (to[0] - from[0]), edge[1] - (to[1] - from[1]), edge[2] - (to[2] - from[2])};
    residual = residual + constant(step.damping) * dot(edge, moved) / divisor;
    weight = constant(1 + step.damping) * weight;
  }
  const WideDouble change = constant(0) - residual / max(weight + constant(step.edge), constant(kMinDenominator));
  const WideDouble scale = change / divisor;
  WideDouble multiplier = change;
  if constexpr (!kFirst) multiplier = WideDouble::load(batch.multiplier + lane) + change;
  multiplier.store(batch.multiplier + lane);
  for (int i = 0; i < 3; ++i) {
    a[i] = a[i] - scale * a[3] * edge[i];
    b[i] = b[i] + scale * b[3] * edge[i];
  }
  store_rows(a, copies.of_now(), batch.offsets[0] + lane);
  store_rows(b, copies.of_now(), batch.offsets[1] + lane);
}

/// Number of batches by which prefetching is ahead.
constexpr Index kAhead = 3;

/// Prefetches the next batches and vertices: between two steps all of them leave the caches.
template <bool kDamped>
class Fetcher {
 public:
  Fetcher(const MaterialTask& task, const MaterialBlock& block, const MaterialBlock& next)
      : task_(task), block_(block), next_(next), place_(next.first_vertex) {
    const Index batches = std::max(block.last_element_batch - block.first_element_batch, 1);
    places_per_batch_ = (next.last_vertex - next.first_vertex + batches - 1) / batches;
  }

  /// The batch to fetch meanwhile.
  SELVAGE_INLINE const ElementBatch& batch_after(Index batch) const {
    const Index beyond = batch + kAhead - block_.last_element_batch;
    return task_.elements[beyond < 0 ? batch + kAhead
                                     : std::min(next_.first_element_batch + beyond, next_.last_element_batch - 1)];
  }

  SELVAGE_INLINE void fetch_vertices() {
    for (const Index end = std::min(place_ + places_per_batch_, next_.last_vertex); place_ < end; ++place_) {
      const Index v = task_.block_vertices[place_];
      prefetch(task_.vertices + v);
      if constexpr (kDamped) prefetch(task_.start + v);
    }
  }

 private:
  const MaterialTask& task_;
  const MaterialBlock &block_, &next_;
  Index place_, places_per_batch_;
};

template <bool kDamped, bool kFirst>
void solve_block(const MaterialTask& task, const MaterialBlock& block, const MaterialBlock& next,
                 BlockVertices& copies) {
  const MaterialStep& step = task.bodies[block.body];
  const std::span vertices(task.block_vertices + block.first_vertex, task.block_vertices + block.last_vertex);
  copies.load<kDamped>(task, vertices);
  for (Index n = block.first_edge_batch; n < block.last_edge_batch; ++n)
    for (int lane = 0; lane < kBatch; lane += WideDouble::kLanes)
      solve_springs<kDamped, kFirst>(copies, step, task.edges[n], lane);
  Fetcher<kDamped> fetcher(task, block, next);
  const auto solve_elements = [&](const auto& solver) {
    for (Index n = block.first_element_batch; n < block.last_element_batch; ++n) {
      fetcher.fetch_vertices();
      ElementBatch& batch = task.elements[n];
      const ElementBatch& next_batch = fetcher.batch_after(n);
      // Places of a batch are filled from the first on.
      const auto has_elements = [&](int lane) { return batch.offsets[0][lane] < kCopyLength * vertices.size(); };
      for (int lane = 0; lane < kBatch && has_elements(lane); lane += 2 * WideDouble::kLanes)
        if (const int second_lane = lane + WideDouble::kLanes; has_elements(second_lane))
          solver.solve(batch, lane, second_lane, next_batch);
        else
          solver.solve(batch, lane, next_batch);
    }
  };
  if (step.kind == MaterialKind::kNeoHookean)
    solve_elements(ElementSolver<true, kDamped, kFirst>(copies, step));
  else
    solve_elements(ElementSolver<false, kDamped, kFirst>(copies, step));
  copies.store(task, vertices);
}

}  // namespace

void solve_blocks(const MaterialTask& task, Index first, Index last) {
  BlockVertices copies;
  for (Index n = first; n < last; ++n) {
    const MaterialBlock& block = task.blocks[n];
    const MaterialBlock& next = task.blocks[n + 1 < last ? n + 1 : task.next_block];
    const bool damped = task.bodies[block.body].damping > 0;
    if (task.is_first)
      damped ? solve_block<true, true>(task, block, next, copies) : solve_block<false, true>(task, block, next, copies);
    else
      damped ? solve_block<true, false>(task, block, next, copies)
             : solve_block<false, false>(task, block, next, copies);
  }
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
