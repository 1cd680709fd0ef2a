#include "selvage/boundary_path/boundary_path.h"

#include "boundary_path/injectivity/vertex_proof.h"
#include "boundary_path/location/group_order.h"
#include "boundary_path/location/locator_impl.h"
#include "boundary_path/packets/path_kernel.h"
#include "boundary_path/search/boundary_corner.h"
#include "core/isa.h"
#include "core/parallel.h"
#include "core/simd/simd.h"
#include "selvage/core/error.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>

namespace selvage {

PathCounters& PathCounters::operator+=(const PathCounters& other) {
  volumes_visited += other.volumes_visited;
  faces_visited += other.faces_visited;
  culled += other.culled;
  traversals += other.traversals;
  elements_visited += other.elements_visited;
  exact_decisions += other.exact_decisions;
  return *this;
}

namespace {

/// Without under- or overflow, and the same bits wherever the vector lies in memory (Eigen's stableNorm is not).
template <int D>
double length_of(const Vec<D>& x) {
  double squared = 0;
  for (int i = 0; i < D; ++i) squared += x[i] * x[i];
  if (squared > 1e-250 && squared < 1e250) return std::sqrt(squared);
  if constexpr (D == 2)
    return std::hypot(x[0], x[1]);
  else
    return std::hypot(x[0], x[1], x[2]);
}

}  // namespace

template <int D>
struct BoundaryPathFinder<D>::Impl {
  PathOptions options;
  PointLocator<D> locator;
  LocatorImpl<D>& located;
  const SimplexMesh<D>& mesh = located.mesh;
  const PathTopology<D>& topology = located.topology;
  DeformedMesh<D>& pose = located.pose;

  Impl(LocatorImpl<D>& impl, PointLocator<D> l, PathOptions o) : options(o), locator(std::move(l)), located(impl) {
    pose.update_faces();
  }

  PathInput<D> input() const { return pose.path_input(options); }

  class Batches;

  void check_faces() const {
    if (!pose.has_faces())
      throw Error("boundary faces", "their hierarchy is of another pose",
                  "call update() of the finder after that of its locator");
  }
  void check(std::span<const PathQuery<D>> queries, std::span<const Index> warm_start, std::size_t counters) const;
  std::vector<Index> order_in_groups(std::span<const PathQuery<D>> queries) const;
  void describe(const PathTask<D>& task, const PathResult<D>& result, BoundaryPath<D>& path) const;
  void set_normal(Index face, const PathResult<D>& result, Vec<D>& unit) const;
};

template <int D>
void BoundaryPathFinder<D>::Impl::check(std::span<const PathQuery<D>> queries, std::span<const Index> warm_start,
                                        std::size_t counters) const {
  if (!warm_start.empty() && warm_start.size() != queries.size())
    throw Error("warm_start", fmt::format("{} faces for {} queries", warm_start.size(), queries.size()),
                "give one face per query, or none at all");
  if (counters != 0 && counters != queries.size())
    throw Error("counters", fmt::format("{} counters for {} queries", counters, queries.size()),
                "give one per query, or none at all");
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const auto where = [&] { return fmt::format("query {}", i); };
    if (queries[i].element < 0 || queries[i].element >= mesh.element_count())
      throw Error(where(), fmt::format("there is no element {}", queries[i].element),
                  fmt::format("elements lie in [0, {})", mesh.element_count()));
    if (!queries[i].point.allFinite()) throw Error(where(), "a coordinate is not finite", "remove NaN and infinity");
    for (Index v : queries[i].source)
      if (v < kNone || v >= mesh.vertex_count())
        throw Error(where(), fmt::format("there is no source vertex {}", v),
                    fmt::format("vertices lie in [0, {})", mesh.vertex_count()));
    if (!warm_start.empty() && (warm_start[i] < kNone || warm_start[i] >= mesh.boundary_face_count()))
      throw Error(where(), fmt::format("there is no boundary face {} to start from", warm_start[i]),
                  fmt::format("boundary faces lie in [0, {})", mesh.boundary_face_count()));
  }
}

