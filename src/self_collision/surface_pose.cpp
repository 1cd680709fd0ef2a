#include "self_collision/surface_pose.h"

#include "selvage/core/error.h"
#include "selvage/core/parallel.h"
#include "selvage/core/simd.h"

#include <fmt/format.h>

namespace selvage {

namespace {

constexpr std::int64_t kGrain = 4096;

/// Corners of the box of positions; NaN does not count.
struct Corners {
  Vec3 lower = Vec3::Constant(HUGE_VAL), upper = Vec3::Constant(-HUGE_VAL);
  bool finite = true;

  void add(const Vec3& x) {
    finite = finite && x.allFinite();
    lower = lower.cwiseMin(x);
    upper = upper.cwiseMax(x);
  }
  void add(const Corners& other) {
    finite = finite && other.finite;
    lower = lower.cwiseMin(other.lower);
    upper = upper.cwiseMax(other.upper);
  }
};

Corners corners_of(std::span<const Vec3> positions) {
  return parallel_reduce<Corners>(std::ssize(positions), kGrain,
                                  [&](std::int64_t first, std::int64_t last, Corners& corners) {
                                    for (std::int64_t v = first; v < last; ++v) corners.add(positions[v]);
                                  });
}

PoseFrame frame_of(const Corners& corners) {
  return corners.lower[0] <= corners.upper[0] ? PoseFrame(corners.lower, corners.upper) : PoseFrame();
}

}  // namespace

PoseFrame frame_around(std::span<const Vec3> positions) {
  const Corners corners = corners_of(positions);
  if (!corners.finite) {
    std::size_t v = 0;
    while (positions[v].allFinite()) ++v;
    throw Error(fmt::format("vertex {}", v), "a coordinate is not finite", "remove NaN and infinity");
  }
  return frame_of(corners);
}

PoseFrame frame_around(std::span<const Vec3> a, std::span<const Vec3> b) {
  Corners corners = corners_of(a);
  corners.add(corners_of(b));
  return frame_of(corners);
}

void check_thickness(const TriangleMesh& mesh, std::span<const double> thickness) {
  if (!thickness.empty() && std::ssize(thickness) != mesh.vertex_count())
    throw Error("thickness", fmt::format("{} entries for {} vertices", thickness.size(), mesh.vertex_count()),
                "give one per vertex, or none at all");
  for (std::size_t v = 0; v < thickness.size(); ++v)
    if (!(thickness[v] >= 0 && std::isfinite(thickness[v])))
      throw Error(fmt::format("vertex {}", v), "its thickness is no length", "give a number that is not negative");
}

void check_position_count(const TriangleMesh& mesh, std::span<const Vec3> positions) {
  if (std::ssize(positions) != mesh.vertex_count())
    throw Error("positions", fmt::format("{} positions for {} vertices", positions.size(), mesh.vertex_count()),
                "give one position per vertex");
}

void SurfacePose::place(const TriangleMesh& mesh, std::span<const Vec3> positions, std::span<const double> thickness,
                        const PoseFrame& frame) {
  positions_.resize(positions.size());
  lower_.resize(positions.size());
  upper_.resize(positions.size());
  parallel_for(std::ssize(positions), kGrain, [&](std::int64_t v) {
    positions_[v] = positions[v];
    const Vec3 x = frame.map(positions[v]);
    lower_[v] = {round_down(x[0]), round_down(x[1]), round_down(x[2]), 0};
    upper_[v] = {round_up(x[0]), round_up(x[1]), round_up(x[2]), 0};
  });
  boxes_.resize(mesh.triangle_count());
  thickness_.resize(thickness.empty() ? 0 : mesh.triangle_count());
  parallel_for(mesh.triangle_count(), kGrain, [&](std::int64_t t) {
    const auto& [a, b, c] = mesh.triangles()[t];
    const auto row = [](const std::array<float, 4>& x) { return Float4::load(x.data()); };
    float lower[4], upper[4];
    min(min(row(lower_[a]), row(lower_[b])), row(lower_[c])).store(lower);
    max(max(row(upper_[a]), row(upper_[b])), row(upper_[c])).store(upper);
    Box box{{lower[0], lower[1], lower[2]}, {upper[0], upper[1], upper[2]}};
    if (!thickness.empty()) {
      // A little more than asked, for the rounding of map_length(); what is too much is told apart later.
      const double length = frame.map_length(std::max({thickness[a], thickness[b], thickness[c]}));
      thickness_[t] = round_up(length * (1 + 0x1p-40));
      for (int axis = 0; axis < 3; ++axis) {
        box.lower[axis] = round_down(double{box.lower[axis]} - thickness_[t]);
        box.upper[axis] = round_up(double{box.upper[axis]} + thickness_[t]);
      }
    }
    boxes_[t] = box;
  });
}

}  // namespace selvage
