#pragma once

#include "boundary_path/input/path_input.h"

namespace selvage {

#define SELVAGE_DECLARE_PATH_KERNEL(isa)                         \
  namespace isa {                                                \
  void search_paths(const PathInput<2>&, PathBatches<2>&);       \
  void search_paths(const PathInput<3>&, PathBatches<3>&);       \
  void search_paths_alone(const PathInput<2>&, PathBatches<2>&); \
  void search_paths_alone(const PathInput<3>&, PathBatches<3>&); \
  }

/// Runs all batches. What is counted in one does not depend on those before. `search_paths_alone` runs each query by
/// find_path_alone(), for tests: the same answers, without counters.
SELVAGE_DECLARE_PATH_KERNEL(baseline)
SELVAGE_DECLARE_PATH_KERNEL(avx2)
SELVAGE_DECLARE_PATH_KERNEL(avx512)

#undef SELVAGE_DECLARE_PATH_KERNEL

}  // namespace selvage
