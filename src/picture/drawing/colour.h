#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>

namespace selvage {

/// Colour in linear light: red, green, blue in [0, 1]. All blending happens here; only the file is in sRGB.
using Rgb = Eigen::Array3f;

/// Colour of perceived lightness `l` in [0, 1] with the green-red and blue-yellow axes of Oklab (Ottosson 2020).
Rgb from_oklab(float l, float a, float b);

/// Perceived lightness of a colour, the first coordinate of Oklab.
float lightness(const Rgb& colour);

/// Colour of an sRGB triple of bytes, as design tools and web pages write it.
Rgb from_srgb(std::uint8_t red, std::uint8_t green, std::uint8_t blue);

/// The sRGB bytes of a colour; values outside [0, 1] are clamped.
std::array<std::uint8_t, 3> to_srgb(const Rgb& colour);

/// Perceptual scale for depths: amber at 0 (shallow) through red to violet at 1 (deep), each step as dark as the
/// next is darker, so that it reads in grey as well.
Rgb depth_colour(float t);

/// `t` of the way from a to b.
inline Rgb mix(const Rgb& a, const Rgb& b, float t) {
  return a + (b - a) * t;
}

}  // namespace selvage
