#include "picture/drawing/shading.h"

#include "core/parallel.h"

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

constexpr int kTaps = 12;
constexpr int kTile = kLightTile;  // the taps' rotation repeats in tiles of this size; the mean of one hides it

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

LightField::LightField(SurfaceLayer&& layer, std::vector<SeenLight> seen, float radius, float pixels_at_one)
    : width_(layer.width),
      height_(layer.rows.last),
      radius_(radius),
      open_(layer.distance.size(), 1),
      seen_(std::move(seen)) {
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
  if (seen_.empty()) seen_.resize(distance_.size());
}

PlaceLight LightField::at(float x, float y, float distance) const {
  const int left = static_cast<int>(x + 0.5f) - kTile / 2, top = static_cast<int>(y + 0.5f) - kTile / 2;
  PlaceLight sum{0, 0, 0}, nearest;
  float count = 0, smallest = std::numeric_limits<float>::infinity();
  for (int v = std::max(0, top); v < std::min(height_, top + kTile); ++v) {
    for (int u = std::max(0, left); u < std::min(width_, left + kTile); ++u) {
      const std::size_t i = static_cast<std::size_t>(v) * width_ + u;
      const float difference = std::abs(distance_[i] - distance);
      if (difference < smallest) {
        smallest = difference;
        nearest = {open_[i], seen_[i].sun, seen_[i].sky};
      }
      if (!(difference <= 0.3f * radius_)) continue;
      sum.open += open_[i];
      sum.sun += seen_[i].sun;
      sum.sky += seen_[i].sky;
      count += 1;
    }
  }
  return count > 0 ? PlaceLight{sum.open / count, sum.sun / count, sum.sky / count} : nearest;
}

Rgb shade(const Rgb& base, const Eigen::Vector3f& normal, const PlaceLight& light, const TurnedLamps& lamps) {
  const Eigen::Vector3f n = normal.squaredNorm() > 0 ? normal.normalized() : Eigen::Vector3f(0, 0, -1);
  const float facing = std::clamp(-n[2], 0.f, 1.f);
  const float lit = std::max(0.f, n.dot(lamps.sun)) * light.sun;
  const float sky = (0.6f + 0.4f * n.dot(lamps.up)) * light.sky;
  const Eigen::Vector3f half = (lamps.sun + Eigen::Vector3f(0, 0, -1)).normalized();
  const float gloss = std::pow(std::max(0.f, n.dot(half)), 40.f) * light.sun;
  const Rgb diffuse = base * (0.07f + 0.12f * facing + 0.40f * sky + 0.60f * lit);
  return (diffuse + 0.05f * gloss) * (0.35f + 0.65f * light.open);
}

Rgb shade_ground(const PlaceLight& light) {
  return Rgb::Constant((0.16f + 0.42f * light.sun + 0.42f * light.sky) * (0.6f + 0.4f * light.open));
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
