#pragma once

#include "selvage/core/types.h"
#include "selvage/mesh/indexed_mesh.h"

#include <cstdint>
#include <optional>
#include <string_view>

namespace selvage {

/// Tetrahedral and triangle meshes made by formula, so that everything can be tried without data. All elements are
/// positive and well shaped, and no shape touches itself; the same arguments give the same bits. Lengths in metres.

/// Axis-aligned box [0, size] cut into cells of about `cell` edge length, each cut into tetrahedra that meet face to
/// face.
/// @throws Error  when a size or the cell is not positive and finite, or the mesh would exceed 2^29 elements; so do all
IndexedMesh make_box(const Vec3& size, double cell);

/// Ball of the given radius around the origin, by isosurface stuffing.
IndexedMesh make_ball(double radius, double cell);

/// Solid torus around the z axis: a disc of radius `minor_radius` swept along a circle of radius `major_radius`.
IndexedMesh make_torus(double major_radius, double minor_radius, double cell);

/// Hollow pipe from z = 0 to z = length, by structured cells: outer and inner radius.
IndexedMesh make_tube(double outer_radius, double inner_radius, double length, double cell);

/// Centre lines for rods: along x; a trefoil knot; a rope that follows a trefoil twice, twining around itself (a knot
/// nested in a knot); a long noodle laid as a coil around z; a rope along x with an overhand knot in its middle, not
/// yet pulled tight; the same with a smaller overhand knot in the strand that the first will close around.
enum class RodCurve { kStraight, kTrefoil, kNestedKnot, kCoil, kOverhand, kNestedOverhand };

/// Rod of circular cross-section swept along a curve of the given total length; trefoil and nested knot are closed.
/// Rods with ends of the same length, radius and cell have the same elements.
/// @throws Error  also when the radius is so large that the rod would touch itself
IndexedMesh make_rod(RodCurve curve, double length, double radius, double cell);

/// Ball with `tentacles` thin arms standing out of it, by isosurface stuffing; `seed` jitters their directions. The
/// more tentacles, the thinner they are; `slenderness` is their length in radii of the ball.
/// @throws Error  also when the cell is too coarse for a tentacle, and for a slenderness below 1
IndexedMesh make_squishy_ball(double radius, int tentacles, double cell, unsigned seed, double slenderness = 1);

/// A head with eight bent arms that reach about `size` from its centre, by isosurface stuffing; `seed` varies how the
/// arms bend. Head and roots of the arms are thinner by the factor `slenderness`, the tips by its square root.
/// @throws Error  also when the cell is too coarse for an arm, and for a slenderness outside [1, 4]
IndexedMesh make_octopus(double size, double cell, unsigned seed, double slenderness = 1);

/// Gear around the z axis from z = 0 to z = length, a tooth on the x axis: `radius` reaches to the tips of its teeth.
/// Two gears with n and m teeth turn in one another where both have the same module 2 radius / (teeth + 2), and stand
/// (n + m) / 2 modules apart.
/// @throws Error  also when the hole reaches the teeth, and for fewer than 5 teeth
IndexedMesh make_gear(double radius, double hole_radius, double length, int teeth, double cell);

/// Rectangular cloth [0, width] x [0, height] in the xy plane, a triangle surface.
IndexedMesh make_cloth(double width, double height, double cell);

/// Cloth sewn to an open tube, from the plane z = 0 upwards around the z axis: a triangle surface. Of at least six
/// cells around.
IndexedMesh make_sleeve(double radius, double length, double cell);

/// Concatenates several meshes into one with several objects; vertices and elements keep their order.
IndexedMesh concatenate(std::span<const IndexedMesh> meshes);

/// Measures of a named shape; those left out take the shape's own default.
struct ShapeOptions {
  std::optional<double> cell = {};            ///< edge length of a cell [m]
  std::optional<std::int64_t> elements = {};  ///< instead of `cell`: about this many elements
  std::optional<Vec3> size = {};              ///< box, beam; cloth (x and y) [m]
  std::optional<double> length = {};          ///< rods, tube, gear, sleeve [m]
  std::optional<double> radius =
      {};  ///< rods, balls, sleeve, tube (outer), torus (major), gear (tips), octopus (reach) [m]
  std::optional<double> inner_radius = {};  ///< tube (inner), torus (minor), gear (hole) [m]
  std::optional<int> tentacles = {};        ///< squishy-ball
  std::optional<int> teeth = {};            ///< gear
  std::optional<unsigned> seed = {};        ///< squishy-ball, octopus
  std::optional<double> slenderness = {};   ///< squishy-ball, octopus: thinner arms
};

/// Names that make_shape knows: box, beam, rod, trefoil, nested-knot, noodle, overhand, nested-overhand, ball, torus,
/// tube, squishy-ball, octopus, gear, cloth. It also takes sphere for ball.
std::span<const std::string_view> shape_names();

/// Names of the curves that a rod may follow: straight, trefoil, nested-knot, coil, overhand, nested-overhand.
std::span<const std::string_view> curve_names();

/// Name of the shape that a rod along a curve is: rod (straight), noodle (coil), else the name of the curve.
/// @throws Error  when there is no such curve
std::string_view shape_along_curve(std::string_view curve);

/// Moves a mesh so that the middle of the box around its vertices is the origin, up to rounding. Nothing happens to an
/// empty one.
void centre_at_origin(std::span<Vec3> positions);

/// Makes a shape by its name.
/// @throws Error  for an unknown name, an option that the shape does not have, or arguments that its maker refuses
IndexedMesh make_shape(std::string_view name, const ShapeOptions& options = {});

/// The cell with which the shape gets about `target` elements: within a tenth for fine meshes; where a thin shape can
/// only jump from one count to the next, the nearer.
/// @throws Error  as make_shape does, and when no cell gives the shape so few elements
double cell_for_element_count(std::string_view name, const ShapeOptions& options, std::int64_t target);

}  // namespace selvage
