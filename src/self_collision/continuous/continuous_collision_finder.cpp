#include "core/merge_sorted.h"
#include "self_collision/continuous/continuous_kernel.h"
#include "self_collision/continuous/star_separation.h"
#include "self_collision/culling/self_culling.h"
#include "self_collision/surface/moving_points.h"
#include "self_collision/surface/neighbour_pairs.h"
#include "self_collision/surface/pair_filter.h"
#include "self_collision/surface/search_progress.h"
#include "self_collision/surface/swept_surface.h"
#include "selvage/core/error.h"
#include "selvage/geometry/moving_distance.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <limits>

namespace selvage {

namespace {

/// Makes the first triangle of every vertex and every edge its representative.
UnsetVector<MovingTriangle> assign_representatives(const TriangleMesh& mesh) {
  UnsetVector<MovingTriangle> triangles(mesh.triangle_count());
  parallel_for(mesh.triangle_count(), kGrain, [&](std::int64_t t) {
    MovingTriangle& triangle = triangles[t];
    triangle = {mesh.triangles()[t], 0};
    for (int i = 0; i < 3; ++i) {
      triangle.represented |= (mesh.vertex_triangles(triangle.vertices[i]).front() == t) << i;
      const HalfFace across = mesh.neighbours()[t][i];
      const bool is_first =
          across.exists() ? t < across.element() : mesh.edge_triangles(mesh.triangle_edges()[t][i]).front() == t;
      triangle.represented |= is_first << (3 + i);
    }
  });
  return triangles;
}

void check_index(const char* what, Index i, Index count) {
  if (i < 0 || i >= count)
    throw Error(fmt::format("{} {}", what, i), "is out of range", fmt::format("give one in [0, {})", count));
}

void check_pairs(const TriangleMesh& mesh, std::span<const VertexFacePair> pairs) {
  for (const VertexFacePair& pair : pairs) {
    check_index("vertex", pair.vertex, mesh.vertex_count());
    check_index("face", pair.face, mesh.triangle_count());
  }
}

void check_pairs(const TriangleMesh& mesh, std::span<const EdgeEdgePair> pairs) {
  for (const EdgeEdgePair& pair : pairs) {
    check_index("edge", pair.first, mesh.edge_count());
    check_index("edge", pair.second, mesh.edge_count());
  }
}

std::optional<double> impact_of(const ContinuousInput& input, const VertexFacePair& pair, double before = 1) {
  return vertex_face_impact(moving_points(input, pair.vertex, pair.face), before);
}

std::optional<double> impact_of(const ContinuousInput& input, const EdgeEdgePair& pair, double before = 1) {
  return edge_edge_impact(moving_edges(input, pair.first, pair.second), before);
}

/// The first time at which the pair meets or is nearer than its thickness.
std::optional<double> nearness_of(const ContinuousInput& input, const VertexFacePair& pair, double before) {
  const double thickness = thickness_of(input, pair.vertex, pair.face);
  const MovingPoints points = moving_points(input, pair.vertex, pair.face);
  const auto near = thickness > 0 ? vertex_face_nearness(points, thickness, before) : std::nullopt;
  // A thickness that rounding hides does not hide an impact.
  const auto impact = vertex_face_impact(points, near.value_or(before));
  return impact ? impact : near;
}

std::optional<double> nearness_of(const ContinuousInput& input, const EdgeEdgePair& pair, double before) {
  const double thickness = thickness_of_edges(input, pair.first, pair.second);
  const MovingPoints points = moving_edges(input, pair.first, pair.second);
  const auto near = thickness > 0 ? edge_edge_nearness(points, thickness, before) : std::nullopt;
  const auto impact = edge_edge_impact(points, near.value_or(before));
  return impact ? impact : near;
}

/// Calls `ask(i)` for each of `count` pairs, in parallel.
template <typename Ask>
void ask_pairs(std::int64_t count, SearchProgress& progress, Ask&& ask) {
  constexpr std::int64_t kAtOnce = 64;
  parallel_ranges(count, kAtOnce, [&](std::int64_t first, std::int64_t last) {
    for (std::int64_t i = first; i < last; ++i) ask(i);
    progress.add(last - first);
  });
}

template <typename Pair>
std::vector<double> impact_times(const ContinuousInput& input, std::span<const Pair> pairs, SearchProgress& progress) {
  std::vector<double> times(pairs.size());
  ask_pairs(std::ssize(pairs), progress, [&](std::int64_t i) {
    times[i] = impact_of(input, pairs[i]).value_or(std::numeric_limits<double>::quiet_NaN());
  });
  return times;
}

/// Lowers `earliest` to the first time of any of the pairs; each is searched only up to the earliest so far.
///
/// @param time_of  `std::optional<double> time_of(const Pair&, double before)`
template <typename Pair, typename TimeOf>
void find_earliest(const std::vector<Pair>& pairs, SearchProgress& progress, std::atomic<double>& earliest,
                   TimeOf&& time_of) {
  ask_pairs(std::ssize(pairs), progress, [&](std::int64_t i) {
    double known = earliest.load(std::memory_order_relaxed);
    const auto time = time_of(pairs[i], known);
    while (time && *time < known && !earliest.compare_exchange_weak(known, *time)) {
    }
  });
}

}  // namespace

ContinuousCounters& ContinuousCounters::operator+=(const ContinuousCounters& other) {
  node_pairs += other.node_pairs;
  self_node_pairs += other.self_node_pairs;
  box_pairs += other.box_pairs;
  vertex_face_boxes += other.vertex_face_boxes;
  edge_edge_boxes += other.edge_edge_boxes;
  tested_nodes += other.tested_nodes;
  culled_nodes += other.culled_nodes;
  culled_triangles += other.culled_triangles;
  exact_tests += other.exact_tests;
  return *this;
}

struct ContinuousCollisionFinder::Impl {
  /// Stars pay where at most one in so many is measured in a step.
  static constexpr std::int64_t kMaxMeasuredShare = 4;
  /// Where they do not pay, ever fewer steps try again, at last every 2^kMaxFailures-th.
  static constexpr int kMaxFailures = 6;

