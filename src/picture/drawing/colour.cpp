#include "picture/drawing/colour.h"

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

float cube(float x) {
  return x * x * x;
}

float srgb_to_linear(float s) {
  return s <= 0.04045f ? s / 12.92f : std::pow((s + 0.055f) / 1.055f, 2.4f);
}

float linear_to_srgb(float x) {
  return x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f;
}

struct Stop {
  float l, chroma, hue;  // lightness, chroma, hue [degrees]
};

/// Lightness falls by equal steps; the hue turns from amber to violet the short way, through red.
constexpr std::array<Stop, 5> kDepthStops{{{0.86f, 0.165f, 88.f},
                                           {0.73f, 0.185f, 52.f},
                                           {0.60f, 0.215f, 22.f},
                                           {0.46f, 0.190f, -12.f},
                                           {0.32f, 0.150f, -55.f}}};

}  // namespace

Rgb from_oklab(float l, float a, float b) {
  const float u = cube(l + 0.3963377774f * a + 0.2158037573f * b);
  const float v = cube(l - 0.1055613458f * a - 0.0638541728f * b);
  const float w = cube(l - 0.0894841775f * a - 1.2914855480f * b);
  return {4.0767416621f * u - 3.3077115913f * v + 0.2309699292f * w,
          -1.2684380046f * u + 2.6097574011f * v - 0.3413193965f * w,
          -0.0041960863f * u - 0.7034186147f * v + 1.7076147010f * w};
}

float lightness(const Rgb& c) {
  const float u = std::cbrt(0.4122214708f * c[0] + 0.5363325363f * c[1] + 0.0514459929f * c[2]);
  const float v = std::cbrt(0.2119034982f * c[0] + 0.6806995451f * c[1] + 0.1073969566f * c[2]);
  const float w = std::cbrt(0.0883024619f * c[0] + 0.2817188376f * c[1] + 0.6299787005f * c[2]);
  return 0.2104542553f * u + 0.7936177850f * v - 0.0040720468f * w;
}

Rgb from_srgb(std::uint8_t red, std::uint8_t green, std::uint8_t blue) {
  return {srgb_to_linear(red / 255.f), srgb_to_linear(green / 255.f), srgb_to_linear(blue / 255.f)};
}

std::array<std::uint8_t, 3> to_srgb(const Rgb& colour) {
  std::array<std::uint8_t, 3> bytes{};
  for (int i = 0; i < 3; ++i) {
    const float s = linear_to_srgb(std::clamp(colour[i], 0.f, 1.f));
    bytes[i] = static_cast<std::uint8_t>(std::lround(255.f * s));
  }
  return bytes;
}

Rgb depth_colour(float t) {
  const float place = std::clamp(t, 0.f, 1.f) * (kDepthStops.size() - 1);
  const auto i = std::min<std::size_t>(static_cast<std::size_t>(place), kDepthStops.size() - 2);
  const float f = place - static_cast<float>(i);
  const Stop &p = kDepthStops[i], &q = kDepthStops[i + 1];
  const float chroma = p.chroma + f * (q.chroma - p.chroma);
  const float hue = (p.hue + f * (q.hue - p.hue)) * 3.14159265f / 180;
  const Rgb colour = from_oklab(p.l + f * (q.l - p.l), chroma * std::cos(hue), chroma * std::sin(hue));
  return colour.max(0.f).min(1.f);
}

}  // namespace selvage
