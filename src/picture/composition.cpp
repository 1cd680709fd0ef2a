#include "picture/composition.h"

#include "core/parallel.h"
#include "picture/drawing/shading.h"

#include <algorithm>

namespace selvage {

namespace {

constexpr float kThroughBody = 0.85f;    // how clearly what lies inside shows through
constexpr float kOcclusionFeatures = 9;  // radius of ambient occlusion against the size of a feature
constexpr int kBandRows = 8;             // pixels

/// One of the two surfaces of a picture.
class ComposedSurface {
 public:
  ComposedSurface(const PictureContent& content, const ScreenSurface& surface)
      : content_(content), bands_(surface, content.height, kBandRows, kOutlineReach) {
    if (content.planar || surface.triangles.empty()) return;
    SurfaceLayer layer(content.width, {0, content.height});
    draw_surface(surface, layer);
    openness_ = Openness(std::move(layer), kOcclusionFeatures * content.feature, content.pixels_at_one);
  }

  std::size_t band_count() const { return bands_.count(); }
  Rows rows(std::size_t band) const { return bands_.rows(band); }

  /// The samples of a band and around it; none where the surface is not in it.
  SurfaceLayer draw(std::size_t band) const {
    const int samples = content_.samples;
    Rows drawn{0, 0};
    if (!bands_.is_empty(band)) {
      const Rows own = bands_.rows(band);
      drawn = {std::max(0, own.first * samples - kOutlineReach),
               std::min(content_.height * samples, own.last * samples + kOutlineReach)};
    }
    SurfaceLayer layer(content_.width * samples, drawn, samples);
    bands_.draw(band, layer);
    return layer;
  }

  Rgb colour(const SurfaceLayer& layer, const Rgb& base, int x, int y) const {
    const std::size_t i = layer.index(x, y);
    const auto scale = static_cast<float>(layer.samples);
    const float open =
        openness_.at((static_cast<float>(x) + 0.5f) / scale, (static_cast<float>(y) + 0.5f) / scale, layer.distance[i]);
    const Rgb shaded = wire(layer, i, shade(base, layer.normal[i], open));
    return mix(shaded, shaded * 0.25f, 0.6f * outline_strength(layer, x, y, content_.feature));
  }

  Rgb wire(const SurfaceLayer& layer, std::size_t i, const Rgb& colour) const {
    if (!content_.wireframe) return colour;
    const float pixels = layer.edge[i] / static_cast<float>(layer.samples);
    return mix(colour, colour * 0.6f, 0.38f * std::clamp(1.1f - pixels, 0.f, 1.f));
  }

 private:
  const PictureContent& content_;
  SurfaceBands bands_;
  Openness openness_;
};

class Composer {
 public:
  explicit Composer(const PictureContent& content)
      : content_(content), body_(content, content.body), inner_(content, content.inner) {}

  std::size_t band_count() const { return body_.band_count(); }

  void draw_band(std::size_t band, Image& image) const {
    const SurfaceLayer body = body_.draw(band), inner = inner_.draw(band);
    const int samples = content_.samples;
    const Rows rows = body_.rows(band);
    for (int y = rows.first; y < rows.last; ++y) {
      for (int x = 0; x < image.width(); ++x) {
        Rgb sum = Rgb::Zero();
        for (int s = 0; s < samples * samples; ++s) {
          sum += sample(body, inner, x * samples + s % samples, y * samples + s / samples).max(0.f).min(1.f);
        }
        image.at(x, y) = sum / static_cast<float>(samples * samples);
      }
    }
  }

 private:
  Rgb sample(const SurfaceLayer& body, const SurfaceLayer& inner, int x, int y) const {
    static const Rgb skin = from_oklab(0.88f, -0.012f, -0.022f);
    if (!body.covers(x, y)) return backdrop(static_cast<float>(y) / static_cast<float>(content_.height * body.samples));
    const std::size_t i = body.index(x, y);
    if (content_.planar) return body_.wire(body, i, cover_colour(body.count[i]));
    const Rgb colour = body_.colour(body, skin, x, y);
    if (!inner.covers(x, y)) return colour;
    const std::size_t j = inner.index(x, y);
    const bool hidden = inner.distance[j] > body.distance[i] + 0.01f * content_.feature;
    return mix(colour, inner_.colour(inner, depth_colour(inner.value[j]), x, y), hidden ? kThroughBody : 1.f);
  }

  static Rgb cover_colour(int count) {
    return count <= 1 ? from_oklab(0.90f, -0.018f, -0.03f)
                      : from_oklab(0.90f - 0.07f * static_cast<float>(std::min(count, 5)), 0.0f,
                                   -0.02f * static_cast<float>(std::min(count, 5)));
  }

  const PictureContent& content_;
  ComposedSurface body_, inner_;
};

}  // namespace

Rgb backdrop(float t) {
  return mix(from_srgb(252, 252, 253), from_srgb(226, 231, 238), t * t);
}

Rgb ink_colour() {
  return from_srgb(44, 52, 66);
}

Image compose(const PictureContent& content) {
  const Composer composer(content);
  Image image(content.width, content.height);
  parallel_for(static_cast<std::int64_t>(composer.band_count()), 1,
               [&](std::int64_t band) { composer.draw_band(band, image); });
  return image;
}

}  // namespace selvage
