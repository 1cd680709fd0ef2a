#include "scene/files/scene_json.h"
#include "core/json.h"

#include <fmt/format.h>

namespace selvage {

namespace {

Json json_of(const Vec3& v) {
  return {v[0], v[1], v[2]};
}

/// Infinite numbers, which JSON does not have, mean that there is no limit.
Json json_of_limit(double limit) {
  return limit < std::numeric_limits<double>::infinity() ? Json(limit) : Json(nullptr);
}

const char* name_of(DetectionMode mode) {
  switch (mode) {
    case DetectionMode::kOff:
      return "off";
    case DetectionMode::kCcd:
      return "ccd";
    case DetectionMode::kDcd:
      return "dcd";
    default:
      return "hybrid";
  }
}

Json json_of(const Material& material) {
  Json json{{"kind", material.kind == MaterialKind::kNeoHookean ? "neo-hookean" : "mass-spring"},
            {"density", material.density}};
  if (material.kind == MaterialKind::kNeoHookean) {
    json["youngs_modulus"] = material.youngs_modulus;
    json["poisson_ratio"] = material.poisson_ratio;
  } else {
    json["edge_compliance"] = material.edge_compliance;
    json["volume_compliance"] = material.volume_compliance;
  }
  json["damping"] = material.damping;
  return json;
}

Json json_of(const ClothMaterial& cloth) {
  Json json{{"kind", "cloth"}, {"density", cloth.density}};
  if (cloth.kind == ClothKind::kIsotropic) {
    json["stiffness"] = cloth.stiffness;
    json["poisson_ratio"] = cloth.poisson_ratio;
  } else {
    json["warp"] = cloth.warp;
    json["weft"] = cloth.weft;
    json["shear"] = cloth.shear;
    json["warp_direction"] = json_of(cloth.warp_direction);
  }
  json["bending"] = cloth.bending;
  json["thickness"] = cloth.thickness;
  json["damping"] = cloth.damping;
  if (cloth.bending_damping) json["bending_damping"] = *cloth.bending_damping;
  return json;
}

Json json_of(const Body& body) {
  Json json{{"name", body.name}, {"vertices", body.vertex_count}, {"elements", body.element_count}};
  if (body.is_cloth()) json["triangles"] = body.triangle_count;
  json["material"] = body.is_cloth() ? json_of(body.cloth) : json_of(body.material);
  return json;
}

struct ShapeJson {
  Json operator()(const PlaneShape& s) const {
    return {{"kind", "plane"}, {"point", json_of(s.point)}, {"normal", json_of(s.normal)}};
  }
  Json operator()(const BoxContainer& s) const {
    return {{"kind", "box"}, {"min", json_of(s.lower)}, {"max", json_of(s.upper)}};
  }
  Json operator()(const Bowl& s) const {
    return {{"kind", "bowl"}, {"centre", json_of(s.centre)}, {"axis", json_of(s.axis)}, {"radius", s.radius}};
  }
  Json operator()(const SphereShape& s) const {
    return {{"kind", "sphere"}, {"centre", json_of(s.centre)}, {"radius", s.radius}};
  }
  Json operator()(const CylinderShape& s) const {
    return {{"kind", "cylinder"},
            {"centre", json_of(s.centre)},
            {"axis", json_of(s.axis)},
            {"radius", s.radius},
            {"length", s.length}};
  }
  Json operator()(const MeshShape& s) const {
    Json json{{"kind", "mesh"}, {"positions", Json::array()}, {"triangles", Json::array()}};
    for (const Vec3& p : s.positions) json["positions"].push_back(json_of(p));
    for (const auto& t : s.triangles) json["triangles"].push_back(t);
    return json;
  }
  Json operator()(const KeyframedShape& s) const {
    Json json{{"kind", "keyframed"}, {"times", s.times}, {"triangles", Json::array()}};
    for (const auto& t : s.triangles) json["triangles"].push_back(t);
    return json;
  }
};

Json json_of(const Collider& collider) {
  Json json = std::visit(ShapeJson{}, collider.shape);
  json["static_friction"] = collider.friction.static_coefficient;
  json["dynamic_friction"] = collider.friction.dynamic_coefficient;
  if (collider.motion.keyframes.empty()) return json;
  Json keyframes = Json::array();
  for (const Keyframe& key : collider.motion.keyframes)
    keyframes.push_back({{"time", key.time}, {"translate", json_of(key.translation)}, {"angle", key.angle}});
  json["motion"] = {{"axis", json_of(collider.motion.axis)},
                    {"centre", json_of(collider.motion.centre)},
                    {"keyframes", std::move(keyframes)}};
  return json;
}

}  // namespace

std::string keyframes_name(std::size_t collider) {
  return fmt::format("collider_{}.pc2", collider);
}

std::string print_scene(const Scene& scene) {
  const XpbdOptions& options = scene.options;
  Json json{{"schema", 1}, {"kind", "scene"}, {"scene", scene.name}, {"scale", scene.scale}};
  json["frames_per_second"] = scene.frames_per_second;
  json["substeps"] = scene.substeps;
  json["time_step"] = options.time_step;
  json["iterations"] = options.iterations;
  json["gravity"] = json_of(options.gravity);
  json["damping"] = options.velocity_damping;
  json["deformation_damping"] = options.deformation_damping;
  json["sleep_speed"] = options.sleep_speed;
  json["max_speed"] = json_of_limit(options.max_speed);
  json["contact"] = {{"mode", name_of(options.contact.mode)},
                     {"static_friction", options.friction.static_coefficient},
                     {"dynamic_friction", options.friction.dynamic_coefficient},
                     {"hold_back", options.contact.hold_back},
                     {"guarantee", options.contact.guarantee},
                     {"from_frame", scene.contact_from_frame}};
  json["bodies"] = Json::array();
  for (const Body& body : scene.model.bodies) json["bodies"].push_back(json_of(body));
  json["colliders"] = Json::array();
  for (std::size_t c = 0; c < scene.colliders.size(); ++c) {
    json["colliders"].push_back(json_of(scene.colliders[c]));
    if (std::holds_alternative<KeyframedShape>(scene.colliders[c].shape))
      json["colliders"].back()["pc2"] = keyframes_name(c);
  }
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace selvage
