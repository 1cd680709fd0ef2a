#pragma once

#include "core/simd/simd_double.h"
#include "core/simd/vec3.h"
#include "simulation/xpbd/material_kernel.h"

#include <span>

namespace selvage {
inline namespace SELVAGE_ISA {

using Wide3 = LaneVec3<WideDouble>;

/// Squared strain below which an element counts as at rest: the rounding of a sum of a few numbers near 1, squared.
inline constexpr double kMinSquaredStrain = 1e-30;
/// In place of a denominator of zero: that of a rigid constraint between pinned vertices, which never move.
inline constexpr double kMinDenominator = 1e-100;
/// Deviatoric residual of a mirror image of an element at rest: none that is distorted more is held back more.
inline constexpr double kMaxDistortion = 8;
/// Share of the hydrostatic compliance that inverted elements have: see MaterialSolver::turn_back().
inline constexpr double kInvertedCompliance = 1e-3;

SELVAGE_INLINE WideDouble constant(double x) {
  return WideDouble::broadcast(x);
}

/// The vertices of the block that is being solved, and those that stand in for missing ones.
struct BlockVertices {
  /// A cache line: a damped material needs both.
  struct alignas(64) Copy {
    StepVertex now, start;
  };
  Copy copies[kMaxBlockVertices];

  SELVAGE_INLINE const double* of_now() const { return copies->now.position; }
  SELVAGE_INLINE double* of_now() { return copies->now.position; }
  SELVAGE_INLINE const double* of_start() const { return copies->start.position; }

  template <bool kDamped>
  void load(const MaterialTask& task, std::span<const Index> vertices) {
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      copies[i].now = task.vertices[vertices[i]];
      if constexpr (kDamped) copies[i].start = task.start[vertices[i]];
    }
    for (int k = 0; k < 4; ++k) {
      const StepVertex missing = {{double(k == 1), double(k == 2), double(k == 3)}, 0};
      copies[vertices.size() + k] = {missing, missing};
    }
  }

  void store(const MaterialTask& task, std::span<const Index> vertices) const {
    for (std::size_t i = 0; i < vertices.size(); ++i) task.vertices[vertices[i]] = copies[i].now;
  }
};
static_assert(sizeof(BlockVertices::Copy) == sizeof(double) * kCopyLength);

/// A constraint of as many elements as there are lanes, while it is solved.
struct Constraint {
  Wide3 edges[3];      ///< from vertex 0
  Wide3 gradients[3];  ///< of vertices 1 to 3
  Wide3 sum;           ///< of them: the gradient of vertex 0 the other way
  WideDouble residual;
  WideDouble rate;     ///< the residual's share by damping
  WideDouble squared;  ///< deviatoric: C^2
  WideDouble value;    ///< C
  WideDouble compliance;
  WideDouble scale;  ///< vertices move against their gradients by so much, times inverse mass
};

/// The vertices of as many elements as there are lanes.
struct Corners {
  WideDouble x[4][4];  ///< position and inverse mass

  SELVAGE_INLINE Corners(const BlockVertices& copies, const ElementBatch& batch, int lane) {
    // Written out: a loop over so much would stay one.
    load_rows(copies.of_now(), batch.offsets[0] + lane, x[0]);
    load_rows(copies.of_now(), batch.offsets[1] + lane, x[1]);
    load_rows(copies.of_now(), batch.offsets[2] + lane, x[2]);
    load_rows(copies.of_now(), batch.offsets[3] + lane, x[3]);
  }

  /// The same, and the edges at the start of the step: each offset is used twice while it is in a register.
  SELVAGE_INLINE Corners(const BlockVertices& copies, const ElementBatch& batch, int lane, Wide3 (&start)[3]) {
    WideDouble first[4];
    load_rows(copies.of_now(), batch.offsets[0] + lane, x[0]);
    load_rows(copies.of_start(), batch.offsets[0] + lane, first);
    load_with_edge(copies, batch.offsets[1] + lane, first, x[1], start[0]);
    load_with_edge(copies, batch.offsets[2] + lane, first, x[2], start[1]);
    load_with_edge(copies, batch.offsets[3] + lane, first, x[3], start[2]);
  }

  template <int kVertex>
  SELVAGE_INLINE void store(double* copies, const ElementBatch& batch, int lane) const {
    store_rows(x[kVertex], copies, batch.offsets[kVertex] + lane);
  }

