#include "picture/drawing/ink.h"

#include <algorithm>

namespace selvage {

namespace {

float distance_to(const Stroke& s, const Eigen::Vector2f& p) {
  const Eigen::Vector2f along = s.to - s.from;
  const float squared_length = along.squaredNorm();
  const float t = squared_length > 0 ? std::clamp((p - s.from).dot(along) / squared_length, 0.f, 1.f) : 0.f;
  return (p - s.from - t * along).norm();
}

/// A rectangle of pixels, half open.
struct Pixels {
  int x0, y0, x1, y1;
};

Pixels pixels_near(const Stroke& s, const Image& image) {
  const auto clip = [](float v, int limit) { return static_cast<int>(std::clamp(v, 0.f, static_cast<float>(limit))); };
  const float margin = s.radius + 1;
  return {clip(std::min(s.from[0], s.to[0]) - margin, image.width()),
          clip(std::min(s.from[1], s.to[1]) - margin, image.height()),
          clip(std::max(s.from[0], s.to[0]) + margin + 1, image.width()),
          clip(std::max(s.from[1], s.to[1]) + margin + 1, image.height())};
}

}  // namespace

void draw_strokes(Image& image, std::span<const Stroke> strokes, const Rgb& colour, float opacity) {
  Pixels all{image.width(), image.height(), 0, 0};
  for (const Stroke& s : strokes) {
    const Pixels reach = pixels_near(s, image);
    all = {std::min(all.x0, reach.x0), std::min(all.y0, reach.y0), std::max(all.x1, reach.x1),
           std::max(all.y1, reach.y1)};
  }
  if (all.x0 >= all.x1 || all.y0 >= all.y1) return;

  const std::size_t width = all.x1 - all.x0;
  std::vector<float> coverage(width * (all.y1 - all.y0), 0);
  const auto covered = [&](int x, int y) -> float& { return coverage[(y - all.y0) * width + (x - all.x0)]; };
  for (const Stroke& s : strokes) {
    const Pixels reach = pixels_near(s, image);
    for (int y = reach.y0; y < reach.y1; ++y) {
      for (int x = reach.x0; x < reach.x1; ++x) {
        const float d = distance_to(s, {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
        covered(x, y) = std::max(covered(x, y), std::clamp(s.radius + 0.5f - d, 0.f, 1.f));
      }
    }
  }
  for (int y = all.y0; y < all.y1; ++y) {
    for (int x = all.x0; x < all.x1; ++x) {
      if (covered(x, y) > 0) image.at(x, y) = mix(image.at(x, y), colour, opacity * covered(x, y));
    }
  }
}

}  // namespace selvage
