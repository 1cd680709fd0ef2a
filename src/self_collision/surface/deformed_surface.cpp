#include "self_collision/surface/deformed_surface.h"

#include "core/parallel.h"
#include "core/simd/simd.h"
#include "selvage/core/error.h"

#include <fmt/format.h>

#include <limits>

namespace selvage {

namespace {

using Row = std::array<float, 4>;

/// At least the next float, so that nothing which was rounded down lies above; at most three away.
Float4 above(Float4 x) {
  const Float4 magnitude = max(x, Float4::broadcast(0) - x);
  return x + (magnitude * Float4::broadcast(0x1p-23f) + Float4::broadcast(0x1p-126f));
}

/// Boxes of four children of a node that are triangles, and empty boxes of the others.
void fill_four(const Row* rows, const LeafVertices& leaves, int first, BvhNode& node) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  Float4 lower[4], upper[4];
  for (int i = 0; i < 4; ++i) {
    const auto row = [&](int corner) { return Float4::load(rows[leaves.corners[corner][first + i]].data()); };
    if (leaves.corners[0][first + i] == kNone) {
      lower[i] = Float4::broadcast(kInfinity);
      upper[i] = Float4::broadcast(-kInfinity);
      continue;
    }
    const Float4 a = row(0), b = row(1), c = row(2);
    lower[i] = min(min(a, b), c);
    upper[i] = above(max(max(a, b), c));
  }
  transpose(lower[0], lower[1], lower[2], lower[3]);
  transpose(upper[0], upper[1], upper[2], upper[3]);
  for (int axis = 0; axis < 3; ++axis) {
    lower[axis].store(node.lower[axis] + first);
    upper[axis].store(node.upper[axis] + first);
  }
}

}  // namespace

BoxUnits box_units_around(const PositionExtent<3>& extent) {
  return extent.lower[0] <= extent.upper[0] ? BoxUnits(extent.lower, extent.upper) : BoxUnits();
}

void check_thickness(const TriangleMesh& mesh, std::span<const double> thickness) {
  if (!thickness.empty() && std::ssize(thickness) != mesh.vertex_count())
    throw Error("thickness", fmt::format("{} entries for {} vertices", thickness.size(), mesh.vertex_count()),
                "give one per vertex, or none at all");
  for (std::size_t v = 0; v < thickness.size(); ++v)
    if (!(thickness[v] >= 0 && std::isfinite(thickness[v])))
      throw Error(fmt::format("vertex {}", v), "its thickness is no length", "give a number that is not negative");
}

void DeformedSurface::place(const TriangleMesh& mesh, std::span<const Vec3> positions,
                            std::span<const double> thickness, const BoxUnits& units) {
  positions_.resize(positions.size());
  rounded_.resize(positions.size());
  parallel_for(std::ssize(positions), kGrain, [&](std::int64_t v) {
    positions_[v] = positions[v];
    const Vec3 x = units.map(positions[v]);
    rounded_[v] = {round_down(x[0]), round_down(x[1]), round_down(x[2]), 0};
  });
  thickness_.resize(thickness.empty() ? 0 : mesh.triangle_count());
  parallel_for(std::ssize(thickness_), kGrain, [&](std::int64_t t) {
    const auto& [a, b, c] = mesh.triangles()[t];
    // A little more, for the rounding of map_length(): pairs that are too far apart are rejected later.
    const double length = units.map_length(std::max({thickness[a], thickness[b], thickness[c]}));
    thickness_[t] = round_up(length * (1 + 0x1p-40));
  });
}

Box DeformedSurface::box(const TriangleMesh& mesh, Index triangle) const {
  const auto& vertices = mesh.triangles()[triangle];
  const auto row = [&](int corner) { return Float4::load(rounded_[vertices[corner]].data()); };
  float lower[4], upper[4];
  min(min(row(0), row(1)), row(2)).store(lower);
  above(max(max(row(0), row(1)), row(2))).store(upper);
  Box box{{lower[0], lower[1], lower[2]}, {upper[0], upper[1], upper[2]}};
  if (thickness_.empty()) return box;
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = round_down(double{box.lower[axis]} - thickness_[triangle]);
    box.upper[axis] = round_up(double{box.upper[axis]} + thickness_[triangle]);
  }
  return box;
}

std::vector<Box> DeformedSurface::boxes(const TriangleMesh& mesh) const {
  std::vector<Box> boxes(mesh.triangle_count());
  parallel_for(mesh.triangle_count(), kGrain, [&](std::int64_t t) { boxes[t] = box(mesh, static_cast<Index>(t)); });
  return boxes;
}

void DeformedSurface::refit(const TriangleMesh& mesh, std::span<const LeafVertices> leaves, Bvh& bvh) const {
  if (!thickness_.empty()) {
    bvh.refit(boxes(mesh));
    return;
  }
  bvh.refit_from([&](BvhNode* nodes, Index first, Index last) {
    for (Index n = first; n < last; ++n)
      for (const int half : {0, 4}) fill_four(rounded_.data(), leaves[n], half, nodes[n]);
  });
}

}  // namespace selvage
