#include "simulation/material_kernel.h"

#include "selvage/core/simd_double.h"

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

SELVAGE_INLINE const double* rows_of(const VertexRow* vertices) {
  return vertices->position;
}
SELVAGE_INLINE double* rows_of(VertexRow* vertices) {
  return vertices->position;
}

/// As many elements as there are lanes.
struct Corners {
  WideDouble x[4][4];  ///< position and inverse mass

  SELVAGE_INLINE Corners(const VertexRow* vertices, const ElementBatch& batch, int part) {
    for (int k = 0; k < 4; ++k) load_rows(rows_of(vertices), batch.vertices[k] + part, x[k]);
  }

  SELVAGE_INLINE void store(VertexRow* vertices, const ElementBatch& batch, int part) const {
    for (int k = 0; k < 4; ++k) store_rows(x[k], rows_of(vertices), batch.vertices[k] + part);
  }

  SELVAGE_INLINE void list_edges(Wide3 (&edges)[3]) const {
    for (int k = 0; k < 3; ++k)
      for (int i = 0; i < 3; ++i) edges[k][i] = x[k + 1][i] - x[0][i];
  }

  /// Moves vertices along the gradients (those of vertices 1 to 3 given, of 0 their negated sum), by inverse mass.
  SELVAGE_INLINE void move(const Wide3 (&gradients)[3], const Wide3& of_first, WideDouble scale) {
    const WideDouble first_scale = scale * x[0][3];
    for (int i = 0; i < 3; ++i) x[0][i] = x[0][i] + first_scale * of_first[i];
    for (int k = 0; k < 3; ++k) {
      const WideDouble own_scale = scale * x[k + 1][3];
      for (int i = 0; i < 3; ++i) x[k + 1][i] = x[k + 1][i] + own_scale * gradients[k][i];
    }
  }

  SELVAGE_INLINE WideDouble weigh(WideDouble of_first, const Wide3& others) const {
    return x[0][3] * of_first + x[1][3] * others[0] + x[2][3] * others[1] + x[3][3] * others[2];
  }
};

/// Twice the areas of the faces at vertex 0, as vectors: the gradients of six volumes.
SELVAGE_INLINE void list_areas(const Wide3 (&edges)[3], Wide3 (&areas)[3]) {
  cross(edges[1], edges[2], areas[0]);
  cross(edges[2], edges[0], areas[1]);
  cross(edges[0], edges[1], areas[2]);
}

SELVAGE_INLINE void negate_sum(const Wide3 (&a)[3], Wide3& r) {
  for (int i = 0; i < 3; ++i) r[i] = constant(0) - (a[0][i] + a[1][i] + a[2][i]);
}

/// How a constraint of the element moves with the vertices: the gradients of all four weighed by inverse mass.
SELVAGE_INLINE WideDouble weigh_gradients(const Corners& corners, const Wide3 (&gradients)[3], const Wide3& of_first) {
  const Wide3 squares = {dot(gradients[0], gradients[0]), dot(gradients[1], gradients[1]),
                         dot(gradients[2], gradients[2])};
  return corners.weigh(dot(of_first, of_first), squares);
}

/// Solves the deviatoric and the hydrostatic constraint of elements one after the other. XPBD, with one term more in
/// the denominator: a quarter of the squared residual times what the gradients weigh at rest. By it no vertex moves
/// farther than an element at rest is large, however flat the element is now and however small its gradients; near rest
/// it is nothing, and where the residual is zero it changes nothing.
template <bool kDeviatoric, bool kDamped, bool kFirst>
class ElementSolver {
 public:
  SELVAGE_INLINE ElementSolver(const MaterialTask& task, const MaterialStep& step) : task_(task) {
    deviatoric_ = constant(step.deviatoric);
    hydrostatic_ = constant(step.hydrostatic);
    damping_ = constant(step.damping);
    share_ = constant(1 + step.damping);
  }

  SELVAGE_INLINE void solve(ElementBatch& batch, int part) const {
    Corners corners(task_.vertices, batch, part);
    Wide3 edges[3], start[3], areas[3];
    if constexpr (kDamped) Corners(task_.start, batch, part).list_edges(start);
    const WideDouble weight = rest_weight(corners, batch, part);
    if constexpr (kDeviatoric) {
      corners.list_edges(edges);
      list_areas(edges, areas);
      solve_deviatoric(batch, part, corners, edges, start, areas, weight);
    }
    corners.list_edges(edges);
    list_areas(edges, areas);
    solve_hydrostatic(batch, part, corners, edges, start, areas, weight);
    corners.store(task_.vertices, batch, part);
  }

