#pragma once

#include "boundary_path/path_scene.h"

namespace selvage {

#define SELVAGE_DECLARE_PATH_KERNEL(isa)                                                                            \
  namespace isa {                                                                                                   \
  void search_paths(const PathScene<2>&, std::span<const PathTask<2>>, std::size_t, PathResult<2>*, PathCounters*); \
  void search_paths(const PathScene<3>&, std::span<const PathTask<3>>, std::size_t, PathResult<3>*, PathCounters*); \
  }

/// Runs tasks one after the other: one result a task and, unless the pointer is null, one set of counters a task. They
/// help each other within batches of a size, so that what is counted does not depend on which batches come in one call.
SELVAGE_DECLARE_PATH_KERNEL(baseline)
SELVAGE_DECLARE_PATH_KERNEL(avx2)
SELVAGE_DECLARE_PATH_KERNEL(avx512)

#undef SELVAGE_DECLARE_PATH_KERNEL

}  // namespace selvage
