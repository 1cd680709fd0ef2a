#pragma once

#include "picture/drawing/colour.h"
#include "picture/drawing/light_maps.h"

namespace selvage {

/// What reaches a place of a surface, each from 0 to 1.
struct PlaceLight {
  float open = 1;  ///< how open the surroundings are, towards 0 in a deep crevice
  float sun = 1, sky = 1;
};

/// The light of a picture, found with a single sample in each pixel: it varies little from pixel to pixel.
class LightField {
 public:
  /// Open everywhere.
  LightField() = default;

  /// Finds crevices by screen-space ambient occlusion.
  ///
  /// @param layer          surfaces seen in the whole picture, one sample a pixel
  /// @param seen           of each sample; empty: all light is seen
  /// @param radius         how far occluders count in the search for crevices [m]
  /// @param pixels_at_one  pixels that one metre takes at distance 1 [m]
  LightField(SurfaceLayer&& layer, std::vector<SeenLight> seen, float radius, float pixels_at_one);

  /// At a place [pixels] of a surface at this distance [m]: the mean of the pixels nearby that see that surface, or
  /// where none does, the one that comes nearest to it.
  PlaceLight at(float x, float y, float distance) const;

 private:
  int width_ = 0, height_ = 0;
  float radius_ = 0;
  std::vector<float> distance_, open_;  ///< of each pixel's sample, not yet smoothed
  std::vector<SeenLight> seen_;
};

/// Directions to the lamps in the axes of a camera.
struct TurnedLamps {
  Eigen::Vector3f sun{-0.45f, -0.6f, -0.75f}, up{0, -1, 0};

  TurnedLamps() { sun.normalize(); }
  TurnedLamps(const Lamps& lamps, const Camera& camera)
      : sun(camera.rotate(lamps.sun.normalized()).cast<float>()),
        up(camera.rotate(lamps.up.normalized()).cast<float>()) {}
};

/// Colour of a surface of the given base colour, seen from both sides alike.
///
/// @param normal  towards the eye, any length
Rgb shade(const Rgb& base, const Eigen::Vector3f& normal, const PlaceLight& light, const TurnedLamps& lamps = {});

/// Colour of a white floor: white where all light comes.
Rgb shade_ground(const PlaceLight& light);

inline constexpr int kOutlineReach = 2;  ///< samples around one that an outline depends on

/// How strongly an outline runs through the sample: where the surface breaks off against what lies behind it.
float outline_strength(const SurfaceLayer& layer, int x, int y, float radius);

}  // namespace selvage
