#pragma once

#include "selvage/core/types.h"

namespace selvage {

/// Friction of one contact during a step, after its projection along the normal: the change of the point's displacement
/// relative to the surface. Its tangential part is undone wholly where that is no more than `static_friction` times the
/// normal correction (stick), else by at most `dynamic_friction` times it (slip).
///
/// Share it out as the contact's projection was: vertex i moves by m_i w_i / (sum of m_k w_k^2) times the result, with
/// m the inverse masses and w the contact's weights.
///
/// @param displacement       of the point relative to the surface since the start of the step [m]
/// @param normal             unit normal of the contact
/// @param normal_correction  how far the projection has moved the point relative to the surface; not negative [m]
/// @param static_friction    coefficient of static friction
/// @param dynamic_friction   coefficient of dynamic friction
/// @return a vector across the normal; zero where nothing slides
///
/// Source: Bender, Mueller, Macklin 2015, A survey on position based dynamics, section on friction.
Vec3 friction_correction(const Vec3& displacement, const Vec3& normal, double normal_correction, double static_friction,
                         double dynamic_friction);

}  // namespace selvage
