#pragma once

#include "selvage/contact/contact_finder.h"
#include "selvage/contact/friction.h"
#include "selvage/core/error.h"

#include <limits>

namespace selvage {

/// A step that cannot be guaranteed: ContactOptions::guarantee. Handles or colliders press bodies together, or lead
/// them through one another, so that something meets however vertices are held back. The state stays as it was.
class PinchError : public Error {
 public:
  using Error::Error;
};

/// Options of a time step that all solvers share.
///
/// With ContactOptions::guarantee a step throws PinchError rather than let anything meet that was free at its start: of
/// vertices and faces, and of edges, that share no vertex and belong to bodies or one to a collider, none meets on the
/// straight way from State::positions before to those after, decided exactly. Where bodies penetrate at the start of a
/// step, StepStatistics::unguarded_vertices says so.
///
/// Bodies that touch one another, and no collider, handle, pinned or sleeping vertex or constraint of the user, keep
/// their momentum and angular momentum to rounding, whatever the solver leaves undone.
struct StepOptions {
  double time_step = 1.0 / 300;  ///< [s] of one step
  Vec3 gravity{0, 0, -9.81};     ///< [m/s^2]
  double velocity_damping = 0;   ///< of all motion, as in a fluid [1/s]
  /// Of all motion but the rigid one of each connected piece: what swings comes to rest, and falls as without [1/s].
  double deformation_damping = 0;
  /// A body sleeps, held still as if pinned, once all but 2% of its mass has moved slower than this part of
  /// the speed of a fall through its own size, for half a second, without penetrating, and so has all that is near it.
  /// What comes near and moves, a collider or handle that moves, a velocity and external forces wake it. Bodies near
  /// one another that are nearly so slow (six times) are damped before, but for the velocity with which they fall or
  /// slide together, and sleep too where they only tremble in their places for three seconds; the spin of a body alone
  /// on a collider is damped, as by a rolling resistance of 3%. 0: nothing sleeps.
  double sleep_speed = 0;
  double max_speed = std::numeric_limits<double>::infinity();  ///< with which a vertex ends a step [m/s]
  /// Of bodies on one another and on themselves; colliders have their own.
  Friction friction{.static_coefficient = 0.3, .dynamic_coefficient = 0.2};
  ContactOptions contact{};  ///< of bodies with one another and with themselves
};

/// Counts and times of one step. Shares of the step are `seconds_material`, the seconds of `contact`
/// and `seconds_projection`; the rest of `seconds` goes to prediction and velocities.
struct StepStatistics {
  std::int64_t constraints = 0;         ///< material constraints solved, over all iterations
  std::int64_t collider_contacts = 0;   ///< times that a vertex was pushed out of a collider
  std::int64_t missed_rounds = 0;       ///< in which contacts were found after the solver, and projected
  std::int64_t hold_back_rounds = 0;    ///< in which vertices were held back: ContactOptions::hold_back
  std::int64_t held_back_vertices = 0;  ///< that end the step elsewhere than the solver left them
  std::int64_t impacts_met = 0;         ///< pairs that met at the end of the solver, before vertices were held back
  std::int64_t impacts_left = 0;        ///< pairs that meet in the end all the same
  std::int64_t unguarded_vertices = 0;  ///< where bodies penetrate at the start; 0: nothing meets in the step, but
                                        ///< impacts_left
  std::int64_t sleeping_bodies = 0;     ///< StepOptions::sleep_speed
  std::int64_t newton_steps = 0;        ///< of the implicit solvers: Newton steps, or sweeps over all vertices
  std::int64_t linear_iterations = 0;   ///< of conjugate gradients, over all Newton steps
  /// Of the implicit solvers, before what is left inside is projected: the distance by which the force out of balance
  /// at a vertex would move it alone in the step, the largest of all [m]. 0: backward Euler is solved exactly.
  double residual = 0;
  ContactStatistics contact;
  double seconds_material = 0;    ///< [s] of the material solve
  double seconds_hold_back = 0;   ///< [s] of holding back; of this the search for what meets is also in `contact`
  double seconds_projection = 0;  ///< [s] of projecting contacts, colliders and friction
  double seconds = 0;             ///< [s] of all

  double constraints_per_second() const {
    return seconds_material > 0 ? static_cast<double>(constraints) / seconds_material : 0;
  }
};

}  // namespace selvage
