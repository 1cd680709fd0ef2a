#include "boundary_path/injectivity/deformed_mesh.h"

#include "boundary_path/injectivity/parity_rays.h"
#include "boundary_path/injectivity/ridge_turns.h"
#include "boundary_path/injectivity/vertex_proof.h"
#include "core/isa.h"
#include "core/parallel.h"
#include "mesh/position_extent.h"
#include "selvage/geometry/predicates.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <memory>
#include <mutex>

namespace selvage {

namespace {

/// Poses for which a hierarchy over the faces is refitted at most. There are few of them, and where a body is crushed a
/// search for a path follows several times as many segments in an old hierarchy, although its quality seems good.
constexpr int kMaxRefits = 32;

/// See DeformedMesh::rounded_positions().
float mark_of(std::int64_t vertex, bool cullable) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(vertex) | static_cast<std::uint32_t>(cullable) << 31);
}

template <typename T>
void add_relaxed(T& sum, T amount) {
  std::atomic_ref(sum).fetch_add(amount, std::memory_order_relaxed);
}

}  // namespace

template <int D>
DeformedMesh<D>::DeformedMesh(const SimplexMesh<D>& mesh, const PathTopology<D>& topology)
    : mesh_(mesh), topology_(topology), vertex_normals_(mesh.vertex_count(), NormalBox::everything()) {}

template <int D>
void DeformedMesh<D>::rebuild_elements(std::span<const Vec<D>> positions) {
  place(positions);
  build_elements();
  examine();
  builds_faces_ = true;
}

template <int D>
bool DeformedMesh<D>::update_elements(std::span<const Vec<D>> positions) {
  place(positions);
  examine();
  const bool is_poor = elements_.quality_loss() > Bvh::kRebuildAbove;
  if (is_poor) build_elements();
  return is_poor;
}

template <int D>
void DeformedMesh<D>::update_faces() {
  if (has_faces_) return;
  if (!builds_faces_) {
    fit_faces();
    if (++face_refits_ <= kMaxRefits && faces_.quality_loss() <= Bvh::kRebuildAbove) return;
  }
  build_faces();
  fit_faces();
}

/// Scales the positions by a power of two and places the box origin.
template <int D>
void DeformedMesh<D>::place(std::span<const Vec<D>> positions) {
  const auto [lower, upper, finite] = check_positions<D>(positions, mesh_.vertex_count());
  const double largest = std::max(lower.cwiseAbs().maxCoeff(), upper.cwiseAbs().maxCoeff());
  exponent_ = largest > 0 ? std::ilogb(largest) : 0;
  // By two factors: 2^-exponent itself may overflow.
  const double half = std::ldexp(1.0, -exponent_ / 2), rest = std::ldexp(1.0, -exponent_ - -exponent_ / 2);
  box_origin_.position = (lower * half * rest + upper * half * rest) / 2;
  positions_.resize(positions.size());
  rounded_.resize(positions.size());
  parallel_for(std::ssize(positions), kGrain, [&](std::int64_t v) {
    positions_[v] = positions[v] * half * rest;
    rounded_[v] = {0, 0, 0, mark_of(v, false)};
    for (int i = 0; i < D; ++i) rounded_[v][i] = static_cast<float>(positions_[v][i] - box_origin_.position[i]);
  });
  rounding_ = static_cast<float>(0x1p-24 * (upper * half * rest - lower * half * rest).maxCoeff()) + 0x1p-149f;
}

template <int D>
std::array<Vec<D>, D + 1> DeformedMesh<D>::corners_of(Index element) const {
  std::array<Vec<D>, D + 1> corners;
  for (int i = 0; i <= D; ++i) corners[i] = positions_[mesh_.elements()[element][i]];
  return corners;
}

template <int D>
template <std::size_t N>
Box DeformedMesh<D>::box_of(const std::array<Index, N>& vertices) const {
  Vec<D> lower = positions_[vertices[0]], upper = lower;
  for (Index v : vertices) {
    lower = lower.cwiseMin(positions_[v]);
    upper = upper.cwiseMax(positions_[v]);
  }
  return box_origin_.around(lower, upper);
}

template <int D>
void DeformedMesh<D>::build_elements() {
  std::vector<Box> boxes(mesh_.element_count());
  parallel_for(std::ssize(boxes), kGrain, [&](std::int64_t e) { boxes[e] = box_of(mesh_.elements()[e]); });
  elements_ = Bvh(boxes);
  list_leaf_nodes<D + 1>(elements_, mesh_.elements(), topology_.is_on_boundary, element_leaves_);
}

