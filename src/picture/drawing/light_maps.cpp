#include "picture/drawing/light_maps.h"

#include "core/parallel.h"
#include "picture/drawing/covered_samples.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

using Eigen::Vector3f;

constexpr int kSunDirections = 16, kSkyDirections = 48;
constexpr int kMapsAtOnce = 8;       // as many as are in memory
constexpr float kSunRadius = 0.09f;  // sine of half the angle that the sun takes
constexpr float kLowestSky = 0.08f;  // sine of the elevation of the lowest direction
constexpr float kGoldenAngle = 2.39996323f;
constexpr float kSunReach = 1.2f, kSkyReach = 3.f;  // how far beside its own place a sample looks [texels]
constexpr float kLift = 1.6f;                       // of a sample over its surface [texels]
constexpr float kWrap = 0.25f;                      // light that a surface turned from the sky still gets

struct Direction {
  Vector3f towards;
  bool sun;
};

/// Points evenly over a disc of radius 1.
Eigen::Vector2f disc_point(int i, int count) {
  const float radius = std::sqrt((static_cast<float>(i) + 0.5f) / static_cast<float>(count));
  const float angle = kGoldenAngle * static_cast<float>(i);
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

std::vector<Direction> choose_directions(const Lamps& lamps) {
  const Vector3f sun = lamps.sun.normalized().cast<float>(), up = lamps.up.normalized().cast<float>();
  std::vector<Direction> directions;
  const Vector3f u = sun.unitOrthogonal(), v = sun.cross(u);
  for (int i = 0; i < kSunDirections; ++i) {
    const Eigen::Vector2f at = kSunRadius * disc_point(i, kSunDirections);
    directions.push_back({(sun + at[0] * u + at[1] * v).normalized(), true});
  }
  const Vector3f east = up.unitOrthogonal(), north = up.cross(east);
  for (int i = 0; i < kSkyDirections; ++i) {  // equal areas of the half sphere
    const float height =
        kLowestSky + (1 - kLowestSky) * (static_cast<float>(i) + 0.5f) / static_cast<float>(kSkyDirections);
    const float across = std::sqrt(1 - height * height), angle = kGoldenAngle * static_cast<float>(i);
    directions.push_back({height * up + across * (std::cos(angle) * east + std::sin(angle) * north), false});
  }
  return directions;
}

/// Heights of the occluders above a plane across a direction, seen from there.
class HeightMap {
 public:
  HeightMap(std::span<const std::array<Vector3f, 3>> occluders, const Vector3f& towards, int size)
      : towards_(towards), u_(towards.unitOrthogonal()), v_(towards.cross(u_)) {
    Eigen::Array2f lower = Eigen::Array2f::Constant(INFINITY), upper = -lower;
    for (const auto& corners : occluders)
      for (const Vector3f& p : corners) {
        const Eigen::Array2f at(u_.dot(p), v_.dot(p));
        lower = lower.min(at);
        upper = upper.max(at);
      }
    texel_ = std::max((upper - lower).maxCoeff() / static_cast<float>(size - 2), 1e-30f);
    origin_ = lower - texel_;
    width_ = static_cast<int>((upper[0] - lower[0]) / texel_) + 3;
    height_ = static_cast<int>((upper[1] - lower[1]) / texel_) + 3;
    heights_.assign(static_cast<std::size_t>(width_) * height_, -INFINITY);
    for (const auto& corners : occluders) draw(corners);
  }

  const Vector3f& towards() const { return towards_; }
  float texel() const { return texel_; }

  bool is_seen_from(const Vector3f& p) const {
    const int x = static_cast<int>(std::floor((u_.dot(p) - origin_[0]) / texel_));
    const int y = static_cast<int>(std::floor((v_.dot(p) - origin_[1]) / texel_));
    if (x < 0 || y < 0 || x >= width_ || y >= height_) return true;
    return heights_[static_cast<std::size_t>(y) * width_ + x] <= towards_.dot(p) + texel_;
  }

 private:
  void draw(const std::array<Vector3f, 3>& corners) {
    std::array<FixedPoint, 3> at{};
    Vector3f h;
    for (int i = 0; i < 3; ++i) {
      at[i] = snap((u_.dot(corners[i]) - origin_[0]) / texel_, (v_.dot(corners[i]) - origin_[1]) / texel_);
      h[i] = towards_.dot(corners[i]);
    }
    visit_covered_samples(at[0], at[1], at[2], width_, {0, height_}, [&](int x, int y, float a, float b, float c) {
      float& height = heights_[static_cast<std::size_t>(y) * width_ + x];
      height = std::max(height, a * h[0] + b * h[1] + c * h[2]);
    });
  }

  Vector3f towards_, u_, v_;
  Eigen::Array2f origin_;
  float texel_;
  int width_, height_;
  std::vector<float> heights_;
};

/// A sample of the layer in space.
struct Receiver {
  Vector3f place, normal, u, v;
  int turn;
};

class Receivers {
 public:
  Receivers(const SurfaceLayer& layer, const Camera& camera, const Vec3& centre)
      : layer_(layer), camera_(camera), centre_(centre) {
    for (int i = 0; i < kLightTile * kLightTile; ++i) beside_[i] = disc_point(i * 7 % 16, kLightTile * kLightTile);
  }

  Receiver at(int x, int y) const {
    const std::size_t i = layer_.index(x, y);
    Receiver r;
    const double distance = layer_.distance[i];
    r.place = (camera_.eye() + distance * camera_.ray(x + 0.5, y + 0.5) - centre_).cast<float>();
    r.normal = camera_.rotate_back(layer_.normal[i].cast<double>()).cast<float>();
    r.normal = r.normal.squaredNorm() > 0 ? Vector3f(r.normal.normalized()) : Vector3f::UnitZ();
    r.u = r.normal.unitOrthogonal();
    r.v = r.normal.cross(r.u);
    r.turn = (y % kLightTile) * kLightTile + x % kLightTile;
    return r;
  }

  Vector3f beside(const Receiver& r, float reach, float texel, int direction) const {
    const Eigen::Vector2f at = reach * beside_[(r.turn + 5 * direction) % (kLightTile * kLightTile)];
    return r.place + texel * (kLift * r.normal + at[0] * r.u + at[1] * r.v);
  }

 private:
  const SurfaceLayer& layer_;
  const Camera& camera_;
  Vec3 centre_;
  std::array<Eigen::Vector2f, kLightTile * kLightTile> beside_;
};

/// Light of some directions, and of all of them if nothing stood in the way.
struct LightSum {
  float sun = 0, all_sun = 0, sky = 0, all_sky = 0;
};

void add_light(const HeightMap& map, bool sun, const Vector3f& place, float facing, LightSum& sum) {
  const float weight = std::max(0.f, sun ? facing : kWrap + (1 - kWrap) * facing);
  if (weight == 0) return;
  const float seen = map.is_seen_from(place) ? weight : 0;
  (sun ? sum.sun : sum.sky) += seen;
  (sun ? sum.all_sun : sum.all_sky) += weight;
}

}  // namespace

