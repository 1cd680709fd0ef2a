#include "selvage/surface_distance/surface_distance.h"

#include "core/parallel.h"
#include "mesh/position_extent.h"
#include "selvage/core/error.h"
#include "surface_distance/distance_kernel.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace selvage {

namespace {

/// Points of one task.
constexpr std::int64_t kPointGrain = 64;

bool is_below_limit(const Vec3& x) {
  return x.allFinite() && x.cwiseAbs().maxCoeff() <= SurfaceDistance::kMaxCoordinate;
}

void check_in_range(std::span<const Vec3> points, const char* what) {
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!is_below_limit(points[i]))
      throw Error(fmt::format("{} {}", what, i), "a coordinate is not finite or too large",
                  "give finite coordinates below 1e150");
}

/// Whether as many triangles run along each edge in one direction as in the other.
bool are_edges_balanced(const TriangleMesh& mesh) {
  std::vector<std::int32_t> balance(mesh.edge_count(), 0);
  for (Index t = 0; t < mesh.triangle_count(); ++t) {
    const auto& triangle = mesh.triangles()[t];
    for (int i = 0; i < 3; ++i)
      balance[mesh.triangle_edges()[t][i]] += triangle[(i + 1) % 3] < triangle[(i + 2) % 3] ? 1 : -1;
  }
  return std::all_of(balance.begin(), balance.end(), [](std::int32_t b) { return b == 0; });
}

}  // namespace

struct SurfaceDistance::Impl {
  const TriangleMesh& mesh;
  bool is_closed;
  std::vector<Vec3> positions;
  Bvh bvh;

  Impl(const TriangleMesh& m, std::span<const Vec3> x) : mesh(m), is_closed(are_edges_balanced(m)) {
    if (mesh.triangle_count() == 0) throw Error("mesh", "there is no triangle", "give a surface of one at least");
    rebuild(x);
  }

  void place(std::span<const Vec3> x) {
    check_positions<3>(x, mesh.vertex_count());
    check_in_range(x, "vertex");
    positions.assign(x.begin(), x.end());
  }

  std::vector<Box> boxes() const {
    std::vector<Box> boxes(mesh.triangle_count());
    parallel_for(mesh.triangle_count(), kGrain, [&](std::int64_t t) {
      const auto& [a, b, c] = mesh.triangles()[t];
      boxes[t] = bounding_box<3>(std::array<Vec3, 3>{positions[a], positions[b], positions[c]});
    });
    return boxes;
  }

  void rebuild(std::span<const Vec3> x) {
    place(x);
    bvh = Bvh(boxes());
  }

  void update(std::span<const Vec3> x) {
    place(x);
    bvh.refit(boxes());
    if (bvh.quality_loss() > Bvh::kRebuildAbove) bvh = Bvh(boxes());
  }

  DistanceInput input() const { return {bvh.nodes(), mesh.triangles().data(), positions.data()}; }

  SurfacePoint describe(const ClosestTriangle& found) const {
    SurfacePoint result{.triangle = found.triangle, .barycentric = found.closest.barycentric};
    result.point = found.closest.point;
    result.distance = std::sqrt(found.closest.squared_distance);
    const unsigned mask = found.closest.vertex_mask;
    const int corner_count = std::popcount(mask);
    if (corner_count == 3) {
      result.feature_index = found.triangle;
    } else if (corner_count == 2) {
      result.feature = SurfaceFeature::kEdge;
      result.feature_index = mesh.triangle_edges()[found.triangle][std::countr_zero(~mask)];
    } else {
      result.feature = SurfaceFeature::kVertex;
      result.feature_index = mesh.triangles()[found.triangle][std::countr_zero(mask)];
    }
    return result;
  }

  void check_closed() const {
    if (!is_closed)
      throw Error("mesh", "the surface is not closed, so that it has no inside",
                  "give a surface without border whose triangles are oriented alike, and merge vertices in one place");
  }
};

SurfaceDistance::SurfaceDistance(const TriangleMesh& mesh, std::span<const Vec3> positions)
    : impl_(std::make_unique<Impl>(mesh, positions)) {}
SurfaceDistance::~SurfaceDistance() = default;
SurfaceDistance::SurfaceDistance(SurfaceDistance&&) noexcept = default;
SurfaceDistance& SurfaceDistance::operator=(SurfaceDistance&&) noexcept = default;

void SurfaceDistance::update(std::span<const Vec3> positions) {
  impl_->update(positions);
}

void SurfaceDistance::rebuild(std::span<const Vec3> positions) {
  impl_->rebuild(positions);
}

bool SurfaceDistance::is_closed() const {
  return impl_->is_closed;
}

std::vector<SurfacePoint> SurfaceDistance::find_closest_points(std::span<const Vec3> points) const {
  check_in_range(points, "point");
  const DistanceInput input = impl_->input();
  std::vector<SurfacePoint> results(points.size());
  parallel_ranges(std::ssize(points), kPointGrain, [&](std::int64_t first, std::int64_t last) {
    std::vector<ClosestTriangle> found(last - first);
    SELVAGE_DISPATCH(find_closest_triangles, input, points.data() + first, last - first, found.data());
    for (std::int64_t i = first; i < last; ++i) results[i] = impl_->describe(found[i - first]);
  });
  return results;
}

std::vector<SurfaceSide> SurfaceDistance::find_sides(std::span<const Vec3> points) const {
  impl_->check_closed();
  check_in_range(points, "point");
  const DistanceInput input = impl_->input();
  std::vector<SurfaceSide> sides(points.size());
  parallel_ranges(std::ssize(points), kPointGrain, [&](std::int64_t first, std::int64_t last) {
    SELVAGE_DISPATCH(find_point_sides, input, points.data() + first, last - first, sides.data() + first);
  });
  return sides;
}

std::vector<SignedDistance> SurfaceDistance::find_signed_distances(std::span<const Vec3> points) const {
  const std::vector<SurfaceSide> sides = find_sides(points);
  const std::vector<SurfacePoint> closest = find_closest_points(points);
  std::vector<SignedDistance> results(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double distance = closest[i].distance;
    const double signed_distance = sides[i].is_on_surface ? 0 : sides[i].winding_number != 0 ? -distance : distance;
    results[i] = {signed_distance, sides[i], closest[i]};
  }
  return results;
}

}  // namespace selvage