template <int D>
void DeformedMesh<D>::build_faces() {
  std::vector<Box> boxes(mesh_.boundary_face_count());
  parallel_for(std::ssize(boxes), kGrain, [&](std::int64_t b) { boxes[b] = box_of(mesh_.boundary_faces()[b]); });
  faces_ = Bvh(boxes);
  face_refits_ = 0;
  builds_faces_ = false;
  list_leaf_nodes<D>(faces_, mesh_.boundary_faces(), topology_.is_on_boundary, face_leaves_);
  node_normals_.resize(faces_.nodes().size());
  cones_.resize(faces_.nodes().size());
}

template <int D>
void DeformedMesh<D>::fit_faces() {
  faces_.refit_from([&](BvhNode* nodes, Index first, Index last) {
    const FaceTask<D> task{.positions = rounded(),
                           .leaves = face_leaves_.data(),
                           .nodes = nodes,
                           .vertex_normals = vertex_normals_.data(),
                           .node_normals = node_normals_.data(),
                           .cones = cones_.data()};
    SELVAGE_DISPATCH(fit_faces, task, first, last);
  });
  has_faces_ = true;
}

template <int D>
void DeformedMesh<D>::examine() {
  defects_ = {};
  component_states_.assign(topology_.component_count, ComponentState::kImmersed);
  inverted_owners_.assign(mesh_.boundary_face_count(), 0);
  examine_elements();
  prove_boundary_vertices();
  prove_local_injectivity();
  defect_places_.clear();
  for (const Index e : defective_) add_defect(mesh_.elements()[e], topology_.component_of[e]);
  find_overwound_interior_ridges();
  find_overwound_boundary_ridges();
  find_folds();
  std::vector<Box> boxes(defect_places_.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) boxes[i] = defect_places_[i].box;
  defect_hierarchy_ = Bvh(boxes);
  for (Index v : mesh_.boundary_vertices()) {
    if (!cullable_[v]) vertex_normals_[v] = NormalBox::everything();
    rounded_[v][3] = mark_of(v, cullable_[v] != 0);
  }
  has_faces_ = false;
}

template <int D>
void DeformedMesh<D>::examine_elements() {
  inner_ray_count_ = 0;
  inner_rays_.resize(elements_.nodes().size());
  ray_marks_.assign(2 * mesh_.vertex_count(), 0);
  ray_counts_.assign(mesh_.vertex_count(), 0);
  defective_.clear();
  std::mutex listing;
  elements_.refit_from([&](BvhNode* nodes, Index first, Index last) {
    const auto doubtful = std::make_unique_for_overwrite<Index[]>(BvhNode::kWidth * (last - first));
    const ElementTask<D> task{.positions = rounded(),
                              .leaves = element_leaves_.data(),
                              .nodes = nodes,
                              .ray_marks = ray_marks_.data(),
                              .inner_rays = inner_rays_.data()};
    const ElementFindings found = SELVAGE_DISPATCH(examine_elements, task, first, last, doubtful.get());
    add_relaxed(inner_ray_count_, found.inner_rays);
    Index* const defective_end = std::partition(doubtful.get(), doubtful.get() + found.doubtful,
                                                [&](Index element) { return examine_doubtful(element); });
    if (defective_end == doubtful.get()) return;
    const std::lock_guard lock(listing);
    defective_.insert(defective_.end(), doubtful.get(), defective_end);
  });
  std::sort(defective_.begin(), defective_.end());
}

template <int D>
bool DeformedMesh<D>::examine_doubtful(Index element) {
  const int sign = orientation_of(element);
  if (sign <= 0) {
    add_relaxed(sign < 0 ? defects_.inverted_elements : defects_.degenerate_elements, std::int64_t{1});
    std::atomic_ref(component_states_[topology_.component_of[element]]).store(ComponentState::kInverted);
    for (const HalfFace across : mesh_.neighbours()[element])
      if (!across.exists()) inverted_owners_[across.boundary_face()] = 1;
  }
  if (sign > 0 && mark_rays(element)) return false;
  // The elements on its vertices' rays are not known: more than one may hold them.
  for (Index v : mesh_.elements()[element]) {
    add_ray(v, 0, 2);
    add_ray(v, 1, 2);
  }
  return sign <= 0;
}

