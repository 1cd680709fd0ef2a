#include "picture/composing/surface_corners.h"

#include "core/parallel.h"

#include <Eigen/Geometry>

#include <algorithm>

namespace selvage {

namespace {

constexpr double kSmoothCosine = 0.65;  // faces that differ by less than about 50 degrees share a normal

/// Triangles around each vertex.
struct Fans {
  std::vector<Index> first, triangles;

  Fans(Index vertex_count, std::span<const VertexTuple<3>> all)
      : first(vertex_count + 1, 0), triangles(3 * all.size()) {
    for (const auto& t : all) {
      for (const Index v : t) ++first[v + 1];
    }
    for (Index v = 0; v < vertex_count; ++v) first[v + 1] += first[v];
    std::vector<Index> next(first.begin(), first.end() - 1);
    for (std::size_t t = 0; t < all.size(); ++t) {
      for (const Index v : all[t]) triangles[next[v]++] = static_cast<Index>(t);
    }
  }

  std::span<const Index> around(Index v) const {
    return std::span(triangles).subspan(first[v], first[v + 1] - first[v]);
  }
};

constexpr double kNearest = 1e-3;  // of the scene's radius: nearer to the eye nothing is drawn
constexpr double kSideways = 2;    // half widths of the picture, beyond which triangles are clipped

/// A corner of a triangle that is clipped.
struct Corner {
  Vec3 p;  ///< [m]
  Eigen::Vector3f normal;
  float value, weight;
  Corner(const Vec3& at, const Eigen::Vector3f& n, float v, float w) : p(at), normal(n), value(v), weight(w) {}
};

/// Where the way between two corners meets a plane, from whichever end it is gone: the same bits.
Corner meet(const Corner& a, const Corner& b, double ha, double hb) {
  if (std::lexicographical_compare(b.p.begin(), b.p.end(), a.p.begin(), a.p.end())) return meet(b, a, hb, ha);
  const double t = ha / (ha - hb);
  const auto s = static_cast<float>(t);
  return {a.p + t * (b.p - a.p), a.normal + s * (b.normal - a.normal), a.value + s * (b.value - a.value),
          a.weight + s * (b.weight - a.weight)};
}

/// Leaves of a convex polygon what lies where height(p) >= 0.
template <typename Height>
void clip(std::vector<Corner>& polygon, const Height& height) {
  std::vector<Corner> left;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Corner &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double ha = height(a.p), hb = height(b.p);
    if (ha >= 0) left.push_back(a);
    if ((ha > 0 && hb < 0) || (ha < 0 && hb > 0)) left.push_back(meet(a, b, ha, hb));
  }
  polygon = std::move(left);
}

/// The half spaces in which a surface is drawn.
class Bounds {
 public:
  Bounds(const Camera& camera, const Frame& frame, const CutPlane* cut)
      : camera_(camera), cut_(cut), nearest_(kNearest * camera.scene_radius()) {
    const double width = frame.right - frame.left, height = frame.bottom - frame.top;
    const auto side = [&](double x, double y) {
      return camera.rotate(
          camera.ray(frame.left + width * (0.5 + kSideways * x), frame.top + height * (0.5 + kSideways * y)));
    };
    left_ = side(-0.5, 0)[0], right_ = side(0.5, 0)[0], top_ = side(0, -0.5)[1], bottom_ = side(0, 0.5)[1];
  }

  bool hold(const Vec3& p) const {
    if (cut_ != nullptr && cut_height(p) < 0) return false;
    const Vec3 d = turned(p);
    return d[2] >= nearest_ && d[0] >= left_ * d[2] && d[0] <= right_ * d[2] && d[1] >= top_ * d[2] &&
           d[1] <= bottom_ * d[2];
  }

  void clip_polygon(std::vector<Corner>& polygon) const {
    if (cut_ != nullptr) clip(polygon, [&](const Vec3& p) { return cut_height(p); });
    clip(polygon, [&](const Vec3& p) { return turned(p)[2] - nearest_; });
    clip(polygon, [&](const Vec3& p) { return turned(p)[0] - left_ * turned(p)[2]; });
    clip(polygon, [&](const Vec3& p) { return right_ * turned(p)[2] - turned(p)[0]; });
    clip(polygon, [&](const Vec3& p) { return turned(p)[1] - top_ * turned(p)[2]; });
    clip(polygon, [&](const Vec3& p) { return bottom_ * turned(p)[2] - turned(p)[1]; });
  }

 private:
  double cut_height(const Vec3& p) const { return cut_->normal.dot(cut_->point - p); }
  Vec3 turned(const Vec3& p) const { return camera_.rotate(p - camera_.eye()); }

  const Camera& camera_;
  const CutPlane* cut_;
  double nearest_, left_, right_, top_, bottom_;
};

ScreenVertex place(const Corner& corner, const Camera& camera) {
  const Vec3 at = camera.project(corner.p);
  return {static_cast<float>(at[0]),
          static_cast<float>(at[1]),
          static_cast<float>(at[2]),
          corner.normal,
          corner.value,
          corner.weight};
}

bool turns_away(const PlacedSurface& surface, std::size_t t, const Vec3& eye) {
  const auto& [a, b, c] = surface.triangles[t];
  const Vec3 &p = surface.positions[a], &q = surface.positions[b], &r = surface.positions[c];
  return (q - p).cross(r - p).dot(eye - p) <= 0;
}

}  // namespace

