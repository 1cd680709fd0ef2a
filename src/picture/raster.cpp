#include "picture/raster.h"

#include "selvage/core/parallel.h"

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

constexpr int kBandRows = 32;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Rows [first, last) of a layer, drawn by one thread.
struct Band {
  int first, last;
};

/// For each band, the items whose rows reach it, ascending.
template <typename RowsOf>
std::vector<std::vector<Index>> bin_into_bands(Index count, int height, const RowsOf& rows_of) {
  std::vector<std::vector<Index>> bins((height + kBandRows - 1) / kBandRows);
  for (Index i = 0; i < count; ++i) {
    const auto [low, high] = rows_of(i);
    if (!(high >= 0 && low < static_cast<float>(height))) continue;
    const int first = static_cast<int>(std::max(low, 0.f)) / kBandRows;
    const int last = static_cast<int>(std::min(high, static_cast<float>(height - 1))) / kBandRows;
    for (int band = first; band <= last; ++band) bins[band].push_back(i);
  }
  return bins;
}

template <typename Draw>
void for_each_band(const std::vector<std::vector<Index>>& bins, int height, const Draw& draw) {
  parallel_for(static_cast<std::int64_t>(bins.size()), 1, [&](std::int64_t b) {
    const int first = static_cast<int>(b) * kBandRows;
    for (const Index item : bins[b]) draw(item, Band{first, std::min(first + kBandRows, height)});
  });
}

struct SampleRange {
  int x0, x1, y0, y1;  // half open
};

SampleRange clip(float left, float right, float top, float bottom, int width, const Band& band) {
  const auto to_int = [](float v) { return static_cast<int>(std::clamp(v, -1.f, 1e6f)); };
  return {std::max(0, to_int(std::floor(left))), std::min(width, to_int(std::ceil(right)) + 1),
          std::max(band.first, to_int(std::floor(top))), std::min(band.last, to_int(std::ceil(bottom)) + 1)};
}

/// Twice the signed area of (a, b, (x, y)).
float side(const ScreenVertex& a, const ScreenVertex& b, float x, float y) {
  return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

float length(const ScreenVertex& a, const ScreenVertex& b) {
  return std::hypot(b.x - a.x, b.y - a.y);
}

void draw_triangle(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c, const Band& band,
                   SurfaceLayer& layer) {
  const float area = side(a, b, c.x, c.y);
  if (area == 0 || !std::isfinite(area)) return;
  const SampleRange range = clip(std::min({a.x, b.x, c.x}), std::max({a.x, b.x, c.x}), std::min({a.y, b.y, c.y}),
                                 std::max({a.y, b.y, c.y}), layer.width, band);
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

SurfaceLayer::SurfaceLayer(int layer_width, int layer_height) : width(layer_width), height(layer_height) {
  const std::size_t samples = static_cast<std::size_t>(width) * height;
  distance.assign(samples, kInfinity);
  normal.assign(samples, Eigen::Vector3f::Zero());
  value.assign(samples, 0);
  edge.assign(samples, kInfinity);
  count.assign(samples, 0);
}

void draw_triangles(std::span<const ScreenVertex> vertices, std::span<const VertexTuple<3>> triangles,
                    SurfaceLayer& layer) {
  const auto bins = bin_into_bands(static_cast<Index>(triangles.size()), layer.height, [&](Index i) {
    const auto& [a, b, c] = triangles[i];
    return std::minmax({vertices[a].y, vertices[b].y, vertices[c].y});
  });
  for_each_band(bins, layer.height, [&](Index i, const Band& band) {
    const auto& [a, b, c] = triangles[i];
    draw_triangle(vertices[a], vertices[b], vertices[c], band, layer);
  });
}

}  // namespace selvage
