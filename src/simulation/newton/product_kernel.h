#pragma once

#include "core/isa.h"
#include "selvage/core/types.h"

namespace selvage {

/// A product of a BlockMatrix in single precision with a vector, both in parts of three.
struct ProductTask {
  const std::int64_t* first;  ///< see BlockMatrix
  const Index* columns;
  const float* blocks;  ///< nine of each, column by column, and one behind the last
  const double* x;
  double* y;
};

// Rows [first, last) of y = matrix x, summed in double precision, and the dot product of these with those of x.
#define SELVAGE_PRODUCT_KERNEL \
  void multiply_rows(const ProductTask&, std::int64_t first, std::int64_t last, double& dot);
namespace baseline {
SELVAGE_PRODUCT_KERNEL
}
namespace avx2 {
SELVAGE_PRODUCT_KERNEL
}
namespace avx512 {
SELVAGE_PRODUCT_KERNEL
}
#undef SELVAGE_PRODUCT_KERNEL

}  // namespace selvage
