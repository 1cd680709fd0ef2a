#include "simulation/colliders/project_colliders.h"

#include "core/parallel.h"
#include "simulation/colliders/passage.h"

#include <cmath>

namespace selvage {

namespace {

constexpr std::int64_t kVertexGrain = 1024;
/// Part of the depth of a touch up to which two depths are the same.
constexpr double kSameDepth = 1e-3;
/// Vertices that are skipped together where a collider is far from all of them.
constexpr std::int64_t kVertexRun = 128;

Eigen::AlignedBox3d box_around(std::span<const StepVertex> vertices) {
  Eigen::AlignedBox3d box;
  for (const StepVertex& vertex : vertices) box.extend(Eigen::Map<const Eigen::Vector3d>(vertex.position));
  return box;
}

/// Around what a box becomes in a collider's own coordinates, with rounding.
Eigen::AlignedBox3d invert_box(const RigidTransform& transform, const Eigen::AlignedBox3d& box) {
  constexpr double kRounding = 1e-12;
  const double size = box.min().lpNorm<1>() + box.max().lpNorm<1>() + transform.translation.lpNorm<1>();
  const Vec3 middle = transform.invert(box.center());
  const Vec3 half = transform.rotation.transpose().cwiseAbs() * (0.5 * box.sizes()) + Vec3::Constant(kRounding * size);
  return {middle - half, middle + half};
}

/// A collider and where it is at the ends of a step.
struct MovingCollider {
  const PreparedCollider& collider;
  RigidTransform start, end;
  bool is_fixed;

  MovingCollider(const PreparedCollider& c, const Step& step)
      : collider(c), start(c.motion.at(step.start_time)), end(c.motion.at(step.end_time)), is_fixed(c.is_fixed()) {}

  /// Where a vertex starts the step, carried along: in the collider's own coordinates.
  Vec3 start_of(const Step& step, std::int64_t v) const { return collider.carry(start.invert(step.positions[v])); }

  /// Whether a key-framed surface is far from the way of a vertex. Others answer as fast by themselves.
  bool is_far(const Step& step, std::int64_t v, double distance, const StepVertex& vertex) const {
    if (!collider.surface_motion) return false;
    Eigen::AlignedBox3d way(start.invert(step.positions[v]));
    way.extend(to_local(vertex));
    const auto bounds = collider.surface_motion->bounds(std::get<MeshCollider>(collider.shape));
    return bounds.squaredExteriorDistance(way) > distance * distance;
  }

  /// In the collider's own coordinates, at the end of the step.
  Vec3 to_local(const StepVertex& vertex) const {
    return is_fixed ? Vec3(position(vertex)) : end.invert(position(vertex));
  }

  /// Whether certainly no vertex in a box is inside at the end of the step, nor has passed on its way.
  /// @param starts  around where they start the step
  template <typename Shape>
  bool is_clear_of(const Shape& shape, const Eigen::AlignedBox3d& starts, const Eigen::AlignedBox3d& now) const {
    if (collider.surface_motion) return false;
    Eigen::AlignedBox3d box = is_fixed ? now : invert_box(end, now);
    if constexpr (kHasFarSide<Shape>) box.extend(is_fixed ? starts : invert_box(start, starts));
    return is_clear(shape, box);
  }

  /// Whether a vertex is outside of a shape that none can pass through. Most are, and need no more than this.
  template <typename Shape>
  bool is_outside(const Shape& shape, const StepVertex& vertex) const {
    if constexpr (kHasFarSide<Shape>)
      return false;
    else
      return !find_hit(shape, to_local(vertex));
  }

  /// @param was                       start_of() the vertex
  /// @param max_correction, depth_share  see selvage::project_colliders()
  template <typename Shape>
  void push_out(const Shape& shape, const Step& step, std::int64_t v, const Vec3& was, double max_correction,
                double depth_share, const Vec3& ejected, const Vec3& way, ColliderContactState& state,
                StepVertex& vertex, ColliderContacts& contacts) const {
    const Vec3 p = to_local(vertex);
    const std::optional<Hit> hit = find_hit_on_way(shape, was, p);
    if (!hit) return;
    if (state.step != step.number) {
      state = {};
      state.step = step.number;
      const std::optional<Hit> at_start = find_hit(shape, was);
      if (at_start && at_start->depth > kContactGap * max_correction) {
        state.way_out = end.rotation * at_start->normal;
        state.start_depth = at_start->depth;
        state.depth_left =
            std::max(at_start->depth - max_correction, is_fixed ? (1 - depth_share) * at_start->depth : 0.0);
        state.waits = kHasFarSide<Shape> && state.depth_left > 0 && state.way_out.dot(way) < 0;
        ++contacts.started_inside;
      }
    }
    if (state.waits) return;
    const double push = hit->depth - state.depth_left;
    if (!(push > 0)) return;
    contacts.pushed.push_back(static_cast<Index>(v));
    state.normal = end.rotation * hit->normal;
    const Vec3 outside = p + push * hit->normal;
    const Vec3 moved = outside - was - end.rotation.transpose() * ejected;
    const Vec3 drift = end.invert(step.positions[v] + step.length() * step.velocities[v]) - was;
    const Vec3 slide = friction_correction(moved, drift, hit->normal, push, collider.friction, state.friction);
    position(vertex) = end(outside + slide);
  }