  const TriangleMesh& mesh;
  SelfCollisionOptions options;
  std::optional<PairFilter> filter;
  UnsetVector<MovingTriangle> triangles;
  SweptSurface pose;
  Bvh bvh;
  SurfacePieces pieces;
  PlanarEmbeddingTest<2> embedding_test;
  CulledPairs culled;
  std::optional<StarSeparation> stars;  ///< from the second step on: they do not pay for one
  bool is_watching = false;             ///< stars know about this step
  bool trusts_stars = false;            ///< most stars keep their shape
  int failures = 0, steps_without_stars = 0;
  std::vector<LeafVertices> leaves;  ///< where stars have been trusted once
  std::vector<NeighbourPair> neighbours;

  Impl(const TriangleMesh& m, std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1,
       SelfCollisionOptions o)
      : mesh(m),
        options(std::move(o)),
        filter(PairFilter::where_needed(m, options.filters)),
        triangles(assign_representatives(m)) {
    check_thickness(mesh, options.thickness);
    rebuild(positions_t0, positions_t1);
  }

  void place(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1) {
    PositionExtent<3> both = check_positions<3>(positions_t0, mesh.vertex_count(), "positions_t0");
    both.add(check_positions<3>(positions_t1, mesh.vertex_count(), "positions_t1"));
    pose.place(mesh, positions_t0, positions_t1, options.thickness, box_units_around(both));
  }

  void build() {
    bvh = Bvh(pose.boxes(), options.asked_once ? BuildQuality::kFast : BuildQuality::kBest);
    if (options.asked_once) pose.free_boxes();  // room for what follows, in memory that is there
    if (is_culling()) pieces = SurfacePieces(mesh, bvh);
    if (!neighbours.empty()) list_neighbours_of_leaves();
  }

  void list_neighbours_of_leaves() {
    leaves = list_leaf_vertices(bvh, mesh.triangles());
    neighbours = list_neighbours(bvh, leaves);
  }

  /// Culling says that features do not meet, not how near they are.
  bool is_culling() const { return options.method != CullingMethod::kBvh && options.thickness.empty(); }

  void cull() {
    if (!is_culling()) return;
    culled = cull_self_pairs<2>(options, bvh, pieces, {pose.positions_t0(), pose.positions_t1()}, embedding_test,
                                pose.rounded(), trusts_stars);
  }

  void update(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1) {
    place(positions_t0, positions_t1);
    bvh.refit(pose.boxes());
    if (bvh.quality_loss() > Bvh::kRebuildAbove) build();
    cull();
    watch_stars();
  }

