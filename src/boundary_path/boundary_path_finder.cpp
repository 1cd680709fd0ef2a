#include "boundary_path/injectivity/deformed_mesh.h"
#include "boundary_path/injectivity/vertex_proof.h"
#include "boundary_path/location/containment.h"
#include "boundary_path/location/group_order.h"
#include "boundary_path/packets/path_kernel.h"
#include "boundary_path/search/boundary_corner.h"
#include "bvh/traverse.h"
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

/// Multiplies by a power of two: by two factors, since the power itself may overflow.
class Scaling {
 public:
  Scaling() = default;
  explicit Scaling(int exponent)
      : half_(std::ldexp(1.0, exponent / 2)), rest_(std::ldexp(1.0, exponent - exponent / 2)) {}

  template <typename T>
  T operator()(const T& x) const {
    return x * half_ * rest_;
  }

 private:
  double half_ = 1, rest_ = 1;
};

/// The mesh itself: one that was made by default has nothing to be searched.
/// @throws Error  when it has no element
template <int D>
const SimplexMesh<D>& with_elements(const SimplexMesh<D>& mesh) {
  if (mesh.element_count() == 0) throw Error("mesh", "there is no element", "give at least one");
  return mesh;
}

}  // namespace

template <int D>
struct BoundaryPathFinder<D>::State {
  const SimplexMesh<D>& mesh;
  PathOptions options;
  PathTopology<D> topology;
  DeformedMesh<D> pose;
  ContainmentSearch<D> containment;
  Scaling to_internal, from_internal;

  State(const SimplexMesh<D>& m, std::span<const Vec<D>> positions, PathOptions o)
      : mesh(with_elements(m)), options(o), topology(m), pose(m, topology), containment(m, pose, pose.elements()) {
    rebuild(positions);
  }

  void update_elements(std::span<const Vec<D>> positions) {
    if (pose.update_elements(positions)) containment.rebuild();
    take_scale();
  }

  void rebuild(std::span<const Vec<D>> positions) {
    pose.rebuild(positions);
    containment.rebuild();
    take_scale();
  }

  void take_scale() {
    to_internal = Scaling(-pose.exponent());
    from_internal = Scaling(pose.exponent());
  }

  PathInput<D> input() const { return pose.path_input(options); }

  class Batches;

  void check_faces() const {
    if (!pose.has_faces())
      throw Error("boundary faces", "their hierarchy is of another pose",
                  "call update_faces() after update_elements()");
  }
  void check(std::span<const PathQuery<D>> queries, std::span<const Index> warm_start, std::size_t counters) const;
  std::vector<Index> order_in_groups(std::span<const PathQuery<D>> queries) const;
  void describe(const PathTask<D>& task, const PathResult<D>& result, BoundaryPath<D>& path) const;
  void set_normal(Index face, const PathResult<D>& result, Vec<D>& unit) const;
  bool is_skipped(Index element) const;
  Box box_around(const std::array<Vec<D>, 2>& corners) const {
    return pose.box_around(to_internal(corners[0]), to_internal(corners[1]));
  }
};

template <int D>
void BoundaryPathFinder<D>::State::check(std::span<const PathQuery<D>> queries, std::span<const Index> warm_start,
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
std::vector<Index> BoundaryPathFinder<D>::State::order_in_groups(std::span<const PathQuery<D>> queries) const {
  if (queries.size() <= kPacketSize) {
    std::vector<Index> order(queries.size());
    std::iota(order.begin(), order.end(), 0);
    return order;
  }
  // What is needed of a query lies behind what is needed before, far apart: fetched for some queries at a time.
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
      const Vec<D> p = to_internal(some[k].point) - pose.frame().origin;
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
void BoundaryPathFinder<D>::State::set_normal(Index face, const PathResult<D>& result, Vec<D>& unit) const {
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
void BoundaryPathFinder<D>::State::describe(const PathTask<D>& task, const PathResult<D>& result,
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
  path.point = from_internal(result.target_count == 1 ? pose.positions()[result.target_vertices[0]]
                                                      : Vec<D>(task.query.point + result.offset));
  path.distance = from_internal(length_of<D>(result.offset));
  set_normal(result.face, result, path.normal);
}

/// Whether DCD leaves the element out: inverted, and on the boundary (SPB section 3.5).
template <int D>
bool BoundaryPathFinder<D>::State::is_skipped(Index element) const {
  if (pose.defects().inverted_elements == 0) return false;
  const auto& across = mesh.neighbours()[element];
  return std::any_of(across.begin(), across.end(), [](Index n) { return n < 0; }) && pose.orientation_of(element) < 0;
}

template <int D>
BoundaryPathFinder<D>::BoundaryPathFinder(const SimplexMesh<D>& mesh, std::span<const Vec<D>> positions,
                                          PathOptions options)
    : state_(std::make_unique<State>(mesh, positions, options)) {}

template <int D>
BoundaryPathFinder<D>::~BoundaryPathFinder() = default;
template <int D>
BoundaryPathFinder<D>::BoundaryPathFinder(BoundaryPathFinder&&) noexcept = default;
template <int D>
BoundaryPathFinder<D>& BoundaryPathFinder<D>::operator=(BoundaryPathFinder&&) noexcept = default;

template <int D>
void BoundaryPathFinder<D>::update(std::span<const Vec<D>> positions) {
  state_->update_elements(positions);
  state_->pose.update_faces();
}

template <int D>
void BoundaryPathFinder<D>::update_elements(std::span<const Vec<D>> positions) {
  state_->update_elements(positions);
}

template <int D>
void BoundaryPathFinder<D>::update_faces() {
  state_->pose.update_faces();
}

template <int D>
void BoundaryPathFinder<D>::rebuild(std::span<const Vec<D>> positions) {
  state_->rebuild(positions);
}

template <int D>
const MeshDefects& BoundaryPathFinder<D>::defects() const {
  return state_->pose.defects();
}

/// What is asked, in the order of the searches, and where the answers go.
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
class BoundaryPathFinder<D>::State::Batches final : public PathBatches<D> {
 public:
  Batches(const State& state, PathWork<D>& work) : state_(state), work_(work) {}

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
      for (double& x : tasks_[i].query.point) x = state_.to_internal(x);
      tasks_[i].warm_start = work_.warm_start.empty() ? kNone : work_.warm_start[share_[i]];
    }
    return {tasks_, results_.data(), counters_.empty() ? nullptr : counters_.data()};
  }

 private:
  void hand_in() {
    for (std::size_t i = 0; i < share_.size(); ++i) {
      state_.describe(tasks_[i], results_[i], work_.paths[share_[i]]);
      if (!counters_.empty()) work_.counters[share_[i]] = counters_[i];
    }
    share_ = {};
  }

  const State& state_;
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
  state_->check_faces();
  state_->check(queries, warm_start, counters.size());
  const std::vector<Index> order = state_->order_in_groups(queries);
  std::vector<BoundaryPath<D>> paths(queries.size());
  const PathInput<D> input = state_->input();
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
    typename State::Batches batches(*state_, work);
    SELVAGE_DISPATCH(search_paths, input, batches);
  });
  return paths;
}

