#pragma once

#include "selvage/simulation/step.h"
#include "simulation/bodies.h"

namespace selvage::bodies {

/// Takes guarded steps: nothing meets in any, by a judge with `pairs(before, after)`, and none is held back in which
/// nothing would meet.
/// @param met, held  what met and what was held back is added to these
template <typename Judge, typename Solver>
void expect_free_steps(const Judge& judge, Solver& solver, State& state, int steps, std::uint64_t seed,
                       std::int64_t& met, std::int64_t& held) {
  for (int i = 0; i < steps; ++i) {
    const State before = state;
    solver.step(state);
    ASSERT_EQ(judge.pairs(before, state), 0) << seed << ", step " << i;
    const StepStatistics& statistics = solver.statistics();
    EXPECT_EQ(statistics.unguarded_vertices, 0);
    if (statistics.impacts_met == 0 && statistics.hold_back_rounds == 0) {
      EXPECT_EQ(statistics.held_back_vertices, 0);
    }
    met += statistics.impacts_met;
    held += statistics.held_back_vertices;
  }
}

}  // namespace selvage::bodies
