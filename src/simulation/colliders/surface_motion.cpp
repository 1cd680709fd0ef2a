#include "simulation/colliders/surface_motion.h"

#include "selvage/core/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

/// Times 6.
double volume_of(std::span<const VertexTuple<3>> triangles, std::span<const Vec3> positions) {
  double volume = 0;
  const Vec3& origin = positions[triangles[0][0]];
  for (const auto& [a, b, c] : triangles)
    volume += (positions[a] - origin).dot((positions[b] - origin).cross(positions[c] - origin));
  return volume;
}

/// Right-handed, of a triangle; nothing where that has no area.
std::optional<Eigen::Matrix3d> frame_of(const std::array<Vec3, 3>& corners) {
  const Vec3 along = (corners[1] - corners[0]).normalized();
  const Vec3 normal = along.cross(corners[2] - corners[0]).normalized();
  if (!(along.squaredNorm() > 0.5 && normal.squaredNorm() > 0.5)) return {};
  Eigen::Matrix3d frame;
  frame << along, normal.cross(along), normal;
  return frame;
}

void check_times(const std::string& where, std::span<const double> times) {
  for (std::size_t i = 0; i < times.size(); ++i)
    if (!std::isfinite(times[i]) || (i > 0 && !(times[i - 1] < times[i])))
      throw Error(where, fmt::format("its key frame {} is not later than the one before", i), "let times ascend");
}

}  // namespace

MeshShape KeyframedShape::at(double time) const {
  const auto after = std::upper_bound(times.begin(), times.end(), time);
  if (after == times.begin()) return {positions.front(), triangles};
  if (after == times.end()) return {positions.back(), triangles};
  const auto next = static_cast<std::size_t>(after - times.begin());
  const double share = (time - times[next - 1]) / (times[next] - times[next - 1]);
  MeshShape shape{positions[next - 1], triangles};
  for (std::size_t v = 0; v < shape.positions.size(); ++v)
    shape.positions[v] += share * (positions[next][v] - shape.positions[v]);
  return shape;
}

SurfaceMotion::SurfaceMotion(const std::string& where, const KeyframedShape& shape, const MeshCollider& at_first)
    : shape_(shape), start_(at_first), start_time_(shape.times.front()), end_time_(shape.times.front()) {
  check_times(where, shape.times);
  if (at_first.positions().size() != shape.positions.front().size())
    throw Error(where, "its triangles have each vertices of their own",
                "give a surface whose triangles share vertices, as in OBJ");
  for (std::size_t i = 0; i < shape.positions.size(); ++i) {
    const auto& positions = shape.positions[i];
    const auto refuse = [&](const std::string& what) {
      throw Error(where, fmt::format("its key frame {} {}", i, what), "give every frame the vertices of the first");
    };
    if (positions.size() != shape.positions.front().size())
      refuse(fmt::format("has {} vertices, the first {}", positions.size(), shape.positions.front().size()));
    if (!std::ranges::all_of(positions, [](const Vec3& p) { return p.allFinite(); }))
      refuse("has a position that is not finite");
    if (!(volume_of(shape.triangles, positions) > 0)) refuse("is turned inside out");
  }
}

void SurfaceMotion::set_step(double start_time, double end_time, MeshCollider& end) {
  if (start_time_ == start_time && end_time_ == end_time) return;
  if (end_time_ == start_time) {
    start_ = end;
  } else {
    start_.set_positions(shape_.at(start_time).positions);
  }
  MeshShape at_end = shape_.at(end_time);
  is_still_ = std::ranges::equal(at_end.positions, start_.positions());
  start_time_ = start_time;
  end_time_ = end_time;
  if (is_still_) {
    end = start_;
  } else {
    end.set_positions(std::move(at_end.positions));
  }
}

Vec3 SurfaceMotion::carry(const Vec3& p, const MeshCollider& end) const {
  if (is_still_) return p;
  const SurfacePlace nearest = start_.find_nearest(p);
  const std::array<Vec3, 3> from = start_.corners(nearest.triangle), to = end.corners(nearest.triangle);
  Vec3 place = Vec3::Zero();
  for (std::size_t i = 0; i < 3; ++i) place += nearest.point.barycentric[i] * to[i];
  const Vec3 offset = p - nearest.point.point;
  const auto frame_from = frame_of(from), frame_to = frame_of(to);
  if (!frame_from || !frame_to) return place + offset;
  return place + *frame_to * (frame_from->transpose() * offset);
}

std::vector<Vec3> inset_positions(const MeshCollider& mesh, double inset) {
  std::vector<Vec3> positions(mesh.positions().begin(), mesh.positions().end());
  for (std::size_t v = 0; v < positions.size(); ++v) positions[v] -= inset * mesh.vertex_normal(static_cast<Index>(v));
  return positions;
}

}  // namespace selvage