  SELVAGE_INLINE void list_edges(Wide3 (&edges)[3]) const {
    for (int k = 0; k < 3; ++k)
      for (int i = 0; i < 3; ++i) edges[k][i] = x[k + 1][i] - x[0][i];
  }

  template <int kVertex>
  SELVAGE_INLINE void move(const Constraint& by) {
    WideDouble(&own)[4] = x[kVertex];
    const WideDouble own_scale = by.scale * own[3];
    for (int i = 0; i < 3; ++i)
      if constexpr (kVertex == 0)
        own[i] = own[i] + own_scale * by.sum[i];
      else
        own[i] = own[i] - own_scale * by.gradients[kVertex - 1][i];
  }

  SELVAGE_INLINE WideDouble weigh(WideDouble of_first, const Wide3& others) const {
    return x[0][3] * of_first + x[1][3] * others[0] + x[2][3] * others[1] + x[3][3] * others[2];
  }

 private:
  SELVAGE_INLINE static void load_with_edge(const BlockVertices& copies, const std::uint16_t* offsets,
                                            const WideDouble (&first)[4], WideDouble (&now)[4], Wide3& edge) {
    WideDouble start[4];
    load_rows(copies.of_now(), offsets, now);
    load_rows(copies.of_start(), offsets, start);
    for (int i = 0; i < 3; ++i) edge[i] = start[i] - first[i];
  }
};

/// Twice the areas of the faces at vertex 0, as vectors: the gradients of six volumes.
SELVAGE_INLINE void list_areas(const Wide3 (&edges)[3], Wide3 (&areas)[3]) {
  areas[0] = cross(edges[1], edges[2]);
  areas[1] = cross(edges[2], edges[0]);
  areas[2] = cross(edges[0], edges[1]);
}

SELVAGE_INLINE Wide3 sum_of(const Wide3 (&a)[3]) {
  return a[0] + a[1] + a[2];
}

/// How a constraint of the element moves with the vertices: the gradients of all four weighed by inverse mass.
SELVAGE_INLINE WideDouble weigh_gradients(const Corners& corners, const Wide3 (&gradients)[3], const Wide3& sum) {
  const Wide3 squares = {dot(gradients[0], gradients[0]), dot(gradients[1], gradients[1]),
                         dot(gradients[2], gradients[2])};
  return corners.weigh(dot(sum, sum), squares);
}

/// Fetches as much of a batch as two registers hold, from `lane` on.
SELVAGE_INLINE void fetch(const ElementBatch& batch, int lane) {
  constexpr int kBytes = sizeof(ElementBatch) / kBatch;
#pragma GCC unroll 32
  for (int at = 0; at < 2 * WideDouble::kLanes * kBytes; at += 64)
    prefetch(reinterpret_cast<const char*>(&batch) + lane * kBytes + at);
}

/// Solves the deviatoric and the hydrostatic constraint of elements one after the other. XPBD, with one term more in
/// the denominator: a quarter of the squared residual times what the gradients weigh at rest. By it no vertex of a flat
/// element, whose gradients are small, moves farther than the element at rest is large; near rest it is nothing, and
/// where the residual is zero it changes nothing. From kMaxDistortion on it grows no more: else it would hold back
/// elements that are drawn out, the more the longer they are, and small ones in a body that falls past many of their
/// edges in a step would stay behind for good.
template <bool kDeviatoric, bool kDamped, bool kFirst>
class ElementSolver {
 public:
  SELVAGE_INLINE ElementSolver(BlockVertices& copies, const MaterialStep& step) : copies_(copies) {
    deviatoric_ = constant(step.deviatoric);
    hydrostatic_ = constant(step.hydrostatic);
    turned_back_ = constant(kInvertedCompliance * step.hydrostatic);
    inverted_ = constant(step.inverted);
    damping_ = constant(step.damping);
    share_ = constant(1 + step.damping);
  }

  /// Two registers' elements of a batch, in turns. A constraint ends in a chain of operations that wait for one
  /// another, and the processor has few places for what waits: when all that moves and stores vertices stands behind
  /// the chain, it takes in nothing else. So between the end of a chain and what needs it there is always work of the
  /// other. Stores have few places, too: those of the first are spread, and the next batch is fetched where nothing is
  /// stored.
  SELVAGE_INLINE void solve(ElementBatch& batch, int first_lane, int second_lane, const ElementBatch& next) const {
    Elements a(copies_, batch, first_lane);
    begin_first(a);
    Elements b(copies_, batch, second_lane);
    end_first(a);
    begin_first(b);
    move_after_first(a);
    end_first(b);
    fetch(next, first_lane);
    if constexpr (kDeviatoric) begin_hydrostatic(a);
    if constexpr (kDeviatoric) end_hydrostatic(a);
    finish<0>(a);
    move_after_first(b);
    finish<1>(a);
    if constexpr (kDeviatoric) begin_hydrostatic(b);
    finish<2>(a);
    if constexpr (kDeviatoric) end_hydrostatic(b);
    finish<3>(a);
    finish_all(b);
  }

