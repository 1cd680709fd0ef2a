#include "simulation/time_step/draw_off.h"

#include "simulation/colliders/passage.h"
#include "simulation/time_step/ways_out_of_solids.h"

#include <algorithm>

namespace selvage {

namespace {

/// Cosine between a way and the way out of a collider below which what meets on it is no touch, nor a slide along.
constexpr double kAgainst = -0.3;

/// Whether a vertex that is outside of a collider runs into it on a straight way.
/// @param least_depth  what is less deep touches it [m]
bool is_in_way(const PreparedCollider& collider, double time, const Vec3& from, const Vec3& way, double least_depth) {
  const RigidTransform place = collider.motion.at(time);
  const Vec3 start = place.invert(from), end = place.invert(from + way);
  Eigen::AlignedBox3d box(start);
  box.extend(end);
  const std::optional<Hit> hit = std::visit(
      [&](const auto& shape) -> std::optional<Hit> {
        if (is_clear(shape, box) || find_hit(shape, start)) return {};
        return find_hit_on_way(shape, start, end);
      },
      collider.shape);
  return hit && hit->depth > least_depth && (place.rotation * hit->normal).dot(way) < kAgainst * way.norm();
}

/// Whether a point is inside a collider.
bool is_inside(const PreparedCollider& collider, double time, const Vec3& point) {
  const Vec3 p = collider.motion.at(time).invert(point);
  return std::visit([&](const auto& shape) { return find_hit(shape, p).has_value(); }, collider.shape);
}

/// Whether a vertex runs into a collider, and is not held between that and another one: then it is pulled along.
/// @param gap  what is nearer touches, and what is less deep [m]
bool is_stopped(std::span<const PreparedCollider> colliders, double time, const Vec3& from, const Vec3& way,
                double gap) {
  const Vec3 back = from - 2 * gap * way.normalized();
  return std::any_of(colliders.begin(), colliders.end(), [&](const PreparedCollider& collider) {
    return is_in_way(collider, time, from, way, gap) &&
           std::none_of(colliders.begin(), colliders.end(), [&](const PreparedCollider& other) {
             return &other != &collider && is_inside(other, time, back);
           });
  });
}

struct Any {
  bool value = false;
  void add(const Any& other) { value |= other.value; }
};

template <typename Predicate>
bool any_vertex(Index count, Predicate&& predicate) {
  return parallel_reduce<Any>(count, kGrain,
                              [&](std::int64_t first, std::int64_t last, Any& any) {
                                for (std::int64_t v = first; v < last && !any.value; ++v)
                                  any.value = predicate(static_cast<Index>(v));
                              })
      .value;
}

/// What takes from a piece its mean motion against a direction.
Vec3 against(std::span<const StepVertex> vertices, const Step& step, const Pieces& pieces, Index piece,
             const Vec3& direction) {
  double sum = 0, mass = 0;
  for (Index v = 0; v < std::ssize(vertices); ++v) {
    if (pieces.of_vertex(v) != piece) continue;
    sum += (position(vertices[v]) - step.positions[v]).dot(direction) / vertices[v].inverse_mass;
    mass += 1 / vertices[v].inverse_mass;
  }
  return std::max(-sum / mass, 0.0) * direction;
}

}  // namespace

void DrawOff::begin() {
  drawn_.clear();
  across_count_ = 0;
  ways_.clear();
  ways_off_edges_.clear();
}

void DrawOff::draw(const Input& input, const PieceWayOff& off, bool is_across, std::span<StepVertex> vertices) {
  const auto count = static_cast<Index>(vertices.size());
  const Pieces& pieces = input.pieces;
  const Index piece = pieces.of_vertex(off.vertex);
  double length = off.way;
  for (Index v = 0; v < count; ++v)
    if (pieces.of_vertex(v) == piece) length = std::min(length, kOffCollider * input.max_corrections[v]);
  drawn_.push_back(off.vertex);
  ways_.resize(vertices.size(), Vec3::Zero());
  ways_off_edges_.resize(vertices.size(), Vec3::Zero());
  // Contacts hold it else.
  const Vec3 hold = is_across ? against(vertices, input.step, pieces, piece, off.direction) : Vec3(Vec3::Zero());
  for (Index v = 0; v < count; ++v) {
    if (pieces.of_vertex(v) != piece) continue;
    ways_[v] = length * off.direction;
    if (!is_across) ways_off_edges_[v] = ways_[v];
    position(vertices[v]) += ways_[v] + hold;
  }
}

void DrawOff::leave_solids(const Input& input, const ColliderSurface& surface, std::span<ColliderContactState> states,
                           std::span<StepVertex> vertices) {
  const auto count = static_cast<Index>(vertices.size());
  const auto is_blocked = [&](Index piece, const Vec3& way, std::span<const Index> solids) {
    return any_vertex(count, [&](Index v) {
      if (input.pieces.of_vertex(v) != piece) return false;
      if (!(vertices[v].inverse_mass > 0)) return true;
      if (input.model.mesh.vertex_boundary_faces(v).empty()) return false;
      for (Index c = 0; c < std::ssize(input.colliders); ++c)
        if (!std::binary_search(solids.begin(), solids.end(), c) &&
            is_in_way(input.colliders[c], input.step.start_time, input.step.positions[v], way,
                      kContactGap * input.max_corrections[v]))
          return true;
      return false;
    });
  };
  for (const auto& [off, solids] :
       ways_out_of_solids(input.model, input.pieces, input.colliders, input.step, input.max_corrections, is_blocked)) {
    std::vector<Index> of_solids;
    for (std::size_t i = 0; i < surface.positions.size(); ++i)
      if (std::binary_search(solids.begin(), solids.end(), surface.collider_of_vertices[i]))
        of_solids.push_back(static_cast<Index>(input.model.mesh.vertex_count() + i));
    input.finder.let_in(off.vertex, of_solids);
    for (Index v = 0; v < count; ++v)
      for (const Index c : solids) {
        if (input.pieces.of_vertex(v) != input.pieces.of_vertex(off.vertex)) continue;
        ColliderContactState& state = states[v * input.colliders.size() + c];
        state = {};
        state.step = input.step.number;
        state.is_let_in = true;
      }
    draw(input, off, true, vertices);
  }
  across_count_ = drawn_.size();
}

void DrawOff::leave_edges(const Input& input, std::span<StepVertex> vertices) {
  const auto count = static_cast<Index>(vertices.size());
  const auto is_held = [&](Index piece) {
    return any_vertex(count,
                      [&](Index v) { return input.pieces.of_vertex(v) == piece && !(vertices[v].inverse_mass > 0); });
  };
  const auto is_blocked = [&](Index of_piece, const Vec3& way) {
    const Index piece = input.pieces.of_vertex(of_piece);
    return !is_held(piece) && any_vertex(count, [&](Index v) {
      return input.pieces.of_vertex(v) == piece && !input.model.mesh.vertex_boundary_faces(v).empty() &&
             is_stopped(input.colliders, input.step.start_time, input.step.positions[v], way,
                        kContactGap * input.max_corrections[v]);
    });
  };
  for (const PieceWayOff& off : input.finder.choose_ways_off(is_blocked))
    if (!is_held(input.pieces.of_vertex(off.vertex))) draw(input, off, false, vertices);
}

}  // namespace selvage