/// Notes what the rays of a positive element's vertices do, unless that is too close to tell.
template <int D>
bool DeformedMesh<D>::mark_rays(Index element) {
  const auto corners = corners_of(element);
  double edges[D][D], sides[D + 1], reach = 0;
  for (int k = 0; k < D; ++k)
    for (int i = 0; i < D; ++i) {
      edges[k][i] = corners[k + 1][i] - corners[0][i];
      reach = std::max(reach, std::abs(edges[k][i]));
    }
  const double shear[2] = {kRayShear[0], kRayShear[1]};
  ray_sides(edges, shear, sides);
  const double bound = 0x1p-46 * (D == 3 ? reach * reach : reach) + 0x1p-900;
  int positive = 0;
  for (const double side : sides) {
    if (!(std::abs(side) > bound)) return false;
    positive += side > 0;
  }
  for (int k = 0; k <= D; ++k) {
    if (positive == D && sides[k] < 0) add_ray(mesh_.elements()[element][k], 0, 1);
    if (positive == 1 && sides[k] > 0) add_ray(mesh_.elements()[element][k], 1, 1);
  }
  return true;
}

/// Some elements hold the forward (0) or backward (1) ray of a vertex.
template <int D>
void DeformedMesh<D>::add_ray(Index vertex, int backward, std::uint32_t elements) {
  if (topology_.is_on_boundary[vertex]) {
    std::atomic_ref(ray_marks_[2 * vertex + backward]).store(1, std::memory_order_relaxed);
  } else if (backward == 0) {
    add_relaxed(ray_counts_[vertex], elements);
    add_relaxed(inner_ray_count_, std::int64_t{elements});
  }
}

template <int D>
void DeformedMesh<D>::prove_boundary_vertices() {
  cullable_.assign(mesh_.vertex_count(), 0);
  const Rims& rims = topology_.rims;
  const auto prove = [&](Index v) { cullable_[v] = is_proven_injective(mesh_, positions_, v, vertex_normals_[v]); };
  parallel_ranges(std::ssize(rims.batches), 64, [&](std::int64_t first, std::int64_t last) {
    const auto doubtful = std::make_unique_for_overwrite<Index[]>(RimBatch::kWidth * (last - first));
    const RimTask task{.positions = rounded(),
                       .vertices = rims.vertices.data(),
                       .normals = vertex_normals_.data(),
                       .proven = cullable_.data()};
    const Index count =
        SELVAGE_DISPATCH(prove_rims, task, std::span(rims.batches).subspan(first, last - first), doubtful.get());
    std::for_each(doubtful.get(), doubtful.get() + count, prove);
  });
  parallel_for(std::ssize(rims.others), 64, [&](std::int64_t i) { prove(rims.others[i]); });
}

/// A vertex is locally injective when no ridge at it can be overwound: see docs/how_it_works/boundary_path.md.
template <int D>
void DeformedMesh<D>::prove_local_injectivity() {
  // All inner vertices have a ray at least.
  all_inner_injective_ = topology_.disagreeing.empty() && inner_ray_count_ == topology_.inner_vertex_count;
  if (!all_inner_injective_) count_rays();
  locally_injective_.resize(mesh_.vertex_count());
  parallel_for(mesh_.vertex_count(), kGrain, [&](std::int64_t v) {
    locally_injective_[v] = topology_.disagreeing.empty() &&
                            (topology_.is_on_boundary[v] ? cullable_[v] && !(ray_marks_[2 * v] && ray_marks_[2 * v + 1])
                                                         : all_inner_injective_ || ray_counts_[v] == 1);
  });
}

/// Counts each inner vertex's rays, which so far are only known in sum.
template <int D>
void DeformedMesh<D>::count_rays() {
  parallel_for(std::ssize(inner_rays_), kGrain, [&](std::int64_t n) {
    for (std::uint32_t rest = inner_rays_[n]; rest != 0; rest &= rest - 1) {
      const int bit = lowest_lane(rest);
      add_relaxed(ray_counts_[element_leaves_[n].vertices[bit / BvhNode::kWidth][bit % BvhNode::kWidth]], 1u);
    }
  });
}

template <int D>
bool DeformedMesh<D>::has_locally_injective(const VertexTuple<D - 1>& ridge) const {
  return std::any_of(ridge.begin(), ridge.end(), [&](Index v) { return locally_injective_[v] != 0; });
}