  /// The elements of one register alone. Not inlined: that would cost the other registers.
  [[gnu::noinline]] void solve(ElementBatch& batch, int lane, const ElementBatch& next) const {
    fetch(next, lane);
    Elements a(copies_, batch, lane);
    begin_first(a);
    end_first(a);
    move_after_first(a);
    if constexpr (kDeviatoric) begin_hydrostatic(a);
    if constexpr (kDeviatoric) end_hydrostatic(a);
    finish_all(a);
  }

 private:
  /// As many as there are lanes, while they are solved.
  struct Elements {
    ElementBatch& batch;
    int lane;
    Wide3 start[3];  ///< edges at the start of the step
    Corners corners;
    WideDouble weight;  ///< of a constraint's gradients at rest
    Constraint constraint;

    SELVAGE_INLINE Elements(const BlockVertices& copies, ElementBatch& b, int l)
        : batch(b), lane(l), corners(load(copies)) {}

    SELVAGE_INLINE WideDouble gram(int i) const { return WideDouble::load(batch.gram[i] + lane); }
    SELVAGE_INLINE WideDouble inverse_volume() const { return WideDouble::load(batch.inverse_volume + lane); }

    SELVAGE_INLINE void weigh_rest() {
      const Wide3 diagonal = {gram(0), gram(1), gram(2)};
      const WideDouble beside = gram(3) + gram(4) + gram(5);
      weight = corners.weigh(diagonal[0] + diagonal[1] + diagonal[2] + (beside + beside), diagonal);
    }

   private:
    SELVAGE_INLINE Corners load(const BlockVertices& copies) {
      if constexpr (kDamped)
        return Corners(copies, batch, lane, start);
      else
        return Corners(copies, batch, lane);
    }
  };

  SELVAGE_INLINE void begin_first(Elements& of) const {
    of.weigh_rest();
    if constexpr (kDeviatoric)
      begin_deviatoric(of);
    else
      begin_hydrostatic(of);
  }

  SELVAGE_INLINE void end_first(Elements& of) const {
    if constexpr (kDeviatoric)
      end_deviatoric(of);
    else
      end_hydrostatic(of);
  }

  /// Where another constraint follows.
  SELVAGE_INLINE void move_after_first(Elements& of) const {
    if constexpr (kDeviatoric) {
      of.corners.template move<0>(of.constraint);
      of.corners.template move<1>(of.constraint);
      of.corners.template move<2>(of.constraint);
      of.corners.template move<3>(of.constraint);
    }
  }

  /// The term by which no vertex of a flat element moves far.
  /// @param distortion  the residual without multiplier and damping
  SELVAGE_INLINE static WideDouble bound_moves(const Elements& of, WideDouble distortion) {
    const WideDouble residual = of.constraint.residual, most = constant(kMaxDistortion);
    const WideDouble squared = select_less(abs(distortion), most, residual * residual, most * most);
    return constant(0.25) * squared * of.weight;
  }

  /// The residual's share by damping.
  SELVAGE_INLINE WideDouble damp(const Elements& of) const {
    const auto& [edges, gradients, sum, residual, rate, squared, value, compliance, scale] = of.constraint;
    const auto of_edge = [&, &edges = edges, &gradients = gradients](int k) {
      const Wide3 moved = {edges[k][0] - of.start[k][0], edges[k][1] - of.start[k][1], edges[k][2] - of.start[k][2]};
      return dot(gradients[k], moved);
    };
    return damping_ * (of_edge(0) + of_edge(1) + of_edge(2));
  }