  /// Like culling, separated stars need no comparison. They pay where the surface keeps its shape for some steps, and
  /// where culling has not left out most of it.
  void watch_stars() {
    is_watching = false;
    if (options.method != CullingMethod::kAuto || !is_culling()) return;
    if (2 * culled.counters.culled_triangles > mesh.triangle_count()) return;
    if (steps_without_stars > 0) {
      --steps_without_stars;
      return;
    }
    if (!stars) stars.emplace(mesh);
    const bool was_trusting = trusts_stars;
    trusts_stars = trusts_stars || stars->are_nearly_rigid(pose.positions_t0(), pose.positions_t1());
    if (trusts_stars) {
      if (neighbours.empty()) list_neighbours_of_leaves();
      stars->place(pose.positions_t0(), pose.positions_t1());
      is_watching = true;
      if (!was_trusting) return;
      if (kMaxMeasuredShare * stars->measured_count() <= stars->count()) {
        failures = 0;
        return;
      }
    }
    trusts_stars = false;
    failures = std::min(failures + 1, kMaxFailures);
    steps_without_stars = (1 << failures) - 1;
  }

  void rebuild(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1) {
    is_watching = false;
    place(positions_t0, positions_t1);
    build();
    cull();
  }

  ContinuousInput input() const {
    return {bvh.nodes(),
            triangles.data(),
            mesh.triangle_edges().data(),
            mesh.edges().data(),
            pose.positions_t0().data(),
            pose.positions_t1().data(),
            pose.rounded().data(),
            options.thickness.empty() ? nullptr : pose.thickness().data(),
            options.thickness.empty() ? nullptr : options.thickness.data(),
            filter ? &*filter : nullptr,
            culled.nodes(),
            leaves.data(),
            neighbours};
  }

  ContinuousPairs search(std::atomic<bool>* stop, ContinuousCounters* counters) const {
    if (counters != nullptr) culled.counters.add_to(*counters);
    return is_watching ? search_beside_stars(stop, counters) : search_all(stop, counters);
  }

  ContinuousPairs search_all(std::atomic<bool>* stop, ContinuousCounters* counters) const {
    const ContinuousInput searched = input();
    const PairWork work = split_self_pair_work(
        bvh, piece_count(bvh), [&](NodePair pair) { return !searched.culled.holds(bvh.nodes().data(), pair); });
    std::vector<ContinuousResult> results(work.pieces.size() + 1);
    results.back().counters.node_pairs = work.compared;
    results.back().counters.self_node_pairs = work.compared_selves;
    for (ContinuousResult& result : results) result.stop = stop;
    SELVAGE_DISPATCH(test_listed_pairs, searched, work.found, results.back());
    SearchProgress progress(options, std::ssize(results));
    parallel_for(std::ssize(work.pieces), 1, [&](std::int64_t i) {
      SELVAGE_DISPATCH(find_continuous_collisions, searched, work.pieces[i], results[i]);
      progress.add(1);
    });
    return bring_together(results, counters, progress);
  }

  /// Triangles without a common vertex by the hierarchy, others where their stars are open.
  ContinuousPairs search_beside_stars(std::atomic<bool>* stop, ContinuousCounters* counters) const {
    constexpr std::int64_t kStarsAtOnce = 64;
    const ContinuousInput searched = input();
    SelfWork work = split_self_work(bvh, neighbours, searched.culled, piece_count(bvh));
    std::erase_if(work.found, [&](const IndexPair& pair) { return do_share_vertex(pair); });
    const std::span<const Index> open = stars->open();
    const std::int64_t cut = std::ssize(work.pieces);
    const std::int64_t run_count = (std::ssize(open) + kStarsAtOnce - 1) / kStarsAtOnce;
    std::vector<ContinuousResult> results(cut + run_count + 1);
    results.back().counters.node_pairs = work.counters.node_pairs;
    results.back().counters.self_node_pairs = work.counters.self_node_pairs;
    for (ContinuousResult& result : results) result.stop = stop;
    SELVAGE_DISPATCH(test_listed_pairs, searched, work.found, results.back());
    SearchProgress progress(options, std::ssize(results));
    parallel_ranges(cut + run_count, 1, [&](std::int64_t first, std::int64_t last) {
      const std::int64_t pieces_end = std::clamp(cut, first, last);
      if (first < pieces_end)
        SELVAGE_DISPATCH(find_nonadjacent_collisions, searched,
                         std::span(work.pieces).subspan(first, pieces_end - first), results[first]);
      std::vector<IndexPair> pairs;
      for (std::int64_t run = pieces_end; run < last; ++run)
        for (std::int64_t i = kStarsAtOnce * (run - cut);
             i < std::min(kStarsAtOnce * (run - cut + 1), std::ssize(open)); ++i)
          stars->append_pairs(open[i], pairs);
      if (!pairs.empty()) SELVAGE_DISPATCH(test_listed_pairs, searched, pairs, results[last - 1]);
      progress.add(last - first);
    });
    return bring_together(results, counters, progress);
  }

