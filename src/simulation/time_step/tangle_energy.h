#pragma once

#include "selvage/contact/contact.h"
#include "selvage/simulation/model.h"
#include "simulation/step_vertex.h"

#include <span>

namespace selvage {

/// Takes from bodies that are inside one another, or in themselves, the speed that their ways out gave them in a step.
/// Bodies that are linked by ways out have no more kinetic energy than before these, or than by `speed` against their
/// common centre of mass, and the same linear momentum: all move less against that centre, by one factor. Without, two
/// boxes that start half in one another fly apart at 9 m/s.
///
/// @param vertices    (n_contact_vertices) at the end of the step; those without inverse mass keep their velocity
/// @param body_of     (n_vertices) kNone: of no body
/// @param before      (n_vertices) velocities by inertia and forces [m/s]
/// @param speed       root mean square that is always left: what has none at all stays hooked into one another [m/s]
/// @param velocities  (n_vertices) at the end of the step [m/s]
void limit_tangle_energy(const Model& model, std::span<const Contact> contacts, std::span<const StepVertex> vertices,
                         std::span<const Index> body_of, std::span<const Vec3> before, double speed,
                         std::span<Vec3> velocities);

}  // namespace selvage