  // With S = C^2 and q = C grad C, the gradient of S / 2, all is multiplied by C, so that nothing is divided by it.
  SELVAGE_INLINE void begin_deviatoric(Elements& of) const {
    constexpr int kPlace[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
    auto& [edges, gradients, sum, residual, rate, squared, value, compliance, scale] = of.constraint;
    Wide3 areas[3];
    of.corners.list_edges(edges);
    list_areas(edges, areas);
    const WideDouble inverse_volume = of.inverse_volume();
    const WideDouble volume = inverse_volume * dot(edges[0], areas[0]);
    const WideDouble area_scale = (volume - constant(2)) * inverse_volume;
    Wide3 squares;
    for (int k = 0; k < 3; ++k) {
      for (int i = 0; i < 3; ++i)
        gradients[k][i] = of.gram(kPlace[k][0]) * edges[0][i] + of.gram(kPlace[k][1]) * edges[1][i] +
                          of.gram(kPlace[k][2]) * edges[2][i];
      squares[k] = dot(edges[k], gradients[k]);
      for (int i = 0; i < 3; ++i) gradients[k][i] = gradients[k][i] + area_scale * areas[k][i];
    }
    squared = max(squares[0] + squares[1] + squares[2] + (volume - constant(4)) * volume, constant(kMinSquaredStrain));
    value = sqrt(squared);
  }

  SELVAGE_INLINE void end_deviatoric(Elements& of) const {
    auto& [edges, gradients, sum, residual, rate, squared, value, compliance, scale] = of.constraint;
    if constexpr (kDamped) rate = damp(of);
    sum = sum_of(gradients);
    const WideDouble stiffness = weigh_gradients(of.corners, gradients, sum);
    compliance = deviatoric_ * of.inverse_volume();
    double* const multiplier = of.batch.multipliers[0] + of.lane;
    residual = squared;
    if constexpr (!kFirst) residual = residual + value * (compliance * WideDouble::load(multiplier));
    if constexpr (kDamped) residual = residual + rate;
    const WideDouble denominator =
        (kDamped ? share_ * stiffness : stiffness) + squared * compliance + bound_moves(of, squared);
    scale = residual / denominator;
    reduce_multiplier(multiplier, scale * value);
  }

  SELVAGE_INLINE void begin_hydrostatic(Elements& of) const {
    auto& [edges, areas, sum, residual, rate, squared, value, compliance, scale] = of.constraint;
    of.corners.list_edges(edges);
    list_areas(edges, areas);
    const WideDouble volume = of.inverse_volume() * dot(edges[0], areas[0]);
    compliance = hydrostatic_compliance(of, volume);
    value = volume - constant(1);
    residual = value;
    if constexpr (!kFirst) residual = residual + compliance * WideDouble::load(of.batch.multipliers[1] + of.lane);
    if constexpr (kDamped) residual = residual + of.inverse_volume() * damp(of);
  }

  SELVAGE_INLINE void end_hydrostatic(Elements& of) const {
    auto& [edges, areas, sum, residual, rate, squared, value, compliance, scale] = of.constraint;
    const WideDouble inverse_volume = of.inverse_volume();
    sum = sum_of(areas);
    const WideDouble stiffness = inverse_volume * inverse_volume * weigh_gradients(of.corners, areas, sum);
    const WideDouble denominator = (kDamped ? share_ * stiffness : stiffness) + compliance + bound_moves(of, value);
    const WideDouble by = residual / max(denominator, constant(kMinDenominator));
    reduce_multiplier(of.batch.multipliers[1] + of.lane, by);
    scale = by * inverse_volume;
  }

  /// @param volume  as a share of that at rest
  SELVAGE_INLINE WideDouble hydrostatic_compliance(const Elements& of, WideDouble volume) const {
    const WideDouble of_material = select_less(volume, inverted_, turned_back_, hydrostatic_);
    const WideDouble compliance = of_material * of.inverse_volume();
    return kDeviatoric ? compliance : compliance * of.inverse_volume();
  }

  /// Moves a vertex for the last time.
  template <int kVertex>
  SELVAGE_INLINE void finish(Elements& of) const {
    of.corners.template move<kVertex>(of.constraint);
    of.corners.template store<kVertex>(copies_.of_now(), of.batch, of.lane);
  }

  SELVAGE_INLINE void finish_all(Elements& of) const {
    finish<0>(of);
    finish<1>(of);
    finish<2>(of);
    finish<3>(of);
  }

  SELVAGE_INLINE static void reduce_multiplier(double* multiplier, WideDouble by) {
    const WideDouble before = kFirst ? constant(0) : WideDouble::load(multiplier);
    (before - by).store(multiplier);
  }

  BlockVertices& copies_;
  WideDouble deviatoric_, hydrostatic_, turned_back_, inverted_, damping_, share_;
};

}  // namespace SELVAGE_ISA
}  // namespace selvage
