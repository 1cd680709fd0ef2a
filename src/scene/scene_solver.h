#pragma once

#include "selvage/scene/scene.h"

#include <variant>

namespace selvage {

/// The solver that a scene asks for.
class SceneSolver {
 public:
  /// @param scene         must outlive this
  /// @param with_contact  false: bodies pass through one another
  SceneSolver(const Scene& scene, bool with_contact) : SceneSolver(scene, with_contact, scene.options.time_step) {}

  /// The same, in other steps.
  SceneSolver(const Scene& scene, bool with_contact, double time_step)
      : solver_(make(scene, with_contact, time_step)) {}

  void step(State& state) {
    std::visit([&](auto& solver) { solver.step(state); }, solver_);
  }
  const StepStatistics& statistics() const {
    return std::visit([](const auto& solver) -> const StepStatistics& { return solver.statistics(); }, solver_);
  }
  /// Where the solver has one, else 0.
  double objective() const {
    return std::visit(
        [](const auto& solver) {
          if constexpr (requires { solver.objective(); }) return solver.objective();
          return 0.0;
        },
        solver_);
  }

 private:
  using Solver = std::variant<XpbdSolver, NewtonSolver, VbdSolver>;

  static Solver make(const Scene& scene, bool with_contact, double time_step) {
    StepOptions shared = scene.options;
    shared.time_step = time_step;
    if (!with_contact) shared.contact.mode = DetectionMode::kOff;
    const auto make_with = [&]<typename Made, typename Options>(Options options) {
      static_cast<StepOptions&>(options) = shared;
      return Solver(std::in_place_type<Made>, scene.model, scene.initial_state, scene.handles, scene.colliders,
                    options);
    };
    switch (scene.solver) {
      case SolverKind::kNewton:
        return make_with.template operator()<NewtonSolver>(scene.newton);
      case SolverKind::kVbd:
        return make_with.template operator()<VbdSolver>(VbdOptions{{}, scene.options.iterations, scene.vbd_residual});
      default:
        return make_with.template operator()<XpbdSolver>(scene.options);
    }
  }

  Solver solver_;
};

}  // namespace selvage
