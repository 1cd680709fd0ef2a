#include "scene/description/scene_description.h"

namespace selvage {

namespace {

constexpr std::array<std::string_view, 7> kShapes{"plane", "box", "bowl", "sphere", "cylinder", "mesh", "keyframed"};

PlaneShape read_plane(JsonObject& object) {
  return {object.get("point").vector(), object.get("normal").direction()};
}

BoxContainer read_box(JsonObject& object) {
  BoxContainer box{object.get("min").vector(), object.get("max").vector()};
  if (!(box.lower.array() < box.upper.array()).all()) object.value().fail("has no inside", "use a min below the max");
  return box;
}

Bowl read_bowl(JsonObject& object) {
  Bowl bowl;
  bowl.centre = object.get("centre").vector();
  bowl.radius = object.get("radius").number(kPositive);
  if (const auto v = object.find("axis")) bowl.axis = v->direction();
  return bowl;
}

SphereShape read_sphere(JsonObject& object) {
  return {object.get("centre").vector(), object.get("radius").number(kPositive)};
}

CylinderShape read_cylinder(JsonObject& object) {
  return {object.get("centre").vector(), object.get("axis").direction(), object.get("radius").number(kPositive),
          object.get("length").number(kPositive)};
}

std::filesystem::path read_path(const JsonValue& value, const std::filesystem::path& folder) {
  if (value.text().empty() || value.text().find('\0') != std::string::npos)
    value.fail("is no file name", "name a file");
  return folder / value.text();
}

KeyframeSource read_keyframes(const JsonValue& value, const std::filesystem::path& folder) {
  JsonObject object(value);
  KeyframeSource source;
  source.where = value.file() + ": " + value.path();
  constexpr std::array<std::string_view, 2> kKinds{"mesh", "files"};
  const auto [kind, chosen] = object.get_one_of(kKinds);
  if (kind == 0) {
    source.mesh = read_path(chosen, folder);
    source.cache = read_path(object.get("pc2"), folder);
  } else if (chosen.json().is_array()) {
    for (const JsonValue& item : chosen.items()) source.files.push_back(read_path(item, folder));
    if (source.files.empty()) chosen.fail("is empty", "list a file for each key frame");
  } else {
    source.files.push_back(read_path(chosen, folder));
  }
  const auto rate = object.find("frames_per_second"), start = object.find("start");
  if (rate) source.frames_per_second = rate->number(kPositive);
  if (start) source.start = start->any_number();
  if (const auto times = object.find("times")) {
    if (rate || start)
      times->fail("stands beside 'frames_per_second' or 'start'", "give the times of all key frames, or a rate");
    for (const JsonValue& time : times->items()) source.times.push_back(time.any_number());
    if (source.times.empty()) times->fail("is empty", "give a time for each key frame");
  }
  object.refuse_others();
  return source;
}

}  // namespace

ColliderDescription read_collider(const JsonValue& value, const std::filesystem::path& folder) {
  JsonObject object(value);
  ColliderDescription result;
  const auto [kind, chosen] = object.get_one_of(kShapes);
  if (const auto v = object.find("static_friction"))
    result.collider.friction.static_coefficient = v->number(kNotNegative);
  if (const auto v = object.find("dynamic_friction"))
    result.collider.friction.dynamic_coefficient = v->number(kNotNegative);
  if (const auto v = object.find("motion")) result.collider.motion = read_motion(*v);
  if (kShapes[kind] == "mesh" || kShapes[kind] == "keyframed") {
    if (kShapes[kind] == "mesh") {
      result.mesh = read_mesh_source(chosen, folder);
    } else {
      result.keyframes = read_keyframes(chosen, folder);
    }
    result.place = read_placement(object);
    object.refuse_others();
    return result;
  }
  object.refuse_others();
  JsonObject shape(chosen);
  auto& solid = result.collider.shape;
  if (kShapes[kind] == "plane") solid = read_plane(shape);
  if (kShapes[kind] == "box") solid = read_box(shape);
  if (kShapes[kind] == "bowl") solid = read_bowl(shape);
  if (kShapes[kind] == "sphere") solid = read_sphere(shape);
  if (kShapes[kind] == "cylinder") solid = read_cylinder(shape);
  shape.refuse_others();
  return result;
}

}  // namespace selvage
