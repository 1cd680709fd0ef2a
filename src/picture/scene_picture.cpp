#include "picture/scene_picture.h"

#include "picture/composing/palette.h"
#include "picture/composing/surface_corners.h"
#include "selvage/core/error.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace selvage {

namespace {

constexpr double kSmallestStep = 0.009;  // of the scene's radius: the smallest step drawn as an outline
constexpr double kMargin = 0.04;         // of the picture, around what is seen
constexpr int kExtremes = 60;            // directions in which a frame's outermost points are kept
constexpr double kFarCollider = 1.6;     // of the room's size: colliders that reach farther need not be seen whole
constexpr double kLegend = 0.29;         // of the picture's height, on the right
constexpr float kLineRadius = 0.55f;     // pixels, in a picture 800 pixels high

std::vector<Vec3> spread_directions() {
  std::vector<Vec3> directions;
  for (int i = 0; i < kExtremes; ++i) {
    const double z = 1 - (2 * i + 1.0) / kExtremes, across = std::sqrt(1 - z * z), angle = 2.39996323 * i;
    directions.emplace_back(across * std::cos(angle), across * std::sin(angle), z);
  }
  return directions;
}

/// Bodies whose every edge has as many triangles on one side as on the other.
std::vector<char> find_closed(const DrawnScene& scene, Index body_count) {
  struct Side {
    Index low, high, turn;
  };
  std::vector<Side> sides;
  sides.reserve(3 * scene.surface.size());
  for (const auto& t : scene.surface)
    for (std::size_t i = 0; i < 3; ++i) {
      const Index a = t[i], b = t[(i + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), a < b ? 1 : -1});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.turn) < std::tie(b.low, b.high, b.turn);
  });
  std::vector<char> closed(static_cast<std::size_t>(body_count), 1);
  for (std::size_t i = 0; i < sides.size();) {
    Index sum = 0;
    const std::size_t first = i;
    for (; i < sides.size() && sides[i].low == sides[first].low && sides[i].high == sides[first].high; ++i)
      sum += sides[i].turn;
    if (sum != 0) closed[static_cast<std::size_t>(scene.bodies[sides[first].low])] = 0;
  }
  return closed;
}

/// The highest of the numbers at a triangle's corners.
Index corner_name(const VertexTuple<3>& t, std::span<const double> values) {
  double highest = 0;
  for (const Index v : t) highest = std::max(highest, values[static_cast<std::size_t>(v)]);
  return static_cast<Index>(highest);
}

}  // namespace

void DrawnScene::number_pieces() {
  std::vector<Index> root(vertex_count);
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](Index v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (const auto& [a, b, c] : surface) {
    for (const Index other : {b, c}) {
      const Index p = find(a), q = find(other);
      root[std::max(p, q)] = std::min(p, q);
    }
  }
  std::vector<char> used(vertex_count, 0);
  for (const auto& t : surface)
    for (const Index v : t) used[v] = 1;
  bodies.assign(vertex_count, 0);
  Index count = 0;
  for (std::size_t v = 0; v < vertex_count; ++v) {
    const Index top = find(static_cast<Index>(v));
    bodies[v] = top == static_cast<Index>(v) ? (used[v] ? count++ : 0) : bodies[top];
  }
}

ScenePictures::ScenePictures(const DrawnScene& scene, const SceneView& view) : scene_(scene), view_(view) {
  for (const int size : {view.width, view.height})
    if (size < 64 || size > 8192) throw Error("picture", "its size must lie between 64 and 8192 pixels");
  if (scene.surface.empty()) throw Error("picture", "there is no surface to draw");
  for (const Index body : scene.bodies) body_count_ = std::max(body_count_, body + 1);
  room_.lower = Vec3::Constant(INFINITY);
  room_.upper = -room_.lower;
  room_.up = scene.up.normalized();
  if (!view.cut) return;
  const auto closed = find_closed(scene, body_count_);
  for (const auto& t : scene.surface) {
    const Index body = scene.bodies[t[0]];
    windings_.push_back(closed[body] ? body : kNone);
  }
}

