#pragma once

#include "picture/drawing/image.h"
#include "picture/drawing/raster.h"

namespace selvage {

/// The contents of a picture, from which each sample's colour is made.
struct PictureContent {
  int width, height;   ///< [pixels]
  int samples = 1;     ///< per pixel in each direction
  ScreenSurface body;  ///< of which the nearest is seen
  ScreenSurface
      inner;  ///< the penetrating surface, of which the nearest is seen through the body; value is depth / deepest

  bool planar = false;      ///< the body lies in the plane: plain colours that tell how often it covers itself
  bool wireframe = false;   ///< draw the triangles' edges
  float feature = 0;        ///< steps in distance above this count as outlines [m]
  float pixels_at_one = 1;  ///< pixels that one metre takes at distance 1 [m]
};

/// The picture's backdrop at relative height t, 0 at the top.
Rgb backdrop(float t);

/// Colour of text and lines.
Rgb ink_colour();

/// Draws the content, `samples` x `samples` of it blended into each pixel. In memory are the samples of a few rows, not
/// of all; the same bits for any number of threads.
Image compose(const PictureContent& content);

}  // namespace selvage
