#include "self_collision/surface_pose.h"

#include "selvage/core/error.h"
#include "selvage/core/parallel.h"
#include "selvage/core/simd.h"

#include <fmt/format.h>

namespace selvage {

namespace {

constexpr std::int64_t kGrain = 4096;

}  // namespace

PoseFrame frame_around(const PositionExtent<3>& extent) {
  return extent.lower[0] <= extent.upper[0] ? PoseFrame(extent.lower, extent.upper) : PoseFrame();
}

void check_thickness(const TriangleMesh& mesh, std::span<const double> thickness) {
  if (!thickness.empty() && std::ssize(thickness) != mesh.vertex_count())
    throw Error("thickness", fmt::format("{} entries for {} vertices", thickness.size(), mesh.vertex_count()),
                "give one per vertex, or none at all");
  for (std::size_t v = 0; v < thickness.size(); ++v)
    if (!(thickness[v] >= 0 && std::isfinite(thickness[v])))
      throw Error(fmt::format("vertex {}", v), "its thickness is no length", "give a number that is not negative");
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
