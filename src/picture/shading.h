#pragma once

#include "picture/colour.h"
#include "picture/raster.h"

namespace selvage {

/// How open each sample's surroundings are, 1 in the open, towards 0 in a deep crevice: screen-space ambient occlusion.
///
/// @param layer          surfaces seen
/// @param radius         how far occluders count [m]
/// @param pixels_at_one  samples that one metre takes at distance 1 [m]
/// @return (width x height)
std::vector<float> compute_openness(const SurfaceLayer& layer, float radius, float pixels_at_one);

/// Colour of a surface of the given base colour under a light beside the eye and the light of the sky, seen from both
/// sides alike.
///
/// @param normal    towards the eye, any length
/// @param openness  as from compute_openness()
Rgb shade(const Rgb& base, const Eigen::Vector3f& normal, float openness);

/// How strongly an outline runs through the sample: where the surface breaks off against what lies behind it.
float outline_strength(const SurfaceLayer& layer, int x, int y, float radius);

}  // namespace selvage
