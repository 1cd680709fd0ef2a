#pragma once

#include "picture/drawing/camera.h"
#include "picture/drawing/raster.h"

namespace selvage {

/// The corners of a surface's triangles on the picture: three vertices a triangle, so that sharp edges stay sharp.
/// Normals are averaged over the neighbours around a vertex that face nearly the same way.
///
/// @param vertex_value  one per vertex, the value of its corners; below 0: value 0 and weight 0
std::vector<ScreenVertex> place_corners(std::span<const Vec3> positions, std::span<const VertexTuple<3>> triangles,
                                        const Camera& camera, std::span<const double> vertex_value);

}  // namespace selvage
