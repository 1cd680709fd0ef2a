#include "scene/reading/stored_colliders.h"

#include "core/json.h"
#include "scene/files/scene_json.h"
#include "selvage/core/error.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

std::vector<Collider> all_kinds() {
  std::vector<Collider> colliders{
      {PlaneShape{{0, 0, 1}, {0, 1, 1}}},
      {BoxContainer{{-1, -2, -3}, {1, 2, 30}}},
      {Bowl{{1, 2, 3}, {0, 0, 1}, 1.5}},
      {SphereShape{{0.1, 0.2, 0.3}, 2}},
      {CylinderShape{{1, 1, 1}, {0, 1, 0}, 0.5, 3}},
      {MeshShape{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}}}};
  colliders[3].motion = {{{0, {0, 0, 0}, 0}, {2, {0, 0, 1}, 1.25}}, {0, 1, 0}, {1, 0, 0}};
  colliders[4].friction = {0.7, 0.6};
  return colliders;
}

TEST(StoredColliders, AreThoseThatTheSceneHad) {
  Scene scene;
  scene.colliders = all_kinds();
  scene.options.gravity = {0, -9, 0};
  const std::string text = print_scene(scene);
  scene.colliders = read_stored_colliders(Json::parse(text), "scene.json");
  EXPECT_EQ(print_scene(scene), text);
  EXPECT_EQ(read_stored_gravity(Json::parse(text), "scene.json"), Vec3(0, -9, 0));
  EXPECT_TRUE(read_stored_colliders(nullptr, "scene.json").empty());
}

TEST(StoredColliders, DamageIsNamedByItsPlace) {
  Scene scene;
  scene.colliders = all_kinds();
  const Json whole = Json::parse(print_scene(scene));
  const auto refused = [&](const char* pointer, const Json& value, const std::string& words) {
    Json broken = whole;
    broken[Json::json_pointer(pointer)] = value;
    try {
      read_stored_colliders(broken, "scene.json");
      ADD_FAILURE() << pointer;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  };
  refused("/colliders", 3, "scene.colliders is no list");
  refused("/colliders/0/kind", "cone", "unknown kind 'cone'");
  refused("/colliders/0/normal", {1, 2}, "scene.colliders[0].normal is no list of three numbers");
  refused("/colliders/2/radius", "1", "scene.colliders[2].radius is no number");
  refused("/colliders/5/triangles/1", {0, 1, 4}, "no triangle of vertices");
  refused("/colliders/3/motion", Json::array(), "scene.colliders[3].motion has no axis");
  refused("/colliders/4", nullptr, "scene.colliders[4] has no kind");
}

}  // namespace
}  // namespace selvage
