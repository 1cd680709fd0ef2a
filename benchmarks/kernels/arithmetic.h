#pragma once

#include "core/isa.h"

#include <cstdint>

namespace selvage {

// Arithmetic on doubles in registers, in as many lanes as there are: `count` times some 160 multiplications and as many
// additions, beside two divisions and a square root. Returns how many multiplications and additions that were; `sink`
// keeps the compiler from leaving them out.
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
