#pragma once

/// The namespace of code that a kernel file inlines (core/simd.h and the traversals): set by selvage_kernel() in CMake
/// to the instruction set for which the file is compiled, so that the linker never merges copies of different sets.
#ifndef SELVAGE_ISA
#define SELVAGE_ISA baseline
#endif

namespace selvage {

inline namespace SELVAGE_ISA {}

/// Instruction sets for which kernels are compiled, from the one every x86-64 has to the newest.
enum class Isa { baseline, avx2, avx512 };

/// The instruction set whose kernels run: the best that this processor has, or a lower one named by the environment
/// variable SELVAGE_ISA (baseline, avx2, avx512). The one place that decides. Every choice gives the same results.
Isa active_isa();

/// Its name: "baseline", "avx2" or "avx512".
const char* isa_name(Isa isa);

}  // namespace selvage

/// Calls `function(...)` of the kernel namespace of the active instruction set; a kernel file compiled by
/// selvage_kernel() in CMake defines it in namespace selvage::{baseline,avx2,avx512}.
#define SELVAGE_DISPATCH(function, ...)                                                         \
  (::selvage::active_isa() == ::selvage::Isa::avx512 ? ::selvage::avx512::function(__VA_ARGS__) \
   : ::selvage::active_isa() == ::selvage::Isa::avx2 ? ::selvage::avx2::function(__VA_ARGS__)   \
                                                     : ::selvage::baseline::function(__VA_ARGS__))
