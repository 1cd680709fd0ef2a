#include "picture/drawing/raster.h"

#include "core/parallel.h"
#include "picture/drawing/covered_samples.h"

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

float length(const ScreenVertex& a, const ScreenVertex& b) {
  return std::hypot(b.x - a.x, b.y - a.y);
}

/// A triangle in samples, whose values are interpolated in space, not on the picture.
struct SampledTriangle {
  ScreenVertex a, b, c;
  FixedPoint pa, pb, pc;

  SampledTriangle(const ScreenSurface& surface, std::size_t t, int samples)
      : a(place(surface, t, 0, samples)),
        b(place(surface, t, 1, samples)),
        c(place(surface, t, 2, samples)),
        pa(snap(a.x, a.y)),
        pb(snap(b.x, b.y)),
        pc(snap(c.x, c.y)) {}

  static ScreenVertex place(const ScreenSurface& surface, std::size_t t, int corner, int samples) {
    ScreenVertex vertex = surface.vertices[surface.triangles[t][corner]];
    vertex.x *= static_cast<float>(samples);
    vertex.y *= static_cast<float>(samples);
    return vertex;
  }

  /// Calls visit(x, y, distance, shares in space).
  template <typename Visit>
  void visit_samples(int width, const Rows& rows, Visit&& visit) const {
    const Eigen::Array3f near(1 / a.distance, 1 / b.distance, 1 / c.distance);
    visit_covered_samples(pa, pb, pc, width, rows, [&](int x, int y, float sa, float sb, float sc) {
      const Eigen::Array3f seen = Eigen::Array3f(sa, sb, sc) * near;
      const float distance = 1 / seen.sum();
      visit(x, y, distance, Eigen::Array3f(seen * distance));
    });
  }

  /// Whether the normal points away from the eye: y runs downward on the picture.
  bool faces_away() const { return (pb.x - pa.x) * (pc.y - pa.y) - (pb.y - pa.y) * (pc.x - pa.x) > 0; }
};

void draw_triangle(const ScreenSurface& surface, std::size_t t, const Rows& rows, SurfaceLayer& layer) {
  const SampledTriangle triangle(surface, t, layer.samples);
  const auto &a = triangle.a, &b = triangle.b, &c = triangle.c;
  const float area = std::abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
  const Eigen::Array3f heights = area / Eigen::Array3f(length(b, c), length(c, a), length(a, b));
  const Eigen::Array3f values(a.value, b.value, c.value), weights(a.weight, b.weight, c.weight);
  const bool whole = (weights == 1).all();
  const Index winding = layer.winding.empty() ? kNone : surface.windings[t];
  const std::int32_t turn = triangle.faces_away() ? 1 : -1;
  triangle.visit_samples(layer.width, rows, [&](int x, int y, float distance, const Eigen::Array3f& share) {
    if (!whole && (share * weights).sum() < 0.5f) return;
    const std::size_t i = layer.index(x, y);
    layer.count[i] = static_cast<std::uint8_t>(std::min(layer.count[i] + 1, 255));
    if (winding != kNone) {
      layer.winding[i].times += turn;
      layer.winding[i].numbered += turn * (winding + 1);
    }
    if (distance >= layer.distance[i]) return;
    const Eigen::Vector3f normal = share[0] * a.normal + share[1] * b.normal + share[2] * c.normal;
    layer.distance[i] = distance;
    layer.normal[i] = normal[2] > 0 ? Eigen::Vector3f(-normal) : normal;
    layer.value[i] = (share * values).sum();
    layer.edge[i] = (share * heights).minCoeff();
    layer.part[i] = surface.part(t);
  });
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
  part.assign(size, 0);
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

Rows SurfaceBands::drawn_rows(std::size_t band, const SurfaceLayer& layer) const {
  const Rows own = rows(band);
  return {std::max((own.first - margin_) * layer.samples, layer.rows.first),
          std::min((own.last + margin_) * layer.samples, layer.rows.last)};
}

void SurfaceBands::draw(std::size_t band, SurfaceLayer& layer) const {
  if (!surface_.windings.empty()) layer.winding.resize(layer.distance.size());
  const Rows drawn = drawn_rows(band, layer);
  for (const Index t : bins_[band]) draw_triangle(surface_, static_cast<std::size_t>(t), drawn, layer);
}

void SurfaceBands::count_in_front(std::size_t band, const SurfaceLayer& layer, std::vector<std::uint8_t>& count) const {
  constexpr float kBias = 0.997f;  // what lies on the surface is before it
  const Rows drawn = drawn_rows(band, layer);
  for (const Index t : bins_[band]) {
    const SampledTriangle triangle(surface_, static_cast<std::size_t>(t), layer.samples);
    triangle.visit_samples(layer.width, drawn, [&](int x, int y, float distance, const Eigen::Array3f&) {
      const std::size_t i = layer.index(x, y);
      if (distance * kBias < layer.distance[i] && count[i] < 255) ++count[i];
    });
  }
}

void draw_surface(const ScreenSurface& surface, SurfaceLayer& layer) {
  constexpr int kTaskRows = 32;
  const SurfaceBands bands(surface, layer.rows.last / layer.samples, kTaskRows);
  if (!surface.windings.empty()) layer.winding.resize(layer.distance.size());
  parallel_for(static_cast<std::int64_t>(bands.count()), 1, [&](std::int64_t band) { bands.draw(band, layer); });
}

}  // namespace selvage
