#pragma once

#include "selvage/core/types.h"
#include "selvage/shapes/shapes.h"

namespace selvage {

/// A place along a centre line: the cross-section lies in the plane of normal and binormal, tangent = normal x
/// binormal.
struct RodSection {
  Vec3 point, tangent, normal, binormal;
};

/// True where the curve's end is its beginning.
bool is_closed(RodCurve curve);

/// Sections at equal steps of arc length along a curve of the given length, with frames that turn as little as possible
/// (double reflection, Wang et al. 2008); on a closed curve what is missing to a whole turn is spread evenly.
///
/// @param count  number of sections; on a closed curve the first is not repeated
std::vector<RodSection> rod_sections(RodCurve curve, double length, double radius, Index count);

/// Layers that a rod along the curve needs to keep its form: a knot more than a rod.
double fewest_layers(RodCurve curve);

/// Sections around a circle of the given radius around z.
std::vector<RodSection> circle_sections(double radius, Index count);

/// Largest radius with which a rod along the curve does not touch itself (the reach of the curve), from samples.
double largest_rod_radius(RodCurve curve, double length);

}  // namespace selvage
