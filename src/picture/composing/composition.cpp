#include "picture/composing/composition.h"

#include "core/parallel.h"
#include "picture/composing/palette.h"
#include "picture/drawing/shading.h"

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

constexpr float kThroughBody = 0.85f;    // how clearly what lies inside shows through
constexpr float kOcclusionFeatures = 9;  // radius of ambient occlusion against the size of a feature
constexpr float kGlass = 0.16f;          // opacity
constexpr int kBandRows = 8;             // pixels
constexpr int kMinMap = 256, kMaxMap = 1024;

/// Puts what is analytic into a layer of the body: caps of a cut, then the ground.
void add_planes(const PictureContent& content, SurfaceLayer& layer) {
  if (!content.camera) return;
  if (content.cut && !layer.winding.empty()) {
    // A ray that leaves more bodies than it enters, behind the cut, has come in through the cut.
    const auto is_cap = [&](std::size_t i, float) { return layer.winding[i].times != 0; };
    const auto part_of = [&](std::size_t i) {
      const Winding& winding = layer.winding[i];
      const bool plain = winding.times == 1 && winding.numbered >= 1 && winding.numbered <= content.body_count;
      return plain ? content.body_count + winding.numbered - 1 : kOverlapPart;
    };
    layer.add_plane(*content.camera, content.cut->point, content.cut->normal, is_cap, part_of);
  }
  if (content.ground) {
    const auto is_nearer = [&](std::size_t i, float distance) { return distance < layer.distance[i]; };
    layer.add_plane(*content.camera, content.ground->point, content.ground->up, is_nearer,
                    [](std::size_t) { return kGroundPart; });
  }
}

int choose_map_size(const PictureContent& content) {
  int size = kMinMap;
  while (size < kMaxMap && size < std::max(content.width, content.height)) size *= 2;
  return size;
}

/// One of the two surfaces of a picture.
class ComposedSurface {
 public:
  ComposedSurface(const PictureContent& content, const ScreenSurface& surface, bool is_body)
      : content_(content), is_body_(is_body), bands_(surface, content.height, kBandRows, kOutlineReach) {
    if (content.camera) lamps_ = {content.lamps, *content.camera};
    if (content.planar || (surface.triangles.empty() && !(is_body && content.ground))) return;
    SurfaceLayer layer(content.width, {0, content.height});
    draw_surface(surface, layer);
    std::vector<SeenLight> seen;
    if (is_body) {
      add_planes(content, layer);
      if (content.camera)
        seen = find_seen_light(layer, *content.camera, content.occluders, content.lamps, choose_map_size(content));
    }
    light_ = LightField(std::move(layer), std::move(seen), kOcclusionFeatures * content.feature, content.pixels_at_one);
  }

  std::size_t band_count() const { return bands_.count(); }
  Rows rows(std::size_t band) const { return bands_.rows(band); }

  /// The samples of a band and around it; none where the surface is not in it.
  SurfaceLayer draw(std::size_t band) const {
    const int samples = content_.samples;
    Rows drawn{0, 0};
    if (!bands_.is_empty(band) || (is_body_ && content_.ground)) {
      const Rows own = bands_.rows(band);
      drawn = {std::max(0, own.first * samples - kOutlineReach),
               std::min(content_.height * samples, own.last * samples + kOutlineReach)};
    }
    SurfaceLayer layer(content_.width * samples, drawn, samples);
    bands_.draw(band, layer);
    if (is_body_) add_planes(content_, layer);
    return layer;
  }

  Rgb colour(const SurfaceLayer& layer, const Rgb& base, int x, int y) const {
    const std::size_t i = layer.index(x, y);
    const auto scale = static_cast<float>(layer.samples);
    const PlaceLight light =
        light_.at((static_cast<float>(x) + 0.5f) / scale, (static_cast<float>(y) + 0.5f) / scale, layer.distance[i]);
    if (layer.part[i] == kGroundPart) return shade_ground(light);
    const Rgb shaded = wire(layer, i, shade(base, layer.normal[i], light, lamps_));
    return mix(shaded, shaded * 0.25f, 0.6f * outline_strength(layer, x, y, content_.feature));
  }

