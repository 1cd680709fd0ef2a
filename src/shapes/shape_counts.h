#pragma once

#include "selvage/core/types.h"
#include "shapes/shape_arguments.h"

#include <numbers>

namespace selvage {

/// How many cells a structured shape gets in each direction, and how many elements that makes; as doubles, for they may
/// be huge.
struct ShapeCells {
  double u, v, w;
  double elements;
};

inline ShapeCells box_cells(const Vec3& size, double cell) {
  const double x = cell_count(size[0], cell), y = cell_count(size[1], cell), z = cell_count(size[2], cell);
  return {x, y, z, 6 * x * y * z};
}

/// Elements of rods and tubes are at most this much longer than thick, however large the cell: then their dihedral
/// angles stay above 8 degrees.
inline constexpr double kLongest = 4;

/// Layers through the wall, cells around, cells along. Throws Error where the radii leave no wall.
inline ShapeCells tube_cells(double outer_radius, double inner_radius, double length, double cell) {
  if (!(inner_radius < outer_radius))
    throw Error("inner radius", fmt::format("{} is not smaller than the outer radius {}", inner_radius, outer_radius),
                "use a smaller inner radius");
  const double layers = cell_count(outer_radius - inner_radius, cell);
  const double longest = kLongest * (outer_radius - inner_radius);
  if (cell > longest) cell = longest;
  const double around = cell_count(std::numbers::pi * (outer_radius + inner_radius), cell, 12);
  const double along = cell_count(length, cell);
  return {layers, around, along, 6 * layers * around * along};
}

inline constexpr int kMinTeeth = 5, kMaxTeeth = 1000;

/// Of the circle at the feet of a gear's teeth.
inline double gear_root(double radius, int teeth) {
  const double module = 2 * radius / (teeth + 2);
  return radius - 2.25 * module;
}

/// Layers through a gear, cells around, as many for each tooth, cells along. Throws Error where it has no such teeth,
/// or the hole leaves nothing below them.
inline ShapeCells gear_cells(double radius, double hole_radius, double length, int teeth, double cell) {
  if (teeth < kMinTeeth || teeth > kMaxTeeth)
    throw Error("teeth", fmt::format("{} are no gear", teeth), fmt::format("use {} to {}", kMinTeeth, kMaxTeeth));
  if (const double root = gear_root(radius, teeth); !(hole_radius < root))
    throw Error("inner radius", fmt::format("{} leaves nothing below the teeth", hole_radius),
                fmt::format("use less than {:.3g}", root));
  const double pitch = 2 * std::numbers::pi * radius / teeth;
  if (cell > pitch / 5) cell = pitch / 5;
  const double layers = cell_count(radius - hole_radius, cell, 2), along = cell_count(length, cell);
  const double around = teeth * cell_count(pitch, cell, 10);
  return {layers, around, along, 6 * layers * around * along};
}

/// Rings of the disc, layers of prisms along the sweep.
inline ShapeCells swept_cells(double length, double radius, double cell, double fewest_layers) {
  const double rings = cell_count(radius, cell);
  const double longest = kLongest * radius;
  const double layers = cell_count(length, cell > longest ? longest : cell, fewest_layers);
  return {rings, layers, 0, 3 * 6 * rings * rings * layers};
}

/// A ring needs a few layers to be round.
inline constexpr double kMinTorusLayers = 12;

inline ShapeCells cloth_cells(double width, double height, double cell) {
  const double columns = cell_count(width, cell), rows = cell_count(height, cell);
  return {columns, rows, 0, 2 * columns * rows};
}

inline ShapeCells sleeve_cells(double radius, double length, double cell) {
  const double around = cell_count(2 * std::numbers::pi * radius, cell, 6), along = cell_count(length, cell);
  return {around, along, 0, 2 * around * along};
}

}  // namespace selvage
