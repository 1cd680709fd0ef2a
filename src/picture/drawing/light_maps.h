#pragma once

#include "picture/drawing/raster.h"

#include <array>

namespace selvage {

/// A triangle that keeps light off what lies behind it [m].
using Occluder = std::array<Vec3, 3>;

/// Where light comes from: directions towards the middle of the sun, and of the sky.
struct Lamps {
  Vec3 sun = Vec3(-0.4, -0.5, 0.76).normalized();
  Vec3 up = Vec3::UnitZ();
};

/// Lamps for a camera: the sun stands over the left shoulder of who looks.
Lamps default_lamps(const Camera& camera, const Vec3& up);

/// The share of each lamp's light that a place sees.
struct SeenLight {
  float sun = 1, sky = 1;
};

/// How much of the sun, which is as large as a lamp in a room, and of an evenly bright sky the samples of a layer see
/// past the occluders: soft shadows, and ambient occlusion at the size of bodies.
///
/// Both lamps are many fixed directions. For each of them the occluders are drawn into a map of heights, seen from
/// there, with which the samples' own heights are compared. Each sample looks up a place beside its own, which repeats
/// in tiles of kLightTile x kLightTile samples: the mean of a tile is smooth.
///
/// @param layer     one sample a pixel
/// @param map_size  of the longer side of a map
/// @return one for each sample; where nothing is, all light is seen
/// @complexity O((n_occluders + n_texels + n_samples) n_directions), parallel; the same bits for any number of threads
std::vector<SeenLight> find_seen_light(const SurfaceLayer& layer, const Camera& camera,
                                       std::span<const Occluder> occluders, const Lamps& lamps, int map_size);

inline constexpr int kLightTile = 4;

}  // namespace selvage
