#pragma once

#include "picture/drawing/raster.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace selvage {

/// A point of the picture in 1/256 of a sample.
struct FixedPoint {
  std::int64_t x, y;
};

inline constexpr int kSubsamples = 256;
inline constexpr float kMaxPlace = 1e6f;  ///< [samples] farther out no vertex may be: products stay within 64 bits

inline FixedPoint snap(float x, float y) {
  const auto fixed = [](float v) {
    return static_cast<std::int64_t>(std::lround(std::clamp(v, -kMaxPlace, kMaxPlace) * kSubsamples));
  };
  return {fixed(x), fixed(y)};
}

/// Calls visit(x, y, share of a, share of b, share of c) for each sample of the rows whose centre the triangle covers,
/// row by row. Centres on an edge belong to one of the two triangles that share it, so that a closed surface has no
/// gap and no sample twice: decided in whole numbers.
///
template <typename Visit>
void visit_covered_samples(FixedPoint a, FixedPoint b, FixedPoint c, int width, const Rows& rows, Visit&& visit) {
  std::int64_t area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  if (area == 0) return;
  const bool swapped = area < 0;
  if (swapped) std::swap(b, c), area = -area;
  const auto first_centre = [](std::int64_t low) { return (low + kSubsamples / 2 - 1) / kSubsamples; };
  const std::int64_t x0 = std::max<std::int64_t>(0, first_centre(std::max<std::int64_t>(0, std::min({a.x, b.x, c.x}))));
  const std::int64_t x1 = std::min<std::int64_t>(width, std::max({a.x, b.x, c.x}) / kSubsamples + 1);
  const std::int64_t top = std::max<std::int64_t>(0, std::min({a.y, b.y, c.y}));
  const auto y0 = std::max<std::int64_t>(rows.first, first_centre(top));
  const auto y1 = std::min<std::int64_t>(rows.last, std::max({a.y, b.y, c.y}) / kSubsamples + 1);
  if (x0 >= x1 || y0 >= y1) return;

  struct Edge {
    std::int64_t across, down, start;  // change for one sample to the right and down; value at the first centre
    Edge(const FixedPoint& p, const FixedPoint& q, std::int64_t px, std::int64_t py)
        : across(-(q.y - p.y) * kSubsamples),
          down((q.x - p.x) * kSubsamples),
          start((q.x - p.x) * (py - p.y) - (q.y - p.y) * (px - p.x)) {
      const bool owns_edge = q.y - p.y > 0 || (q.y == p.y && q.x - p.x > 0);
      if (!owns_edge) start -= 1;  // 0 is outside: all values are whole
    }
  };
  const std::int64_t px = x0 * kSubsamples + kSubsamples / 2, py = y0 * kSubsamples + kSubsamples / 2;
  const Edge ea(b, c, px, py), eb(c, a, px, py), ec(a, b, px, py);
  const float scale = 1 / static_cast<float>(area);
  std::int64_t row_a = ea.start, row_b = eb.start, row_c = ec.start;
  for (std::int64_t y = y0; y < y1; ++y, row_a += ea.down, row_b += eb.down, row_c += ec.down) {
    std::int64_t va = row_a, vb = row_b, vc = row_c;
    for (std::int64_t x = x0; x < x1; ++x, va += ea.across, vb += eb.across, vc += ec.across) {
      if ((va | vb | vc) < 0) continue;
      const float sa = static_cast<float>(va) * scale, sb = static_cast<float>(vb) * scale;
      const float sc = static_cast<float>(vc) * scale;
      visit(static_cast<int>(x), static_cast<int>(y), sa, swapped ? sc : sb, swapped ? sb : sc);
    }
  }
}

}  // namespace selvage
