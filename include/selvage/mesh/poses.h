#pragma once

#include "selvage/core/types.h"

#include <string>

namespace selvage {

/// Poses: maps of space that move a mesh's vertices so that the mesh runs into itself while every element stays
/// positive (for elements small against the bend; `orientation` of the result tells).

/// Turns cross-sections about the `axis` (0, 1, 2) through the centre, by `turns` full turns from one end to the other.
void pose_twist(std::span<Vec3> positions, int axis, double turns);

/// Bends the mesh along `axis` into an arc in the plane of `axis` and the next axis: `turns` full turns over its length,
/// so that with more than one turn it passes through itself.
void pose_bend(std::span<Vec3> positions, int axis, double turns);

/// Folds the mesh in the middle of `axis` by `angle` radians around a rounded crease, so that above pi one half passes
/// through the other.
void pose_fold(std::span<Vec3> positions, int axis, double angle);

/// Turns every point about the z axis through the centre by an angle that grows towards the axis, `turns` at the centre.
void pose_swirl(std::span<Vec3> positions, double turns);

/// Lays a mesh that is long in `axis` along a plane curve that crosses itself `crossings` times without rising.
void pose_self_crossing(std::span<Vec3> positions, int axis, int crossings);

/// Moves the vertices from `first` on by `offset`: objects of one mesh overlap.
void pose_overlap(std::span<Vec3> positions, Index first, const Vec3& offset);

}  // namespace selvage
