#pragma once

#include "selvage/core/types.h"

namespace selvage {

/// Coefficients of (Coulomb) friction: of what sticks, and of what slips.
struct Friction {
  double static_friction = 0, dynamic_friction = 0;
};

/// What one contact has done to its point during a step in which it is projected any number of times.
struct Grip {
  double pressed = 0;        ///< sum of the corrections along the normal [m]
  Vec3 held = Vec3::Zero();  ///< sum of those by friction [m]
};

/// Friction of one contact after each projection along its normal: the change of the point's displacement relative to
/// the surface. All of it since the start of the step together undoes the whole tangential displacement where that
/// takes no more than `static_friction` times what the contact has pressed in the step (stick), else it is no more than
/// that where `dynamic_friction` stops what slides already within the step, and no more than `dynamic_friction` times
/// what is pressed where it does not (slip). Judged per projection instead, what is pressed once and projected again
/// would hardly hold: the second time there is little left to press. Were all that gives way held by dynamic friction
/// alone, the first vertex of a body that a tremor moves would leave its share to the others, and these follow: a block
/// would slide down a slope that is too flat for it.
///
/// Share it out as the contact's projection was: vertex i moves by m_i w_i / (sum of m_k w_k^2) times the result, with
/// m the inverse masses and w the contact's weights.
///
/// @param displacement       of the point relative to the surface since the start of the step [m]
/// @param drift              the displacement that the speed at the start of the step alone would have given it [m]
/// @param normal             unit normal of the contact
/// @param normal_correction  how far this projection has moved the point relative to the surface; not negative [m]
/// @param grip               what earlier projections did; this one is added
/// @return a vector across the normal; zero where nothing slides
///
/// Source: Bender, Mueller, Macklin 2015, A survey on position based dynamics, section on friction.
Vec3 friction_correction(const Vec3& displacement, const Vec3& drift, const Vec3& normal, double normal_correction,
                         const Friction& friction, Grip& grip);

}  // namespace selvage
