#pragma once

#include "selvage/contact/contact_finder.h"
#include "selvage/simulation/collider.h"
#include "selvage/simulation/model.h"

namespace selvage {

struct XpbdOptions {
  double time_step = 1.0 / 300;                                ///< [s] of one step
  int iterations = 3;                                          ///< of the material solve in a step
  Vec3 gravity{0, 0, -9.81};                                   ///< [m/s^2]
  double velocity_damping = 0;                                 ///< [1/s]
  double max_speed = std::numeric_limits<double>::infinity();  ///< [m/s]
  double static_friction = 0.3, dynamic_friction = 0.2;        ///< of bodies on one another and on themselves
  ContactOptions contact{};                                    ///< of bodies with one another and with themselves
};

/// What one step did, and how long its parts took. Shares of the step are `seconds_material`, the seconds of `contact`
/// and `seconds_projection`; the rest of `seconds` goes to prediction and velocities.
struct StepStatistics {
  std::int64_t constraints = 0;        ///< material constraints solved, over all iterations
  std::int64_t collider_contacts = 0;  ///< times that a vertex was pushed out of a collider
  ContactStatistics contact;
  double seconds_material = 0;    ///< [s] of the material solve
  double seconds_projection = 0;  ///< [s] of projecting contacts, colliders and friction
  double seconds = 0;             ///< [s] of all

  double constraints_per_second() const {
    return seconds_material > 0 ? static_cast<double>(constraints) / seconds_material : 0;
  }
};

/// Deformable bodies in time: XPBD with the contacts of SPB.
///
/// One step is SPB's supplement, algorithm 5, but that contacts are found after the first half of the iterations and
/// projected then and after each of the others, not once. The material is solved by Gauss-Seidel over blocks of
/// elements: blocks of one colour share no vertex and are solved at the same time, inside a block by as many lanes as
/// registers have. The result is the same, bit for bit, for any number of threads and on any instruction set.
/// Sources: Macklin, Mueller, Chentanez 2016 (XPBD); Macklin and Mueller 2021; Chen, Diaz, Yuksel 2023 (SPB).
class XpbdSolver {
 public:
  /// @param model    must outlive the solver
  /// @param initial  where handles start: the state at time 0, also where a run is continued from a later one
  /// @throws Error   when a size, an index, a handle, a collider or an option is impossible; it names which
  XpbdSolver(const Model& model, const State& initial, std::vector<Handle> handles, std::vector<Collider> colliders,
             const XpbdOptions& options);
  ~XpbdSolver();
  XpbdSolver(XpbdSolver&&) noexcept;
  XpbdSolver& operator=(XpbdSolver&&) noexcept;

  /// Takes the state one time step further. What follows depends on the state alone, not on steps before.
  /// @throws Error  naming the first vertex whose position stops being finite (is_in_range()); the state is then left
  /// as it was
  void step(State& state);

  /// Of the last step.
  const StepStatistics& statistics() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace selvage