/// Groups lie close together in space and in the material: where it overlaps itself, queries have near answers only if
/// they are near some boundary face in the mesh, and that one is near the others'.
template <int D>
std::vector<Index> BoundaryPathFinder<D>::Impl::order_in_groups(std::span<const PathQuery<D>> queries) const {
  if (queries.size() <= kPacketSize) {
    std::vector<Index> order(queries.size());
    std::iota(order.begin(), order.end(), 0);
    return order;
  }
  // The data of a query lie far apart, one behind the other: they are fetched for some queries at a time.
  constexpr std::size_t kAtOnce = 64;
  std::vector<PlacePair> places(queries.size());
  for (std::size_t first = 0; first < queries.size(); first += kAtOnce) {
    const auto some = queries.subspan(first, std::min(kAtOnce, queries.size() - first));
    Index near[kAtOnce];
    for (const PathQuery<D>& query : some) prefetch(topology.hints.data() + query.element);
    for (std::size_t k = 0; k < some.size(); ++k) {
      near[k] = topology.hints[some[k].element];
      prefetch(topology.face_stars.data() + std::max(near[k], 0));
    }
    for (std::size_t k = 0; k < some.size(); ++k) {
      if (near[k] == kNone) continue;
      near[k] = topology.face_stars[near[k]].vertices[0];
      prefetch(pose.rounded_positions().data() + near[k]);
    }
    for (std::size_t k = 0; k < some.size(); ++k) {
      PlacePair& place = places[first + k];
      const Vec<D> p = located.to_internal(some[k].point) - pose.box_origin().position;
      for (int i = 0; i < D; ++i) {
        place[0][i] = static_cast<float>(p[i]);
        if (near[k] != kNone) place[1][i] = pose.rounded_positions()[near[k]][i];
      }
    }
  }
  return order_along_curve(places);
}

/// Area-weighted over the faces of the feature at this corner of the material; where they cancel, the face's own.
template <int D>
void BoundaryPathFinder<D>::Impl::set_normal(Index face, const PathResult<D>& result, Vec<D>& unit) const {
  const auto normal_of = [&](Index f) { return face_normal(pose.positions(), topology.face_stars[f].vertices); };
  const auto set = [&](const Vec<D>& normal) {
    const double length = length_of<D>(normal);
    // The sum turns a negative zero into a positive one.
    for (int i = 0; i < D; ++i) unit[i] = length > 0 ? (0.0 + normal[i]) / length : 0.0 + normal[i];
  };
  if (result.has_normal) return set(result.normal);
  if (result.target_count == D) return set(normal_of(face));
  Vec<D> normal = Vec<D>::Zero();
  double total = 0;
  visit_feature<D>(mesh.boundary_faces().data(), mesh.boundary_neighbours().data(), face, result.target_vertices,
                   result.target_count, [&](Index other) {
                     const Vec<D> part = normal_of(other);
                     normal += part;
                     total += part.norm();
                   });
  set(normal.norm() > 1e-12 * total ? normal : normal_of(face));
}

template <int D>
void BoundaryPathFinder<D>::Impl::describe(const PathTask<D>& task, const PathResult<D>& result,
                                           BoundaryPath<D>& path) const {
  path.status = result.status;
  path.barycentric.setZero();
  path.point.setZero();
  path.normal.setZero();
  if (result.status != PathStatus::kFound) return;
  constexpr BoundaryFeature kFeatures[] = {BoundaryFeature::kVertex, BoundaryFeature::kEdge, BoundaryFeature::kFace};
  path.feature = result.target_count == D ? BoundaryFeature::kFace : kFeatures[result.target_count - 1];
  path.face = result.face;
  const auto& ids = topology.face_stars[result.face].vertices;
  for (int i = 0; i < result.target_count; ++i)
    path.barycentric[std::find(ids.begin(), ids.end(), result.target_vertices[i]) - ids.begin()] =
        result.barycentric[i];
  path.point = located.from_internal(result.target_count == 1 ? pose.positions()[result.target_vertices[0]]
                                                              : Vec<D>(task.query.point + result.offset));
  path.distance = located.from_internal(length_of<D>(result.offset));
  set_normal(result.face, result, path.normal);
}

template <int D>
BoundaryPathFinder<D>::BoundaryPathFinder(const SimplexMesh<D>& mesh, std::span<const Vec<D>> positions,
                                          PathOptions options) {
  PointLocator<D> locator(mesh, positions);
  LocatorImpl<D>& located = *locator.impl_;
  impl_ = std::make_unique<Impl>(located, std::move(locator), options);
}

template <int D>
BoundaryPathFinder<D>::BoundaryPathFinder(PointLocator<D>& locator, PathOptions options)
    : impl_(std::make_unique<Impl>(*locator.impl_, PointLocator<D>(locator.impl_), options)) {}

template <int D>
BoundaryPathFinder<D>::~BoundaryPathFinder() = default;
template <int D>
BoundaryPathFinder<D>::BoundaryPathFinder(BoundaryPathFinder&&) noexcept = default;
template <int D>
BoundaryPathFinder<D>& BoundaryPathFinder<D>::operator=(BoundaryPathFinder&&) noexcept = default;

template <int D>
void BoundaryPathFinder<D>::update(std::span<const Vec<D>> positions) {
  impl_->located.update(positions);
  impl_->pose.update_faces();
}