  /// The earliest time of all pairs; 1 where none has any.
  template <typename TimeOf>
  double find_earliest_of(const ContinuousPairs& pairs, TimeOf&& time_of) const {
    check_pairs(mesh, pairs.vertex_face);
    check_pairs(mesh, pairs.edge_edge);
    SearchProgress progress(options, std::ssize(pairs.vertex_face) + std::ssize(pairs.edge_edge));
    std::atomic<double> earliest = 1;
    find_earliest(pairs.vertex_face, progress, earliest, time_of);
    find_earliest(pairs.edge_edge, progress, earliest, time_of);
    return earliest;
  }

  bool do_share_vertex(const IndexPair& pair) const {
    const auto& a = mesh.triangles()[pair.first];
    const auto& b = mesh.triangles()[pair.second];
    return std::find_first_of(a.begin(), a.end(), b.begin(), b.end()) != a.end();
  }

  static ContinuousPairs bring_together(std::span<ContinuousResult> results, ContinuousCounters* counters,
                                        SearchProgress& progress) {
    std::vector<std::vector<VertexFacePair>> vertex_face;
    std::vector<std::vector<EdgeEdgePair>> edge_edge;
    for (ContinuousResult& result : results) {
      vertex_face.push_back(std::move(result.pairs.vertex_face));
      edge_edge.push_back(std::move(result.pairs.edge_edge));
      if (counters != nullptr) *counters += result.counters;
    }
    ContinuousPairs pairs{merge_sorted(std::span<const std::vector<VertexFacePair>>(vertex_face),
                                       &VertexFacePair::vertex, &VertexFacePair::face),
                          merge_sorted(std::span<const std::vector<EdgeEdgePair>>(edge_edge), &EdgeEdgePair::first,
                                       &EdgeEdgePair::second)};
    progress.add(1);
    return pairs;
  }
};

ContinuousCollisionFinder::ContinuousCollisionFinder(const TriangleMesh& mesh, std::span<const Vec3> positions_t0,
                                                     std::span<const Vec3> positions_t1, SelfCollisionOptions options)
    : impl_(std::make_unique<Impl>(mesh, positions_t0, positions_t1, std::move(options))) {}
ContinuousCollisionFinder::~ContinuousCollisionFinder() = default;
ContinuousCollisionFinder::ContinuousCollisionFinder(ContinuousCollisionFinder&&) noexcept = default;
ContinuousCollisionFinder& ContinuousCollisionFinder::operator=(ContinuousCollisionFinder&&) noexcept = default;

void ContinuousCollisionFinder::update(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1) {
  impl_->update(positions_t0, positions_t1);
}

void ContinuousCollisionFinder::rebuild(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1) {
  impl_->rebuild(positions_t0, positions_t1);
}

ContinuousPairs ContinuousCollisionFinder::find_pairs(ContinuousCounters* counters) const {
  return impl_->search(nullptr, counters);
}

bool ContinuousCollisionFinder::has_pairs(ContinuousCounters* counters) const {
  std::atomic<bool> stop = false;
  impl_->search(&stop, counters);
  return stop;
}

std::vector<double> ContinuousCollisionFinder::find_impact_times(std::span<const VertexFacePair> pairs) const {
  check_pairs(impl_->mesh, pairs);
  SearchProgress progress(impl_->options, std::ssize(pairs));
  return impact_times(impl_->input(), pairs, progress);
}

std::vector<double> ContinuousCollisionFinder::find_impact_times(std::span<const EdgeEdgePair> pairs) const {
  check_pairs(impl_->mesh, pairs);
  SearchProgress progress(impl_->options, std::ssize(pairs));
  return impact_times(impl_->input(), pairs, progress);
}

double ContinuousCollisionFinder::find_free_step(const ContinuousPairs& pairs) const {
  const ContinuousInput input = impl_->input();
  return impl_->find_earliest_of(pairs,
                                 [&](const auto& pair, double before) { return impact_of(input, pair, before); });
}

double ContinuousCollisionFinder::find_separated_step(const ContinuousPairs& pairs) const {
  const ContinuousInput input = impl_->input();
  return impl_->find_earliest_of(pairs,
                                 [&](const auto& pair, double before) { return nearness_of(input, pair, before); });
}

}  // namespace selvage
