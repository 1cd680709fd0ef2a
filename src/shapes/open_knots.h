#pragma once

#include "selvage/core/types.h"

namespace selvage {

/// An overhand knot in a rope with two straight ends along x, in units of its own: from (-9, 0, 0) at t = 0 to
/// (9, 0, 0) at t = 1. Turned by half a turn about y it is the same. Smooth: the second derivative is continuous.
Vec3 overhand_point(double t);

/// The same with a second knot, a third as large, in the strand that runs through its middle: pulled tight, the large
/// knot closes around the small one.
Vec3 nested_overhand_point(double t);

}  // namespace selvage
