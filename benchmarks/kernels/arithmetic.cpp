#include "kernels/arithmetic.h"

#include "selvage/core/simd_double.h"

namespace selvage {
inline namespace SELVAGE_ISA {

std::int64_t run_arithmetic(std::int64_t count, double& sink) {
  constexpr int kChains = 12;
  const WideDouble factor = WideDouble::broadcast(0.999999 + 1e-12 * sink), term = WideDouble::broadcast(1e-6);
  WideDouble chains[kChains];
  for (int i = 0; i < kChains; ++i) chains[i] = WideDouble::broadcast(i);
  for (std::int64_t n = 0; n < count; ++n)
    for (int i = 0; i < kChains; ++i) chains[i] = chains[i] * factor + term;
  for (int i = 1; i < kChains; ++i) chains[0] = chains[0] + chains[i];
  double lanes[WideDouble::kLanes];
  chains[0].store(lanes);
  sink += lanes[0];
  return 2 * kChains * WideDouble::kLanes * count;
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
