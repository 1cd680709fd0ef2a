#include "simulation/vbd/star_kernel.h"

#include "simulation/vbd/star_lanes.h"

namespace selvage {
inline namespace SELVAGE_ISA {

namespace {

/// Sums over the batches in a part of their places. Each place has a sum of its own, so that registers of any width add
/// the same numbers in the same order.
SELVAGE_INLINE void add_places(const StarTask& task, Index star, int lane, double (&places)[9][kStarBatch]) {
  const double* own = task.rows + task.own_rows[star];
  const Wide3 p = broadcast_point(own);
  const WideDouble zero = WideDouble::broadcast(0), one = WideDouble::broadcast(1);
  Wide3 gradient = {{zero, zero, zero}}, squares = gradient, products = gradient;
  for (std::int64_t n = task.first_batches[star]; n < task.first_batches[star + 1]; ++n) {
    const StarBatch& batch = task.batches[n];
    const Wide3 a = load_points(task.rows, batch.rows[0] + lane), b = load_points(task.rows, batch.rows[1] + lane),
                c = load_points(task.rows, batch.rows[2] + lane);
    // J = slope . (p - a): it is linear in p.
    const Wide3 slope = (zero - WideDouble::load(batch.inverse_determinant + lane)) * cross(b - a, c - a);
    const WideDouble growth = dot(slope, p - a) - one, bulk = WideDouble::load(batch.bulk + lane);
    gradient = gradient + WideDouble::load(batch.weights[0] + lane) * (a - p) +
               WideDouble::load(batch.weights[1] + lane) * (b - p) +
               WideDouble::load(batch.weights[2] + lane) * (c - p) +
               (bulk * growth - WideDouble::load(batch.shear + lane)) * slope;
    const Wide3 stiff = bulk * slope;
    for (int i = 0; i < 3; ++i) squares[i] = squares[i] + stiff[i] * slope[i];
    products[0] = products[0] + stiff[0] * slope[1];
    products[1] = products[1] + stiff[0] * slope[2];
    products[2] = products[2] + stiff[1] * slope[2];
  }
  for (int i = 0; i < 3; ++i) {
    gradient[i].store(places[i] + lane);
    squares[i].store(places[3 + i] + lane);
    products[i].store(places[6 + i] + lane);
  }
}

}  // namespace

void sum_stars(const StarTask& task, Index first, Index last, StarSums* sums) {
  for (Index star = first; star < last; ++star) {
    alignas(64) double places[9][kStarBatch];
    for (int lane = 0; lane < kStarBatch; lane += WideDouble::kLanes) add_places(task, star, lane, places);
    StarSums& sum = sums[star - first];
    for (int i = 0; i < 3; ++i) sum.gradient[i] = sum_of(places[i]);
    for (int i = 0; i < 6; ++i) sum.hessian[i] = sum_of(places[3 + i]);
  }
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
