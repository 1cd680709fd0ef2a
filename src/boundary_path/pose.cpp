#include "boundary_path/pose.h"

#include "selvage/core/error.h"
#include "selvage/core/parallel.h"
#include "selvage/geometry/predicates.h"

#include <fmt/format.h>

#include <atomic>
#include <cmath>

namespace selvage {

namespace {

constexpr std::int64_t kGrain = 4096;

/// In which half turn from the direction of `first` a link vertex lies: 0 the first half, `first`'s own direction
/// included, 1 the second. Exact.
int half_turn(std::span<const Vec3> x, const VertexTuple<2>& ridge, Index first, Index v) {
  const Vec3 axis = x[ridge[1]] - x[ridge[0]], a = x[first] - x[ridge[0]], b = x[v] - x[ridge[0]];
  const Vec3 across = axis.cross(a);
  const double height = across.dot(b);
  const double bound =
      64 * 0x1p-53 * axis.lpNorm<Eigen::Infinity>() * a.lpNorm<Eigen::Infinity>() * b.lpNorm<Eigen::Infinity>();
  const int sign =
      std::abs(height) > bound + 0x1p-900 ? (height > 0 ? 1 : -1) : orient3d(x[ridge[0]], x[ridge[1]], x[first], x[v]);
  if (sign != 0) return sign > 0 ? 0 : 1;
  return across.dot(axis.cross(b)) >= 0 ? 0 : 1;
}

int half_turn(std::span<const Vec2> x, const VertexTuple<1>& ridge, Index first, Index v) {
  const int sign = orient2d(x[ridge[0]], x[first], x[v]);
  if (sign != 0) return sign > 0 ? 0 : 1;
  return (x[first] - x[ridge[0]]).dot(x[v] - x[ridge[0]]) >= 0 ? 0 : 1;
}

/// A cone in single precision, wider by more than its rounding; unbounded when it is wider than a half space.
NormalCone cone_around(const Vec3& axis, double cosine) {
  if (!(cosine > 1e-3)) return NormalCone::everything();
  const Eigen::Vector3f a = axis.cast<float>();
  return {{a[0], a[1], a[2]}, static_cast<float>(cosine) - 4e-6f};
}

/// How often a link of less than half a turn a step comes around to the direction of its first vertex.
template <int D>
int count_turns(std::span<const Vec<D>> x, const VertexTuple<D - 1>& ridge, std::span<const Index> link) {
  int turns = 0;
  for (std::size_t i = 1, before = 0; i < link.size(); ++i) {
    const std::size_t half = half_turn(x, ridge, link[0], link[i]);
    turns += before == 1 && half == 0;
    before = half;
  }
  return turns;
}

/// Whether the link ends exactly in the direction in which it began.
bool ends_where_it_began(std::span<const Vec3> x, const VertexTuple<2>& ridge, std::span<const Index> link) {
  return orient3d(x[ridge[0]], x[ridge[1]], x[link.front()], x[link.back()]) == 0;
}
bool ends_where_it_began(std::span<const Vec2> x, const VertexTuple<1>& ridge, std::span<const Index> link) {
  return orient2d(x[ridge[0]], x[link.front()], x[link.back()]) == 0;
}

template <typename Predicate>
std::int64_t count_if_parallel(std::int64_t count, Predicate&& predicate) {
  std::atomic<std::int64_t> sum{0};
  parallel_ranges(count, kGrain, [&](std::int64_t first, std::int64_t last) {
    std::int64_t local = 0;
    for (std::int64_t i = first; i < last; ++i) local += predicate(i) ? 1 : 0;
    sum.fetch_add(local, std::memory_order_relaxed);
  });
  return sum;
}

}  // namespace

template <int D>
void Pose<D>::set(std::span<const Vec<D>> positions) {
  if (std::ssize(positions) != mesh_.vertex_count())
    throw Error("positions", fmt::format("{} positions for {} vertices", positions.size(), mesh_.vertex_count()),
                "give one position per vertex");
  place(positions);
  defects_ = {};
  component_states_.assign(topology_.component_count, ComponentState::kImmersed);
  examine_elements();
  examine_faces();
  find_overwound_interior_ridges();
  list_defects();
  prove_boundary_vertices();
  find_overwound_boundary_ridges();
}

/// Scales the positions by a power of two and lays the frame.
template <int D>
void Pose<D>::place(std::span<const Vec<D>> positions) {
  Vec<D> lower = Vec<D>::Constant(HUGE_VAL), upper = -lower;
  for (std::size_t v = 0; v < positions.size(); ++v) {
    if (!positions[v].allFinite())
      throw Error(fmt::format("vertex {}", v), "a coordinate is not finite", "remove NaN and infinity");
    lower = lower.cwiseMin(positions[v]);
    upper = upper.cwiseMax(positions[v]);
  }
  const double largest = std::max(lower.cwiseAbs().maxCoeff(), upper.cwiseAbs().maxCoeff());
  exponent_ = largest > 0 ? std::ilogb(largest) : 0;
  // By two factors: 2^-exponent itself may overflow.
  const double half = std::ldexp(1.0, -exponent_ / 2), rest = std::ldexp(1.0, -exponent_ - -exponent_ / 2);
  frame_.origin = (lower * half * rest + upper * half * rest) / 2;
  positions_.resize(positions.size());
  rounded_.resize(positions.size());
  parallel_for(std::ssize(positions), kGrain, [&](std::int64_t v) {
    positions_[v] = positions[v] * half * rest;
    rounded_[v] = {};
    for (int i = 0; i < D; ++i) rounded_[v][i] = static_cast<float>(positions_[v][i] - frame_.origin[i]);
  });
  rounding_ = static_cast<float>(0x1p-24 * (upper * half * rest - lower * half * rest).maxCoeff()) + 0x1p-149f;
}

template <int D>
int Pose<D>::orientation_of(Index element) const {
  std::array<Vec<D>, D + 1> corners;
  for (int i = 0; i <= D; ++i) corners[i] = positions_[mesh_.elements()[element][i]];
  return orientation(corners);
}

/// One pass for boxes and orientations: both read the same positions. Each product in the determinant has one factor
/// for each coordinate, none larger than the box, so that the box bounds its rounding error.
template <int D>
void Pose<D>::examine_elements() {
  element_boxes_.resize(mesh_.element_count());
  inverted_owners_.assign(mesh_.boundary_face_count(), 0);
  std::atomic<std::int64_t> flat{0};
  defects_.inverted_elements = count_if_parallel(mesh_.element_count(), [&](std::int64_t e) {
    std::array<Vec<D>, D + 1> corners;
    for (int i = 0; i <= D; ++i) corners[i] = positions_[mesh_.elements()[e][i]];
    Vec<D> lower = corners[0], upper = corners[0];
    Eigen::Matrix<double, D, D> edges;
    for (int i = 1; i <= D; ++i) {
      lower = lower.cwiseMin(corners[i]);
      upper = upper.cwiseMax(corners[i]);
      edges.col(i - 1) = corners[i] - corners[0];
    }
    element_boxes_[e] = frame_.around(lower, upper);
    if (edges.determinant() > 0x1p-46 * (upper - lower).prod() + 0x1p-900) return false;
    const int sign = orientation(corners);
    if (sign > 0) return false;
    flat += sign == 0;
    std::atomic_ref(component_states_[topology_.component_of[e]]).store(ComponentState::kInverted);
    for (Index across : mesh_.neighbours()[e])
      if (across < 0) inverted_owners_[~across] = 1;
    return sign < 0;
  });
  defects_.degenerate_elements = flat;
}

/// Boxes and normals of the boundary.
template <int D>
void Pose<D>::examine_faces() {
  const std::size_t count = mesh_.boundary_faces().size();
  face_boxes_.resize(count);
  face_normals_.resize(count);
  face_measures_.resize(count);
  parallel_for(std::ssize(face_boxes_), kGrain, [&](std::int64_t b) {
    const auto& f = mesh_.boundary_faces()[b];
    Vec<D> lower = positions_[f[0]], upper = lower;
    for (int i = 1; i < D; ++i) {
      lower = lower.cwiseMin(positions_[f[i]]);
      upper = upper.cwiseMax(positions_[f[i]]);
    }
    face_boxes_[b] = frame_.around(lower, upper);
    const Vec<D> along = positions_[f[1]] - positions_[f[0]];
    Vec<D> normal;
    if constexpr (D == 3)
      normal = along.cross(positions_[f[2]] - positions_[f[0]]);
    else
      normal = Vec2(along[1], -along[0]);
    const double measure = normal.norm();
    face_measures_[b] = measure;
    face_normals_[b] = measure > 0 ? Vec<D>(normal / measure) : Vec<D>::Zero();
  });
}

template <int D>
void Pose<D>::find_overwound_interior_ridges() {
  const auto& fans = topology_.interior_fans;
  defects_.overwound_interior_ridges = count_if_parallel(fans.count(), [&](std::int64_t k) {
    ComponentState& state = component_states_[topology_.component_of[fans.fans[k].element]];
    if (std::atomic_ref(state).load(std::memory_order_relaxed) == ComponentState::kInverted) return false;
    // The last link vertex leads back to the first.
    if (turns_once(fans.fans[k].ridge, fans.link(k).first(fans.link(k).size() - 1))) return false;
    std::atomic_ref(state).store(ComponentState::kOverwound, std::memory_order_relaxed);
    return true;
  });
}

/// Whether a link does not come around to the direction of its first vertex. With positive elements its second vertex
/// is in the first half turn, so that this means: first some on the one side, then the rest on the other. What plain
/// arithmetic leaves open is decided exactly.
template <>
bool Pose<3>::turns_once(const VertexTuple<2>& ridge, std::span<const Index> open_link) const {
  const Vec3 foot = positions_[ridge[0]], axis = positions_[ridge[1]] - foot, first = positions_[open_link[0]] - foot;
  const Vec3 across = axis.cross(first);
  const double length = across.lpNorm<1>();
  bool sure = length > 1e-3 * axis.lpNorm<1>() * first.lpNorm<1>(), back = false;
  for (std::size_t i = 2; sure && i < open_link.size(); ++i) {
    const Vec3 arm = positions_[open_link[i]] - foot;
    const double height = across.dot(arm);
    sure = std::abs(height) > 1e-12 * length * arm.lpNorm<1>() + 0x1p-900 && !(back && height > 0);
    back = height < 0;
  }
  return sure || count_turns<3>(positions_, ridge, open_link) == 0;
}

template <>
bool Pose<2>::turns_once(const VertexTuple<1>& ridge, std::span<const Index> open_link) const {
  return count_turns<2>(positions_, ridge, open_link) == 0;
}

template <int D>
Box Pose<D>::box_of(const VertexTuple<D - 1>& ridge) const {
  Vec<D> lower = positions_[ridge[0]], upper = lower;
  for (Index v : ridge) {
    lower = lower.cwiseMin(positions_[v]);
    upper = upper.cwiseMax(positions_[v]);
  }
  return frame_.around(lower, upper);
}

/// A second look at what the counts say is there: rare enough to be done in order.
template <int D>
void Pose<D>::list_defects() {
  defect_places_.clear();
  if (defects_.inverted_elements + defects_.degenerate_elements > 0)
    for (Index e = 0; e < mesh_.element_count(); ++e)
      if (component_states_[topology_.component_of[e]] == ComponentState::kInverted && orientation_of(e) <= 0)
        defect_places_.push_back({element_boxes_[e], topology_.component_of[e]});
  if (defects_.overwound_interior_ridges > 0) {
    const auto& fans = topology_.interior_fans;
    for (std::int64_t k = 0; k < fans.count(); ++k) {
      const auto& fan = fans.fans[k];
      const Index component = topology_.component_of[fan.element];
      if (component_states_[component] == ComponentState::kOverwound &&
          !turns_once(fan.ridge, fans.link(k).first(fans.link(k).size() - 1)))
        defect_places_.push_back({box_of(fan.ridge), component});
    }
  }
  std::vector<Box> boxes(defect_places_.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) boxes[i] = defect_places_[i].box;
  defect_hierarchy_ = Bvh(boxes);
}

template <int D>
void Pose<D>::prove_boundary_vertices() {
  cullable_.assign(mesh_.vertex_count(), 0);
  normal_cones_.assign(mesh_.vertex_count(), NormalCone::everything());
  const auto vertices = mesh_.boundary_vertices();
  parallel_for(std::ssize(vertices), kGrain, [&](std::int64_t i) {
    const Index v = vertices[i];
    NormalCone cone;
    cullable_[v] = is_boundary_vertex_injective(v, cone);
    if (cullable_[v]) normal_cones_[v] = cone;
  });
}

/// Sufficient, not necessary: seen along the average normal, the boundary faces around the vertex all turn the same way
/// and go around once. Then the link of the vertex is bounded by a simple polygon on the sphere of directions, and
/// elements that fill it without an overwound interior ridge cover it once.
template <>
bool Pose<3>::is_boundary_vertex_injective(Index v, NormalCone& cone) const {
  const auto star = mesh_.vertex_boundary_faces(v);
  Vec3 axis = Vec3::Zero();
  for (Index face : star) axis += face_normals_[face] * face_measures_[face];
  constexpr double kMargin = 1e-9;  // relative; far above rounding
  const double axis_length = axis.norm();
  double cosine = axis_length;
  for (Index face : star) cosine = std::min(cosine, face_normals_[face].dot(axis));
  cosine /= axis_length;
  if (!(cosine > kMargin)) return false;
  cone = cone_around(axis / axis_length, cosine);
  // A half plane that no edge is likely to lie in; an edge too close to it leaves the vertex unproven.
  const Vec3 across = axis.cross(Vec3(0.3571, 0.6139, 0.7041));
  const double across_length = across.norm();
  int turns = 0;
  for (Index face : star) {
    const auto& f = mesh_.boundary_faces()[face];
    const int i = f[0] == v ? 0 : f[1] == v ? 1 : 2;
    const Vec3 from = positions_[f[(i + 1) % 3]] - positions_[v], to = positions_[f[(i + 2) % 3]] - positions_[v];
    const double a = across.dot(from), b = across.dot(to);
    if (!(std::abs(a) > kMargin * from.norm() * across_length)) return false;
    turns += a < 0 && b > 0;
  }
  return turns == 1;
}

/// What is left to prove in the plane, that the elements turn by less than 2 pi, is seen to with the boundary ridges.
template <>
bool Pose<2>::is_boundary_vertex_injective(Index v, NormalCone& cone) const {
  const auto star = mesh_.vertex_boundary_faces(v);
  if (star.size() != 2) return false;
  const Vec2 normals[2] = {face_normals_[star[0]], face_normals_[star[1]]};
  const Vec2 sum = normals[0] + normals[1];
  const Vec2 axis = sum.norm() > 0.1 ? Vec2(sum.normalized()) : normals[0];
  cone = cone_around(Vec3(axis[0], axis[1], 0), std::min(normals[0].dot(axis), normals[1].dot(axis)));
  return true;
}

/// Counts them, and withdraws the proof of the vertices at them.
template <int D>
void Pose<D>::find_overwound_boundary_ridges() {
  const auto& fans = topology_.boundary_fans;
  defects_.overwound_boundary_ridges = count_if_parallel(fans.count(), [&](std::int64_t k) {
    const auto& fan = fans.fans[k];
    if (component_states_[topology_.component_of[fan.element]] == ComponentState::kInverted) return false;
    const auto link = fans.link(k);
    if (turns_once(fan.ridge, link)) return false;
    for (Index v : fan.ridge) {
      std::atomic_ref(cullable_[v]).store(0, std::memory_order_relaxed);
      std::atomic_ref(normal_cones_[v].cosine).store(NormalCone::everything().cosine, std::memory_order_relaxed);
    }
    // A slit of exactly 2 pi is legal.
    return count_turns<D>(positions_, fan.ridge, link) > 1 || !ends_where_it_began(positions_, fan.ridge, link);
  });
}

template class Pose<2>;
template class Pose<3>;

}  // namespace selvage
