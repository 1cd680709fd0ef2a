#include "picture/drawing/shading.h"

#include "core/parallel.h"

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

constexpr int kTaps = 12;
constexpr int kTile = 4;  // the taps' rotation repeats in tiles of this size, and one tile of averaging hides it

struct Tap {
  float x, y;
};

/// Taps on a spiral, turned by the sample's place in its tile.
std::array<Tap, kTaps> spiral(int turn) {
  std::array<Tap, kTaps> taps;
  for (int i = 0; i < kTaps; ++i) {
    const float radius = std::sqrt((static_cast<float>(i) + 0.5f) / kTaps);
    const float angle = 2.3999632f * static_cast<float>(i) + 6.2831853f * static_cast<float>(turn) / (kTile * kTile);
    taps[i] = {radius * std::cos(angle), radius * std::sin(angle)};
  }
  return taps;
}

/// Share of the taps whose surface stands out of the sample's tangent plane by less than the radius.
float occlusion(const SurfaceLayer& layer, int x, int y, float reach, float radius,
                const std::array<Tap, kTaps>& taps) {
  const std::size_t i = layer.index(x, y);
  const Eigen::Vector3f normal = layer.normal[i].normalized();
  const float metres = radius / reach;  // of one sample
  float blocked = 0;
  for (const Tap& tap : taps) {
    const int dx = static_cast<int>(std::lround(tap.x * reach)), dy = static_cast<int>(std::lround(tap.y * reach));
    const int u = x + dx, v = y + dy;
    if (!layer.covers(u, v)) continue;
    const Eigen::Vector3f offset(static_cast<float>(dx) * metres, static_cast<float>(dy) * metres,
                                 layer.distance[layer.index(u, v)] - layer.distance[i]);
    const float length = offset.norm();
    if (length == 0 || length > 2 * radius) continue;
    const float rise = offset.dot(normal) / length;
    blocked += std::max(0.f, rise - 0.1f) * (1 - length / (2 * radius));
  }
  return blocked / kTaps;
}

}  // namespace

Openness::Openness(SurfaceLayer&& layer, float radius, float pixels_at_one)
    : width_(layer.width), height_(layer.rows.last), radius_(radius), open_(layer.distance.size(), 1) {
  std::array<std::array<Tap, kTaps>, kTile * kTile> taps;
  for (int turn = 0; turn < kTile * kTile; ++turn) taps[turn] = spiral(turn * 7 % (kTile * kTile));
  parallel_for(height_, 16, [&](std::int64_t y) {
    for (int x = 0; x < width_; ++x) {
      const std::size_t i = layer.index(x, static_cast<int>(y));
      if (!layer.covers(i)) continue;
      const float reach = std::max(2.f, radius * pixels_at_one / layer.distance[i]);
      const auto& turned = taps[(y % kTile) * kTile + x % kTile];
      open_[i] = 1 - std::min(1.f, 4.5f * occlusion(layer, x, static_cast<int>(y), reach, radius, turned));
    }
  });
  distance_ = std::move(layer.distance);
}

/// The mean of the tile around the place, of what lies on the same surface.
float Openness::at(float x, float y, float distance) const {
  const int left = static_cast<int>(x + 0.5f) - kTile / 2, top = static_cast<int>(y + 0.5f) - kTile / 2;
  float sum = 0, count = 0;
  for (int v = std::max(0, top); v < std::min(height_, top + kTile); ++v) {
    for (int u = std::max(0, left); u < std::min(width_, left + kTile); ++u) {
      const std::size_t i = static_cast<std::size_t>(v) * width_ + u;
      if (std::abs(distance_[i] - distance) > 0.3f * radius_) continue;
      sum += open_[i];
      count += 1;
    }
  }
  return count > 0 ? sum / count : 1;
}

Rgb shade(const Rgb& base, const Eigen::Vector3f& normal, float openness) {
  static const Eigen::Vector3f key = Eigen::Vector3f(-0.45f, -0.6f, -0.75f).normalized();
  const Eigen::Vector3f n = normal.squaredNorm() > 0 ? normal.normalized() : Eigen::Vector3f(0, 0, -1);
  const float facing = std::clamp(-n[2], 0.f, 1.f);
  const float lit = std::max(0.f, n.dot(key));
  const float sky = 0.5f - 0.5f * n[1];  // y points down
  const Eigen::Vector3f half = (key + Eigen::Vector3f(0, 0, -1)).normalized();
  const float gloss = std::pow(std::max(0.f, n.dot(half)), 40.f);
  const Rgb diffuse = base * (0.15f + 0.22f * sky + 0.66f * lit + 0.10f * facing);
  return (diffuse + 0.07f * gloss) * (0.30f + 0.70f * openness);
}

float outline_strength(const SurfaceLayer& layer, int x, int y, float radius) {
  const float here = layer.distance[layer.index(x, y)];
  float strength = 0;
  for (const auto& [dx, dy] : {std::pair(-1, 0), {1, 0}, {0, -1}, {0, 1}, {-2, 0}, {2, 0}, {0, -2}, {0, 2}}) {
    const int u = x + dx, v = y + dy;
    if (!layer.holds(u, v)) continue;
    const float there = layer.distance[layer.index(u, v)];
    if (there > here + radius) strength += 0.25f;
  }
  return std::min(1.f, strength);
}

}  // namespace selvage