void ScenePictures::add_frame(std::span<const Vec3> positions, double time) {
  static const std::vector<Vec3> directions = spread_directions();
  std::vector<std::pair<double, Index>> outermost(directions.size(), {-INFINITY, kNone});
  std::vector<char> used(positions.size(), 0);
  for (const auto& t : scene_.surface)
    for (const Index v : t) used[v] = 1;
  for (std::size_t v = 0; v < positions.size(); ++v) {
    if (!used[v]) continue;
    room_.lower = room_.lower.cwiseMin(positions[v]);
    room_.upper = room_.upper.cwiseMax(positions[v]);
    for (std::size_t i = 0; i < directions.size(); ++i) {
      const double height = directions[i].dot(positions[v]);
      if (height > outermost[i].first) outermost[i] = {height, static_cast<Index>(v)};
    }
  }
  for (const auto& [height, v] : outermost) seen_.push_back(positions[v]);
  times_.push_back(time);
}

/// Bowls and other colliders stand on the ground, too.
void ScenePictures::lower_ground_below_colliders() {
  for (const Collider& collider : scene_.colliders) {
    const ColliderPart part = make_collider_part(collider, times_.front(), room_);
    if (part.free_side) continue;
    for (const Vec3& p : part.positions)
      if ((p - room_.middle()).norm() < kFarCollider * room_.size())
        ground_->height = std::min(ground_->height, room_.up.dot(p));
  }
}

/// What must be seen: bodies in all frames, and colliders nearby.
std::vector<Vec3> ScenePictures::seen_points() const {
  std::vector<Vec3> points = seen_;
  for (const double time : times_)
    for (std::size_t i = 0; i < scene_.colliders.size(); ++i) {
      const ColliderPart part = make_collider_part(scene_.colliders[i], time, room_);
      if (ground_ && ground_->plane == i) continue;
      const bool near = std::all_of(part.positions.begin(), part.positions.end(), [&](const Vec3& p) {
        return (p - room_.middle()).norm() < kFarCollider * room_.size();
      });
      if (near && !part.free_side) points.insert(points.end(), part.positions.begin(), part.positions.end());
    }
  return points;
}

View ScenePictures::base_view() const {
  View view = view_.view;
  view.up = room_.up;
  if (!view.towards && !view.eye) {
    const Vec3 east = std::abs(room_.up[0]) < 0.9 ? Vec3(Vec3::UnitX() - room_.up[0] * room_.up).normalized()
                                                  : Vec3(Vec3::UnitY() - room_.up[1] * room_.up).normalized();
    view.towards = 0.5 * east - room_.up.cross(east) + 0.5 * room_.up;
  }
  return view;
}

void ScenePictures::place_ground() {
  if (ground_ || !scene_.ground) return;
  ground_ = find_ground(scene_.colliders, room_);
  if (ground_ && !ground_->plane && !ground_->walled) lower_ground_below_colliders();
}

void ScenePictures::look(const View& view) {
  place_ground();
  const double width = view_.width, height = view_.height;
  const double right = view_.scale != nullptr ? width - kLegend * height : (1 - kMargin) * width;
  const Frame frame =
      view.eye ? Frame{0, 0, width, height}
               : Frame{kMargin * width, kMargin * height, std::max(right, 0.5 * width), (1 - kMargin) * height};
  const bool is_first = !camera_;
  camera_.emplace(seen_points(), view, frame);
  if (is_first) lamps_ = default_lamps(*camera_, room_.up);
}

View ScenePictures::turned_view(double angle) {
  place_ground();
  View view = base_view();
  const Vec3 centre = room_.middle();
  if (!view.eye) {
    double radius = 0;
    for (const Vec3& p : seen_points()) radius = std::max(radius, (p - centre).norm());
    const double across = std::min(1.0, static_cast<double>(view_.width) / view_.height);
    view.eye = centre + view.towards->normalized() * radius / (std::sin(view.angle * M_PI / 360) * across);
    view.target = centre;
  }
  const Eigen::AngleAxisd turn(angle, room_.up);
  view.eye = centre + turn * (*view.eye - centre);
  view.target = centre + turn * (view.target.value_or(centre) - centre);
  return view;
}

void ScenePictures::add_colliders(double time, PictureContent& content) const {
  const Frame frame{0, 0, static_cast<double>(view_.width), static_cast<double>(view_.height)};
  const float radius = kLineRadius * static_cast<float>(std::max(view_.height, 400)) / 800;
  content.lined_part = static_cast<Index>(content.colours.size());
  for (std::size_t i = 0; i < scene_.colliders.size(); ++i) {
    if (ground_ && ground_->plane == i) continue;
    const ColliderPart part = make_collider_part(scene_.colliders[i], time, room_);
    const std::vector<Index> parts(part.triangles.size(), content.lined_part);
    PlacedSurface surface{part.positions, part.triangles};
    surface.parts = parts;
    surface.one_sided = part.one_sided;
    const bool from_behind =
        part.free_side && !part.positions.empty() && part.free_side->dot(camera_->eye() - part.positions[0]) < 0;
    add_surface(surface, *camera_, frame, from_behind ? content.glass : content.body);
    if (part.casts_shadow) add_occluders(surface, content.occluders);
    for (const auto& [from, to] : part.edges)
      if (const auto line = place_line(from, to, radius, *camera_)) content.lines.push_back(*line);
  }
}

