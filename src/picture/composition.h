#pragma once

#include "picture/image.h"
#include "picture/raster.h"

namespace selvage {

/// The layers of a picture, all of one size, from which each sample's colour is made.
struct PictureLayers {
  SurfaceLayer body;   ///< the nearest surface
  SurfaceLayer inner;  ///< the nearest penetrating surface, seen through the body; value is depth / deepest

  bool planar = false;       ///< the body lies in the plane: plain colours that tell how often it covers itself
  bool wireframe = false;    ///< draw the triangles' edges
  float samples = 1;         ///< per pixel in each direction
  float feature = 0;         ///< steps in distance above this count as outlines [m]
  float samples_at_one = 1;  ///< samples that one metre takes at distance 1 [m]
};

/// The picture's backdrop at relative height t, 0 at the top.
Rgb backdrop(float t);

/// Colour of text and lines.
Rgb ink_colour();

/// Blends the layers, `samples` x `samples` of them into each pixel.
Image compose(const PictureLayers& layers);

}  // namespace selvage
