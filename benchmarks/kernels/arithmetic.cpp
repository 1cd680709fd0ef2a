#include "kernels/arithmetic.h"

#include "core/simd/simd_double.h"

namespace selvage {
inline namespace SELVAGE_ISA {

std::int64_t run_arithmetic(std::int64_t count, double& sink) {
  // As many as hide how long an operation takes, and fit into the registers.
  constexpr int kChains = WideDouble::kLanes == 8 ? 16 : 12, kRounds = 160 / kChains;
  const WideDouble factor = WideDouble::broadcast(0.999999 + 1e-12 * sink), term = WideDouble::broadcast(1e-6);
  WideDouble chains[kChains], root = factor;
  for (int i = 0; i < kChains; ++i) chains[i] = WideDouble::broadcast(i);
  for (std::int64_t n = 0; n < count; ++n) {
    root = sqrt(factor / (factor / root));
    for (int round = 0; round < kRounds; ++round)
      for (int i = 0; i < kChains; ++i) chains[i] = chains[i] * factor + term;
  }
  for (int i = 0; i < kChains; ++i) root = root + chains[i];
  double lanes[WideDouble::kLanes];
  root.store(lanes);
  sink += lanes[0];
  return 2 * kRounds * kChains * WideDouble::kLanes * count;
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