/// Whether the elements around a ridge are all positive and hang together forward around it: where some are inverted,
/// turns mean nothing, and each of these is a defect itself.
template <int D>
bool DeformedMesh<D>::turns_forward(const VertexTuple<D - 1>& ridge, std::span<const Index> link, bool closed) const {
  std::array<Vec<D>, D + 1> corners;
  for (int i = 0; i < D - 1; ++i) corners[i] = positions_[ridge[i]];
  for (std::size_t k = closed ? 0 : 1; k < link.size(); ++k) {
    corners[D - 1] = positions_[k == 0 ? link.back() : link[k - 1]];
    corners[D] = positions_[link[k]];
    if (orientation(corners) <= 0) return false;
  }
  return true;
}

/// Nothing but the definition holds as far from p as this.
template <int D>
template <std::size_t N>
void DeformedMesh<D>::add_defect(const std::array<Index, N>& vertices, Index component) {
  defect_places_.push_back({box_of(vertices), component});
  ComponentState& state = component_states_[component];
  if (state == ComponentState::kImmersed) state = ComponentState::kOverwound;
}

template <int D>
void DeformedMesh<D>::find_overwound_interior_ridges() {
  const auto& fans = topology_.interior_fans;
  const std::int64_t count = all_inner_injective_ ? topology_.spanning_count : fans.count();
  const std::vector<std::int64_t> overwound = parallel_list_if(count, kGrain, [&](std::int64_t k) {
    const auto& ridge = fans.fans[k].ridge;
    // The last link vertex leads back to the first.
    return !has_locally_injective(ridge) &&
           !turns_once(positions_, ridge, fans.link(k).first(fans.link(k).size() - 1)) &&
           turns_forward(ridge, fans.link(k), true);
  });
  defects_.overwound_interior_ridges = std::ssize(overwound);
  for (const std::int64_t k : overwound) add_defect(fans.fans[k].ridge, topology_.component_of[fans.fans[k].element]);
}

/// Withdraws the proof of the vertices where a turn is full, too.
template <int D>
void DeformedMesh<D>::find_overwound_boundary_ridges() {
  const auto& fans = topology_.boundary_fans;
  const std::vector<std::int64_t> overwound = parallel_list_if(fans.count(), kGrain, [&](std::int64_t k) {
    const auto& ridge = fans.fans[k].ridge;
    if (has_locally_injective(ridge) || turns_once(positions_, ridge, fans.link(k))) return false;
    for (Index v : ridge) std::atomic_ref(cullable_[v]).store(0, std::memory_order_relaxed);
    return turns_beyond(positions_, ridge, fans.link(k)) && turns_forward(ridge, fans.link(k), false);
  });
  defects_.overwound_boundary_ridges = std::ssize(overwound);
  for (const std::int64_t k : overwound) add_defect(fans.fans[k].ridge, topology_.component_of[fans.fans[k].element]);
}

/// Where two positive elements lie on one side of their common face, the material is folded as by an inverted one.
template <int D>
void DeformedMesh<D>::find_folds() {
  for (const HalfFace side : topology_.disagreeing) {
    const Index element = side.element();
    const HalfFace across = mesh_.neighbours()[element][side.face()];
    if (orientation_of(element) > 0 && orientation_of(across.element()) > 0)
      add_defect(mesh_.face_of(mesh_.elements()[element], side.face()), topology_.component_of[element]);
  }
}

template <int D>
PathInput<D> DeformedMesh<D>::path_input(const PathOptions& options) const {
  return {.positions = positions_.data(),
          .elements = topology_.elements.data(),
          .boundary_faces = mesh_.boundary_faces().data(),
          .boundary_owners = mesh_.boundary_owners().data(),
          .boundary_neighbours = mesh_.boundary_neighbours().data(),
          .mesh = &mesh_,
          .face_nodes = faces_.nodes(),
          .face_cones = cones_.data(),
          .face_leaves = face_leaves_.data(),
          .face_stars = topology_.face_stars.data(),
          .rounded = rounded_.data(),
          .rounding = rounding_,
          .box_origin = box_origin_,
          .component_of = topology_.component_of.data(),
          .component_state = component_states_.data(),
          .cullable = cullable_.data(),
          .is_split = topology_.is_split.data(),
          .hints = topology_.hints.data(),
          .inverted_owner = inverted_owners_.data(),
          .defect_nodes = defect_hierarchy_.nodes(),
          .defects = defect_places_.data(),
          .is_oriented = topology_.disagreeing.empty(),
          .options = options};
}

template class DeformedMesh<2>;
template class DeformedMesh<3>;

}  // namespace selvage
