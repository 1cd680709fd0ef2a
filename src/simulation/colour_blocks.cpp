#include "simulation/material_blocks.h"

namespace selvage {

namespace {

/// The least loaded colour that none of the neighbours has; kNone where they have all.
Index lightest_colour(std::span<const Index> neighbours, std::span<const Index> colours, std::span<const Index> loads,
                      std::vector<Index>& taken_by, Index taker) {
  for (const Index neighbour : neighbours)
    if (colours[neighbour] != kNone) taken_by[colours[neighbour]] = taker;
  Index best = kNone;
  for (Index colour = 0; colour < std::ssize(loads); ++colour)
    if (taken_by[colour] != taker && (best == kNone || loads[colour] < loads[best])) best = colour;
  return best;
}

}  // namespace

std::vector<Index> colour_blocks(std::span<const std::vector<Index>> conflicts) {
  const auto count = static_cast<Index>(conflicts.size());
  std::vector<Index> colours(count, kNone), loads, taken_by;
  for (Index block = 0; block < count; ++block) {
    Index colour = lightest_colour(conflicts[block], colours, loads, taken_by, block);
    if (colour == kNone) {
      colour = static_cast<Index>(loads.size());
      loads.push_back(0);
      taken_by.push_back(kNone);
    }
    colours[block] = colour;
    ++loads[colour];
  }
  // Colours that came late have few blocks.
  constexpr int kRounds = 4;
  for (int round = 0; round < kRounds; ++round)
    for (Index block = 0; block < count; ++block) {
      const Index colour = lightest_colour(conflicts[block], colours, loads, taken_by, (round + 1) * count + block);
      if (colour == kNone || loads[colour] + 1 >= loads[colours[block]]) continue;
      --loads[colours[block]];
      ++loads[colour];
      colours[block] = colour;
    }
  return colours;
}

}  // namespace selvage
