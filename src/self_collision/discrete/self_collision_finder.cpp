#include "core/merge_sorted.h"
#include "core/parallel.h"
#include "self_collision/culling/self_culling.h"
#include "self_collision/discrete/discrete_kernel.h"
#include "self_collision/surface/deformed_surface.h"
#include "self_collision/surface/neighbour_pairs.h"
#include "self_collision/surface/pair_filter.h"
#include "self_collision/surface/search_progress.h"
#include "selvage/core/error.h"
#include "selvage/self_collision/self_collision.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace selvage {

namespace {

constexpr std::array<std::string_view, 7> kMethodNames{
    "bvh", "normal-cone", "dual-cone", "dual-cone-internal", "enhanced-dual-cone", "enhanced-dual-cone-published",
    "auto"};
void check_triangle(const TriangleMesh& mesh, Index t) {
  if (t < 0 || t >= mesh.triangle_count())
    throw Error(fmt::format("triangle {}", t), "there is no such triangle",
                fmt::format("triangles lie in [0, {})", mesh.triangle_count()));
}

/// Searches all pieces of the work in parallel, and brings their results together.
///
/// @param search  `search(span of pieces, DiscreteResult&)`
template <typename Work, typename Search>
std::vector<TrianglePair> search_all(const SelfCollisionOptions& options, const DiscreteInput& input, const Work& work,
                                     const SelfCollisionCounters& cutting, std::atomic<bool>* stop,
                                     SelfCollisionCounters* counters, Search&& search) {
  std::vector<DiscreteResult> results(work.pieces.size() + 1);
  results.back().counters = cutting;
  for (DiscreteResult& result : results) result.stop = stop;
  SELVAGE_DISPATCH(test_listed_pairs, input, work.found, results.back());
  SearchProgress progress(options, std::ssize(results));
  parallel_ranges(std::ssize(work.pieces), 1, [&](std::int64_t first, std::int64_t last) {
    search(std::span(work.pieces).subspan(first, last - first), results[first]);
    progress.add(last - first);
  });
  std::vector<std::vector<TrianglePair>> lists;
  for (DiscreteResult& result : results) {
    lists.push_back(std::move(result.pairs));
    if (counters != nullptr) *counters += result.counters;
  }
  auto pairs =
      merge_sorted(std::span<const std::vector<TrianglePair>>(lists), &TrianglePair::first, &TrianglePair::second);
  progress.add(1);
  return pairs;
}

std::vector<TrianglePair> search_two(const SelfCollisionOptions& options, const DiscreteInput& input,
                                     const PairWork& work, SelfCollisionCounters* counters) {
  return search_all(options, input, work, {.node_pairs = work.compared}, nullptr, counters,
                    [&](std::span<const NodePair> some, DiscreteResult& result) {
                      SELVAGE_DISPATCH(find_collisions, input, some, result);
                    });
}

}  // namespace

std::span<const std::string_view> culling_method_names() {
  return kMethodNames;
}

CullingMethod culling_method(std::string_view name) {
  const auto found = std::find(kMethodNames.begin(), kMethodNames.end(), name);
  if (found == kMethodNames.end())
    throw Error("method", fmt::format("there is no method '{}'", name),
                fmt::format("choose one of {}", fmt::join(kMethodNames, ", ")));
  return static_cast<CullingMethod>(found - kMethodNames.begin());
}

SelfCollisionCounters& SelfCollisionCounters::operator+=(const SelfCollisionCounters& other) {
  node_pairs += other.node_pairs;
  self_node_pairs += other.self_node_pairs;
  box_pairs += other.box_pairs;
  adjacent_pairs += other.adjacent_pairs;
  tested_nodes += other.tested_nodes;
  culled_nodes += other.culled_nodes;
  culled_triangles += other.culled_triangles;
  exact_tests += other.exact_tests;
  return *this;
}

