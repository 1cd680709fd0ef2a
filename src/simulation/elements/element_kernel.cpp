#include "simulation/elements/element_kernel.h"

#include "simulation/elements/wide_axes.h"

namespace selvage {
inline namespace SELVAGE_ISA {

namespace {

constexpr int kRecord = sizeof(ElementDerivatives) / sizeof(double);
static_assert(kRecord == 64);

/// Pairs of vertices in the order of ElementDerivatives::blocks.
constexpr int kPairs[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

SELVAGE_INLINE Wide3 load_point(const double* rows, const Index* offsets) {
  WideDouble columns[4];
  load_rows(rows, offsets, columns);
  return {{columns[0], columns[1], columns[2]}};
}

/// Elements of some places of a batch, as they are deformed.
struct Elements {
  Wide3 edges[3];  ///< from vertex 0
  Wide3 b[3];      ///< RestSimplex::by_vertex() of vertices 1 to 3
  Wide3 f[3];      ///< columns of F
  WideDouble growth, mu, bulk;

  SELVAGE_INLINE Elements(const ElementTask& task, const SolidBatch& batch, int lane)
      : mu(WideDouble::load(batch.mu + lane)), bulk(WideDouble::load(batch.bulk + lane)) {
    const Wide3 first = load_point(task.rows, batch.rows[0] + lane);
    for (int k = 0; k < 3; ++k) {
      edges[k] = load_point(task.rows, batch.rows[k + 1] + lane) - first;
      for (int j = 0; j < 3; ++j) b[k][j] = WideDouble::load(batch.inverse_edges[k][j] + lane);
    }
    for (int j = 0; j < 3; ++j) f[j] = b[0][j] * edges[0] + b[1][j] * edges[1] + b[2][j] * edges[2];
    growth = dot(f[0], cross(f[1], f[2])) - wide_number(1);
  }

  SELVAGE_INLINE WideDouble slope() const { return bulk * growth - mu; }
};

/// StrainDamping of some places.
struct Damping {
  WideDouble mu, bulk;
  Wide3 diagonal, across;  ///< of the strain: 00 11 22, and 12 02 01

  SELVAGE_INLINE Damping(const SolidBatch& batch, int lane, const Elements& e)
      : mu(WideDouble::load(batch.damping_mu + lane)), bulk(WideDouble::load(batch.damping_bulk + lane)) {
    const auto start = [&](int i) { return WideDouble::load(batch.squared_start[i] + lane); };
    const WideDouble half = wide_number(0.5);
    diagonal =
        half * Wide3{{dot(e.f[0], e.f[0]) - start(0), dot(e.f[1], e.f[1]) - start(1), dot(e.f[2], e.f[2]) - start(2)}};
    across =
        half * Wide3{{dot(e.f[1], e.f[2]) - start(3), dot(e.f[0], e.f[2]) - start(4), dot(e.f[0], e.f[1]) - start(5)}};
  }

  SELVAGE_INLINE WideDouble trace() const { return diagonal[0] + diagonal[1] + diagonal[2]; }
  SELVAGE_INLINE WideDouble energy() const {
    const WideDouble sum = trace();
    return mu * (dot(diagonal, diagonal) + wide_number(2) * dot(across, across)) + wide_number(0.5) * bulk * sum * sum;
  }
};

/// A symmetric matrix: 00 11 22, and 12 02 01.
struct Symmetric {
  Wide3 diagonal, across;

  SELVAGE_INLINE Wide3 times(const Wide3& x) const {
    return {{diagonal[0] * x[0] + across[2] * x[1] + across[1] * x[2],
             across[2] * x[0] + diagonal[1] * x[1] + across[0] * x[2],
             across[1] * x[0] + across[0] * x[1] + diagonal[2] * x[2]}};
  }
};

SELVAGE_INLINE Symmetric stress_of(const Damping& damping) {
  const WideDouble twice = wide_number(2) * damping.mu, all = damping.bulk * damping.trace();
  Symmetric stress{twice * damping.diagonal, twice * damping.across};
  for (int i = 0; i < 3; ++i) stress.diagonal[i] = stress.diagonal[i] + all;
  return stress;
}

SELVAGE_INLINE Symmetric positive_part(const Symmetric& matrix) {
  const WideSymmetricAxes axes(matrix.diagonal, matrix.across);
  const WideDouble zero = wide_number(0);
  Symmetric result{{{zero, zero, zero}}, {{zero, zero, zero}}};
  for (int n = 0; n < 3; ++n) {
    const Wide3& a = axes.axes[n];
    const Wide3 scaled = max(axes.values[n], zero) * a;
    for (int i = 0; i < 3; ++i) result.diagonal[i] = result.diagonal[i] + scaled[i] * a[i];
    result.across = result.across + Wide3{{scaled[1] * a[2], scaled[0] * a[2], scaled[0] * a[1]}};
  }
  return result;
}

/// Blocks of the Hessian, as ElementDerivatives has them.
struct Blocks {
  WideDouble at[kRecord];

  /// Vertices have `of` each, the first the negative sum of the others.
  SELVAGE_INLINE static void complete(Wide3 (&of)[4]) {
    const Wide3 zero = {{wide_number(0), wide_number(0), wide_number(0)}};
    of[0] = zero - (of[1] + of[2] + of[3]);
  }
  SELVAGE_INLINE WideDouble& entry(int pair, int row, int column) { return at[9 * pair + 3 * column + row]; }
  SELVAGE_INLINE void clear() {
    for (int i = 0; i < kRecord; ++i) at[i] = wide_number(0);
  }
  /// Adds factor a_k a_l^T.
  SELVAGE_INLINE void add_squares(const WideDouble& factor, const Wide3 (&a)[4]) {
    for (int p = 0; p < 6; ++p) {
      const Wide3 scaled = factor * a[kPairs[p][0]];
      const Wide3& other = a[kPairs[p][1]];
      for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 3; ++i) entry(p, i, j) = entry(p, i, j) + scaled[i] * other[j];
    }
  }
};

/// Modes of the material in which it has less than no stiffness: an eigenvalue below 0 is taken off again.
SELVAGE_INLINE void take_off_negative(const Elements& e, Blocks& blocks) {
  const WideStretchAxes axes(e.f);
  const WideDouble slope = e.slope(), zero = wide_number(0), half = wide_number(0.5);
  const WideDouble(&s)[3] = axes.stretches;
  WideDouble along[3][3];  // of vertices 1 to 3, by v
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < 3; ++i) along[k][i] = dot(axes.v[i], e.b[k]);
  const auto take_off = [&](const WideDouble& eigenvalue, int i, int j, bool flips) {
    if (!any_less(eigenvalue, zero)) return;
    const WideDouble factor = half * (zero - select_less(eigenvalue, zero, eigenvalue, zero));
    Wide3 mode[4];
    for (int k = 0; k < 3; ++k) {
      const Wide3 a = along[k][j] * axes.u[i], b = along[k][i] * axes.u[j];
      mode[k + 1] = flips ? a + b : a - b;
    }
    Blocks::complete(mode);
    blocks.add_squares(factor, mode);
  };
  Wide3 diagonal, across;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const WideDouble twist = slope * s[k];
    take_off(e.mu + twist, i, j, false);
    take_off(e.mu - twist, i, j, true);
    diagonal[k] = e.mu + e.bulk * (s[i] * s[j]) * (s[i] * s[j]);
    across[k] = slope * s[k] + e.bulk * (s[j] * s[k]) * (s[i] * s[k]);
  }
  // Scalings of the three axes, where they are not positive definite: their pivots say so.
  const WideDouble l01 = across[2] / diagonal[0], l02 = across[1] / diagonal[0];
  const WideDouble second = diagonal[1] - l01 * across[2], below = across[0] - l01 * across[1];
  const WideDouble third = diagonal[2] - l02 * across[1] - below / second * below;
  const WideDouble positive = select_less(
      zero, diagonal[0], select_less(zero, second, select_less(zero, third, wide_number(1), zero), zero), zero);
  if (!any_less(positive, half)) return;
  const WideSymmetricAxes scalings(diagonal, across);
  for (int n = 0; n < 3; ++n) {
    const WideDouble negative = select_less(scalings.values[n], zero, scalings.values[n], zero);
    if (!any_less(negative, zero)) continue;
    const WideDouble factor = zero - select_less(positive, half, negative, zero);
    const Wide3& a = scalings.axes[n];
    Wide3 mode[4];
    for (int k = 0; k < 3; ++k)
      mode[k + 1] =
          (a[0] * along[k][0]) * axes.u[0] + (a[1] * along[k][1]) * axes.u[1] + (a[2] * along[k][2]) * axes.u[2];
    Blocks::complete(mode);
    blocks.add_squares(factor, mode);
  }
}

/// Derivative of J by vertices 1 to 3.
SELVAGE_INLINE void volume_gradients(const Elements& e, const WideDouble& inverse_determinant, Wide3 (&c)[4]) {
  c[1] = inverse_determinant * cross(e.edges[1], e.edges[2]);
  c[2] = inverse_determinant * cross(e.edges[2], e.edges[0]);
  c[3] = inverse_determinant * cross(e.edges[0], e.edges[1]);
}

/// Second derivatives of J: of vertices k and l the cross product with the edge across, or with differences of edges.
SELVAGE_INLINE void add_volume_curvature(const Elements& e, const WideDouble& factor, Blocks& blocks) {
  const Wide3 zero = {{wide_number(0), wide_number(0), wide_number(0)}};
  const Wide3& d1 = e.edges[0];
  const Wide3& d2 = e.edges[1];
  const Wide3& d3 = e.edges[2];
  const Wide3 of_pair[6] = {d3 - d2, d1 - d3, d2 - d1, d3, zero - d2, d1};
  for (int p = 0; p < 6; ++p) {
    const Wide3 a = factor * of_pair[p];
    const auto add = [&](int row, int column, const WideDouble& x) {
      blocks.entry(p, row, column) = blocks.entry(p, row, column) + x;
      blocks.entry(p, column, row) = blocks.entry(p, column, row) - x;
    };
    add(0, 1, a[2]);
    add(2, 0, a[1]);
    add(1, 2, a[0]);
  }
}

/// The part of all blocks that is a symmetric matrix times how far b of two vertices agree, and one that is isotropic.
struct Pairwise {
  WideDouble agreement[6];