void ScenePictures::add_bodies(std::span<const Vec3> positions, const std::optional<CutPlane>& cut,
                               std::span<const double> values, PictureContent& content) const {
  const Frame frame{0, 0, static_cast<double>(view_.width), static_cast<double>(view_.height)};
  const bool has_names = view_.scale != nullptr && !view_.scale->names.empty();
  const auto first_name = static_cast<Index>(content.colours.size());
  std::vector<Index> parts;
  for (const auto& t : scene_.surface)
    parts.push_back(has_names ? first_name + corner_name(t, values) : scene_.bodies[t[0]]);
  std::vector<double> shares;
  if (view_.scale != nullptr && !has_names)
    for (const double value : values) shares.push_back(std::clamp(value / view_.scale->top, 0.0, 1.0));
  if (has_names)
    for (std::size_t i = 0; i < view_.scale->names.size(); ++i)
      content.colours.push_back(contact_colour(static_cast<Index>(i)));
  PlacedSurface surface{positions, scene_.surface};
  surface.vertex_value = shares;
  surface.parts = parts;
  surface.windings = windings_;
  surface.cut = cut ? &*cut : nullptr;
  add_surface(surface, *camera_, frame, content.body);
  add_occluders(surface, content.occluders);
  if (scene_.marked.empty()) return;
  std::vector<VertexTuple<3>> marked;
  for (const Index t : scene_.marked) marked.push_back(scene_.surface[t]);
  PlacedSurface shining{positions, marked};
  shining.cut = surface.cut;
  add_surface(shining, *camera_, frame, content.inner);
  content.inner.windings.clear();
  for (ScreenVertex& vertex : content.inner.vertices) vertex.value = -1;
}

void ScenePictures::draw_legend(Image& image) const {
  const ColourScale& scale = *view_.scale;
  if (scale.names.empty()) {
    draw_scale(image, scale.top, scale.title, value_colour);
    return;
  }
  std::vector<Rgb> colours;
  for (std::size_t i = 0; i < scale.names.size(); ++i) colours.push_back(contact_colour(static_cast<Index>(i)));
  draw_names(image, scale.names, colours);
}

Image ScenePictures::draw(std::span<const Vec3> positions, double time, std::span<const double> values) {
  if (times_.empty()) add_frame(positions, time);
  if (!camera_) look(base_view());
  PictureContent content{view_.width, view_.height, view_.samples, {}, {}};
  content.camera = camera_;
  content.lamps = lamps_;
  content.feature = static_cast<float>(kSmallestStep * camera_->scene_radius());
  content.pixels_at_one = static_cast<float>(camera_->pixels_per_metre(1));
  content.wireframe = view_.edges;
  for (Index body = 0; body < body_count_; ++body) content.colours.push_back(body_colour(body));
  if (view_.cut) {
    CutPlane cut{Vec3::Zero(), Vec3::Unit(view_.cut->axis)};
    cut.point[view_.cut->axis] = view_.cut->position;
    if (cut.normal.dot(camera_->eye() - cut.point) < 0) cut.normal = -cut.normal;
    content.cut = cut;
    content.body_count = body_count_;
    for (Index body = 0; body < body_count_; ++body) content.colours.push_back(cap_colour(body));
  }
  if (view_.scale != nullptr && view_.scale->names.empty()) {
    content.valued_parts = body_count_;
    content.grey_at_zero = view_.scale->grey_at_zero;
  }
  add_bodies(positions, content.cut, values, content);
  const auto colliders = content.colours.size();
  add_colliders(time, content);
  content.colours.resize(colliders);
  content.colours.push_back(collider_colour());
  if (ground_ && !ground_->walled) {
    const Vec3 point = ground_->height * room_.up;
    if (room_.up.dot(camera_->eye() - point) > 0) content.ground = GroundPlane{point, room_.up};
  }
  Image image = compose(content);
  if (view_.scale != nullptr) draw_legend(image);
  return image;
}

}  // namespace selvage
