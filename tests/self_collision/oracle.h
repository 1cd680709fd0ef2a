#pragma once

#include "self_collision/surfaces.h"
#include "selvage/self_collision/self_collision.h"

namespace selvage::oracle {

/// All pairs of triangles that meet, one by one, in integer arithmetic: written apart from the library, from the
/// definition alone. Two convex sets meet where the origin lies in the hull of the differences of their points, their
/// interiors where it lies in the hull's interior; and that is told by the linear functions that are nowhere negative
/// on the differences.
std::vector<TrianglePair> meeting_pairs(const surfaces::Surface& surface, bool include_adjacent);

/// The same for two surfaces without a common vertex.
std::vector<TrianglePair> meeting_pairs(const surfaces::Surface& a, const surfaces::Surface& b);

/// How two triangles meet.
TriangleContact contact(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b);

}  // namespace selvage::oracle
