#pragma once

#include "picture/drawing/image.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace selvage {

/// Meaning of values as colours.
struct ColourScale {
  double top = 1;                         ///< the value that has the brightest colour
  std::string title{};                    ///< of the legend, with the unit
  bool grey_at_zero = false;              ///< 0 is no value
  std::vector<std::string_view> names{};  ///< not empty: values are numbers of these, those of contact_colour()
};

/// Draws a scale from 0 to `top` along the right side of the picture.
/// @param title   what it is of, with the unit
/// @param colour  of a value from 0 to 1
void draw_scale(Image& image, double top, std::string_view title, Rgb (*colour)(float));

/// Draws names with their colours along the right side of the picture, but for those that are empty.
void draw_names(Image& image, std::span<const std::string_view> names, std::span<const Rgb> colours);

/// Draws a line of text at the bottom left of the picture.
void draw_caption(Image& image, std::string_view caption);

/// Round numbers from 0 to at most `largest`, three to six of them, for the marks of a scale.
std::vector<double> round_marks(double largest);

}  // namespace selvage