struct SelfCollisionFinder::Impl {
  const TriangleMesh& mesh;
  SelfCollisionOptions options;
  std::optional<PairFilter> filter;
  BoxUnits units;
  DeformedSurface pose;
  Bvh bvh;
  std::vector<LeafVertices> leaves;
  std::vector<NeighbourPair> neighbours;
  SurfacePieces pieces;
  PlanarEmbeddingTest<1> embedding_test;
  CulledPairs culled;

  Impl(const TriangleMesh& m, std::span<const Vec3> positions, SelfCollisionOptions o)
      : mesh(m), options(std::move(o)), filter(PairFilter::where_needed(m, options.filters)) {
    check_thickness(mesh, options.thickness);
    rebuild(positions);
  }

  void place(std::span<const Vec3> positions) {
    units = box_units_around(check_positions<3>(positions, mesh.vertex_count()));
    pose.place(mesh, positions, options.thickness, units);
  }

  void build() {
    bvh = Bvh(pose.boxes(mesh), options.asked_once ? BuildQuality::kFast : BuildQuality::kBest);
    leaves = list_leaf_vertices(bvh, mesh.triangles());
    // One search finds neighbours in less time than it takes to list them, and on all threads.
    neighbours = options.asked_once ? std::vector<NeighbourPair>() : list_neighbours(bvh, leaves);
    if (is_culling()) pieces = SurfacePieces(mesh, bvh);
  }

  /// Culling says that triangles do not meet, not how near they are.
  bool is_culling() const { return options.method != CullingMethod::kBvh && options.thickness.empty(); }

  void cull() {
    if (is_culling()) culled = cull_self_pairs<1>(options, bvh, pieces, {pose.positions()}, embedding_test);
  }

  void update(std::span<const Vec3> positions) {
    place(positions);
    pose.refit(mesh, leaves, bvh);
    if (bvh.quality_loss() > Bvh::kRebuildAbove) build();
    cull();
  }

  void rebuild(std::span<const Vec3> positions) {
    place(positions);
    build();
    cull();
  }

  static SurfaceView view(const TriangleMesh& mesh, const DeformedSurface& pose, const Bvh& bvh,
                          const std::vector<LeafVertices>& leaves, const std::vector<double>& thickness) {
    return {bvh.nodes(),
            leaves.data(),
            nullptr,
            mesh.triangles().data(),
            pose.positions().data(),
            pose.rounded().data(),
            thickness.empty() ? nullptr : pose.thickness().data(),
            thickness.empty() ? nullptr : thickness.data()};
  }

  DiscreteInput self_input() const {
    const SurfaceView surface = view(mesh, pose, bvh, leaves, options.thickness);
    return {surface, surface, true, options.include_adjacent, nullptr, filter ? &*filter : nullptr};
  }

  std::vector<TrianglePair> search_self_pairs(std::atomic<bool>* stop, SelfCollisionCounters* counters) const {
    DiscreteInput input = self_input();
    input.culled = culled.nodes();
    if (counters != nullptr) culled.counters.add_to(*counters);
    input.neighbours = neighbours;
    const SelfWork work = split_self_work(bvh, neighbours, input.culled, piece_count(bvh));
    return search_all(options, input, work, work.counters, stop, counters,
                      [&](std::span<const SelfPiece> some, DiscreteResult& result) {
                        SELVAGE_DISPATCH(find_self_collisions, input, some, result);
                      });
  }
};

SelfCollisionFinder::SelfCollisionFinder(const TriangleMesh& mesh, std::span<const Vec3> positions,
                                         SelfCollisionOptions options)
    : impl_(std::make_unique<Impl>(mesh, positions, std::move(options))) {}
SelfCollisionFinder::~SelfCollisionFinder() = default;
SelfCollisionFinder::SelfCollisionFinder(SelfCollisionFinder&&) noexcept = default;
SelfCollisionFinder& SelfCollisionFinder::operator=(SelfCollisionFinder&&) noexcept = default;

void SelfCollisionFinder::update(std::span<const Vec3> positions) {
  impl_->update(positions);
}

void SelfCollisionFinder::rebuild(std::span<const Vec3> positions) {
  impl_->rebuild(positions);
}

