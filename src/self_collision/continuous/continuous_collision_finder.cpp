#include "self_collision/continuous/bring_together.h"
#include "self_collision/continuous/continuous_kernel.h"
#include "self_collision/continuous/finder_input.h"
#include "self_collision/continuous/impact_times.h"
#include "self_collision/continuous/near_features.h"
#include "self_collision/continuous/star_separation.h"
#include "self_collision/culling/self_culling.h"
#include "self_collision/surface/neighbour_pairs.h"
#include "self_collision/surface/pair_filter.h"
#include "self_collision/surface/search_progress.h"
#include "self_collision/surface/swept_surface.h"

#include <algorithm>
#include <atomic>

namespace selvage {

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
  /// Of the margin: how much farther vertices that stray may come.
  static constexpr double kRoom = 32;

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
  NearFeatures near;
  std::int64_t near_uses = 0;  ///< since they were listed
  int unused_lists = 0, steps_without_list = 0;
  std::vector<Vec3> moved_on;        ///< where vertices would come to within a motion
  std::vector<LeafVertices> leaves;  ///< where stars have been trusted once
  std::vector<NeighbourPair> neighbours;

  Impl(const TriangleMesh& m, std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1,
       SelfCollisionOptions o)
      : mesh(m),
        options(std::move(o)),
        filter(PairFilter::where_needed(m, options.filters)),
        triangles(assign_representatives(m)),
        near(m) {
    check_thickness(mesh, options.thickness);
    rebuild(positions_t0, positions_t1);
  }

  void place(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1, double margin = 0) {
    PositionExtent<3> both = check_positions<3>(positions_t0, mesh.vertex_count(), "positions_t0");
    both.add(check_positions<3>(positions_t1, mesh.vertex_count(), "positions_t1"));
    both.lower.array() -= kRoom * margin;
    both.upper.array() += kRoom * margin;
    pose.place(mesh, positions_t0, positions_t1, options.thickness, box_units_around(both), margin);
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
    if (update_near(positions_t0, positions_t1) || list_near(positions_t0, positions_t1)) return;
    place(positions_t0, positions_t1);
    refit();
    cull();
    watch_stars();
  }

  void refit() {
    bvh.refit(pose.boxes());
    if (bvh.quality_loss() > Bvh::kRebuildAbove) build();
  }

  /// Whether to list what comes near, for later steps. It pays where stars do, for else most of the surface may be left
  /// out at once; and where lists are used. Where they are not, ever fewer steps try again.
  bool begin_list() {
    if (near.is_set()) {
      unused_lists = near.has_paid(near_uses) ? 0 : std::min(unused_lists + 1, kMaxFailures);
      steps_without_list = unused_lists == 0 ? 0 : 16 << unused_lists;
    }
    near.clear();
    if (!trusts_stars || options.asked_once) return false;
    if (steps_without_list == 0) return true;
    --steps_without_list;
    return false;
  }

  /// Lists what comes near while all moves on as in this step. False: that is of no use.
  bool list_near(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1) {
    if (!begin_list() || !are_of_all(positions_t0, positions_t1)) return false;
    const double margin = near.margin_at(positions_t0);
    const int steps = near.choose_steps(margin, positions_t0, positions_t1, pose);
    if (steps == 0) return false;
    move_on(positions_t0, positions_t1, steps, moved_on);
    if (std::ranges::any_of(moved_on, [](const Vec3& x) { return !x.allFinite(); })) return false;
    place(positions_t0, moved_on, margin);
    refit();
    culled = {};
    is_watching = false;
    stars->place(positions_t0, moved_on, margin);
    if (kMaxMeasuredShare * stars->measured_count() > stars->count()) {
      near.shorten();
      return false;
    }
    near.set_motion(margin, steps, pose);
    near.set_pairs(search_beside_stars(near_input({}), nullptr, {}));
    near_uses = 0;
    pose.move(positions_t0, positions_t1, near.vertices());
    return true;
  }

  bool are_of_all(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1) const {
    return std::ssize(positions_t0) == mesh.vertex_count() && std::ssize(positions_t1) == mesh.vertex_count();
  }