Lamps default_lamps(const Camera& camera, const Vec3& up) {
  const Vec3 right = camera.rotate_back({1, 0, 0}), back = camera.rotate_back({0, 0, -1});
  const Vec3 level = back - up.dot(back) * up;
  const Vec3 towards_eye = level.norm() > 1e-6 ? Vec3(level.normalized()) : Vec3(camera.rotate_back({0, 1, 0}));
  return {(up + 0.42 * towards_eye - 0.45 * right).normalized(), up};
}

std::vector<SeenLight> find_seen_light(const SurfaceLayer& layer, const Camera& camera,
                                       std::span<const Occluder> occluders, const Lamps& lamps, int map_size) {
  std::vector<SeenLight> light(layer.distance.size());
  if (occluders.empty()) return light;
  Vec3 lower = occluders[0][0], upper = lower;
  for (const Occluder& corners : occluders)
    for (const Vec3& p : corners) lower = lower.cwiseMin(p), upper = upper.cwiseMax(p);
  const Vec3 centre = (lower + upper) / 2;
  std::vector<std::array<Vector3f, 3>> near(occluders.size());  // around the origin, where single precision is finest
  for (std::size_t t = 0; t < occluders.size(); ++t)
    for (int i = 0; i < 3; ++i) near[t][i] = (occluders[t][i] - centre).cast<float>();

  const auto directions = choose_directions(lamps);
  std::vector<LightSum> sums(light.size());
  const Receivers receivers(layer, camera, centre);
  for (std::size_t first = 0; first < directions.size(); first += kMapsAtOnce) {
    const std::size_t count = std::min<std::size_t>(kMapsAtOnce, directions.size() - first);
    std::vector<std::optional<HeightMap>> maps(count);
    parallel_for(static_cast<std::int64_t>(count), 1,
                 [&](std::int64_t i) { maps[i].emplace(near, directions[first + i].towards, map_size); });
    parallel_for(layer.rows.last - layer.rows.first, 8, [&](std::int64_t row) {
      const int y = layer.rows.first + static_cast<int>(row);
      for (int x = 0; x < layer.width; ++x) {
        if (!layer.covers(layer.index(x, y))) continue;
        const Receiver r = receivers.at(x, y);
        for (std::size_t i = 0; i < count; ++i) {
          const Direction& direction = directions[first + i];
          const Vector3f place =
              receivers.beside(r, direction.sun ? kSunReach : kSkyReach, maps[i]->texel(), static_cast<int>(first + i));
          add_light(*maps[i], direction.sun, place, r.normal.dot(direction.towards), sums[layer.index(x, y)]);
        }
      }
    });
  }
  for (std::size_t i = 0; i < light.size(); ++i) {
    if (sums[i].all_sun > 0) light[i].sun = sums[i].sun / sums[i].all_sun;
    if (sums[i].all_sky > 0) light[i].sky = sums[i].sky / sums[i].all_sky;
  }
  return light;
}

}  // namespace selvage
