#include "picture/drawing/raster.h"

#include "core/parallel.h"

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct SampleRange {
  int x0, x1, y0, y1;  // half open
};

SampleRange clip(float left, float right, float top, float bottom, int width, const Rows& rows) {
  const auto to_int = [](float v) { return static_cast<int>(std::clamp(v, -1.f, 1e6f)); };
  return {std::max(0, to_int(std::floor(left))), std::min(width, to_int(std::ceil(right)) + 1),
          std::max(rows.first, to_int(std::floor(top))), std::min(rows.last, to_int(std::ceil(bottom)) + 1)};
}

/// Twice the signed area of (a, b, (x, y)).
float side(const ScreenVertex& a, const ScreenVertex& b, float x, float y) {
  return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

float length(const ScreenVertex& a, const ScreenVertex& b) {
  return std::hypot(b.x - a.x, b.y - a.y);
}

void draw_triangle(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c, const Rows& rows,
                   SurfaceLayer& layer) {
  const float area = side(a, b, c.x, c.y);
  if (area == 0 || !std::isfinite(area)) return;
  const SampleRange range = clip(std::min({a.x, b.x, c.x}), std::max({a.x, b.x, c.x}), std::min({a.y, b.y, c.y}),
                                 std::max({a.y, b.y, c.y}), layer.width, rows);
  const Eigen::Array3f heights = std::abs(area) / Eigen::Array3f(length(b, c), length(c, a), length(a, b));
  const Eigen::Array3f depths(a.distance, b.distance, c.distance), values(a.value, b.value, c.value);
  const Eigen::Array3f weights(a.weight, b.weight, c.weight);
  for (int y = range.y0; y < range.y1; ++y) {
    for (int x = range.x0; x < range.x1; ++x) {
      const float px = static_cast<float>(x) + 0.5f, py = static_cast<float>(y) + 0.5f;
      const Eigen::Array3f bary = Eigen::Array3f(side(b, c, px, py), side(c, a, px, py), side(a, b, px, py)) / area;
      if ((bary < 0).any()) continue;
      if ((bary * weights).sum() < 0.5f) continue;
      const float distance = (bary * depths).sum();
      const std::size_t i = layer.index(x, y);
      layer.count[i] = static_cast<std::uint8_t>(std::min(layer.count[i] + 1, 255));
      if (distance >= layer.distance[i]) continue;
      const Eigen::Vector3f normal = bary[0] * a.normal + bary[1] * b.normal + bary[2] * c.normal;
      layer.distance[i] = distance;
      layer.normal[i] = normal[2] > 0 ? Eigen::Vector3f(-normal) : normal;
      layer.value[i] = (bary * values).sum();
      layer.edge[i] = (bary * heights).minCoeff();
    }
  }
}

}  // namespace

SurfaceLayer::SurfaceLayer(int layer_width, const Rows& layer_rows, int samples_per_pixel)
    : width(layer_width), rows(layer_rows), samples(samples_per_pixel) {
  const std::size_t size = static_cast<std::size_t>(width) * (rows.last - rows.first);
  distance.assign(size, kInfinity);
  normal.assign(size, Eigen::Vector3f::Zero());
  value.assign(size, 0);
  edge.assign(size, kInfinity);
  count.assign(size, 0);
}

SurfaceBands::SurfaceBands(const ScreenSurface& surface, int height, int band_rows, int margin)
    : surface_(surface), height_(height), band_rows_(band_rows), margin_(margin) {
  const auto reach = static_cast<float>(margin);
  bins_.resize((height + band_rows - 1) / band_rows);
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    const auto& [a, b, c] = surface.triangles[i];
    const auto [low, high] = std::minmax({surface.vertices[a].y, surface.vertices[b].y, surface.vertices[c].y});
    if (!(high >= -reach && low < static_cast<float>(height) + reach)) continue;
    const int first = static_cast<int>(std::max(low - reach, 0.f)) / band_rows;
    const int last = static_cast<int>(std::min(high + reach, static_cast<float>(height - 1))) / band_rows;
    for (int band = first; band <= last; ++band) bins_[band].push_back(static_cast<Index>(i));
  }
}

Rows SurfaceBands::rows(std::size_t band) const {
  const int first = static_cast<int>(band) * band_rows_;
  return {first, std::min(first + band_rows_, height_)};
}

void SurfaceBands::draw(std::size_t band, SurfaceLayer& layer) const {
  const Rows own = rows(band);
  const Rows drawn{std::max((own.first - margin_) * layer.samples, layer.rows.first),
                   std::min((own.last + margin_) * layer.samples, layer.rows.last)};
  const auto place = [&](Index v) {
    ScreenVertex vertex = surface_.vertices[v];
    vertex.x *= static_cast<float>(layer.samples);
    vertex.y *= static_cast<float>(layer.samples);
    return vertex;
  };
  for (const Index t : bins_[band]) {
    const auto& [a, b, c] = surface_.triangles[t];
    draw_triangle(place(a), place(b), place(c), drawn, layer);
  }
}

void draw_surface(const ScreenSurface& surface, SurfaceLayer& layer) {
  constexpr int kTaskRows = 32;
  const SurfaceBands bands(surface, layer.rows.last / layer.samples, kTaskRows);
  parallel_for(static_cast<std::int64_t>(bands.count()), 1, [&](std::int64_t band) { bands.draw(band, layer); });
}

}  // namespace selvage