  SELVAGE_INLINE Pairwise(const Wide3 (&b)[4], const Wide3 (&of_b)[4]) {
    for (int p = 0; p < 6; ++p) agreement[p] = dot(b[kPairs[p][0]], of_b[kPairs[p][1]]);
  }
};

SELVAGE_INLINE void add_damping(const SolidBatch& batch, int lane, bool is_exact, const Elements& e,
                                const Wide3 (&b)[4], const Pairwise& pairwise, Wide3 (&gradient)[3], Blocks& blocks) {
  const Damping damping(batch, lane, e);
  const Symmetric stress = stress_of(damping), stiff = is_exact ? stress : positive_part(stress);
  Wide3 g[4], of_b[4];
  for (int k = 1; k < 4; ++k) {
    const Wide3 pull = stress.times(b[k]);
    gradient[k - 1] = gradient[k - 1] + (pull[0] * e.f[0] + pull[1] * e.f[1] + pull[2] * e.f[2]);
    g[k] = b[k][0] * e.f[0] + b[k][1] * e.f[1] + b[k][2] * e.f[2];
    of_b[k] = stiff.times(b[k]);
  }
  Blocks::complete(g);
  of_b[0] = stiff.times(b[0]);
  const Pairwise isotropic(b, of_b);
  Wide3 spread[3];  // mu F F^T
  for (int j = 0; j < 3; ++j) spread[j] = damping.mu * (e.f[0][j] * e.f[0] + e.f[1][j] * e.f[1] + e.f[2][j] * e.f[2]);
  for (int p = 0; p < 6; ++p) {
    const Wide3 &first = g[kPairs[p][0]], &second = g[kPairs[p][1]];
    const Wide3 bulk = damping.bulk * first, shear = damping.mu * first;
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i)
        blocks.entry(p, i, j) =
            blocks.entry(p, i, j) + (bulk[i] * second[j] + shear[j] * second[i] + pairwise.agreement[p] * spread[j][i]);
    for (int i = 0; i < 3; ++i) blocks.entry(p, i, i) = blocks.entry(p, i, i) + isotropic.agreement[p];
  }
}

