#pragma once

#include "picture/drawing/image.h"

#include <span>
#include <string_view>
#include <vector>

namespace selvage {

/// A straight stroke with round ends, in pixels.
struct Stroke {
  Eigen::Vector2f from, to;
  float radius;
};

/// Draws strokes of one colour over a picture with soft rims; where they overlap they count once.
void draw_strokes(Image& image, std::span<const Stroke> strokes, const Rgb& colour, float opacity = 1);

/// Strokes that spell a line of text: small letters (capitals are drawn as small ones), digits and common signs; what
/// it does not know is left blank.
///
/// @param start   left end of the line that the text stands on
/// @param height  of a small letter without ascender
/// @param radius  half of the strokes' width
std::vector<Stroke> write_text(std::string_view text, const Eigen::Vector2f& start, float height, float radius);

/// Width of the text.
float text_width(std::string_view text, float height);

}  // namespace selvage
