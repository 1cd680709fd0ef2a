#pragma once

#include "peer/report.h"
#include "selvage/io/mesh_file.h"

namespace selvage::bench {

struct BoundaryPathPlan {
  std::vector<int> threads;  ///< thread counts to measure with
  double seconds = 1;        ///< for the rounds of each measurement
  int fewest_rounds = 5;
  std::int64_t most_queries = 50000;  ///< of each kind, evenly spread; more are left out
};

/// Measures BoundaryPathFinder beside the peer on one tangled mesh, and prints as it goes.
void measure_boundary_paths(const std::string& name, const IndexedMesh& mesh, const BoundaryPathPlan& plan,
                            Report& report);

}  // namespace selvage::bench
