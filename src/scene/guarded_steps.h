#pragma once

#include "scene/scene_solver.h"
#include "selvage/scene/scene.h"

#include <array>
#include <memory>

namespace selvage {

/// Takes a scene from step to step. A step that cannot be guaranteed is taken in two of half its length, and so may
/// each of these: what a fast collider drags along is then led a shorter way, and has room where it had none. Only what
/// stays pinched in steps of a sixteenth is refused. The same bits for any number of threads, and after a stop, since
/// solvers keep nothing that changes answers.
class GuardedSteps {
 public:
  /// @param scene         must outlive this
  /// @param with_contact  false: bodies pass through one another
  GuardedSteps(const Scene& scene, bool with_contact) : scene_(scene), with_contact_(with_contact) {}

  /// @param use  called with the solver after each part of the step that it has taken
  /// @returns    how many steps, of whatever length, were halved
  /// @throws PinchError  that of the whole step; the state is then of no use
  template <typename Use>
  std::int64_t step(State& state, Use&& use) {
    return take(state, 0, use);
  }

 private:
  static constexpr int kMaxHalvings = 4;

  template <typename Use>
  std::int64_t take(State& state, int halvings, Use& use) {
    SceneSolver& solver = solver_of(halvings);
    try {
      solver.step(state);
      use(solver);
      return 0;
    } catch (const PinchError&) {
      if (halvings == kMaxHalvings) throw;
      try {
        // Time is counted in steps.
        state.steps *= 2;
        const std::int64_t first = take(state, halvings + 1, use), second = take(state, halvings + 1, use);
        state.steps /= 2;
        return 1 + first + second;
      } catch (const PinchError&) {
      }
      throw;
    }
  }

  SceneSolver& solver_of(int halvings) {
    std::unique_ptr<SceneSolver>& solver = solvers_[halvings];
    if (!solver)
      solver = std::make_unique<SceneSolver>(scene_, with_contact_, scene_.options.time_step / (1 << halvings));
    return *solver;
  }

  const Scene& scene_;
  bool with_contact_;
  std::array<std::unique_ptr<SceneSolver>, kMaxHalvings + 1> solvers_;  ///< by halvings; made where needed
};

}  // namespace selvage
