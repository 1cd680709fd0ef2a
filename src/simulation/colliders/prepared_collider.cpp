#include "simulation/colliders/prepared_collider.h"

#include "selvage/core/error.h"

#include <fmt/format.h>

namespace selvage {

namespace {

void demand(bool good, const std::string& where, std::string_view what, std::string_view remedy) {
  if (!good) throw Error(where, what, remedy);
}

void demand_length(double length, const std::string& where, std::string_view name) {
  demand(length > 0 && std::isfinite(length), where, fmt::format("its {} is {}", name, length),
         "give a number above 0");
}

Vec3 make_unit(const Vec3& direction, const std::string& where, std::string_view name) {
  demand(direction.allFinite() && direction.norm() > 0, where, fmt::format("its {} is 0 or not finite", name),
         "give a direction");
  return direction.normalized();
}

/// The prepared shapes of a collider: one, or the six planes of a BoxContainer.
using PreparedShapes = std::vector<decltype(PreparedCollider::shape)>;

PreparedShapes prepare_shape(const std::string& where, PlaneShape plane) {
  plane.normal = make_unit(plane.normal, where, "normal");
  demand(plane.point.allFinite(), where, "its point is not finite", "");
  return {plane};
}

PreparedShapes prepare_shape(const std::string& where, const BoxContainer& box) {
  demand((box.lower.array() < box.upper.array()).all() && box.lower.allFinite() && box.upper.allFinite(), where,
         "its lower corner is not below its upper one", "give finite corners");
  PreparedShapes walls;
  for (int axis = 0; axis < 3; ++axis) {
    walls.push_back(PlaneShape{box.lower, Vec3::Unit(axis)});
    walls.push_back(PlaneShape{box.upper, -Vec3::Unit(axis)});
  }
  return walls;
}

PreparedShapes prepare_shape(const std::string& where, Bowl bowl) {
  demand_length(bowl.radius, where, "radius");
  demand(bowl.centre.allFinite(), where, "its centre is not finite", "");
  bowl.axis = make_unit(bowl.axis, where, "axis");
  return {bowl};
}

PreparedShapes prepare_shape(const std::string& where, const SphereShape& sphere) {
  demand_length(sphere.radius, where, "radius");
  demand(sphere.centre.allFinite(), where, "its centre is not finite", "");
  return {sphere};
}

PreparedShapes prepare_shape(const std::string& where, CylinderShape cylinder) {
  demand_length(cylinder.radius, where, "radius");
  demand_length(cylinder.length, where, "length");
  demand(cylinder.centre.allFinite(), where, "its centre is not finite", "");
  cylinder.axis = make_unit(cylinder.axis, where, "axis");
  return {PreparedCylinder{cylinder}};
}

PreparedShapes prepare_shape(const std::string& where, const MeshShape& shape) {
  return {MeshCollider(where, shape)};
}

PreparedShapes prepare_shape(const std::string& where, const KeyframedShape& shape) {
  demand(!shape.times.empty() && shape.times.size() == shape.positions.size(), where,
         fmt::format("it has {} key frames and {} times", shape.positions.size(), shape.times.size()),
         "give as many of both, at least one");
  return {MeshCollider(where, {shape.positions.front(), shape.triangles})};
}

/// Part of an element's size: what is thinner than that fits between two colliders.
constexpr double kBuriedGap = 0.05;

/// @param is_in_another  of a point, whether it is in another collider
template <typename IsInAnother>
std::vector<std::uint8_t> buried_of(const MeshCollider& mesh, double gap, IsInAnother&& is_in_another) {
  std::vector<std::uint8_t> buried;
  for (Index t = 0; t < mesh.mesh().triangle_count(); ++t) {
    const auto [a, b, c] = mesh.corners(t);
    const Vec3 behind = gap * (b - a).cross(c - a).normalized(), middle = (a + b + c) / 3;
    buried.push_back(is_in_another(a + behind) && is_in_another(b + behind) && is_in_another(c + behind) &&
                     is_in_another(middle + behind));
  }
  return buried;
}

template <typename IsInAnother>
std::array<std::uint8_t, 2> buried_of(const PreparedCylinder& cylinder, double gap, IsInAnother&& is_in_another) {
  std::array<std::uint8_t, 2> buried{};
  const auto [u, v] = across(cylinder.axis);
  for (int end = 0; end < 2; ++end) {
    const Vec3 middle = cylinder.centre + (end == 0 ? -1 : 1) * (cylinder.length / 2 + gap) * cylinder.axis;
    buried[end] = is_in_another(middle);
    for (const Vec3& rim : {u, v, Vec3(-u), Vec3(-v)})
      buried[end] = buried[end] != 0 && is_in_another(middle + cylinder.radius * rim);
  }
  return buried;
}

}  // namespace

std::vector<PreparedCollider> prepare_colliders(std::span<const Collider> colliders) {
  std::vector<PreparedCollider> prepared;
  for (std::size_t i = 0; i < colliders.size(); ++i) {
    const Collider& collider = colliders[i];
    const std::string where = fmt::format("collider {}", i);
    check_motion(where, collider.motion);
    demand(collider.friction.static_coefficient >= 0 && collider.friction.dynamic_coefficient >= 0, where,
           "its friction is negative", "give numbers of at least 0");
    for (auto& shape : std::visit([&](const auto& given) { return prepare_shape(where, given); }, collider.shape))
      prepared.push_back({std::move(shape), collider.motion, collider.friction, nullptr});
    if (const auto* keyframed = std::get_if<KeyframedShape>(&collider.shape)) {
      PreparedCollider& last = prepared.back();
      last.surface_motion = std::make_unique<SurfaceMotion>(where, *keyframed, std::get<MeshCollider>(last.shape));
      last.set_step(0, 0);
    }
  }
  return prepared;
}

std::vector<PreparedCollider> bury_faces(double element_size, std::vector<PreparedCollider> colliders) {
  const double gap = kBuriedGap * element_size;
  for (PreparedCollider& collider : colliders) {
    if (!collider.is_fixed()) continue;
    const auto is_in_another = [&](const Vec3& point) {
      return std::any_of(colliders.begin(), colliders.end(), [&](const PreparedCollider& other) {
        return &other != &collider && other.is_fixed() &&
               std::visit([&](const auto& shape) { return find_hit(shape, point).has_value(); }, other.shape);
      });
    };
    const auto bury = [&](auto& shape) {
      if constexpr (std::is_same_v<std::decay_t<decltype(shape)>, MeshCollider>)
        shape.set_buried(buried_of(shape, gap, is_in_another));
      if constexpr (std::is_same_v<std::decay_t<decltype(shape)>, PreparedCylinder>)
        shape.is_end_buried = buried_of(shape, gap, is_in_another);
    };
    std::visit(bury, collider.shape);
  }
  return colliders;
}

void check_motion(const std::string& where, const Motion& motion) {
  demand(motion.axis.allFinite() && motion.axis.norm() > 0 && motion.centre.allFinite(), where,
         "the axis or centre of its motion is not finite, or the axis is 0", "");
  for (std::size_t i = 0; i < motion.keyframes.size(); ++i) {
    const Keyframe& keyframe = motion.keyframes[i];
    demand(std::isfinite(keyframe.time) && keyframe.translation.allFinite() && std::isfinite(keyframe.angle), where,
           fmt::format("its key-frame {} is not finite", i), "");
    demand(i == 0 || motion.keyframes[i - 1].time < keyframe.time, where,
           fmt::format("its key-frame {} is not later than the one before", i), "let times ascend");
  }
}

}  // namespace selvage
