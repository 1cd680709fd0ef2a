#pragma once

#include "selvage/core/isa.h"

#include <cstdint>

namespace selvage {

// Multiplies and adds doubles in registers, `count` times twelve chains of as many lanes as there are, and returns how
// many operations that were; `sink` keeps the compiler from leaving them out.
#define SELVAGE_ARITHMETIC_KERNEL std::int64_t run_arithmetic(std::int64_t count, double& sink);
namespace baseline {
SELVAGE_ARITHMETIC_KERNEL
}
namespace avx2 {
SELVAGE_ARITHMETIC_KERNEL
}
namespace avx512 {
SELVAGE_ARITHMETIC_KERNEL
}
#undef SELVAGE_ARITHMETIC_KERNEL

}  // namespace selvage
