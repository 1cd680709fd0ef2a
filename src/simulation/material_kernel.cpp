#include "simulation/material_kernel.h"

#include "selvage/core/simd_double.h"

#include <span>

namespace selvage {
inline namespace SELVAGE_ISA {

namespace {

using Wide3 = WideDouble[3];

/// Below this squared strain an element is at rest: what a sum of a few numbers near 1 can be off by, squared.
constexpr double kLeastSquaredStrain = 1e-30;
/// In place of a denominator of zero: that of a rigid constraint between pinned vertices, which nothing moves.
constexpr double kLeastDenominator = 1e-100;

SELVAGE_INLINE WideDouble constant(double x) {
  return WideDouble::broadcast(x);
}

SELVAGE_INLINE WideDouble dot(const Wide3& a, const Wide3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

SELVAGE_INLINE void cross(const Wide3& a, const Wide3& b, Wide3& r) {
  r[0] = a[1] * b[2] - a[2] * b[1];
  r[1] = a[2] * b[0] - a[0] * b[2];
  r[2] = a[0] * b[1] - a[1] * b[0];
}

/// The vertices of the block that is being solved, and those that stand in for missing ones.
struct BlockRows {
  /// A cache line: what is damped needs both.
  struct alignas(64) Row {
    VertexRow now, start;
  };
  Row rows[kBlockRows];

  SELVAGE_INLINE const double* of_now() const { return rows->now.position; }
  SELVAGE_INLINE double* of_now() { return rows->now.position; }
  SELVAGE_INLINE const double* of_start() const { return rows->start.position; }

  template <bool kDamped>
  void load(const MaterialTask& task, std::span<const Index> vertices) {
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      rows[i].now = task.vertices[vertices[i]];
      if constexpr (kDamped) rows[i].start = task.start[vertices[i]];
    }
    for (int k = 0; k < 4; ++k) {
      const VertexRow missing = {{double(k == 1), double(k == 2), double(k == 3)}, 0};
      rows[vertices.size() + k] = {missing, missing};
    }
  }

  void store(const MaterialTask& task, std::span<const Index> vertices) const {
    for (std::size_t i = 0; i < vertices.size(); ++i) task.vertices[vertices[i]] = rows[i].now;
  }
};
static_assert(sizeof(BlockRows::Row) == sizeof(double) * kRowLength);

/// How a constraint moves the vertices of its element: against its gradients (those of vertices 1 to 3 given, of 0
/// their sum the other way), by inverse mass.
struct Change {
  Wide3 gradients[3], sum;
  WideDouble scale;
};

/// The vertices of as many elements as there are lanes.
struct Corners {
  WideDouble x[4][4];  ///< position and inverse mass

  SELVAGE_INLINE Corners(const BlockRows& rows, const ElementBatch& batch, int part) {
    // Written out: a loop over so much would stay one.
    load_rows(rows.of_now(), batch.rows[0] + part, x[0]);
    load_rows(rows.of_now(), batch.rows[1] + part, x[1]);
    load_rows(rows.of_now(), batch.rows[2] + part, x[2]);
    load_rows(rows.of_now(), batch.rows[3] + part, x[3]);
  }

  /// The same, and the edges at the start of the step: each offset is used twice while it is in a register.
  SELVAGE_INLINE Corners(const BlockRows& rows, const ElementBatch& batch, int part, Wide3 (&start)[3]) {
    WideDouble first[4];
    load_rows(rows.of_now(), batch.rows[0] + part, x[0]);
    load_rows(rows.of_start(), batch.rows[0] + part, first);
    load_with_edge(rows, batch.rows[1] + part, first, x[1], start[0]);
    load_with_edge(rows, batch.rows[2] + part, first, x[2], start[1]);
    load_with_edge(rows, batch.rows[3] + part, first, x[3], start[2]);
  }

  SELVAGE_INLINE void store(double* rows, const ElementBatch& batch, int part) const {
    store_rows(x[0], rows, batch.rows[0] + part);
    store_rows(x[1], rows, batch.rows[1] + part);
    store_rows(x[2], rows, batch.rows[2] + part);
    store_rows(x[3], rows, batch.rows[3] + part);
  }

  SELVAGE_INLINE void list_edges(Wide3 (&edges)[3]) const {
    for (int k = 0; k < 3; ++k)
      for (int i = 0; i < 3; ++i) edges[k][i] = x[k + 1][i] - x[0][i];
  }

  SELVAGE_INLINE void move(const Change& by) {
    const WideDouble first_scale = by.scale * x[0][3];
    for (int i = 0; i < 3; ++i) x[0][i] = x[0][i] + first_scale * by.sum[i];
    for (int k = 0; k < 3; ++k) {
      const WideDouble own_scale = by.scale * x[k + 1][3];
      for (int i = 0; i < 3; ++i) x[k + 1][i] = x[k + 1][i] - own_scale * by.gradients[k][i];
    }
  }

  SELVAGE_INLINE WideDouble weigh(WideDouble of_first, const Wide3& others) const {
    return x[0][3] * of_first + x[1][3] * others[0] + x[2][3] * others[1] + x[3][3] * others[2];
  }

 private:
  SELVAGE_INLINE static void load_with_edge(const BlockRows& rows, const std::uint16_t* offsets,
                                            const WideDouble (&first)[4], WideDouble (&now)[4], Wide3& edge) {
    WideDouble start[4];
    load_rows(rows.of_now(), offsets, now);
    load_rows(rows.of_start(), offsets, start);
    for (int i = 0; i < 3; ++i) edge[i] = start[i] - first[i];
  }
};

/// Twice the areas of the faces at vertex 0, as vectors: the gradients of six volumes.
SELVAGE_INLINE void list_areas(const Wide3 (&edges)[3], Wide3 (&areas)[3]) {
  cross(edges[1], edges[2], areas[0]);
  cross(edges[2], edges[0], areas[1]);
  cross(edges[0], edges[1], areas[2]);
}

SELVAGE_INLINE void add_up(const Wide3 (&a)[3], Wide3& r) {
  for (int i = 0; i < 3; ++i) r[i] = a[0][i] + a[1][i] + a[2][i];
}

/// How a constraint of the element moves with the vertices: the gradients of all four weighed by inverse mass.
SELVAGE_INLINE WideDouble weigh_gradients(const Corners& corners, const Wide3 (&gradients)[3], const Wide3& sum) {
  const Wide3 squares = {dot(gradients[0], gradients[0]), dot(gradients[1], gradients[1]),
                         dot(gradients[2], gradients[2])};
  return corners.weigh(dot(sum, sum), squares);
}

/// Solves the deviatoric and the hydrostatic constraint of elements one after the other. XPBD, with one term more in
/// the denominator: a quarter of the squared residual times what the gradients weigh at rest. By it no vertex moves
/// farther than an element at rest is large, however flat the element is now and however small its gradients; near rest
/// it is nothing, and where the residual is zero it changes nothing.
template <bool kDeviatoric, bool kDamped, bool kFirst>
class ElementSolver {
 public:
  SELVAGE_INLINE ElementSolver(BlockRows& rows, const MaterialStep& step) : rows_(rows) {
    deviatoric_ = constant(step.deviatoric);
    hydrostatic_ = constant(step.hydrostatic);
    damping_ = constant(step.damping);
    share_ = constant(1 + step.damping);
  }

  /// Two parts of a batch, in turns. A constraint ends in a chain of operations that wait for one another, and the
  /// processor looks only so far ahead for what it can do meanwhile: what comes next must not wait for that chain, too.
  /// So vertices move only after something of the other part.
  SELVAGE_INLINE void solve(ElementBatch& batch, int first_part, int second_part) const {
    Elements a(rows_, batch, first_part);
    Change of_a, of_b;
    if constexpr (kDeviatoric) find_deviatoric(a, of_a);
    Elements b(rows_, batch, second_part);
    if constexpr (kDeviatoric) {
      a.corners.move(of_a);
      find_deviatoric(b, of_b);
    }
    find_hydrostatic(a, of_a);
    if constexpr (kDeviatoric) b.corners.move(of_b);
    finish(a, of_a);
    find_hydrostatic(b, of_b);
    finish(b, of_b);
  }

  /// One part alone. Not inlined: that would cost the other registers.
  [[gnu::noinline]] void solve(ElementBatch& batch, int part) const {
    Elements a(rows_, batch, part);
    Change change;
    if constexpr (kDeviatoric) {
      find_deviatoric(a, change);
      a.corners.move(change);
    }
    find_hydrostatic(a, change);
    finish(a, change);
  }

 private:
  /// As many as there are lanes, while they are solved.
  struct Elements {
    ElementBatch& batch;
    int part;
    Wide3 start[3];  ///< edges at the start of the step
    Corners corners;
    WideDouble weight;  ///< what the gradients of a constraint weigh at rest

    SELVAGE_INLINE Elements(const BlockRows& rows, ElementBatch& b, int p)
        : batch(b), part(p), corners(load(rows)), weight(rest_weight(corners, b, p)) {}

   private:
    SELVAGE_INLINE Corners load(const BlockRows& rows) {
      if constexpr (kDamped)
        return Corners(rows, batch, part, start);
      else
        return Corners(rows, batch, part);
    }
  };

  SELVAGE_INLINE static WideDouble rest_weight(const Corners& corners, const ElementBatch& batch, int part) {
    const auto gram = [&](int i) { return WideDouble::load(batch.gram[i] + part); };
    const Wide3 diagonal = {gram(0), gram(1), gram(2)};
    const WideDouble beside = gram(3) + gram(4) + gram(5);
    return corners.weigh(diagonal[0] + diagonal[1] + diagonal[2] + (beside + beside), diagonal);
  }

  /// The residual's part by damping.
  SELVAGE_INLINE WideDouble damp(const Wide3 (&gradients)[3], const Wide3 (&edges)[3], const Wide3 (&start)[3]) const {
    WideDouble rate = constant(0);
    for (int k = 0; k < 3; ++k) {
      const Wide3 moved = {edges[k][0] - start[k][0], edges[k][1] - start[k][1], edges[k][2] - start[k][2]};
      rate = rate + dot(gradients[k], moved);
    }
    return damping_ * rate;
  }

  // With S = C^2 and q = C grad C, the gradient of S / 2, all is multiplied by C, so that nothing is divided by it.
  SELVAGE_INLINE void find_deviatoric(const Elements& of, Change& change) const {
    ElementBatch& batch = of.batch;
    const int part = of.part;
    const auto gram = [&](int i) { return WideDouble::load(batch.gram[i] + part); };
    constexpr int kPlace[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
    auto& [gradients, sum, scale] = change;
    Wide3 edges[3], areas[3];
    of.corners.list_edges(edges);
    list_areas(edges, areas);
    const WideDouble inverse_volume = WideDouble::load(batch.inverse_volume + part);
    const WideDouble volume = inverse_volume * dot(edges[0], areas[0]);
    const WideDouble area_scale = (volume - constant(2)) * inverse_volume;
    WideDouble squared_norm = constant(0);
    for (int k = 0; k < 3; ++k) {
      for (int i = 0; i < 3; ++i)
        gradients[k][i] =
            gram(kPlace[k][0]) * edges[0][i] + gram(kPlace[k][1]) * edges[1][i] + gram(kPlace[k][2]) * edges[2][i];
      squared_norm = squared_norm + dot(edges[k], gradients[k]);
      for (int i = 0; i < 3; ++i) gradients[k][i] = gradients[k][i] + area_scale * areas[k][i];
    }
    add_up(gradients, sum);
    const WideDouble squared = max(squared_norm + (volume - constant(4)) * volume, constant(kLeastSquaredStrain));
    const WideDouble value = sqrt(squared), compliance = deviatoric_ * inverse_volume;
    WideDouble residual = squared;
    if constexpr (!kFirst) residual = residual + value * (compliance * WideDouble::load(batch.multipliers[0] + part));
    if constexpr (kDamped) residual = residual + damp(gradients, edges, of.start);
    const WideDouble stiffness = weigh_gradients(of.corners, gradients, sum);
    const WideDouble denominator = (kDamped ? share_ * stiffness : stiffness) + squared * compliance +
                                   constant(0.25) * (residual * residual) * of.weight;
    scale = residual / denominator;
    reduce_multiplier(batch.multipliers[0] + part, scale * value);
  }

  SELVAGE_INLINE void find_hydrostatic(const Elements& of, Change& change) const {
    ElementBatch& batch = of.batch;
    const int part = of.part;
    auto& [areas, sum, scale] = change;
    Wide3 edges[3];
    of.corners.list_edges(edges);
    list_areas(edges, areas);
    add_up(areas, sum);
    const WideDouble inverse_volume = WideDouble::load(batch.inverse_volume + part);
    WideDouble compliance = hydrostatic_ * inverse_volume;
    if constexpr (!kDeviatoric) compliance = compliance * inverse_volume;
    WideDouble residual = inverse_volume * dot(edges[0], areas[0]) - constant(1);
    if constexpr (!kFirst) residual = residual + compliance * WideDouble::load(batch.multipliers[1] + part);
    if constexpr (kDamped) residual = residual + inverse_volume * damp(areas, edges, of.start);
    const WideDouble stiffness = inverse_volume * inverse_volume * weigh_gradients(of.corners, areas, sum);
    const WideDouble denominator =
        (kDamped ? share_ * stiffness : stiffness) + compliance + constant(0.25) * (residual * residual) * of.weight;
    const WideDouble by = residual / max(denominator, constant(kLeastDenominator));
    reduce_multiplier(batch.multipliers[1] + part, by);
    scale = by * inverse_volume;
  }

  SELVAGE_INLINE void finish(Elements& of, const Change& change) const {
    of.corners.move(change);
    of.corners.store(rows_.of_now(), of.batch, of.part);  // at once, from registers
  }

  SELVAGE_INLINE static void reduce_multiplier(double* multiplier, WideDouble by) {
    const WideDouble before = kFirst ? constant(0) : WideDouble::load(multiplier);
    (before - by).store(multiplier);
  }

  BlockRows& rows_;
  WideDouble deviatoric_, hydrostatic_, damping_, share_;
};

/// XPBD's distance constraints.
template <bool kDamped, bool kFirst>
SELVAGE_INLINE void solve_springs(BlockRows& rows, const MaterialStep& step, EdgeBatch& batch, int part) {
  WideDouble a[4], b[4];
  load_rows(rows.of_now(), batch.rows[0] + part, a);
  load_rows(rows.of_now(), batch.rows[1] + part, b);
  const Wide3 edge = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  const WideDouble length = sqrt(dot(edge, edge)), divisor = max(length, constant(kLeastDenominator));
  WideDouble residual = length - WideDouble::load(batch.length + part);
  if constexpr (!kFirst) residual = residual + constant(step.edge) * WideDouble::load(batch.multiplier + part);
  WideDouble weight = a[3] + b[3];
  if constexpr (kDamped) {
    WideDouble from[4], to[4];
    load_rows(rows.of_start(), batch.rows[0] + part, from);
    load_rows(rows.of_start(), batch.rows[1] + part, to);
    const Wide3 moved = {edge[0] - (to[0] - from[0]), edge[1] - (to[1] - from[1]), edge[2] - (to[2] - from[2])};
    residual = residual + constant(step.damping) * dot(edge, moved) / divisor;
    weight = constant(1 + step.damping) * weight;
  }
  const WideDouble change = constant(0) - residual / max(weight + constant(step.edge), constant(kLeastDenominator));
  const WideDouble scale = change / divisor;
  WideDouble multiplier = change;
  if constexpr (!kFirst) multiplier = WideDouble::load(batch.multiplier + part) + change;
  multiplier.store(batch.multiplier + part);
  for (int i = 0; i < 3; ++i) {
    a[i] = a[i] - scale * a[3] * edge[i];
    b[i] = b[i] + scale * b[3] * edge[i];
  }
  store_rows(a, rows.of_now(), batch.rows[0] + part);
  store_rows(b, rows.of_now(), batch.rows[1] + part);
}

/// So many batches ahead the next are fetched.
constexpr Index kAhead = 2;

/// Fetches what comes next: between two steps all of it leaves the caches.
template <bool kDamped>
class Fetcher {
 public:
  Fetcher(const MaterialTask& task, const MaterialBlock& block, Index next)
      : task_(task), last_batch_(task.blocks[next].last_element_batch - 1) {
    const MaterialBlock& following = task.blocks[next];
    place_ = following.first_vertex;
    last_place_ = following.last_vertex;
    const Index batches = std::max(block.last_element_batch - block.first_element_batch, 1);
    places_per_batch_ = (last_place_ - place_ + batches - 1) / batches;
  }

  SELVAGE_INLINE void fetch(Index batch) {
    const auto* const lines = reinterpret_cast<const char*>(&task_.elements[std::min(batch + kAhead, last_batch_)]);
    for (std::size_t at = 0; at < sizeof(ElementBatch); at += 64) prefetch(lines + at);
    for (const Index end = std::min(place_ + places_per_batch_, last_place_); place_ < end; ++place_) {
      const Index v = task_.block_vertices[place_];
      prefetch(task_.vertices + v);
      if constexpr (kDamped) prefetch(task_.start + v);
    }
  }

 private:
  const MaterialTask& task_;
  Index last_batch_, place_, last_place_, places_per_batch_;
};

template <bool kDamped, bool kFirst>
void solve_block(const MaterialTask& task, const MaterialBlock& block, Index next, BlockRows& rows) {
  const MaterialStep& step = task.bodies[block.body];
  const std::span vertices(task.block_vertices + block.first_vertex, task.block_vertices + block.last_vertex);
  rows.load<kDamped>(task, vertices);
  for (Index n = block.first_edge_batch; n < block.last_edge_batch; ++n)
    for (int part = 0; part < kBatch; part += WideDouble::kLanes)
      solve_springs<kDamped, kFirst>(rows, step, task.edges[n], part);
  Fetcher<kDamped> fetcher(task, block, next);
  const auto solve_elements = [&](const auto& solver) {
    for (Index n = block.first_element_batch; n < block.last_element_batch; ++n) {
      fetcher.fetch(n);
      ElementBatch& batch = task.elements[n];
      // Places of a batch are filled from the first on.
      const auto has_elements = [&](int part) { return batch.rows[0][part] < kRowLength * vertices.size(); };
      for (int part = 0; part < kBatch && has_elements(part); part += 2 * WideDouble::kLanes)
        if (const int second_part = part + WideDouble::kLanes; has_elements(second_part))
          solver.solve(batch, part, second_part);
        else
          solver.solve(batch, part);
    }
  };
  if (step.kind == MaterialKind::kNeoHookean)
    solve_elements(ElementSolver<true, kDamped, kFirst>(rows, step));
  else
    solve_elements(ElementSolver<false, kDamped, kFirst>(rows, step));
  rows.store(task, vertices);
}

}  // namespace

void solve_blocks(const MaterialTask& task, Index first, Index last) {
  BlockRows rows;
  for (Index n = first; n < last; ++n) {
    const MaterialBlock& block = task.blocks[n];
    const Index next = n + 1 < task.block_count ? n + 1 : n;
    const bool damped = task.bodies[block.body].damping > 0;
    if (task.is_first)
      damped ? solve_block<true, true>(task, block, next, rows) : solve_block<false, true>(task, block, next, rows);
    else
      damped ? solve_block<true, false>(task, block, next, rows) : solve_block<false, false>(task, block, next, rows);
  }
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
