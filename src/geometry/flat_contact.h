#pragma once

#include <array>

#include "selvage/geometry/triangle_triangle.h"

namespace selvage {

/// `classify_contact` where one triangle at least is degenerate, or one plane holds both.
TriangleContact classify_flat_contact(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b);

/// Whether the point lies in the closed triangle, which may be degenerate.
bool triangle_contains(const std::array<Vec3, 3>& triangle, const Vec3& point);

}  // namespace selvage
