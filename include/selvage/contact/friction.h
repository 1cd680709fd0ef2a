#pragma once

#include "selvage/core/types.h"

namespace selvage {

/// Coefficients of Coulomb friction, without unit: of a contact that sticks, and of one that slips.
struct Friction {
  double static_coefficient = 0, dynamic_coefficient = 0;
};

/// Corrections that one contact has made to its point so far in a step. A contact is projected several times a step.
struct FrictionState {
  double normal_sum = 0;               ///< sum of the lengths of the corrections along the normal [m]
  Vec3 tangential_sum = Vec3::Zero();  ///< sum of the corrections by friction [m]
};

/// Friction of one contact after a projection along its normal: the change of the point's displacement relative to the
/// surface.
///
/// The limits of Coulomb's law hold for the sums over the step, not for one projection. Let N be `normal_sum`, with
/// this projection. The sum of the friction corrections
/// - sticks: it undoes the whole tangential displacement where that takes no more than `static_coefficient` * N;
/// - stops: else it is at most `static_coefficient` * N long where `dynamic_coefficient` * N is enough to stop the
/// drift;
/// - slips: else it is at most `dynamic_coefficient` * N long.
///
/// Why sums: a contact is projected again with hardly any correction along the normal. A limit for each projection
/// would then allow hardly any friction.
/// Why a limit for stops: a small vibration moves one vertex of a resting body past the static limit. With the dynamic
/// limit it would pass its share of the load to the others, these would slip in turn, and a block would slide down a
/// slope on which it should rest.
///
/// Distribute the result as the contact's projection was distributed: vertex i moves by m_i w_i / (sum of m_k w_k^2)
/// times the result, with m the inverse masses and w the contact's weights.
///
/// @param displacement       of the point relative to the surface since the start of the step [m]
/// @param drift              displacement that the velocity at the start of the step alone would have caused [m]
/// @param normal             unit normal of the contact
/// @param normal_correction  how far this projection has moved the point relative to the surface; not negative [m]
/// @param state              of the earlier projections in this step; updated
/// @return a vector across the normal; zero where nothing slides
///
/// Source: Bender, Mueller, Macklin 2015, A survey on position based dynamics, section on friction.
Vec3 friction_correction(const Vec3& displacement, const Vec3& drift, const Vec3& normal, double normal_correction,
                         const Friction& friction, FrictionState& state);

}  // namespace selvage
