#pragma once

#include "picture/drawing/image.h"

#include <string_view>
#include <vector>

namespace selvage {

/// Draws the scale of depths from 0 to `deepest` [m] along the right side of the picture.
void draw_scale(Image& image, double deepest);

/// Draws a line of text at the bottom left of the picture.
void draw_caption(Image& image, std::string_view caption);

/// Round numbers from 0 to at most `largest`, three to six of them, for the marks of a scale.
std::vector<double> round_marks(double largest);

}  // namespace selvage