  /// Finds again what comes near vertices that have strayed. False: that is not known, or they are too many.
  bool update_near(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1) {
    if (!near.is_set() || !are_of_all(positions_t0, positions_t1)) return false;
    if (!near.find_strayed(positions_t0, positions_t1) || near.is_worn()) return false;
    if (!near.strayed().empty()) {
      if (!near.take_strayed(positions_t0, positions_t1)) return false;
      bvh.refit(near.motion().boxes());
      if (bvh.quality_loss() > Bvh::kRebuildAbove) return false;
      stars->place(near.motion().positions_t0(), near.motion().positions_t1(), near.margin(), near.strayed());
      near.set_pairs(search_beside_stars(near_input(near.strayed_vertices()), nullptr, {}));
    }
    ++near_uses;
    pose.move(positions_t0, positions_t1, near.vertices());
    return true;
  }

  ContinuousInput near_input(std::span<const std::uint8_t> strayed) {
    ContinuousInput searched = input();
    searched.positions_t0 = near.motion().positions_t0().data();
    searched.positions_t1 = near.motion().positions_t1().data();
    searched.rounded = near.motion().rounded().data();
    searched.margin = near.motion().margin();
    if (strayed.empty()) return searched;
    searched.strayed = strayed.data();
    searched.culled.strayed = near.mark_nodes(bvh.nodes()).data();
    return searched;
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
    near.clear();
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
    if (near.is_set()) return search_near(stop, counters);
    if (!is_watching) return search_all(stop, counters);
    std::vector<ContinuousResult> results = search_beside_stars(input(), stop, options);
    return bring_together(results, counters);
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
    ContinuousPairs pairs = bring_together(results, counters);
    progress.add(1);
    return pairs;
  }

  /// Only what came near in a step from which this one hardly differs.
  ContinuousPairs search_near(std::atomic<bool>* stop, ContinuousCounters* counters) const {
    constexpr std::int64_t kAtOnce = 256;
    const ContinuousInput searched = input();
    const std::span<const FeaturePair> pairs[] = {near.vertex_face(), near.edge_edge()};
    const auto run_count = [&](int kind) { return (std::ssize(pairs[kind]) + kAtOnce - 1) / kAtOnce; };
    std::vector<ContinuousResult> results(run_count(0) + run_count(1));
    SearchProgress progress(options, std::ssize(results) + 1);
    parallel_for(std::ssize(results), 1, [&](std::int64_t i) {
      const int kind = i < run_count(0) ? 0 : 1;
      const std::int64_t first = kAtOnce * (i - (kind == 0 ? 0 : run_count(0)));
      const auto some = pairs[kind].subspan(first, std::min(kAtOnce, std::ssize(pairs[kind]) - first));
      results[i].stop = stop;
      if (stop == nullptr || !stop->load(std::memory_order_relaxed))
        SELVAGE_DISPATCH(test_listed_features, searched, kind == 0 ? some : std::span<const FeaturePair>(),
                         kind == 0 ? std::span<const FeaturePair>() : some, results[i]);
      progress.add(1);
    });
    ContinuousPairs found = bring_together(results, counters);
    progress.add(1);
    return found;
  }

  /// Triangles without a common vertex by the hierarchy, others where their stars are open.
  /// @param reporting  whose progress is reported
  std::vector<ContinuousResult> search_beside_stars(const ContinuousInput& searched, std::atomic<bool>* stop,
                                                    const SelfCollisionOptions& reporting) const {
    constexpr std::int64_t kStarsAtOnce = 64;
    SelfWork work = split_self_work(bvh, neighbours, searched.culled, piece_count(bvh));
    const auto has_strayed = [&](const IndexPair& pair) {
      const auto strayed = near.strayed_triangles();
      return searched.strayed == nullptr || (strayed[pair.first] | strayed[pair.second]) != 0;
    };
    std::erase_if(work.found, [&](const IndexPair& pair) { return !has_strayed(pair) || do_share_vertex(pair); });
    const std::span<const Index> open = stars->open();
    const std::int64_t cut = std::ssize(work.pieces);
    const std::int64_t run_count = (std::ssize(open) + kStarsAtOnce - 1) / kStarsAtOnce;
    std::vector<ContinuousResult> results(cut + run_count + 1);
    results.back().counters.node_pairs = work.counters.node_pairs;
    results.back().counters.self_node_pairs = work.counters.self_node_pairs;
    for (ContinuousResult& result : results) result.stop = stop;
    SELVAGE_DISPATCH(test_listed_pairs, searched, work.found, results.back());
    SearchProgress progress(reporting, std::ssize(results));
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
      std::erase_if(pairs, [&](const IndexPair& pair) { return !has_strayed(pair); });
      if (!pairs.empty()) SELVAGE_DISPATCH(test_listed_pairs, searched, pairs, results[last - 1]);
      progress.add(last - first);
    });
    progress.add(1);
    return results;
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