  /// Moves a vertex that friction has left inside, or beyond, to the surface once more.
  void set_on_surface(const Step& step, std::int64_t v, double half_thickness, double depth_left,
                      StepVertex& vertex) const {
    if (is_far(step, v, half_thickness, vertex)) return;
    const auto is_missed = [&](const auto& shape) { return half_thickness == 0 && is_outside(shape, vertex); };
    if (std::visit(is_missed, collider.shape)) return;
    const Vec3 p = to_local(vertex), was = start_of(step, v);
    const std::optional<Hit> hit = std::visit(
        [&](const auto& shape) {
          return half_thickness > 0 ? find_hit_on_way(grown_for(shape, half_thickness, was), was, p)
                                    : find_hit_on_way(shape, was, p);
        },
        collider.shape);
    if (hit && hit->depth > depth_left) position(vertex) = end(p + (hit->depth - depth_left) * hit->normal);
  }

  /// Whether a vertex is inside at the end of the step, or has passed, by more than a depth and more than it was. What
  /// a collider carries along is as deep but for rounding.
  bool is_entered(const Step& step, Index v, double least_depth, const StepVertex& vertex) const {
    if (is_far(step, v, 0, vertex)) return false;
    return std::visit(
        [&](const auto& shape) {
          if (is_outside(shape, vertex)) return false;
          const Vec3 p = to_local(vertex), was = start_of(step, v);
          const std::optional<Hit> hit = find_hit_on_way(shape, was, p);
          if (!hit || !(hit->depth > least_depth)) return false;
          const std::optional<Hit> before = find_hit(shape, was);
          return !before || hit->depth > before->depth + kSameDepth * least_depth;
        },
        collider.shape);
  }
};

/// One projection of all vertices out of all colliders.
class Projection {
 public:
  Projection(std::span<const PreparedCollider> colliders, const Step& step, std::span<const double> max_corrections,
             double depth_share, std::span<const double> half_thickness, std::span<const Vec3> ejected,
             std::span<const Vec3> ways, std::span<ColliderContactState> states, std::span<StepVertex> vertices)
      : step_(step),
        max_corrections_(max_corrections),
        depth_share_(depth_share),
        half_thickness_(half_thickness),
        ejected_(ejected),
        ways_(ways),
        states_(states),
        vertices_(vertices) {
    for (const double half : half_thickness) largest_half_ = std::max(largest_half_, half);
    for (const PreparedCollider& collider : colliders) {
      colliders_.emplace_back(collider, step);
      any_far_side_ |= std::visit([](const auto& s) { return kHasFarSide<std::decay_t<decltype(s)>>; }, collider.shape);
    }
  }

  ColliderContacts project() {
    const std::int64_t run = uses_boxes() ? kVertexRun : std::ssize(vertices_);
    return parallel_reduce<ColliderContacts>(std::ssize(vertices_), kVertexGrain,
                                             [&](std::int64_t first, std::int64_t last, ColliderContacts& hits) {
                                               for (; first < last; first += run)
                                                 project_run(first, std::min(first + run, last), hits);
                                             });
  }

 private:
  /// Around a run of vertices: where they are, and where they start the step, if a collider asks for that.
  struct Boxes {
    Eigen::AlignedBox3d now, starts;
  };

  /// A box takes half as long as asking one collider of every vertex: it pays for two.
  bool uses_boxes() const { return colliders_.size() > 1; }

  Boxes boxes_around(std::int64_t first, std::int64_t last) const {
    Boxes boxes;
    boxes.now = box_around(vertices_.subspan(first, last - first));
    for (std::int64_t v = first; v < last && any_far_side_; ++v) boxes.starts.extend(step_.positions[v]);
    for (Eigen::AlignedBox3d* box : {&boxes.now, &boxes.starts}) {
      box->min().array() -= largest_half_;
      box->max().array() += largest_half_;
    }
    return boxes;
  }