std::vector<TrianglePair> SelfCollisionFinder::find_pairs(SelfCollisionCounters* counters) const {
  return impl_->search_self_pairs(nullptr, counters);
}

bool SelfCollisionFinder::has_pairs(SelfCollisionCounters* counters) const {
  std::atomic<bool> stop = false;
  impl_->search_self_pairs(&stop, counters);
  return stop;
}

std::vector<TrianglePair> SelfCollisionFinder::find_pairs_of(std::span<const Index> triangles,
                                                             SelfCollisionCounters* counters) const {
  const Impl& s = *impl_;
  std::vector<std::uint8_t> in_subset(s.mesh.triangle_count(), 0);
  std::vector<Box> boxes;
  for (const Index t : triangles) {
    check_triangle(s.mesh, t);
    if (std::exchange(in_subset[t], 1) != 0)
      throw Error(fmt::format("triangle {}", t), "is given twice", "give each triangle once");
    boxes.push_back(s.pose.box(s.mesh, t));
  }
  const Bvh part(boxes);
  const std::vector<LeafVertices> leaves = list_leaf_vertices(part, s.mesh.triangles(), triangles);
  DiscreteInput input = s.self_input();
  input.a.nodes = part.nodes();
  input.a.leaves = leaves.data();
  input.a.triangle_of = triangles.data();
  input.in_subset = in_subset.data();
  return search_two(s.options, input, split_pair_work(part, s.bvh, piece_count(s.bvh)), counters);
}

std::vector<TrianglePair> SelfCollisionFinder::find_pairs_with(const SelfCollisionFinder& other,
                                                               SelfCollisionCounters* counters) const {
  // Boxes can be compared in box units only.
  PositionExtent<3> both = extent_of<3>(impl_->pose.positions());
  both.add(extent_of<3>(other.impl_->pose.positions()));
  const BoxUnits units = box_units_around(both);
  struct Side {
    DeformedSurface pose;
    Bvh bvh;
  };
  const auto bring = [&](const Impl& s) {
    Side side{{}, s.bvh};
    side.pose.place(s.mesh, s.pose.positions(), s.options.thickness, units);
    side.pose.refit(s.mesh, s.leaves, side.bvh);
    return side;
  };
  const Side a = bring(*impl_), b = bring(*other.impl_);
  const auto view = [](const Impl& s, const Side& side) {
    return Impl::view(s.mesh, side.pose, side.bvh, s.leaves, s.options.thickness);
  };
  const DiscreteInput input{view(*impl_, a), view(*other.impl_, b), false, false, nullptr, nullptr};
  return search_two(impl_->options, input, split_pair_work(a.bvh, b.bvh, piece_count(b.bvh)), counters);
}

std::vector<CommonSegment> SelfCollisionFinder::find_segments(std::span<const TrianglePair> pairs) const {
  return find_segments_with(*this, pairs);
}

std::vector<CommonSegment> SelfCollisionFinder::find_segments_with(const SelfCollisionFinder& other,
                                                                   std::span<const TrianglePair> pairs) const {
  const auto corners = [](const Impl& s, Index t) {
    const auto& [a, b, c] = s.mesh.triangles()[t];
    const std::span<const Vec3> x = s.pose.positions();
    return std::array<Vec3, 3>{x[a], x[b], x[c]};
  };
  for (const TrianglePair& pair : pairs) {
    check_triangle(impl_->mesh, pair.first);
    check_triangle(other.impl_->mesh, pair.second);
  }
  std::vector<CommonSegment> segments(pairs.size());
  SearchProgress progress(impl_->options, std::ssize(pairs));
  parallel_ranges(std::ssize(pairs), 256, [&](std::int64_t first, std::int64_t last) {
    for (std::int64_t i = first; i < last; ++i)
      segments[i] = intersection_segment(corners(*impl_, pairs[i].first), corners(*other.impl_, pairs[i].second));
    progress.add(last - first);
  });
  return segments;
}

}  // namespace selvage
