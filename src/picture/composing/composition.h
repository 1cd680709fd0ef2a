#pragma once

#include "picture/drawing/image.h"
#include "picture/drawing/light_maps.h"

#include <optional>

namespace selvage {

/// The flat on which all stands: white, with shadows.
struct GroundPlane {
  Vec3 point, up;
};

/// A plane that cuts bodies open; the half on the eye's side has been taken away.
struct CutPlane {
  Vec3 point, normal;  ///< the normal points to the eye's side
};

/// A straight line at some depth, which is hidden by what is nearer.
struct ScreenLine {
  Eigen::Vector3f from, to;  ///< x, y [pixels], distance [m]
  float radius;              ///< [pixels]
};

inline constexpr Index kGroundPart = -2;
inline constexpr Index kOverlapPart = -3;  ///< of a cut: where bodies overlap, or a body itself

/// The contents of a picture, from which each sample's colour is made.
struct PictureContent {
  int width, height;   ///< [pixels]
  int samples = 1;     ///< per pixel in each direction
  ScreenSurface body;  ///< of which the nearest is seen
  /// Seen through the body, the nearest of it; value is depth / deepest, or below 0 what is marked.
  ScreenSurface inner;
  ScreenSurface glass{};            ///< that of which only a tint is seen, over all that is behind it
  std::vector<ScreenLine> lines{};  ///< edges of colliders
  Index lined_part = kNone;         ///< the part of the body that has these edges
  std::vector<Rgb> colours{};       ///< of the body's parts; empty: one colour
  Index valued_parts = 0;           ///< the first of them are coloured by the value of each sample, from 0 to 1
  bool grey_at_zero = false;        ///< but not where the value is 0

  bool planar = false;      ///< the body lies in the plane: plain colours that tell how often it covers itself
  bool wireframe = false;   ///< draw the triangles' edges
  float feature = 0;        ///< steps in distance above this count as outlines [m]
  float pixels_at_one = 1;  ///< pixels that one metre takes at distance 1 [m]

  std::optional<Camera> camera{};  ///< for light, ground and cut
  std::optional<GroundPlane> ground{};
  std::optional<CutPlane> cut{};
  Index body_count = 0;  ///< with a cut: the colours of caps stand this many places behind those of their bodies
  std::vector<Occluder> occluders{};  ///< that cast shadows
  Lamps lamps{};
};

/// Colour of text and lines.
Rgb ink_colour();

/// Colour of what is marked: colliding triangles, overlaps in a cut.
Rgb mark_colour();

/// Draws the content on white, `samples` x `samples` of it blended into each pixel. In memory are the samples of a few
/// rows, not of all; the same bits for any number of threads.
Image compose(const PictureContent& content);

}  // namespace selvage