/// Negative modes first, so that blocks begin with zeros of one sign: where a mode is 0, nothing changes.
SELVAGE_INLINE void differentiate(const ElementTask& task, const SolidBatch& batch, int lane, bool is_exact,
                                  Blocks& blocks) {
  const Elements e(task, batch, lane);
  blocks.clear();
  if (!is_exact) take_off_negative(e, blocks);
  Wide3 b[4] = {e.b[0], e.b[0], e.b[1], e.b[2]}, c[4];
  Blocks::complete(b);
  const WideDouble inverse_determinant = WideDouble::load(batch.inverse_determinant + lane), slope = e.slope();
  volume_gradients(e, inverse_determinant, c);
  Blocks::complete(c);
  blocks.add_squares(e.bulk, c);
  add_volume_curvature(e, slope * inverse_determinant, blocks);
  const Pairwise pairwise(b, b);
  for (int p = 0; p < 6; ++p)
    for (int i = 0; i < 3; ++i) blocks.entry(p, i, i) = blocks.entry(p, i, i) + e.mu * pairwise.agreement[p];
  Wide3 gradient[3];
  for (int k = 0; k < 3; ++k)
    gradient[k] = e.mu * (e.b[k][0] * e.f[0] + e.b[k][1] * e.f[1] + e.b[k][2] * e.f[2]) + slope * c[k + 1];
  if (task.is_damped) add_damping(batch, lane, is_exact, e, b, pairwise, gradient, blocks);
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < 3; ++i) blocks.at[54 + 3 * k + i] = gradient[k][i];
}

}  // namespace

