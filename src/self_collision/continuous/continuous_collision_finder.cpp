#include "core/same_bits.h"
#include "self_collision/continuous/bring_together.h"
#include "self_collision/continuous/continuous_search.h"
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
  /// And where culling leaves at least one triangle in so many.
  static constexpr std::int64_t kMinLeftShare = 8;
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
  std::vector<Vec3> still;               ///< where all was in the last step, if nothing moved in it
  std::optional<ContinuousPairs> known;  ///< of that step, from the second like it on
  MarkedVertices moved;                  ///< by move_ends()
  std::vector<Vec3> moved_on;            ///< where vertices would come to within a motion
  std::vector<LeafVertices> leaves;      ///< where stars have been trusted once
  std::vector<NeighbourPair> neighbours;

  Impl(const TriangleMesh& m, std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1,
       SelfCollisionOptions o)
      : mesh(m),
        options(std::move(o)),
        filter(PairFilter::where_needed(m, options.filters)),
        triangles(assign_representatives(m)),
        near(m),
        moved(m) {
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

  /// What stands still from step to step, as bodies that sleep, is searched once.
  void update(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1) {
    const bool is_still = options.reuse && !options.asked_once && are_same_bits(positions_t0, positions_t1);
    if (is_still && are_same_bits(positions_t0, still)) {
      if (!known) known = search(nullptr, nullptr);
      return;
    }
    forget_still();
    take_step(positions_t0, positions_t1);
    if (is_still) still.assign(positions_t0.begin(), positions_t0.end());
  }

  void forget_still() {
    still.clear();
    known.reset();
  }

  void take_step(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1) {
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
  /// out at once; and where all but rests, so that a list lasts. Where lists are not used, ever fewer steps try again.
  bool begin_list(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1) {
    near.end();
    if (options.method != CullingMethod::kAuto || !is_culling() || options.asked_once || !options.reuse) return false;
    if (!trusts_stars && !near.nearly_rests(near.margin_at(positions_t0), positions_t0, positions_t1)) return false;
    return near.is_due();
  }

  /// Lists what comes near while all moves on as in this step. False: that is of no use.
  bool list_near(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1) {
    if (!are_of_all(positions_t0, positions_t1) || !begin_list(positions_t0, positions_t1)) return false;
    const double margin = near.margin_at(positions_t0);
    const int steps = near.choose_steps(margin, positions_t0, positions_t1, pose.positions_t0(), pose.positions_t1());
    if (steps == 0) return false;
    move_on(positions_t0, positions_t1, steps, moved_on);
    if (std::ranges::any_of(moved_on, [](const Vec3& x) { return !x.allFinite(); })) return false;
    place(positions_t0, moved_on, margin);
    refit();
    culled = {};
    is_watching = false;
    const bool are_new = !stars;
    if (are_new) stars.emplace(mesh);
    if (neighbours.empty()) list_neighbours_of_leaves();
    stars->place(positions_t0, moved_on, margin);
    if (!are_new && kMaxMeasuredShare * stars->measured_count() > stars->count()) {
      near.shorten();
      if (!trusts_stars) near.count_failure();
      return false;
    }
    near.set_motion(margin, steps, pose);
    near.set_pairs(search_beside_stars(bvh, near_input(nullptr), *stars, nullptr, nullptr, {}));
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
      near.set_pairs(search_beside_stars(bvh, near_input(&near.taken()), *stars, &near.taken(), nullptr, {}));
    }
    near.count_use();
    pose.move(positions_t0, positions_t1, near.vertices());
    return true;
  }

  /// @param strayed  null: all vertices
  ContinuousInput near_input(MarkedVertices* strayed) {
    ContinuousInput searched = input();
    searched.positions_t0 = near.motion().positions_t0().data();
    searched.positions_t1 = near.motion().positions_t1().data();
    searched.rounded = near.motion().rounded().data();
    searched.margin = near.motion().margin();
    if (strayed == nullptr) return searched;
    searched.strayed = strayed->vertex_marks().data();
    searched.culled.strayed = strayed->node_marks(bvh.nodes()).data();
    return searched;
  }

  ContinuousPairs move_ends(std::span<const Index> vertices, std::span<const Vec3> positions_t1,
                            ContinuousCounters* counters) {
    for (const Index v : vertices) check_index("vertex", v, mesh.vertex_count());
    check_positions<3>(positions_t1, mesh.vertex_count(), "positions_t1");
    forget_still();
    moved.clear();
    for (const Index v : vertices) moved.mark(v);
    const bool are_moved = take_ends(positions_t1);
    if (!are_moved) {
      const std::vector<Vec3> positions_t0(pose.positions_t0().begin(), pose.positions_t0().end());
      take_step(positions_t0, positions_t1);
    }
    return search_moved(are_moved, counters);
  }

  /// Of the moved vertices. False: nothing has been taken that an update does not take again.
  bool take_ends(std::span<const Vec3> positions_t1) {
    if (near.is_set() || options.asked_once) return false;
    std::vector<std::array<Vec3, 2>> ends;
    for (const Index v : moved.vertices()) ends.push_back({pose.positions_t0()[v], positions_t1[v]});
    if (!pose.replace(mesh, moved.vertices(), ends, moved.triangles())) return false;
    refit();
    culled = {};
    is_watching = false;
    return true;
  }

  /// Pairs with a moved vertex.
  /// @param is_known  else all are found, after an update
  ContinuousPairs search_moved(bool is_known, ContinuousCounters* counters) {
    ContinuousInput searched = input();
    if (is_known) searched.culled.strayed = moved.node_marks(bvh.nodes()).data();
    std::vector<ContinuousResult> found;
    if (is_known) found = search_all(bvh, searched, nullptr, options);
    ContinuousPairs pairs = is_known ? bring_together(found, counters) : search(nullptr, counters);
    std::erase_if(pairs.vertex_face, [&](const VertexFacePair& p) {
      return !moved.has(p.vertex) && !moved.has_any(mesh.triangles()[p.face]);
    });
    std::erase_if(pairs.edge_edge, [&](const EdgeEdgePair& p) {
      return !moved.has_any(mesh.edges()[p.first]) && !moved.has_any(mesh.edges()[p.second]);
    });
    return pairs;
  }

  /// Like culling, separated stars need no comparison. They pay where the surface keeps its shape for some steps, and
  /// where culling has not left out nearly all of it.
  void watch_stars() {
    is_watching = false;
    if (options.method != CullingMethod::kAuto || !is_culling()) return;
    if (kMinLeftShare * (mesh.triangle_count() - culled.counters.culled_triangles) < mesh.triangle_count()) return;
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
    forget_still();
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
    std::vector<ContinuousResult> results;
    if (near.is_set())
      results = search_near(input(), near, stop, options);
    else if (is_watching)
      results = search_beside_stars(bvh, input(), *stars, nullptr, stop, options);
    else
      results = search_all(bvh, input(), stop, options);
    return bring_together(results, counters);
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
  if (impl_->known) return *impl_->known;
  return impl_->search(nullptr, counters);
}

ContinuousPairs ContinuousCollisionFinder::move_ends(std::span<const Index> vertices,
                                                     std::span<const Vec3> positions_t1, ContinuousCounters* counters) {
  return impl_->move_ends(vertices, positions_t1, counters);
}

bool ContinuousCollisionFinder::has_pairs(ContinuousCounters* counters) const {
  if (impl_->known) return !impl_->known->vertex_face.empty() || !impl_->known->edge_edge.empty();
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