std::vector<ScreenVertex> place_corners(const PlacedSurface& surface, const Camera& camera) {
  const auto& [positions, triangles, values, parts, windings, cut, one_sided] = surface;
  const Fans fans(static_cast<Index>(positions.size()), triangles);
  std::vector<Vec3> normals(triangles.size());  // as long as twice the area
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto& [a, b, c] = triangles[t];
    normals[t] = (positions[b] - positions[a]).cross(positions[c] - positions[a]);
  }
  std::vector<ScreenVertex> corners(3 * triangles.size());
  parallel_for(static_cast<std::int64_t>(triangles.size()), 1024, [&](std::int64_t t) {
    for (int i = 0; i < 3; ++i) {
      const Index v = surface.triangles[t][i];
      Vec3 normal = Vec3::Zero();
      for (const Index other : fans.around(v)) {
        const double cosine = normals[t].dot(normals[other]);
        if (cosine >= kSmoothCosine * normals[t].norm() * normals[other].norm()) normal += normals[other];
      }
      if (normal.norm() > 0) normal.normalize();
      const double value = surface.vertex_value.empty() ? 0 : surface.vertex_value[v];
      corners[3 * t + i] = place({surface.positions[v], camera.rotate(normal).cast<float>(),
                                  static_cast<float>(std::max(value, 0.0)), value < 0 ? 0.f : 1.f},
                                 camera);
    }
  });
  return corners;
}

void add_surface(const PlacedSurface& surface, const Camera& camera, const Frame& frame, ScreenSurface& screen) {
  const Bounds bounds(camera, frame, surface.cut);
  std::vector<char> held(surface.positions.size());
  parallel_for(static_cast<std::int64_t>(held.size()), 4096,
               [&](std::int64_t v) { held[v] = bounds.hold(surface.positions[v]) ? 1 : 0; });
  const auto first = static_cast<Index>(screen.vertices.size());
  const auto corners = place_corners(surface, camera);
  screen.vertices.insert(screen.vertices.end(), corners.begin(), corners.end());
  const auto add_triangle = [&](std::size_t t, const VertexTuple<3>& triangle) {
    screen.triangles.push_back(triangle);
    screen.parts.push_back(surface.parts.empty() ? 0 : surface.parts[t]);
    if (surface.cut != nullptr || !screen.windings.empty()) {
      screen.windings.resize(screen.triangles.size() - 1, kNone);
      screen.windings.push_back(surface.windings.empty() ? kNone : surface.windings[t]);
    }
  };
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto& [a, b, c] = surface.triangles[t];
    if (surface.one_sided && turns_away(surface, t, camera.eye())) continue;
    const Index at = first + static_cast<Index>(3 * t);
    if (held[a] && held[b] && held[c]) {
      add_triangle(t, {at, at + 1, at + 2});
      continue;
    }
    std::vector<Corner> polygon;
    for (int i = 0; i < 3; ++i) {
      const ScreenVertex& corner = corners[3 * t + static_cast<std::size_t>(i)];
      polygon.push_back({surface.positions[surface.triangles[t][i]], corner.normal, corner.value, corner.weight});
    }
    bounds.clip_polygon(polygon);
    if (polygon.size() < 3) continue;
    const auto fan = static_cast<Index>(screen.vertices.size());
    for (const Corner& corner : polygon) screen.vertices.push_back(place(corner, camera));
    for (Index i = 2; i < static_cast<Index>(polygon.size()); ++i) add_triangle(t, {fan, fan + i - 1, fan + i});
  }
}

std::optional<ScreenLine> place_line(const Vec3& from, const Vec3& to, float radius, const Camera& camera) {
  Vec3 a = camera.rotate(from - camera.eye()), b = camera.rotate(to - camera.eye());
  const double nearest = kNearest * camera.scene_radius();
  if (a[2] < nearest && b[2] < nearest) return {};
  if (a[2] < nearest) a = a + (nearest - a[2]) / (b[2] - a[2]) * (b - a);
  if (b[2] < nearest) b = b + (nearest - b[2]) / (a[2] - b[2]) * (a - b);
  return ScreenLine{camera.project_turned(a).cast<float>(), camera.project_turned(b).cast<float>(), radius};
}

void add_occluders(const PlacedSurface& surface, std::vector<Occluder>& occluders) {
  for (const auto& [a, b, c] : surface.triangles) {
    const Occluder corners{surface.positions[a], surface.positions[b], surface.positions[c]};
    std::vector<Corner> polygon;
    if (surface.cut != nullptr) {
      const auto height = [&](const Vec3& p) { return surface.cut->normal.dot(surface.cut->point - p); };
      if (std::any_of(corners.begin(), corners.end(), [&](const Vec3& p) { return height(p) < 0; })) {
        for (const Vec3& p : corners) polygon.push_back({p, Eigen::Vector3f::Zero(), 0, 0});
        clip(polygon, height);
        for (std::size_t i = 2; i < polygon.size(); ++i)
          occluders.push_back({polygon[0].p, polygon[i - 1].p, polygon[i].p});
        continue;
      }
    }
    occluders.push_back(corners);
  }
}

}  // namespace selvage
