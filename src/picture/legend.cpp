#include "picture/legend.h"

#include "picture/composing/composition.h"
#include "picture/drawing/ink.h"

#include <fmt/format.h>

#include <cmath>

namespace selvage {

namespace {

void draw_text(Image& image, std::string_view text, float x, float y, float height) {
  const auto strokes = write_text(text, {x, y}, height, std::max(0.65f, 0.115f * height));
  draw_strokes(image, strokes, ink_colour());
}

}  // namespace

std::vector<double> round_marks(double largest) {
  const double power = std::pow(10, std::floor(std::log10(largest)));
  double step = power;
  for (const double candidate : {0.2, 0.25, 0.5, 1.0}) {
    step = candidate * power;
    if (largest / step < 6) break;
  }
  if (largest / step >= 6) step = 2 * power;
  std::vector<double> marks;
  for (int i = 0; i * step <= largest * (1 + 1e-12); ++i) marks.push_back(i * step);
  return marks;
}

void draw_scale(Image& image, double top_value, std::string_view title, Rgb (*colour)(float)) {
  const float unit = static_cast<float>(image.height()) / 1000;
  const float bar = 26 * unit, left = static_cast<float>(image.width()) - 158 * unit;
  const float top = 250 * unit, bottom = 750 * unit;
  for (int y = static_cast<int>(top); y < static_cast<int>(bottom); ++y) {
    const float t = (bottom - static_cast<float>(y) - 0.5f) / (bottom - top);
    for (int x = static_cast<int>(left); x < static_cast<int>(left + bar); ++x) image.at(x, y) = colour(t);
  }
  std::vector<Stroke> ticks;
  const float letter = 11.5f * unit;
  for (const double mark : round_marks(top_value)) {
    const float y = bottom - static_cast<float>(mark / top_value) * (bottom - top);
    ticks.push_back({{left + bar + 3 * unit, y}, {left + bar + 9 * unit, y}, 0.8f * unit});
    draw_text(image, fmt::format("{:.4g}", mark), left + bar + 17 * unit, y + letter / 2, letter);
  }
  draw_strokes(image, ticks, ink_colour());
  draw_text(image, title, left - 12 * unit, top - 34 * unit, letter);
}

void draw_names(Image& image, std::span<const std::string_view> names, std::span<const Rgb> colours) {
  const float unit = static_cast<float>(image.height()) / 1000;
  const float box = 22 * unit, left = static_cast<float>(image.width()) - 272 * unit, letter = 11.5f * unit;
  float top = 250 * unit;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].empty()) continue;
    for (int y = static_cast<int>(top); y < static_cast<int>(top + box); ++y)
      for (int x = static_cast<int>(left); x < static_cast<int>(left + box); ++x) image.at(x, y) = colours[i];
    draw_text(image, names[i], left + box + 12 * unit, top + (box + letter) / 2, letter);
    top += 40 * unit;
  }
}

void draw_caption(Image& image, std::string_view caption) {
  const float unit = static_cast<float>(image.height()) / 1000;
  float letter = 12.5f * unit;
  const float room = static_cast<float>(image.width()) - 80 * unit, wanted = text_width(caption, letter);
  if (wanted > room) letter *= room / wanted;
  draw_text(image, caption, 40 * unit, static_cast<float>(image.height()) - 36 * unit, letter);
}

}  // namespace selvage
