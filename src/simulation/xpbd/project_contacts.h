#pragma once

#include "selvage/contact/contact.h"
#include "selvage/contact/friction.h"
#include "simulation/colliders/project_colliders.h"
#include "simulation/step.h"
#include "simulation/step_vertex.h"

namespace selvage {

/// Friction of one contact during a step.
struct ContactFriction {
  Friction coefficients;
  FrictionState state{};
};

/// Moves vertices out of every contact, one after the other in the order given, with friction.
///
/// A contact by CCD keeps its point in front of the surface, by as much as it was at the start of the step and
/// kContactGap at most, which gives it no speed: set on the surface itself, rounding and other contacts would leave
/// half of the points inside, and the next step would look for their way out.
///
/// A contact by DCD sends its point out by at most the least of the largest corrections of its vertices: where elements
/// are inverted, the way out can be a long detour, and all of it at once would invert the point's own elements, and
/// theirs in turn others. A collider's point is left by so much that the body gains kOffCollider of that in the step.
///
/// A vertex that a collider has pushed in the step is not pushed back into it: the other side of the contact moves all
/// the way. Else either would undo a half of the other, and where a body stands on vertices of another that lie on the
/// floor, contacts would still be open at the end of the step, to be held back as they were at its start.
///
/// @param max_corrections  (n_vertices) see max_corrections_of() [m]
/// @param frictions        (n_contacts) updated
/// @param ejected          (n_vertices) see TimeStep::ejected() [m]; updated
void project_contacts(std::span<const Contact> contacts, const Step& step, std::span<const double> max_corrections,
                      const ColliderSupports& supports, std::span<ContactFriction> frictions, std::span<Vec3> ejected,
                      std::span<StepVertex> vertices);

/// How far points are pushed out of surfaces.
struct Push {
  double clearance;       ///< to be in front of the surface [m]
  double max_correction;  ///< in one projection [m]
};

/// Moves vertices out of every contact, one after the other in the order given, without friction.
void push_apart(std::span<const Contact> contacts, const Push& push, std::span<StepVertex> vertices);

}  // namespace selvage
