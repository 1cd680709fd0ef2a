#include "picture/composition.h"

#include "picture/shading.h"
#include "selvage/core/parallel.h"

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

constexpr float kThroughBody = 0.85f;    // how clearly what lies inside shows through
constexpr float kOcclusionFeatures = 9;  // radius of ambient occlusion against the size of a feature

class Composer {
 public:
  explicit Composer(const PictureLayers& layers) : layers_(layers) {
    if (layers.planar) return;
    const float radius = kOcclusionFeatures * layers.feature;
    body_open_ = compute_openness(layers.body, radius, layers.samples_at_one);
    inner_open_ = compute_openness(layers.inner, radius, layers.samples_at_one);
  }

  Rgb sample(int x, int y) const {
    static const Rgb body = from_oklab(0.88f, -0.012f, -0.022f);
    const std::size_t i = layers_.body.index(x, y);
    Rgb colour = backdrop(static_cast<float>(y) / static_cast<float>(layers_.body.height));
    if (!layers_.body.covers(i)) return colour;
    if (layers_.planar) return wire(layers_.body, i, cover_colour(layers_.body.count[i]));
    colour = surface(layers_.body, body_open_, body, x, y);
    if (layers_.inner.covers(i)) {
      const Rgb inner = surface(layers_.inner, inner_open_, depth_colour(layers_.inner.value[i]), x, y);
      const bool hidden = layers_.inner.distance[i] > layers_.body.distance[i] + 0.01f * layers_.feature;
      colour = mix(colour, inner, hidden ? kThroughBody : 1.f);
    }
    return colour;
  }

 private:
  static Rgb cover_colour(int count) {
    return count <= 1 ? from_oklab(0.90f, -0.018f, -0.03f)
                      : from_oklab(0.90f - 0.07f * static_cast<float>(std::min(count, 5)), 0.0f,
                                   -0.02f * static_cast<float>(std::min(count, 5)));
  }

  Rgb wire(const SurfaceLayer& layer, std::size_t i, const Rgb& colour) const {
    if (!layers_.wireframe) return colour;
    const float pixels = layer.edge[i] / layers_.samples;
    return mix(colour, colour * 0.6f, 0.38f * std::clamp(1.1f - pixels, 0.f, 1.f));
  }

  Rgb surface(const SurfaceLayer& layer, const std::vector<float>& open, const Rgb& base, int x, int y) const {
    const std::size_t i = layer.index(x, y);
    const Rgb colour = wire(layer, i, shade(base, layer.normal[i], open[i]));
    return mix(colour, colour * 0.25f, 0.6f * outline_strength(layer, x, y, layers_.feature));
  }

  const PictureLayers& layers_;
  std::vector<float> body_open_, inner_open_;
};

}  // namespace

Rgb backdrop(float t) {
  return mix(from_srgb(252, 252, 253), from_srgb(226, 231, 238), t * t);
}

Rgb ink_colour() {
  return from_srgb(44, 52, 66);
}

Image compose(const PictureLayers& layers) {
  const Composer composer(layers);
  const int samples = static_cast<int>(layers.samples);
  Image image(layers.body.width / samples, layers.body.height / samples);
  parallel_for(image.height(), 8, [&](std::int64_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < image.width(); ++x) {
      Rgb sum = Rgb::Zero();
      for (int s = 0; s < samples * samples; ++s) {
        sum += composer.sample(x * samples + s % samples, y * samples + s / samples).max(0.f).min(1.f);
      }
      image.at(x, y) = sum / static_cast<float>(samples * samples);
    }
  });
  return image;
}

}  // namespace selvage
