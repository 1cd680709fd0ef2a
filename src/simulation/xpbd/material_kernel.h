#pragma once

#include "core/isa.h"
#include "simulation/xpbd/material_blocks.h"

namespace selvage {

/// A body's material, scaled for a time step.
struct MaterialStep {
  MaterialKind kind;
  double deviatoric;   ///< Neo-Hookean: compliance over the squared time step, times the rest volume
  double hydrostatic;  ///< the same; mass-spring: times the squared rest volume
  double edge;         ///< mass-spring: compliance over the squared time step
  double damping;      ///< over the time step
  double inverted;     ///< of less than this share of their volume at rest elements resist more
};

/// One iteration over the material.
struct MaterialTask {
  StepVertex* vertices;
  const StepVertex* start;      ///< the vertices at the start of the step; may be null where no body is damped
  const Index* block_vertices;  ///< MaterialBlocks::vertices
  ElementBatch* elements;
  EdgeBatch* edges;
  const MaterialBlock* blocks;
  const MaterialStep* bodies;
  bool is_first;     ///< of the step: multipliers start from zero
  Index next_block;  ///< block that is most likely solved after the last one given: it is prefetched
};

// Solves the blocks [first, last) one after the other.
#define SELVAGE_MATERIAL_KERNEL void solve_blocks(const MaterialTask&, Index first, Index last);
namespace baseline {
SELVAGE_MATERIAL_KERNEL
}
namespace avx2 {
SELVAGE_MATERIAL_KERNEL
}
namespace avx512 {
SELVAGE_MATERIAL_KERNEL
}
#undef SELVAGE_MATERIAL_KERNEL

}  // namespace selvage
