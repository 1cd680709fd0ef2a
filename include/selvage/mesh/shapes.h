#pragma once

#include "selvage/core/types.h"
#include "selvage/mesh/mesh_file.h"

#include <string>

namespace selvage {

/// Tetrahedral and triangle meshes made by formula, so that everything can be tried without data. All elements are
/// positive and well shaped; the same arguments give the same bits. Lengths in metres.

/// Axis-aligned box [0, size] cut into cells of about `cell` edge length, each cut into tetrahedra that meet face to face.
/// @throws Error  when a size or the cell is not positive and finite, or the mesh would exceed 2^29 elements; so do all
MeshFile make_box(const Vec3& size, double cell);

/// Ball of the given radius around the origin, by isosurface stuffing.
MeshFile make_ball(double radius, double cell);

/// Solid torus around the z axis.
MeshFile make_torus(double major_radius, double minor_radius, double cell);

/// Hollow pipe along z, by structured cells: outer and inner radius.
MeshFile make_tube(double outer_radius, double inner_radius, double length, double cell);

/// Centre lines for rods.
enum class RodCurve { kStraight, kTrefoil, kNestedKnot, kCoil };

/// Rod of circular cross-section swept along a curve of the given total length (closed where the curve is closed).
MeshFile make_rod(RodCurve curve, double length, double radius, double cell);

/// Ball with `tentacles` thin arms standing out of it, by isosurface stuffing; `seed` jitters their directions.
MeshFile make_squishy_ball(double radius, int tentacles, double cell, unsigned seed);

/// A head with eight bent arms, by isosurface stuffing; `seed` varies how the arms bend.
MeshFile make_octopus(double size, double cell, unsigned seed);

/// Rectangular cloth in the xy plane, a triangle surface.
MeshFile make_cloth(double width, double height, double cell);

/// Concatenates several meshes into one with several objects; vertices and elements keep their order.
MeshFile concatenate(std::span<const MeshFile> meshes);

}  // namespace selvage