 private:
  /// What the gradients of a constraint weigh at rest.
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
  SELVAGE_INLINE void solve_deviatoric(ElementBatch& batch, int part, Corners& corners, const Wide3 (&edges)[3],
                                       const Wide3 (&start)[3], const Wide3 (&areas)[3], WideDouble weight) const {
    const auto gram = [&](int i) { return WideDouble::load(batch.gram[i] + part); };
    constexpr int kPlace[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
    const WideDouble inverse_volume = WideDouble::load(batch.inverse_volume + part);
    const WideDouble volume = inverse_volume * dot(edges[0], areas[0]);
    const WideDouble area_scale = (volume - constant(2)) * inverse_volume;
    Wide3 gradients[3], of_first;
    WideDouble squared_norm = constant(0);
    for (int k = 0; k < 3; ++k) {
      for (int i = 0; i < 3; ++i)
        gradients[k][i] =
            gram(kPlace[k][0]) * edges[0][i] + gram(kPlace[k][1]) * edges[1][i] + gram(kPlace[k][2]) * edges[2][i];
      squared_norm = squared_norm + dot(edges[k], gradients[k]);
      for (int i = 0; i < 3; ++i) gradients[k][i] = gradients[k][i] + area_scale * areas[k][i];
    }
    negate_sum(gradients, of_first);
    const WideDouble squared = max(squared_norm + (volume - constant(4)) * volume, constant(kLeastSquaredStrain));
    const WideDouble value = sqrt(squared), compliance = deviatoric_ * inverse_volume;
    WideDouble residual = squared;
    if constexpr (!kFirst) residual = residual + value * (compliance * WideDouble::load(batch.multipliers[0] + part));
    if constexpr (kDamped) residual = residual + damp(gradients, edges, start);
    const WideDouble stiffness = weigh_gradients(corners, gradients, of_first);
    const WideDouble denominator = (kDamped ? share_ * stiffness : stiffness) + squared * compliance +
                                   constant(0.25) * (residual * residual) * weight;
    const WideDouble scale = constant(0) - residual / denominator;
    add_multiplier(batch.multipliers[0] + part, scale * value);
    corners.move(gradients, of_first, scale);
  }

  SELVAGE_INLINE void solve_hydrostatic(ElementBatch& batch, int part, Corners& corners, const Wide3 (&edges)[3],
                                        const Wide3 (&start)[3], const Wide3 (&areas)[3], WideDouble weight) const {
    const WideDouble inverse_volume = WideDouble::load(batch.inverse_volume + part);
    WideDouble compliance = hydrostatic_ * inverse_volume;
    if constexpr (!kDeviatoric) compliance = compliance * inverse_volume;
    Wide3 gradients[3], of_first;
    for (int k = 0; k < 3; ++k)
      for (int i = 0; i < 3; ++i) gradients[k][i] = inverse_volume * areas[k][i];
    negate_sum(gradients, of_first);
    WideDouble residual = inverse_volume * dot(edges[0], areas[0]) - constant(1);
    if constexpr (!kFirst) residual = residual + compliance * WideDouble::load(batch.multipliers[1] + part);
    if constexpr (kDamped) residual = residual + damp(gradients, edges, start);
    const WideDouble stiffness = weigh_gradients(corners, gradients, of_first);
    const WideDouble denominator =
        (kDamped ? share_ * stiffness : stiffness) + compliance + constant(0.25) * (residual * residual) * weight;
    const WideDouble scale = constant(0) - residual / max(denominator, constant(kLeastDenominator));
    add_multiplier(batch.multipliers[1] + part, scale);
    corners.move(gradients, of_first, scale);
  }

  SELVAGE_INLINE static void add_multiplier(double* multiplier, WideDouble change) {
    if constexpr (!kFirst) change = WideDouble::load(multiplier) + change;
    change.store(multiplier);
  }

  const MaterialTask& task_;
  WideDouble deviatoric_, hydrostatic_, damping_, share_;
};

/// XPBD's distance constraints.
template <bool kDamped, bool kFirst>
SELVAGE_INLINE void solve_springs(const MaterialTask& task, const MaterialStep& step, EdgeBatch& batch, int part) {
  WideDouble a[4], b[4];
  load_rows(rows_of(task.vertices), batch.vertices[0] + part, a);
  load_rows(rows_of(task.vertices), batch.vertices[1] + part, b);
  const Wide3 edge = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  const WideDouble length = sqrt(dot(edge, edge)), divisor = max(length, constant(kLeastDenominator));
  WideDouble residual = length - WideDouble::load(batch.length + part);
  if constexpr (!kFirst) residual = residual + constant(step.edge) * WideDouble::load(batch.multiplier + part);
  WideDouble weight = a[3] + b[3];
  if constexpr (kDamped) {
    WideDouble from[4], to[4];
    load_rows(rows_of(task.start), batch.vertices[0] + part, from);
    load_rows(rows_of(task.start), batch.vertices[1] + part, to);
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
  store_rows(a, rows_of(task.vertices), batch.vertices[0] + part);
  store_rows(b, rows_of(task.vertices), batch.vertices[1] + part);
}

/// So many batches ahead vertices are fetched.
constexpr Index kAhead = 2;

SELVAGE_INLINE void prefetch_vertices(const MaterialTask& task, const ElementBatch& batch) {
  for (const auto& lanes : batch.vertices)
    for (int i = 0; i < kBatch; ++i) prefetch(task.vertices + lanes[i]);
}

template <bool kDamped, bool kFirst>
void solve_block(const MaterialTask& task, const MaterialBlock& block) {
  const MaterialStep& step = task.bodies[block.body];
  for (Index n = block.first_edge_batch; n < block.last_edge_batch; ++n)
    for (int part = 0; part < kBatch; part += WideDouble::kLanes)
      solve_springs<kDamped, kFirst>(task, step, task.edges[n], part);
  const auto solve_elements = [&](const auto& solver) {
    for (Index n = block.first_element_batch; n < block.last_element_batch; ++n) {
      prefetch_vertices(task, task.elements[n + kAhead < block.last_element_batch ? n + kAhead : n]);
      for (int part = 0; part < kBatch; part += WideDouble::kLanes) solver.solve(task.elements[n], part);
    }
  };
  if (step.kind == MaterialKind::kNeoHookean)
    solve_elements(ElementSolver<true, kDamped, kFirst>(task, step));
  else
    solve_elements(ElementSolver<false, kDamped, kFirst>(task, step));
}

}  // namespace

void solve_blocks(const MaterialTask& task, Index first, Index last) {
  for (Index n = first; n < last; ++n) {
    const MaterialBlock& block = task.blocks[n];
    const bool damped = task.bodies[block.body].damping > 0;
    if (task.is_first)
      damped ? solve_block<true, true>(task, block) : solve_block<false, true>(task, block);
    else
      damped ? solve_block<true, false>(task, block) : solve_block<false, false>(task, block);
  }
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