  Rgb wire(const SurfaceLayer& layer, std::size_t i, const Rgb& colour) const {
    if (!content_.wireframe) return colour;
    const float pixels = layer.edge[i] / static_cast<float>(layer.samples);
    return mix(colour, colour * 0.6f, 0.38f * std::clamp(1.1f - pixels, 0.f, 1.f));
  }

 private:
  const PictureContent& content_;
  bool is_body_;
  SurfaceBands bands_;
  LightField light_;
  TurnedLamps lamps_;
};

/// How much of each sample of a layer the lines cover that are not hidden.
std::vector<float> draw_lines(const PictureContent& content, const SurfaceLayer& layer) {
  // Lines lie on the surface that they are edges of, and on the ground; a sheet may hide them from as near as rounding.
  constexpr float kOwnBias = 0.996f, kBias = 0.99995f;
  if (content.lines.empty()) return {};
  std::vector<float> ink(layer.distance.size(), 0);
  const auto samples = static_cast<float>(layer.samples);
  for (const ScreenLine& line : content.lines) {
    const Eigen::Vector2f a = samples * line.from.head<2>(), along = samples * line.to.head<2>() - a;
    const float reach = samples * line.radius + 0.5f, length = along.norm();
    if (!(length > 0)) continue;
    const float low = std::min(a[1], a[1] + along[1]) - reach, high = std::max(a[1], a[1] + along[1]) + reach;
    const int first = std::max(layer.rows.first, static_cast<int>(std::max(low, 0.f)));
    const int last = std::min(layer.rows.last, static_cast<int>(std::min(high, 1e6f)) + 1);
    for (int y = first; y < last; ++y) {
      const float py = static_cast<float>(y) + 0.5f - a[1];
      // The samples of the row that are near the line: all between its ends where it runs along the row.
      float left = std::min(0.f, along[0]) - reach, right = std::max(0.f, along[0]) + reach;
      if (std::abs(along[1]) > 1e-3f * length) {
        const float middle = py * along[0] / along[1], half = reach * length / std::abs(along[1]);
        left = std::max(left, middle - half), right = std::min(right, middle + half);
      }
      const int x0 = std::max(0, static_cast<int>(std::clamp(a[0] + left, -1.f, 1e6f)));
      const int x1 = std::min(layer.width, static_cast<int>(std::clamp(a[0] + right, -1.f, 1e6f)) + 1);
      for (int x = x0; x < x1; ++x) {
        const float px = static_cast<float>(x) + 0.5f - a[0];
        const float t = std::clamp((px * along[0] + py * along[1]) / (length * length), 0.f, 1.f);
        const float off = std::hypot(px - t * along[0], py - t * along[1]);
        const float cover = std::clamp(samples * line.radius + 0.5f - off, 0.f, 1.f);
        if (cover == 0) continue;
        const float distance = 1 / ((1 - t) / line.from[2] + t / line.to[2]);
        const std::size_t i = layer.index(x, y);
        const bool is_own = layer.part[i] == content.lined_part || layer.part[i] == kGroundPart;
        if (distance * (is_own ? kOwnBias : kBias) < layer.distance[i]) ink[i] = std::max(ink[i], cover);
      }
    }
  }
  return ink;
}

class Composer {
 public:
  explicit Composer(const PictureContent& content)
      : content_(content),
        body_(content, content.body, true),
        inner_(content, content.inner, false),
        glass_(content.glass, content.height, kBandRows, kOutlineReach) {}

  std::size_t band_count() const { return body_.band_count(); }

