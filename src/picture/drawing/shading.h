#pragma once

#include "picture/drawing/colour.h"
#include "picture/drawing/raster.h"

namespace selvage {

/// How open the surroundings are, 1 in the open, towards 0 in a deep crevice: screen-space ambient occlusion. It varies
/// little from pixel to pixel, so that a single sample in each tells.
class Openness {
 public:
  /// Open everywhere.
  Openness() = default;

  /// @param layer          surfaces seen in the whole picture, one sample a pixel
  /// @param radius         how far occluders count [m]
  /// @param pixels_at_one  pixels that one metre takes at distance 1 [m]
  Openness(SurfaceLayer&& layer, float radius, float pixels_at_one);

  /// At a place [pixels] of a surface at this distance [m], where no pixel nearby sees that surface: 1.
  float at(float x, float y, float distance) const;

 private:
  int width_ = 0, height_ = 0;
  float radius_ = 0;
  std::vector<float> distance_, open_;  ///< of each pixel's sample, not yet smoothed
};

/// Colour of a surface of the given base colour under a light beside the eye and the light of the sky, seen from both
/// sides alike.
///
/// @param normal    towards the eye, any length
/// @param openness  as from Openness
Rgb shade(const Rgb& base, const Eigen::Vector3f& normal, float openness);

inline constexpr int kOutlineReach = 2;  ///< samples around one that an outline depends on

/// How strongly an outline runs through the sample: where the surface breaks off against what lies behind it.
float outline_strength(const SurfaceLayer& layer, int x, int y, float radius);

}  // namespace selvage
