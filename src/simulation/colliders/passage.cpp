#include "simulation/colliders/passage.h"

#include "bvh/traverse.h"

#include <cmath>
#include <limits>

namespace selvage {

namespace {

/// Part of a shape's size by which a way may begin inside it: rounding of points that were set on its surface.
constexpr double kOnSurface = 1e-9;
/// Pieces in which a way as long as a mesh's diagonal, or longer, looks for triangles.
constexpr double kMostPieces = 12;

/// The part of a line that is inside a convex shape, as parameters of the line, and the normals at its ends.
struct Chord {
  double first = -std::numeric_limits<double>::infinity(), last = std::numeric_limits<double>::infinity();
  Vec3 first_normal = Vec3::Zero(), last_normal = Vec3::Zero();

  void cut(double from, const Vec3& from_normal, double to, const Vec3& to_normal) {
    if (from > first) {
      first = from;
      first_normal = from_normal;
    }
    if (to < last) {
      last = to;
      last_normal = to_normal;
    }
  }
};

/// Parameters t at which from + t way is at the given distance from the origin.
std::optional<std::array<double, 2>> cross_round(const Vec3& from, const Vec3& way, double radius) {
  const double a = way.squaredNorm(), b = from.dot(way), c = from.squaredNorm() - radius * radius;
  const double root = b * b - a * c;
  if (!(a > 0) || !(root > 0)) return {};
  return std::array{(-b - std::sqrt(root)) / a, (-b + std::sqrt(root)) / a};
}

std::optional<Passage> passage_of(const Chord& chord, const Vec3& from, const Vec3& way) {
  const double slack = kOnSurface * (chord.last - chord.first);
  if (!(chord.first < chord.last) || chord.first < -slack || chord.first > 1 || chord.last < slack) return {};
  const Vec3 entry = from + std::max(chord.first, 0.0) * way;
  return Passage{entry, chord.first_normal, chord.last < 1 ? chord.last_normal : Vec3(Vec3::Zero())};
}

}  // namespace

std::optional<Passage> find_passage(const SphereShape& sphere, const Vec3& from, const Vec3& to) {
  const Vec3 start = from - sphere.centre, way = to - from;
  const auto ends = cross_round(start, way, sphere.radius);
  if (!ends) return {};
  const auto normal = [&](double t) { return Vec3((start + t * way) / sphere.radius); };
  Chord chord;
  chord.cut((*ends)[0], normal((*ends)[0]), (*ends)[1], normal((*ends)[1]));
  return passage_of(chord, from, way);
}

std::optional<Passage> find_passage(const CylinderShape& cylinder, const Vec3& from, const Vec3& to) {
  const Vec3 start = from - cylinder.centre, way = to - from;
  const double height = cylinder.axis.dot(start), rise = cylinder.axis.dot(way), end = cylinder.length / 2;
  const Vec3 start_across = start - height * cylinder.axis, way_across = way - rise * cylinder.axis;
  Chord chord;
  if (rise != 0) {
    const double side = rise > 0 ? 1 : -1;
    chord.cut((-side * end - height) / rise, -side * cylinder.axis, (side * end - height) / rise, side * cylinder.axis);
  } else if (std::abs(height) >= end) {
    return {};
  }
  if (way_across.squaredNorm() > 0) {
    const auto ends = cross_round(start_across, way_across, cylinder.radius);
    if (!ends) return {};
    const auto normal = [&](double t) { return Vec3((start_across + t * way_across) / cylinder.radius); };
    chord.cut((*ends)[0], normal((*ends)[0]), (*ends)[1], normal((*ends)[1]));
  } else if (start_across.norm() >= cylinder.radius) {
    return {};
  }
  return passage_of(chord, from, way);
}

std::optional<Passage> find_passage(const MeshCollider& shape, const Vec3& from, const Vec3& to) {
  const Vec3 way = to - from;
  const double length = way.norm();
  if (!(length > 0)) return {};
  const double diagonals = length / shape.bounds().diagonal().norm(), slack = kOnSurface / diagonals;
  double first = std::numeric_limits<double>::infinity(), last = -first;
  Passage passage{from, Vec3::Zero(), Vec3::Zero()};
  const auto visit = [&](Index t) {
    const auto& [a, b, c] = shape.corners(t);
    const Vec3 area = (b - a).cross(c - a);
    const double along = area.dot(way);
    if (along == 0) return;
    const double at = area.dot(a - from) / along;
    if (at < -slack || at > 1) return;
    const Vec3 p = from + at * way;
    const std::array<Vec3, 3> corners{a, b, c};
    for (int i = 0; i < 3; ++i) {
      const Vec3 &u = corners[i], &v = corners[(i + 1) % 3];
      // Ways through an edge cross both of its triangles.
      if (area.dot((v - u).cross(p - u)) < -kOnSurface * area.squaredNorm()) return;
    }
    if (along < 0 && at < first) {
      first = at;
      passage.entry = from + std::max(at, 0.0) * way;
      passage.entry_normal = area.normalized();
    }
    if (along > 0 && at > last) {
      last = at;
      passage.exit_normal = area.normalized();
    }
  };
  // The box of a long way across axes would hold most triangles.
  const int pieces = std::max(1, static_cast<int>(kMostPieces * std::min(diagonals, 1.0)));
  Vec3 begin = from - slack * way;
  for (int i = 1; i <= pieces; ++i) {
    const Vec3 end = from + static_cast<double>(i) / pieces * way;
    visit_overlaps(shape.nodes(), enclosing_box<3>(begin.cwiseMin(end), begin.cwiseMax(end)), visit);
    begin = end;
  }
  if (std::isinf(first)) return {};
  return passage;
}

std::optional<Passage> find_passage(const GrownMesh& shape, const Vec3& from, const Vec3& to) {
  std::optional<Passage> passage = find_passage(shape.mesh, from, to);
  if (passage) passage->entry += shape.by * passage->entry_normal;
  return passage;
}

}  // namespace selvage