  void draw_band(std::size_t band, Image& image) const {
    const int samples = content_.samples;
    const Rows rows = body_.rows(band);
    Band drawn{body_.draw(band), inner_.draw(band), {}, {}};
    if (!content_.lines.empty() || !glass_.is_empty(band)) {
      // Lines and glass are also where no body is.
      if (drawn.body.distance.empty())
        drawn.body = SurfaceLayer(content_.width * samples, {rows.first * samples, rows.last * samples}, samples);
      drawn.ink = draw_lines(content_, drawn.body);
      drawn.panes.assign(drawn.body.distance.size(), 0);
      glass_.count_in_front(band, drawn.body, drawn.panes);
    }
    for (int y = rows.first; y < rows.last; ++y) {
      for (int x = 0; x < image.width(); ++x) {
        Rgb sum = Rgb::Zero();
        for (int s = 0; s < samples * samples; ++s) {
          sum += sample(drawn, x * samples + s % samples, y * samples + s / samples).max(0.f).min(1.f);
        }
        image.at(x, y) = sum / static_cast<float>(samples * samples);
      }
    }
  }

 private:
  struct Band {
    SurfaceLayer body, inner;
    std::vector<float> ink;
    std::vector<std::uint8_t> panes;
  };

  Rgb sample(const Band& band, int x, int y) const {
    static const Rgb glass = from_oklab(0.68f, -0.005f, -0.015f), line = from_oklab(0.50f, -0.005f, -0.012f);
    Rgb colour = solid(band.body, band.inner, x, y);
    if (band.ink.empty() && band.panes.empty()) return colour;
    const std::size_t i = band.body.index(x, y);
    if (!band.panes.empty() && band.panes[i] > 0)
      colour = mix(colour, glass, 1 - std::pow(1 - kGlass, static_cast<float>(band.panes[i])));
    return band.ink.empty() ? colour : mix(colour, line, 0.75f * band.ink[i]);
  }

  Rgb solid(const SurfaceLayer& body, const SurfaceLayer& inner, int x, int y) const {
    if (!body.covers(x, y)) return Rgb::Ones();
    const std::size_t i = body.index(x, y);
    if (content_.planar) return body_.wire(body, i, cover_colour(body.count[i]));
    const Rgb colour = body_.colour(body, base_colour(body.part[i], body.value[i]), x, y);
    if (!inner.covers(x, y)) return colour;
    const std::size_t j = inner.index(x, y);
    const bool hidden = inner.distance[j] > body.distance[i] + 0.01f * content_.feature;
    const Rgb marked = inner.value[j] < 0 ? mark_colour() : depth_colour(inner.value[j]);
    return mix(colour, inner_.colour(inner, marked, x, y), hidden ? kThroughBody : 1.f);
  }

  Rgb base_colour(Index part, float value) const {
    static const Rgb skin = from_oklab(0.88f, -0.012f, -0.022f);
    if (part == kOverlapPart) return mark_colour();
    if (part >= 0 && part < content_.valued_parts)
      return content_.grey_at_zero && !(value > 0) ? contact_colour(0) : value_colour(value);
    return part < 0 || content_.colours.empty() ? skin : content_.colours[static_cast<std::size_t>(part)];
  }

  static Rgb cover_colour(int count) {
    return count <= 1 ? from_oklab(0.90f, -0.018f, -0.03f)
                      : from_oklab(0.90f - 0.07f * static_cast<float>(std::min(count, 5)), 0.0f,
                                   -0.02f * static_cast<float>(std::min(count, 5)));
  }

  const PictureContent& content_;
  ComposedSurface body_, inner_;
  SurfaceBands glass_;
};

}  // namespace

Rgb ink_colour() {
  return from_srgb(44, 52, 66);
}

Rgb mark_colour() {
  return from_srgb(0xd5, 0x5e, 0x00);
}

Image compose(const PictureContent& content) {
  const Composer composer(content);
  Image image(content.width, content.height);
  parallel_for(static_cast<std::int64_t>(composer.band_count()), 1,
               [&](std::int64_t band) { composer.draw_band(static_cast<std::size_t>(band), image); });
  return image;
}

}  // namespace selvage
