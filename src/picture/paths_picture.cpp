#include "picture/paths_picture.h"

#include "picture/composing/composition.h"
#include "picture/composing/surface_corners.h"
#include "picture/drawing/camera.h"
#include "picture/drawing/ink.h"
#include "picture/legend.h"
#include "selvage/core/error.h"

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

constexpr std::size_t kMaxPaths = 1200;  // more lines than this hide each other
constexpr double kWireframePixels = 9;   // triangles smaller than this are drawn without their edges
constexpr double kFeatureSize = 0.012;   // of the scene's radius: the smallest step drawn as an outline

std::vector<Vec3> used_positions(const PathsDrawing& scene) {
  std::vector<char> used(scene.positions.size(), 0);
  for (const auto& triangle : scene.surface) {
    for (const Index v : triangle) used[v] = 1;
  }
  std::vector<Vec3> points;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v]) points.push_back(scene.positions[v]);
  }
  if (points.empty()) throw Error("picture", "there is no surface to draw");
  return points;
}

double mean_edge_pixels(const PathsDrawing& scene, const Camera& camera) {
  double sum = 0;
  for (const auto& [a, b, c] : scene.surface) {
    const Vec3 p = camera.project(scene.positions[a]), q = camera.project(scene.positions[b]);
    sum += (p - q).head<2>().norm();
  }
  return sum / static_cast<double>(scene.surface.size());
}

PictureContent make_content(const PathsDrawing& scene, const PictureOptions& options, const Camera& camera,
                            double deepest) {
  std::vector<double> value(scene.vertex_depth.begin(), scene.vertex_depth.end());
  for (double& v : value) v = v < 0 ? -1 : v / deepest;
  PictureContent content{options.width, options.height, options.samples, {}, {}};
  PlacedSurface surface{scene.positions, scene.surface};
  surface.vertex_value = value;
  add_surface(surface, camera, {0, 0, static_cast<double>(options.width), static_cast<double>(options.height)},
              content.body);
  content.planar = !scene.outline.empty();
  if (!content.planar) {
    content.inner.vertices = content.body.vertices;
    for (const auto& triangle : content.body.triangles) {
      const auto weight = [&](Index v) { return content.inner.vertices[v].weight; };
      if (weight(triangle[0]) + weight(triangle[1]) + weight(triangle[2]) > 0)
        content.inner.triangles.push_back(triangle);
    }
    content.camera = camera;
    content.lamps = default_lamps(camera, Vec3::UnitZ());
    add_occluders(surface, content.occluders);
  }
  for (ScreenVertex& corner : content.body.vertices) corner.weight = 1;
  content.wireframe = mean_edge_pixels(scene, camera) > kWireframePixels;
  content.feature = static_cast<float>(kFeatureSize * camera.scene_radius());
  content.pixels_at_one = static_cast<float>(camera.pixels_per_metre(1));
  return content;
}

Stroke place_stroke(const Camera& camera, const Vec3& from, const Vec3& to, float radius) {
  const Vec3 p = camera.project(from), q = camera.project(to);
  return {{static_cast<float>(p[0]), static_cast<float>(p[1])},
          {static_cast<float>(q[0]), static_cast<float>(q[1])},
          radius};
}

/// Draws the paths from the farthest to the nearest, each a bright line with a dark rim and a dot at its inner end.
void draw_path_lines(Image& image, const PathsDrawing& scene, const Camera& camera, double deepest) {
  std::vector<DrawnPath> drawn;
  const std::size_t step = (scene.paths.size() + kMaxPaths - 1) / kMaxPaths;
  for (std::size_t i = 0; i < scene.paths.size(); i += std::max<std::size_t>(step, 1)) drawn.push_back(scene.paths[i]);
  std::stable_sort(drawn.begin(), drawn.end(), [&](const DrawnPath& a, const DrawnPath& b) {
    return camera.project(a.from)[2] > camera.project(b.from)[2];
  });
  const float crowd = std::clamp(std::sqrt(400.f / static_cast<float>(drawn.size() + 1)), 0.45f, 1.f);
  const float scale = crowd * static_cast<float>(image.height()) / 1000;
  for (const DrawnPath& path : drawn) {
    const Rgb colour = depth_colour(static_cast<float>(path.depth / deepest));
    const Stroke rim = place_stroke(camera, path.from, path.to, 1.9f * scale);
    const Stroke dot{rim.from, rim.from, 3.2f * scale};
    const Stroke core{rim.from, rim.to, 0.9f * scale}, dot_core{rim.from, rim.from, 2.1f * scale};
    draw_strokes(image, std::array{rim, dot}, colour * 0.35f, 0.75f);
    draw_strokes(image, std::array{core}, mix(colour, Rgb::Ones(), 0.6f), 0.9f);
    draw_strokes(image, std::array{dot_core}, mix(colour, Rgb::Ones(), 0.25f), 1.f);
  }
}

void check_options(const PictureOptions& options) {
  for (const int size : {options.width, options.height}) {
    if (size < 64 || size > 8192) throw Error("picture", "its size must lie between 64 and 8192 pixels");
  }
}

}  // namespace

Image draw_paths(const PathsDrawing& scene, const PictureOptions& options) {
  check_options(options);
  const double width = options.width, height = options.height;
  const Frame frame{0.04 * width, 0.05 * height, 0.87 * width, 0.91 * height};
  const bool planar = !scene.outline.empty();
  View view;
  view.towards = planar ? Vec3(0, 0, 1) : options.towards;
  const Camera camera(used_positions(scene), view, frame);
  double deepest = 0;
  for (const double d : scene.vertex_depth) deepest = std::max(deepest, d);
  for (const DrawnPath& path : scene.paths) deepest = std::max(deepest, path.depth);
  const double scale = deepest > 0 ? deepest : 1;

  Image image = compose(make_content(scene, options, camera, scale));
  std::vector<Stroke> outline;
  for (const auto& [a, b] : scene.outline) {
    outline.push_back(
        place_stroke(camera, scene.positions[a], scene.positions[b], static_cast<float>(image.height()) / 1000));
  }
  draw_strokes(image, outline, ink_colour(), 0.85f);
  draw_path_lines(image, scene, camera, scale);
  if (deepest > 0) draw_scale(image, deepest, "depth [m]", depth_colour);
  draw_caption(image, scene.caption);
  return image;
}

}  // namespace selvage
