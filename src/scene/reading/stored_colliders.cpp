#include "scene/reading/stored_colliders.h"

#include "core/json.h"
#include "selvage/core/error.h"
#include "selvage/io/point_cache.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace selvage {

namespace {

/// A part of the file, with the place of it in errors.
class Reader {
 public:
  Reader(const Json& json, std::string file, std::string place)
      : json_(json), file_(std::move(file)), place_(std::move(place)) {}

  [[noreturn]] void refuse(std::string_view what) const {
    throw Error(file_, fmt::format("{} {}", place_, what), "run the scene anew");
  }

  Reader at(const char* key) const {
    if (!json_.is_object() || !json_.contains(key)) refuse(fmt::format("has no {}", key));
    return {json_[key], file_, fmt::format("{}.{}", place_, key)};
  }

  std::vector<Reader> items() const {
    if (!json_.is_array()) refuse("is no list");
    std::vector<Reader> result;
    for (std::size_t i = 0; i < json_.size(); ++i)
      result.push_back({json_[i], file_, fmt::format("{}[{}]", place_, i)});
    return result;
  }

  double number() const {
    if (!json_.is_number()) refuse("is no number");
    return json_.get<double>();
  }

  Vec3 vector() const {
    if (!json_.is_array() || json_.size() != 3 ||
        !std::all_of(json_.begin(), json_.end(), [](const Json& x) { return x.is_number(); }))
      refuse("is no list of three numbers");
    return {json_[0].get<double>(), json_[1].get<double>(), json_[2].get<double>()};
  }

  std::string text() const {
    if (!json_.is_string()) refuse("is no text");
    return json_;
  }

  VertexTuple<3> triangle(std::size_t vertices) const {
    VertexTuple<3> result{};
    if (!json_.is_array() || json_.size() != 3) refuse("is no triangle");
    for (std::size_t i = 0; i < 3; ++i) {
      if (!json_[i].is_number_integer() || json_[i] < 0 || json_[i] >= vertices) refuse("is no triangle of vertices");
      result[i] = json_[i];
    }
    return result;
  }

  bool has(const char* key) const { return json_.is_object() && json_.contains(key); }

 private:
  const Json& json_;
  std::string file_, place_;
};

MeshShape read_mesh_shape(const Reader& json) {
  MeshShape shape;
  for (const Reader& position : json.at("positions").items()) shape.positions.push_back(position.vector());
  for (const Reader& triangle : json.at("triangles").items())
    shape.triangles.push_back(triangle.triangle(shape.positions.size()));
  return shape;
}

KeyframedShape read_keyframed_shape(const Reader& json, const std::filesystem::path& folder) {
  const std::string name = json.at("pc2").text();
  if (std::filesystem::path(name).filename() != name) json.refuse("names a file in another folder");
  KeyframedShape shape;
  shape.positions = read_point_cache(folder / name).samples;
  for (const Reader& time : json.at("times").items()) shape.times.push_back(time.number());
  if (shape.times.size() != shape.positions.size()) json.refuse("has not as many times as its file has key frames");
  for (const Reader& triangle : json.at("triangles").items())
    shape.triangles.push_back(triangle.triangle(shape.positions[0].size()));
  return shape;
}

/// @param folder  of the file
Collider read_collider(const Reader& json, const std::filesystem::path& folder) {
  Collider collider;
  const std::string kind = json.at("kind").text();
  if (kind == "plane") {
    collider.shape = PlaneShape{json.at("point").vector(), json.at("normal").vector()};
  } else if (kind == "box") {
    collider.shape = BoxContainer{json.at("min").vector(), json.at("max").vector()};
  } else if (kind == "bowl") {
    collider.shape = Bowl{json.at("centre").vector(), json.at("axis").vector(), json.at("radius").number()};
  } else if (kind == "sphere") {
    collider.shape = SphereShape{json.at("centre").vector(), json.at("radius").number()};
  } else if (kind == "cylinder") {
    collider.shape = CylinderShape{json.at("centre").vector(), json.at("axis").vector(), json.at("radius").number(),
                                   json.at("length").number()};
  } else if (kind == "mesh") {
    collider.shape = read_mesh_shape(json);
  } else if (kind == "keyframed") {
    collider.shape = read_keyframed_shape(json, folder);
  } else {
    json.refuse(fmt::format("is of the unknown kind '{}'", kind));
  }
  collider.friction = {json.at("static_friction").number(), json.at("dynamic_friction").number()};
  if (!json.has("motion")) return collider;
  const Reader motion = json.at("motion");
  collider.motion.axis = motion.at("axis").vector();
  collider.motion.centre = motion.at("centre").vector();
  for (const Reader& key : motion.at("keyframes").items())
    collider.motion.keyframes.push_back(
        {key.at("time").number(), key.at("translate").vector(), key.at("angle").number()});
  return collider;
}

}  // namespace

std::vector<Collider> read_stored_colliders(const Json& scene, const std::string& file) {
  std::vector<Collider> colliders;
  if (scene.is_null()) return colliders;
  for (const Reader& json : Reader(scene, file, "scene").at("colliders").items())
    colliders.push_back(read_collider(json, std::filesystem::path(file).parent_path()));
  return colliders;
}

Vec3 read_stored_gravity(const Json& scene, const std::string& file) {
  return scene.is_null() ? Vec3::Zero() : Reader(scene, file, "scene").at("gravity").vector();
}

}  // namespace selvage