template <int D>
std::vector<PathQuery<D>> BoundaryPathFinder<D>::find_penetrating_vertices() const {
  std::vector<PathQuery<D>> queries;
  for (const auto& [vertex, element] : state_->containment.find_boundary_vertices())
    if (!state_->is_skipped(element))
      queries.push_back({state_->from_internal(state_->pose.positions()[vertex]), element, {vertex, kNone}});
  return queries;
}

template <int D>
typename BoundaryPathFinder<D>::Located BoundaryPathFinder<D>::locate(std::span<const Vec<D>> points) const {
  std::vector<Vec<D>> scaled(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite())
      throw Error(fmt::format("point {}", i), "a coordinate is not finite", "remove NaN and infinity");
    scaled[i] = state_->to_internal(points[i]);
  }
  Located located;
  located.first.assign(points.size() + 1, 0);
  for (const auto& [point, element] : state_->containment.find_points(scaled)) {
    located.queries.push_back({points[point], element, {kNone, kNone}});
    ++located.first[point + 1];
  }
  std::partial_sum(located.first.begin(), located.first.end(), located.first.begin());
  return located;
}

template <int D>
std::vector<PathQuery<D>> BoundaryPathFinder<D>::locate_vertices(std::span<const Index> vertices) const {
  for (const Index v : vertices)
    if (v < 0 || v >= state_->mesh.vertex_count())
      throw Error(fmt::format("vertex {}", v), "there is no such vertex",
                  fmt::format("vertices lie in [0, {})", state_->mesh.vertex_count()));
  std::vector<PathQuery<D>> queries;
  for (const auto& [vertex, element] : state_->containment.find_vertices(vertices))
    queries.push_back({state_->from_internal(state_->pose.positions()[vertex]), element, {vertex, kNone}});
  return queries;
}

namespace {

/// Primitives of a hierarchy whose boxes meet each of some boxes.
template <typename BoxOf>
auto find_near(const Bvh& bvh, std::int64_t count, BoxOf&& box_of, auto nearby) {
  constexpr std::int64_t kAtOnce = 64;
  std::vector<std::vector<Index>> pieces((count + kAtOnce - 1) / kAtOnce);
  nearby.first.assign(count + 1, 0);
  parallel_for(std::ssize(pieces), 1, [&](std::int64_t k) {
    for (std::int64_t i = k * kAtOnce; i < std::min((k + 1) * kAtOnce, count); ++i) {
      const std::size_t before = pieces[k].size();
      visit_overlaps(bvh.nodes(), box_of(i), [&](Index primitive) { pieces[k].push_back(primitive); });
      nearby.first[i + 1] = static_cast<std::int64_t>(pieces[k].size() - before);
    }
  });
  std::partial_sum(nearby.first.begin(), nearby.first.end(), nearby.first.begin());
  nearby.found.reserve(nearby.first.back());
  for (const auto& piece : pieces) nearby.found.insert(nearby.found.end(), piece.begin(), piece.end());
  return nearby;
}

}  // namespace

template <int D>
typename BoundaryPathFinder<D>::Nearby BoundaryPathFinder<D>::find_elements_near(
    std::span<const std::array<Vec<D>, 2>> boxes) const {
  return find_near(
      state_->pose.elements(), std::ssize(boxes), [&](std::int64_t i) { return state_->box_around(boxes[i]); },
      Nearby());
}

template <int D>
typename BoundaryPathFinder<D>::Nearby BoundaryPathFinder<D>::find_faces_near(
    std::span<const std::array<Vec<D>, 2>> boxes) const {
  state_->check_faces();
  return find_near(
      state_->pose.faces(), std::ssize(boxes), [&](std::int64_t i) { return state_->box_around(boxes[i]); }, Nearby());
}

template <int D>
std::span<const Index> BoundaryPathFinder<D>::defective_elements() const {
  return state_->pose.defective_elements();
}

template <int D>
std::span<const std::uint8_t> BoundaryPathFinder<D>::locally_injective_vertices() const {
  return state_->pose.settled();
}

template class BoundaryPathFinder<2>;
template class BoundaryPathFinder<3>;

}  // namespace selvage