template <int D>
void BoundaryPathFinder<D>::update() {
  impl_->pose.update_faces();
}

template <int D>
void BoundaryPathFinder<D>::rebuild(std::span<const Vec<D>> positions) {
  impl_->located.rebuild(positions);
  impl_->pose.update_faces();
}

template <int D>
const PointLocator<D>& BoundaryPathFinder<D>::locator() const {
  return impl_->locator;
}

/// Queries in the order of the searches, and where the answers go.
template <int D>
struct PathWork {
  std::span<const PathQuery<D>> queries;
  std::span<const Index> warm_start, order;
  std::span<BoundaryPath<D>> paths;
  std::span<PathCounters> counters;  ///< or none
  std::int64_t batch_size;
  std::atomic<std::int64_t> taken = 0;  ///< batches

  std::int64_t batch_count() const { return (std::ssize(order) + batch_size - 1) / batch_size; }
};

/// The batches that one thread takes.
template <int D>
class BoundaryPathFinder<D>::Impl::Batches final : public PathBatches<D> {
 public:
  Batches(const Impl& state, PathWork<D>& work) : impl_(state), work_(work) {}

  PathBatch<D> next() override {
    hand_in();
    const std::int64_t first = work_.batch_size * work_.taken.fetch_add(1, std::memory_order_relaxed);
    if (first >= std::ssize(work_.order)) return {};
    share_ = work_.order.subspan(first, std::min(std::ssize(work_.order) - first, work_.batch_size));
    tasks_.resize(share_.size());
    results_.resize(share_.size());
    counters_.assign(work_.counters.empty() ? 0 : share_.size(), {});
    for (std::size_t i = 0; i < share_.size(); ++i) {
      tasks_[i].query = work_.queries[share_[i]];
      for (double& x : tasks_[i].query.point) x = impl_.located.to_internal(x);
      tasks_[i].warm_start = work_.warm_start.empty() ? kNone : work_.warm_start[share_[i]];
    }
    return {tasks_, results_.data(), counters_.empty() ? nullptr : counters_.data()};
  }

 private:
  void hand_in() {
    for (std::size_t i = 0; i < share_.size(); ++i) {
      impl_.describe(tasks_[i], results_[i], work_.paths[share_[i]]);
      if (!counters_.empty()) work_.counters[share_[i]] = counters_[i];
    }
    share_ = {};
  }

  const Impl& impl_;
  PathWork<D>& work_;
  std::span<const Index> share_;
  std::vector<PathTask<D>> tasks_;
  std::vector<PathResult<D>> results_;
  std::vector<PathCounters> counters_;
};

template <int D>
std::vector<BoundaryPath<D>> BoundaryPathFinder<D>::find_paths(std::span<const PathQuery<D>> queries,
                                                               std::span<const Index> warm_start,
                                                               std::span<PathCounters> counters) const {
  impl_->check_faces();
  impl_->check(queries, warm_start, counters.size());
  const std::vector<Index> order = impl_->order_in_groups(queries);
  std::vector<BoundaryPath<D>> paths(queries.size());
  const PathInput<D> input = impl_->input();
  // Few queries in small batches, so that there is one for each core.
  constexpr std::int64_t kMaxGroups = 8, kBatches = 16;
  const std::int64_t groups = (std::ssize(order) + kPacketSize - 1) / kPacketSize;
  PathWork<D> work{.queries = queries,
                   .warm_start = warm_start,
                   .order = order,
                   .paths = paths,
                   .counters = counters,
                   .batch_size = kPacketSize * std::clamp<std::int64_t>(groups / kBatches, 1, kMaxGroups)};
  // Each thread takes batches until there is none left, and its memory from the first one on.
  const std::int64_t threads = std::min<std::int64_t>(work.batch_count(), tbb::this_task_arena::max_concurrency());
  parallel_for(threads, 1, [&](std::int64_t) {
    typename Impl::Batches batches(*impl_, work);
    SELVAGE_DISPATCH(search_paths, input, batches);
  });
  return paths;
}

template <int D>
BoundaryPath<D> BoundaryPathFinder<D>::find_path(const PathQuery<D>& query, Index warm_start) const {
  return find_paths(std::span(&query, 1), std::span(&warm_start, 1)).front();
}

template <int D>
NearbyItems BoundaryPathFinder<D>::find_faces_near(std::span<const std::array<Vec<D>, 2>> boxes) const {
  impl_->check_faces();
  return find_near(impl_->pose.faces(), std::ssize(boxes),
                   [&](std::int64_t i) { return impl_->located.box_around(boxes[i]); });
}

template class BoundaryPathFinder<2>;
template class BoundaryPathFinder<3>;

}  // namespace selvage
