#pragma once

#include "simulation/colliders/prepared_collider.h"
#include "simulation/implicit/incremental_potential.h"
#include "simulation/time_step/time_step.h"

namespace selvage {

/// Contacts and colliders of a step as energies (SPB, equation 7): stiffness/2 times the squared depth along the way
/// out, none in front of the target, and friction that is smooth near rest. The stiffness is kContactStiffness times
/// that with which the vertices together resist: light beside heavy and soft beside stiff, a contact gives way by a
/// part of what its elements do.

/// Stiffness of a contact, as a multiple of that of its vertices.
inline constexpr double kContactStiffness = 20;

/// Contacts of a step: bodies with one another, with themselves, and with edges and corners of colliders, which stay
/// where they are at its end. By CCD a point is kept as far in front of the surface as it was, up to kContactGap; by
/// DCD it is sent out by its largest correction at most.
void append_contact_terms(TimeStep& time_step, const IncrementalPotential& potential, std::vector<OffsetTerm>& terms);

/// Vertices that are inside colliders at x, each kept in front of the plane of its way out. One that starts the step
/// inside is kept from going deeper: TimeStep::project_colliders() takes it out, without speed.
void append_collider_terms(const TimeStep& time_step, std::span<const Vec3> x, const IncrementalPotential& potential,
                           std::vector<OffsetTerm>& terms);

}  // namespace selvage
