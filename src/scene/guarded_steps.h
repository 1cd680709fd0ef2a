#pragma once

#include "scene/scene_solver.h"
#include "selvage/scene/scene.h"

#include <array>
#include <memory>

namespace selvage {

/// Takes a scene from step to step. A step that cannot be guaranteed is taken in two of half its length, and so may
/// each of these: what a fast collider drags along is then led a shorter way, and has room where it had none. Only what
/// stays pinched in steps of a sixteenth is refused. Steps can also be halved from the first on. The same bits for any
/// number of threads, and after a stop, since solvers keep nothing that changes answers.
class GuardedSteps {
 public:
  /// @param scene         must outlive this
  /// @param with_contact  false: bodies pass through one another
  GuardedSteps(const Scene& scene, bool with_contact) : scene_(scene), with_contact_(with_contact) {}

  /// @param halvings  0 to 4: how often the step is halved in any case
  /// @param use       called with the solver after each part of the step that it has taken
  /// @returns         how many steps, of whatever length, were halved
  /// @throws PinchError  that of the longest step that was tried; the state is then of no use
  template <typename Use>
  std::int64_t step(State& state, int halvings, Use&& use) {
    // Time is counted in steps.
    const std::int64_t parts = std::int64_t{1} << halvings;
    std::int64_t halved = parts - 1;
    state.steps *= parts;
    for (std::int64_t part = 0; part < parts; ++part) halved += take(state, halvings, use);
    state.steps /= parts;
    return halved;
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
