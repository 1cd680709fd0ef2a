#include "core/isa.h"
#include "core/merge_sorted.h"
#include "core/parallel.h"
#include "mesh/position_extent.h"
#include "self_collision/continuous/continuous_search.h"
#include "self_collision/continuous/finder_input.h"
#include "self_collision/continuous/near_features.h"
#include "self_collision/proximity/closest_kernel.h"
#include "self_collision/surface/pair_filter.h"
#include "self_collision/surface/search_progress.h"
#include "self_collision/surface/swept_surface.h"
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
/// Squares in the range from this to its inverse neither over- nor underflow, as closest_point_on_segment() has it.
constexpr double kSmallestSquare = 0x1p-200;
/// Of the distance: the most that vertices may stray before pairs are found again. More lasts for more steps, but lists
/// more pairs, of which each step measures all.
constexpr double kMarginPart = 0.2;
/// A search for what is near costs several times as much as to measure a list.
constexpr ListPays kListPays = {.min_searches = 2, .max_strayed_rate = 16, .first_wait = 1};

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
  /// Of the margin: how much farther vertices that stray may come.
  static constexpr double kRoom = 32;

  const TriangleMesh& mesh;
  double distance;
  std::optional<PairFilter> filter;
  SelfCollisionOptions options;  ///< whose progress is reported
  UnsetVector<MovingTriangle> triangles;
  double searched = 0;  ///< the distance of searches
  double reach = 0;     ///< the largest coordinate for which it serves
  SweptSurface pose;    ///< which does not move; or lists are made of a motion that leads here
  Bvh bvh;
  NearFeatures near;                ///< from the second pose on
  std::vector<Vec3> last, earlier;  ///< poses before this one

  Impl(const TriangleMesh& m, std::span<const Vec3> x, double d, const PairFilters& filters,
       std::function<void(double)> progress)
      : mesh(m),
        distance(d),
        filter(PairFilter::where_needed(m, filters)),
        triangles(assign_representatives(m)),
        near(m, kListPays) {
    if (!(distance > 0 && std::isfinite(distance)))
      throw Error("distance", fmt::format("{} is no positive length", distance), "give a positive number");
    if (progress) options.on_progress = [report = std::move(progress)](double share) { report(share / 2); };
    rebuild(x);
  }

  /// Distances of the search are off by rounding: pairs a little farther apart are searched too, then dropped. Enough
  /// for surfaces up to twice as far from the origin.
  void take_extent(std::span<const Vec3> x) {
    const PositionExtent<3> extent = check_positions<3>(x, mesh.vertex_count());
    const double largest =
        x.empty() ? 0 : std::max(extent.lower.cwiseAbs().maxCoeff(), extent.upper.cwiseAbs().maxCoeff());
    if (largest <= reach && searched > 0) return;
    reach = 2 * largest;
    searched = distance * (1 + 0x1p-20) + largest * 0x1p-44;
    near.clear();
  }

  void rebuild(std::span<const Vec3> x) {
    take_extent(x);
    near.clear();
    last.assign(x.begin(), x.end());
    place(x, x);
    build();
  }

  void place(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1, double margin = 0) {
    PositionExtent<3> both = extent_of<3>(positions_t0);
    both.add(extent_of<3>(positions_t1));
    both.lower.array() -= kRoom * margin;
    both.upper.array() += kRoom * margin;
    pose.place(mesh, positions_t0, positions_t1, {}, box_units_around(both), margin, searched);
  }

  void build() { bvh = Bvh(pose.boxes(), BuildQuality::kBest); }

  void refit() {
    bvh.refit(pose.boxes());
    if (bvh.quality_loss() > Bvh::kRebuildAbove) build();
  }

  void update(std::span<const Vec3> x) {
    take_extent(x);
    std::swap(earlier, last);
    last.assign(pose.positions_t1().begin(), pose.positions_t1().end());
    if (update_near(x) || list_near(x)) return;
    place(x, x);
    refit();
  }

  /// Lists what comes near while all moves on as from the last pose to this one. False: that is of no use.
  bool list_near(std::span<const Vec3> x) {
    near.end();
    if (earlier.empty() || !near.is_due()) return false;
    const double margin = std::min(near.margin_at(x), kMarginPart * distance);
    const int steps = near.choose_steps(margin, last, x, earlier, last);
    if (steps == 0) return false;
    std::vector<Vec3> moved_on;
    move_on(last, x, steps, moved_on);
    if (std::ranges::any_of(moved_on, [](const Vec3& p) { return !p.allFinite(); })) return false;
    place(last, moved_on, margin);
    refit();
    near.set_motion(margin, steps, pose);
    set_near_pairs(nullptr);
    pose.move(x, x, near.vertices());
    return true;
  }

  /// Finds again what comes near vertices that have strayed. False: that is not known, or they are too many.
  bool update_near(std::span<const Vec3> x) {
    if (!near.is_set() || !near.find_strayed(last, x) || near.is_worn()) return false;
    if (!near.strayed().empty()) {
      if (!near.take_strayed(last, x)) return false;
      bvh.refit(near.motion().boxes());
      if (bvh.quality_loss() > Bvh::kRebuildAbove) return false;
      set_near_pairs(&near.taken());
    }
    near.count_use();
    pose.move(x, x, near.vertices());
    return true;
  }

  /// @param strayed  null: all vertices
  void set_near_pairs(MarkedVertices* strayed) {
    ContinuousInput searched_input = input(near.motion());
    if (strayed != nullptr) {
      searched_input.strayed = strayed->vertex_marks().data();
      searched_input.culled.strayed = strayed->node_marks(bvh.nodes()).data();
    }
    near.set_pairs(search_kept(searched_input, {}));
  }

  /// Of a search for what the input has near. Positions in doubles are not asked for.
  ContinuousInput input(const SweptSurface& surface) const {
    ContinuousInput input{};
    input.nodes = bvh.nodes();
    input.triangles = triangles.data();
    input.triangle_edges = mesh.triangle_edges().data();
    input.edges = mesh.edges().data();
    input.rounded = surface.rounded().data();
    input.margin = surface.margin();
    input.distance = surface.distance();
    return input;
  }

  /// What the filter keeps.
  std::vector<ContinuousResult> search_kept(const ContinuousInput& searched_input,
                                            const SelfCollisionOptions& reporting) const {
    std::vector<ContinuousResult> results = search_all(bvh, searched_input, nullptr, reporting);
    if (!filter) return results;
    parallel_for(std::ssize(results), 1, [&](std::int64_t i) {
      std::erase_if(results[i].near_vertex_face,
                    [&](const FeaturePair& pair) { return !filter->keeps_vertex_face(pair.first, pair.second); });
      std::erase_if(results[i].near_edge_edge,
                    [&](const FeaturePair& pair) { return !filter->keeps_edges(pair.first, pair.second); });
    });
    return results;
  }

  /// Pairs that are near up to rounding.
  std::vector<ContinuousResult> search() const {
    ContinuousInput here = input(pose);
    if (!near.is_set()) return search_kept(here, options);
    here.margin = 0;
    return search_near(here, near, nullptr, options);
  }

  NearVertexFace measure_face(const FeaturePair& pair) const {
    const auto& [v, a, b, c] = pair.vertices;
    const auto positions = pose.positions_t1();
    const Vec3& p = positions[v];
    const auto closest = closest_point_on_triangle(p, positions[a], positions[b], positions[c]);
    const bool meet = vertex_meets_face(at_rest({p, positions[a], positions[b], positions[c]}));
    return {pair.first,
            pair.second,
            meet ? 0 : distance_of(closest.squared_distance),
            closest.barycentric,
            {p, closest.point}};
  }

  NearEdges near_edges(const FeaturePair& pair, const std::array<double, 2>& place, double squared_distance) const {
    const auto positions = pose.positions_t1();
    const auto &e = mesh.edges()[pair.first], &f = mesh.edges()[pair.second];
    const std::array<Vec3, 2> a{positions[e[0]], positions[e[1]]}, b{positions[f[0]], positions[f[1]]};
    const bool meet = edge_meets_edge(at_rest({a[0], a[1], b[0], b[1]}));
    const auto point = [](const std::array<Vec3, 2>& segment, double at) {
      return Vec3((1 - at) * segment[0] + at * segment[1]);
    };
    return {pair.first,
            pair.second,
            meet ? 0 : distance_of(squared_distance),
            place,
            {point(a, place[0]), point(b, place[1])}};
  }

  /// Eight at once, but for lengths whose squares over- or underflow.
  void measure_edges(std::span<const FeaturePair> pairs, NearEdges* measured) const {
    const auto positions = pose.positions_t1();
    const auto ends_of = [&](Index edge) {
      const auto& [v, w] = mesh.edges()[edge];
      return std::array<Vec3, 2>{positions[v], positions[w]};
    };
    SegmentPairs batch;
    for (std::size_t first = 0; first < pairs.size(); first += SegmentPairs::kSize) {
      const std::size_t count = std::min<std::size_t>(SegmentPairs::kSize, pairs.size() - first);
      for (std::size_t i = 0; i < SegmentPairs::kSize; ++i) {
        const FeaturePair& pair = pairs[first + std::min(i, count - 1)];
        const auto a = ends_of(pair.first), b = ends_of(pair.second);
        for (int end = 0; end < 2; ++end)
          for (int k = 0; k < 3; ++k) {
            batch.a[end][k][i] = a[end][k];
            batch.b[end][k][i] = b[end][k];
          }
      }
      SELVAGE_DISPATCH(find_closest_places, batch);
      for (std::size_t i = 0; i < count; ++i) {
        const FeaturePair& pair = pairs[first + i];
        if (batch.least[i] >= kSmallestSquare && batch.most[i] <= 1 / kSmallestSquare) {
          measured[first + i] = near_edges(pair, {batch.place[0][i], batch.place[1][i]}, batch.squared_distance[i]);
        } else {
          const ClosestSegmentPoints closest = closest_points(ends_of(pair.first), ends_of(pair.second));
          measured[first + i] = near_edges(pair, closest.place, closest.difference.squaredNorm());
        }
      }
    }
  }

  /// Measures pairs in parallel, in order, and drops those that are not nearer than the distance.
  template <typename Near, typename Measure>
  std::vector<Near> measure_all(std::span<const std::vector<FeaturePair>> lists, SearchProgress& progress,
                                Measure&& measure) const {
    const std::vector<FeaturePair> pairs = merge_sorted(lists, &FeaturePair::first, &FeaturePair::second);
    std::vector<Near> near_pairs(pairs.size());
    parallel_ranges(std::ssize(pairs), kPairGrain, [&](std::int64_t first, std::int64_t end) {
      measure(std::span(pairs).subspan(first, end - first), near_pairs.data() + first);
      progress.add(end - first);
    });
    std::erase_if(near_pairs, [&](const Near& pair) { return !(pair.distance < distance); });
    return near_pairs;
  }

  NearPairs find_pairs(ContinuousCounters* counters) const {
    std::vector<std::vector<FeaturePair>> vertex_face, edge_edge;
    std::int64_t count = 0;
    for (ContinuousResult& result : search()) {
      count += std::ssize(result.near_vertex_face) + std::ssize(result.near_edge_edge);
      vertex_face.push_back(std::move(result.near_vertex_face));
      edge_edge.push_back(std::move(result.near_edge_edge));
      if (counters != nullptr) *counters += result.counters;
    }
    if (counters != nullptr) counters->exact_tests += count;
    // The search was the first half of the work.
    SelfCollisionOptions second_half;
    if (options.on_progress) second_half.on_progress = [this](double share) { options.on_progress(1 + share); };
    SearchProgress progress(second_half, count + 1);
    NearPairs pairs{
        measure_all<NearVertexFace>(vertex_face, progress,
                                    [&](std::span<const FeaturePair> some, NearVertexFace* measured) {
                                      for (const FeaturePair& pair : some) *measured++ = measure_face(pair);
                                    }),
        measure_all<NearEdges>(edge_edge, progress, [&](std::span<const FeaturePair> some, NearEdges* measured) {
          measure_edges(some, measured);
        })};
    progress.add(1);
    return pairs;
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
  return impl_->find_pairs(counters);
}

}  // namespace selvage
