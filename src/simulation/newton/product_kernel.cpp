#include "simulation/newton/product_kernel.h"

#include "core/simd/simd_double.h"

namespace selvage {
inline namespace SELVAGE_ISA {

// Three sums a row, one for each column of the blocks, so that none waits for another.
void multiply_rows(const ProductTask& task, std::int64_t first, std::int64_t last, double& dot) {
  double sum_of_rows = 0;
  for (std::int64_t row = first; row < last; ++row) {
    Double4 a = Double4::broadcast(0), b = a, c = a;
    for (std::int64_t i = task.first[row]; i < task.first[row + 1]; ++i) {
      const float* block = task.blocks + 9 * i;
      const double* x = task.x + 3 * std::int64_t{task.columns[i]};
      a = a + Double4::load_floats(block) * Double4::broadcast(x[0]);
      b = b + Double4::load_floats(block + 3) * Double4::broadcast(x[1]);
      c = c + Double4::load_floats(block + 6) * Double4::broadcast(x[2]);
    }
    double sums[4];
    (a + b + c).store(sums);
    double* y = task.y + 3 * row;
    const double* own = task.x + 3 * row;
    for (int k = 0; k < 3; ++k) y[k] = sums[k];
    sum_of_rows += own[0] * sums[0] + own[1] * sums[1] + own[2] * sums[2];
  }
  dot = sum_of_rows;
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
