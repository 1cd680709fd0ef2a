#pragma once

#include "selvage/core/types.h"
#include "selvage/mesh/indexed_mesh.h"

#include <optional>
#include <string_view>

namespace selvage {

/// Poses: maps that move a mesh's vertices so that the mesh runs into itself while every element stays positive.
///
/// A map of all space that keeps orientation everywhere is one-to-one, so a mesh can only run into itself when the map
/// is defined on the mesh alone: along a curve that crosses itself (bend, fold, self-crossing), or arm by arm (swirl).
/// The determinants below are those of the smooth maps; an element keeps its orientation when it is small against the
/// radius of the bend or the height of a turn.
///
/// The poses along a curve bend the mesh towards the thinner of its two other axes. Their determinant is 1 - k u, with
/// k the curvature and u the distance from the middle: positive where the mesh is thinner than the bend is wide.
/// @throws Error  where it would not be positive, when a number is not finite, an axis not 0, 1 or 2, or the mesh flat
///                along the axis; so do all

/// Turns cross-sections about the `axis` (0, 1, 2) through the centre, by `turns` full turns from one end to the other.
/// Determinant 1. One-to-one: it tangles nothing by itself.
void pose_twist(std::span<Vec3> positions, int axis, double turns);

/// Bends the mesh along `axis` into an arc of `turns` full turns, so that with more than one turn it passes through
/// itself.
void pose_bend(std::span<Vec3> positions, int axis, double turns);

/// Folds the mesh in the middle of `axis` by `angle` radians around a rounded crease, so that above pi one half passes
/// through the other. The crease is as wide as the thickness asks for.
void pose_fold(std::span<Vec3> positions, int axis, double angle);

/// Lays a mesh that is long in `axis` along a plane curve of loops that crosses itself `crossings` times without
/// rising.
void pose_self_crossing(std::span<Vec3> positions, int axis, int crossings);

/// Turns every arm of a mesh about the z axis through the centre, by an angle that grows with the distance from 0 at
/// `core` (a fraction of the largest distance) to `turns` full turns at the tip; one arm to the left, the next to the
/// right, so that they pass through each other. An arm is a connected piece of what lies farther away than the core.
/// Determinant 1 on each arm.
void pose_swirl(IndexedMesh& mesh, double core, double turns);

/// Moves the vertices from `first` on by `offset`: objects of one mesh overlap. Determinant 1.
void pose_overlap(std::span<Vec3> positions, Index first, const Vec3& offset);

/// Parameters of a named pose; those left out take a default that tangles.
struct PoseOptions {
  std::optional<int> axis = {};       ///< default: the mesh's longest; not for swirl and overlap
  std::optional<double> turns = {};   ///< twist (1), bend (1.25), swirl (0.15)
  std::optional<double> angle = {};   ///< fold [rad] (4.2)
  std::optional<int> crossings = {};  ///< self-crossing (2), twist (1; 0: only turned)
  std::optional<double> core = {};    ///< swirl (0.5)
  std::optional<Vec3> offset = {};    ///< overlap [m] (about a third of the mesh's size)
};

/// Names that apply_pose knows: twist, bend, fold, swirl, self-crossing, overlap.
std::span<const std::string_view> pose_names();

/// Poses a mesh by name. Two of the names do more than the map of that name: `twist` also lets the mesh throw a loop
/// through itself, as a twisted rope does, unless it is to have none; `overlap` adds a copy of the mesh as a second
/// object, moved by the offset.
/// @throws Error  for an unknown name, an option that the pose does not have, arguments that the pose refuses, and when
///                a tetrahedron would turn over or be flattened; the mesh is as it was then
void apply_pose(IndexedMesh& mesh, std::string_view name, const PoseOptions& options = {});

/// A shape and a pose by whose defaults the shape runs into itself with no element inverted.
struct TangledExample {
  std::string_view shape;
  std::string_view pose;
};

/// The pairs for which that is tested.
std::span<const TangledExample> tangled_examples();

}  // namespace selvage