  void project_run(std::int64_t first, std::int64_t last, ColliderContacts& hits) {
    const std::size_t pushed_before = hits.pushed.size();
    Boxes boxes;
    if (uses_boxes()) boxes = boxes_around(first, last);
    for (std::size_t c = 0; c < colliders_.size(); ++c)
      std::visit(
          [&](const auto& shape) {
            if (uses_boxes() && colliders_[c].is_clear_of(shape, boxes.starts, boxes.now)) return;
            const std::size_t before = hits.pushed.size();
            push_run_out(c, shape, first, last, hits);
            if (uses_boxes() && hits.pushed.size() > before) boxes = boxes_around(first, last);
          },
          colliders_[c].collider.shape);
    // Friction that stops a vertex from sliding along one wall also stops it from leaving another, and from leaving the
    // same one where that is hollow.
    for (const std::int64_t v : std::span(hits.pushed).subspan(pushed_before))
      for (std::size_t c = 0; c < colliders_.size(); ++c) {
        const ColliderContactState& state = states_[v * colliders_.size() + c];
        if (state.step == step_.number && (state.waits || state.is_let_in)) continue;
        const double depth_left = state.step == step_.number ? state.depth_left : 0;
        colliders_[c].set_on_surface(step_, v, half_thickness_of(v), depth_left, vertices_[v]);
      }
  }

  double half_thickness_of(std::int64_t v) const { return half_thickness_.empty() ? 0 : half_thickness_[v]; }

  template <typename Shape>
  void push_run_out(std::size_t c, const Shape& shape, std::int64_t first, std::int64_t last, ColliderContacts& hits) {
    for (std::int64_t v = first; v < last; ++v) {
      if (!(vertices_[v].inverse_mass > 0) || states_[v * colliders_.size() + c].lets_in(step_)) continue;
      const double half = half_thickness_of(v);
      if (colliders_[c].is_far(step_, v, half, vertices_[v])) continue;
      if (half == 0 && colliders_[c].is_outside(shape, vertices_[v])) continue;
      const Vec3 was = colliders_[c].start_of(step_, v);
      const auto push_out = [&](const auto& own) {
        colliders_[c].push_out(own, step_, v, was, max_corrections_[v], depth_share_, ejected_[v],
                               ways_.empty() ? Vec3(Vec3::Zero()) : ways_[v], states_[v * colliders_.size() + c],
                               vertices_[v], hits);
      };
      half > 0 ? push_out(grown_for(shape, half, was)) : push_out(shape);
    }
  }

  const Step& step_;
  std::span<const double> max_corrections_;
  double depth_share_;
  std::span<const double> half_thickness_;
  double largest_half_ = 0;  ///< [m]
  std::span<const Vec3> ejected_, ways_;
  std::span<ColliderContactState> states_;
  std::span<StepVertex> vertices_;
  std::vector<MovingCollider> colliders_;
  bool any_far_side_ = false;
};

}  // namespace

ColliderContacts project_colliders(std::span<const PreparedCollider> colliders, const Step& step,
                                   std::span<const double> max_corrections, double depth_share,
                                   std::span<const double> half_thickness, std::span<const Vec3> ejected,
                                   std::span<const Vec3> ways, std::span<ColliderContactState> states,
                                   std::span<StepVertex> vertices) {
  if (colliders.empty()) return {};
  return Projection(colliders, step, max_corrections, depth_share, half_thickness, ejected, ways, states, vertices)
      .project();
}

std::vector<Index> find_deep_vertices(const ColliderContacts& contacts, std::span<const ColliderContactState> states,
                                      std::span<const PreparedCollider> colliders, const Step& step) {
  std::vector<Index> deep;
  if (contacts.started_inside == 0) return deep;
  for (const Index v : contacts.pushed)
    for (std::size_t c = 0; c < colliders.size(); ++c) {
      const ColliderContactState& state = states[v * colliders.size() + c];
      const bool is_deep = state.step == step.number && state.depth_left > 0;
      if (is_deep && !colliders[c].moves(step.start_time, step.end_time)) deep.push_back(v);
    }
  return deep;
}

std::vector<ColliderEntry> find_entries(std::span<const PreparedCollider> colliders, const Step& step,
                                        std::span<const double> max_corrections,
                                        std::span<const ColliderContactState> states, std::span<const Index> vertices,
                                        std::span<const StepVertex> positions) {
  std::vector<MovingCollider> moving;
  for (const PreparedCollider& collider : colliders) moving.emplace_back(collider, step);
  std::vector<Index> entered(vertices.size(), kNone);
  parallel_for(std::ssize(vertices), kVertexGrain, [&](std::int64_t i) {
    const Index v = vertices[i];
    if (!(positions[v].inverse_mass > 0)) return;
    for (std::size_t c = 0; c < moving.size() && entered[i] == kNone; ++c)
      if (!states[v * colliders.size() + c].lets_in(step) &&
          moving[c].is_entered(step, v, kContactGap * max_corrections[v], positions[v]))
        entered[i] = static_cast<Index>(c);
  });
  std::vector<ColliderEntry> entries;
  for (std::size_t i = 0; i < vertices.size(); ++i)
    if (entered[i] != kNone) entries.push_back({vertices[i], entered[i]});
  return entries;
}

}  // namespace selvage
