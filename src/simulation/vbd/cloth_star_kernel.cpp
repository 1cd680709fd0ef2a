#include "simulation/vbd/cloth_star_kernel.h"

#include "simulation/vbd/star_lanes.h"

namespace selvage {
inline namespace SELVAGE_ISA {

namespace {

SELVAGE_INLINE WideDouble number(double x) {
  return WideDouble::broadcast(x);
}

/// A symmetric matrix as sums of products.
struct Products {
  WideDouble at[6];

  SELVAGE_INLINE void add(const WideDouble& factor, const Wide3& a) {
    const Wide3 scaled = factor * a;
    at[0] = at[0] + scaled[0] * a[0];
    at[1] = at[1] + scaled[1] * a[1];
    at[2] = at[2] + scaled[2] * a[2];
    at[3] = at[3] + scaled[0] * a[1];
    at[4] = at[4] + scaled[0] * a[2];
    at[5] = at[5] + scaled[1] * a[2];
  }
  SELVAGE_INLINE void add_isotropic(const WideDouble& factor) {
    for (int i = 0; i < 3; ++i) at[i] = at[i] + factor;
  }
};

/// What triangles of some places are with their vertex at p.
struct Triangles {
  Wide3 f[2];            ///< columns of F
  Wide3 across;          ///< their cross product
  WideDouble area;       ///< by that at rest
  WideDouble strain[3];  ///< since the start of the step: 00 01 11

  SELVAGE_INLINE Triangles(const ClothStarTask& task, const TriangleStarBatch& batch, int lane, const Wide3& p) {
    const Wide3 q = load_points(task.rows, batch.rows[0] + lane) - p,
                r = load_points(task.rows, batch.rows[1] + lane) - p;
    for (int k = 0; k < 2; ++k)
      f[k] = WideDouble::load(batch.by_q[k] + lane) * q + WideDouble::load(batch.by_r[k] + lane) * r;
    across = cross(f[0], f[1]);
    area = sqrt(dot(across, across));
    const WideDouble half = number(0.5);
    strain[0] = half * (dot(f[0], f[0]) - WideDouble::load(batch.squared_start[0] + lane));
    strain[1] = half * (dot(f[0], f[1]) - WideDouble::load(batch.squared_start[1] + lane));
    strain[2] = half * (dot(f[1], f[1]) - WideDouble::load(batch.squared_start[2] + lane));
  }

  SELVAGE_INLINE WideDouble energy(const TriangleStarBatch& batch, int lane, bool is_damped) const {
    const WideDouble mu = WideDouble::load(batch.mu + lane), bulk = WideDouble::load(batch.bulk + lane),
                     growth = area - number(1), half = number(0.5);
    WideDouble sum =
        half * mu * (dot(f[0], f[0]) + dot(f[1], f[1]) - number(2)) - mu * growth + half * bulk * growth * growth;
    if (is_damped) {
      const WideDouble trace = strain[0] + strain[2];
      sum = sum +
            WideDouble::load(batch.damping_mu + lane) *
                (strain[0] * strain[0] + number(2) * strain[1] * strain[1] + strain[2] * strain[2]) +
            half * WideDouble::load(batch.damping_bulk + lane) * trace * trace;
    }
    return sum;
  }
};

struct TriangleSums {
  Wide3 gradient;
  Products hessian;
  WideDouble energy, least_area;
};

/// As MembraneNeoHookean::by_vertex().
SELVAGE_INLINE void add_membrane(const Triangles& of, const TriangleStarBatch& batch, int lane,
                                 const WideDouble (&b)[2], TriangleSums& sums) {
  const WideDouble zero = number(0), one = number(1);
  const WideDouble mu = WideDouble::load(batch.mu + lane), bulk = WideDouble::load(batch.bulk + lane);
  const WideDouble inverse_area = select_less(zero, of.area, one / of.area, zero);
  const Wide3 n = inverse_area * of.across;
  const Wide3 away = b[0] * cross(of.f[1], n) + b[1] * cross(n, of.f[0]), fb = b[0] * of.f[0] + b[1] * of.f[1];
  const WideDouble slope = bulk * (of.area - one) - mu, stiff = mu * (b[0] * b[0] + b[1] * b[1]);
  sums.gradient = sums.gradient + mu * fb + slope * away;
  sums.hessian.add_isotropic(stiff);
  sums.hessian.add(bulk, away);
  sums.hessian.add(max(slope * inverse_area * dot(away, away), zero - stiff), n);
  // Places without a triangle have no area.
  sums.least_area =
      select_less(sums.least_area, of.area, sums.least_area, select_less(zero, mu, of.area, sums.least_area));
}

/// As StrainDamping<2>::by_vertex().
SELVAGE_INLINE void add_damping(const Triangles& of, const TriangleStarBatch& batch, int lane, const WideDouble (&b)[2],
                                TriangleSums& sums) {
  const WideDouble mu = WideDouble::load(batch.damping_mu + lane), lambda = WideDouble::load(batch.damping_bulk + lane);
  const WideDouble pressure = lambda * (of.strain[0] + of.strain[2]), twice = mu + mu;
  const WideDouble stress[2] = {(twice * of.strain[0] + pressure) * b[0] + twice * of.strain[1] * b[1],
                                twice * of.strain[1] * b[0] + (twice * of.strain[2] + pressure) * b[1]};
  sums.gradient = sums.gradient + stress[0] * of.f[0] + stress[1] * of.f[1];
  sums.hessian.add(lambda + mu, b[0] * of.f[0] + b[1] * of.f[1]);
  const WideDouble spread = mu * (b[0] * b[0] + b[1] * b[1]);
  sums.hessian.add(spread, of.f[0]);
  sums.hessian.add(spread, of.f[1]);
  sums.hessian.add_isotropic(max(b[0] * stress[0] + b[1] * stress[1], number(0)));
}

/// Sums in a part of the places. Each place has a sum of its own, so that registers of any width add the same numbers
/// in the same order.
SELVAGE_INLINE void add_triangle_places(const ClothStarTask& task, Index star, int lane,
                                        double (&places)[11][kStarBatch]) {
  const Wide3 p = broadcast_point(task.rows + task.own_rows[star]);
  const WideDouble zero = number(0);
  TriangleSums sums{{{zero, zero, zero}}, {{zero, zero, zero, zero, zero, zero}}, zero, number(1)};
  for (std::int64_t n = task.first_triangles[star]; n < task.first_triangles[star + 1]; ++n) {
    const TriangleStarBatch& batch = task.triangles[n];
    const Triangles of(task, batch, lane, p);
    const WideDouble b[2] = {zero - WideDouble::load(batch.by_q[0] + lane) - WideDouble::load(batch.by_r[0] + lane),
                             zero - WideDouble::load(batch.by_q[1] + lane) - WideDouble::load(batch.by_r[1] + lane)};
    add_membrane(of, batch, lane, b, sums);
    if (task.is_damped) add_damping(of, batch, lane, b, sums);
    sums.energy = sums.energy + of.energy(batch, lane, task.is_damped);
  }
  for (int i = 0; i < 3; ++i) sums.gradient[i].store(places[i] + lane);
  for (int i = 0; i < 6; ++i) sums.hessian.at[i].store(places[3 + i] + lane);
  sums.energy.store(places[9] + lane);
  sums.least_area.store(places[10] + lane);
}

SELVAGE_INLINE void add_hinge_places(const ClothStarTask& task, Index star, int lane, double (&places)[9][kStarBatch]) {
  const Wide3 p = broadcast_point(task.rows + task.own_rows[star]);
  const WideDouble zero = number(0);
  Wide3 gradient = {{zero, zero, zero}};
  Products hessian = {{zero, zero, zero, zero, zero, zero}};
  for (std::int64_t n = task.first_bendings[star]; n < task.first_bendings[star + 1]; ++n) {
    const BendingStarBatch& batch = task.bendings[n];
    gradient = gradient + WideDouble::load(batch.weights + lane) * (load_points(task.rows, batch.rows + lane) - p);
  }
  for (std::int64_t n = task.first_hinges[star]; n < task.first_hinges[star + 1]; ++n) {
    const HingeStarBatch& batch = task.hinges[n];
    const Wide3 a = load_points(task.rows, batch.rows[0] + lane), b = load_points(task.rows, batch.rows[1] + lane),
                c = load_points(task.rows, batch.rows[2] + lane);
    // The sine of the angle, with lengths as at rest, is linear in p.
    const WideDouble stiffness = WideDouble::load(batch.stiffness + lane);
    const Wide3 slope = (zero - WideDouble::load(batch.scale + lane)) * cross(b - a, c - a);
    gradient = gradient + stiffness * (dot(slope, p - a) - WideDouble::load(batch.start + lane)) * slope;
    hessian.add(stiffness, slope);
  }
  for (int i = 0; i < 3; ++i) gradient[i].store(places[i] + lane);
  for (int i = 0; i < 6; ++i) hessian.at[i].store(places[3 + i] + lane);
}

}  // namespace

void sum_cloth_star(const ClothStarTask& task, Index star, ClothStarSums& sums) {
  alignas(64) double triangles[11][kStarBatch];
  for (int lane = 0; lane < kStarBatch; lane += WideDouble::kLanes) add_triangle_places(task, star, lane, triangles);
  for (int i = 0; i < 3; ++i) sums.gradient[i] = sum_of(triangles[i]);
  for (int i = 0; i < 6; ++i) sums.hessian[i] = sum_of(triangles[3 + i]);
  sums.energy = sum_of(triangles[9]);
  sums.least_area = triangles[10][0];
  for (int i = 1; i < kStarBatch; ++i)
    sums.least_area = triangles[10][i] < sums.least_area ? triangles[10][i] : sums.least_area;
  alignas(64) double hinges[9][kStarBatch];
  for (int lane = 0; lane < kStarBatch; lane += WideDouble::kLanes) add_hinge_places(task, star, lane, hinges);
  for (int i = 0; i < 3; ++i) sums.quadratic[i] = sum_of(hinges[i]);
  for (int i = 0; i < 6; ++i) sums.quadratic_hessian[i] = sum_of(hinges[3 + i]);
}

void measure_cloth_star(const ClothStarTask& task, Index star, const double at[3], double& energy) {
  const Wide3 p = broadcast_point(at);
  alignas(64) double places[kStarBatch];
  for (int lane = 0; lane < kStarBatch; lane += WideDouble::kLanes) {
    WideDouble sum = number(0);
    for (std::int64_t n = task.first_triangles[star]; n < task.first_triangles[star + 1]; ++n) {
      const TriangleStarBatch& batch = task.triangles[n];
      sum = sum + Triangles(task, batch, lane, p).energy(batch, lane, task.is_damped);
    }
    sum.store(places + lane);
  }
  energy = sum_of(places);
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