void measure_elements(const ElementTask& task, std::int64_t first, std::int64_t last, double* energies) {
  for (std::int64_t n = first; n < last; ++n) {
    const SolidBatch& batch = task.batches[n];
    for (int lane = 0; lane < kSolidBatch; lane += WideDouble::kLanes) {
      const Elements e(task, batch, lane);
      const WideDouble square = dot(e.f[0], e.f[0]) + dot(e.f[1], e.f[1]) + dot(e.f[2], e.f[2]),
                       half = wide_number(0.5);
      // By J - 1, not by J: near rest the large terms cancel.
      WideDouble energy =
          half * e.mu * (square - wide_number(3)) - e.mu * e.growth + half * e.bulk * e.growth * e.growth;
      if (task.is_damped) energy = energy + Damping(batch, lane, e).energy();
      double places[WideDouble::kLanes];
      energy.store(places);
      for (int i = 0; i < WideDouble::kLanes; ++i) energies[batch.elements[lane + i]] = places[i];
    }
  }
}

void pull_elements(const ElementTask& task, std::int64_t first, std::int64_t last, ElementGradient* gradients) {
  constexpr int kStride = sizeof(ElementGradient) / sizeof(double);
  for (std::int64_t n = first; n < last; ++n) {
    const SolidBatch& batch = task.batches[n];
    for (int lane = 0; lane < kSolidBatch; lane += WideDouble::kLanes) {
      const Elements e(task, batch, lane);
      Wide3 c[4];
      volume_gradients(e, WideDouble::load(batch.inverse_determinant + lane), c);
      Symmetric stress{};
      if (task.is_damped) stress = stress_of(Damping(batch, lane, e));
      std::int64_t offsets[WideDouble::kLanes];
      for (int i = 0; i < WideDouble::kLanes; ++i) offsets[i] = std::int64_t{kStride} * batch.elements[lane + i];
      for (int k = 0; k < 3; ++k) {
        Wide3 pull = e.mu * e.b[k];
        if (task.is_damped) pull = pull + stress.times(e.b[k]);
        const Wide3 sum = pull[0] * e.f[0] + pull[1] * e.f[1] + pull[2] * e.f[2] + e.slope() * c[k + 1];
        const WideDouble columns[4] = {sum[0], sum[1], sum[2], wide_number(0)};
        store_rows(columns, gradients->of_vertex[k], offsets);
      }
    }
  }
}

void differentiate_elements(const ElementTask& task, bool is_exact, std::int64_t first, std::int64_t last,
                            ElementDerivatives* derivatives) {
  auto* const records = reinterpret_cast<double*>(derivatives);  // each from its first number to the last
  for (std::int64_t n = first; n < last; ++n) {
    const SolidBatch& batch = task.batches[n];
    for (int lane = 0; lane < kSolidBatch; lane += WideDouble::kLanes) {
      Blocks blocks;
      differentiate(task, batch, lane, is_exact, blocks);
      std::int64_t offsets[WideDouble::kLanes];
      for (int i = 0; i < WideDouble::kLanes; ++i) offsets[i] = std::int64_t{kRecord} * batch.elements[lane + i];
      for (int i = 0; i < kRecord; i += 4) {
        const WideDouble columns[4] = {blocks.at[i], blocks.at[i + 1], blocks.at[i + 2], blocks.at[i + 3]};
        store_rows(columns, records + i, offsets);
      }
    }
  }
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
