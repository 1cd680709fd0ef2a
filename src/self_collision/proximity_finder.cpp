#include "core/parallel.h"
#include "mesh/position_extent.h"
#include "self_collision/surface/search_progress.h"
#include "selvage/core/error.h"
#include "selvage/geometry/closest_point.h"
#include "selvage/geometry/continuous.h"
#include "selvage/geometry/distance.h"
#include "selvage/self_collision/proximity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace selvage {

namespace {

/// Pairs of one task.
constexpr std::int64_t kPairGrain = 256;

/// Four points that do not move.
MovingPoints at_rest(const std::array<Vec3, 4>& points) {
  return {points, points};
}

/// The square root, and never 0 where the sets do not meet: a square may have vanished.
double distance_of(double squared) {
  return squared > 0 ? std::sqrt(squared) : std::numeric_limits<double>::denorm_min();
}

}  // namespace

struct ProximityFinder::Impl {
  const TriangleMesh& mesh;
  double distance;
  PairFilters filters;
  std::function<void(double)> on_progress;
  std::vector<Vec3> positions;
  double searched = 0;  ///< the distance that `finder` searches
  /// A step in which nothing moves, with half of the distance as the thickness of each vertex.
  std::optional<ContinuousCollisionFinder> finder;

  Impl(const TriangleMesh& m, std::span<const Vec3> x, double d, PairFilters f, std::function<void(double)> progress)
      : mesh(m), distance(d), filters(std::move(f)), on_progress(std::move(progress)) {
    if (!(distance > 0 && std::isfinite(distance)))
      throw Error("distance", fmt::format("{} is no positive length", distance), "give a positive number");
    rebuild(x);
  }

  /// Distances of the search are off by rounding: pairs a little farther apart are searched too, then dropped.
  double wanted_distance(std::span<const Vec3> x) const {
    const PositionExtent<3> extent = check_positions<3>(x, mesh.vertex_count());
    const double largest =
        x.empty() ? 0 : std::max(extent.lower.cwiseAbs().maxCoeff(), extent.upper.cwiseAbs().maxCoeff());
    return distance * (1 + 0x1p-20) + largest * 0x1p-45;
  }

  void rebuild(std::span<const Vec3> x) {
    searched = wanted_distance(x);
    SelfCollisionOptions options;
    options.filters = filters;
    options.thickness.assign(mesh.vertex_count(), searched / 2);
    if (on_progress) options.on_progress = [this](double share) { on_progress(share / 2); };
    finder.emplace(mesh, x, x, std::move(options));
    positions.assign(x.begin(), x.end());
  }

  void update(std::span<const Vec3> x) {
    if (wanted_distance(x) > searched) return rebuild(x);
    finder->update(x, x);
    positions.assign(x.begin(), x.end());
  }

  NearVertexFace measure(const VertexFacePair& pair) const {
    const auto& [a, b, c] = mesh.triangles()[pair.face];
    const Vec3& p = positions[pair.vertex];
    const auto closest = closest_point_on_triangle(p, positions[a], positions[b], positions[c]);
    const bool meet = vertex_meets_face(at_rest({p, positions[a], positions[b], positions[c]}));
    return {pair.vertex,
            pair.face,
            meet ? 0 : distance_of(closest.squared_distance),
            closest.barycentric,
            {p, closest.point}};
  }

  NearEdges measure(const EdgeEdgePair& pair) const {
    const auto &e = mesh.edges()[pair.first], &f = mesh.edges()[pair.second];
    const std::array<Vec3, 2> a{positions[e[0]], positions[e[1]]}, b{positions[f[0]], positions[f[1]]};
    const ClosestSegmentPoints closest = closest_points(a, b);
    const bool meet = edge_meets_edge(at_rest({a[0], a[1], b[0], b[1]}));
    const auto point = [](const std::array<Vec3, 2>& segment, double place) {
      return Vec3((1 - place) * segment[0] + place * segment[1]);
    };
    return {pair.first,
            pair.second,
            meet ? 0 : distance_of(closest.difference.squaredNorm()),
            closest.place,
            {point(a, closest.place[0]), point(b, closest.place[1])}};
  }

  /// Measures pairs in parallel, and drops those that are not nearer than the distance.
  template <typename Near, typename Pair>
  std::vector<Near> measure_all(const std::vector<Pair>& pairs, SearchProgress& progress) const {
    std::vector<Near> near(pairs.size());
    parallel_ranges(std::ssize(pairs), kPairGrain, [&](std::int64_t first, std::int64_t last) {
      for (std::int64_t i = first; i < last; ++i) near[i] = measure(pairs[i]);
      progress.add(last - first);
    });
    std::erase_if(near, [&](const Near& pair) { return !(pair.distance < distance); });
    return near;
  }
};

ProximityFinder::ProximityFinder(const TriangleMesh& mesh, std::span<const Vec3> positions, double distance,
                                 PairFilters filters, std::function<void(double share)> on_progress)
    : impl_(std::make_unique<Impl>(mesh, positions, distance, std::move(filters), std::move(on_progress))) {}
ProximityFinder::~ProximityFinder() = default;
ProximityFinder::ProximityFinder(ProximityFinder&&) noexcept = default;
ProximityFinder& ProximityFinder::operator=(ProximityFinder&&) noexcept = default;

void ProximityFinder::update(std::span<const Vec3> positions) {
  impl_->update(positions);
}

void ProximityFinder::rebuild(std::span<const Vec3> positions) {
  impl_->rebuild(positions);
}

NearPairs ProximityFinder::find_pairs(ContinuousCounters* counters) const {
  const ContinuousPairs pairs = impl_->finder->find_pairs(counters);
  // The search was the first half of the work.
  SelfCollisionOptions second_half;
  if (impl_->on_progress) second_half.on_progress = [this](double share) { impl_->on_progress((1 + share) / 2); };
  SearchProgress progress(second_half, std::ssize(pairs.vertex_face) + std::ssize(pairs.edge_edge) + 1);
  NearPairs near{impl_->measure_all<NearVertexFace>(pairs.vertex_face, progress),
                 impl_->measure_all<NearEdges>(pairs.edge_edge, progress)};
  progress.add(1);
  return near;
}

}  // namespace selvage
