#pragma once

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

namespace selvage::bench {

/// Which scenes to run, and how.
struct SimulationPlan {
  std::filesystem::path folder;     ///< of the scene files
  std::vector<std::string> scenes;  ///< names; empty: all
  std::string scale = "small";      ///< empty: as the files stand
  std::int64_t frames = 0;          ///< of each; 0: as many as it has
  bool without_culling = true;      ///< also without infeasible-region culling (SPB figure 21)
  bool growth = true;               ///< also the cost of a step over 1, 10 and 100 octopi
  int threads = 1;
};

/// Runs scenes and prints the columns of SPB table 1 for each, and what part of the machine's limit the material solve
/// reaches.
/// @param json  file of the summaries, "-": standard output; empty: none
void measure_simulation(const SimulationPlan& plan, std::FILE* table, const std::string& json);

}  // namespace selvage::bench
