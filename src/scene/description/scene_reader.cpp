#include "scene/description/replaced_values.h"
#include "scene/description/scene_description.h"
#include "selvage/core/error.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <limits>
#include <map>
#include <numbers>

namespace selvage {

namespace {

/// Of scenes that say nothing: what has fallen comes to rest in seconds, and bounces all the same [1/s], [s].
constexpr double kDeformationDamping = 1, kMaterialDamping = 0.002;
/// Of scenes that say nothing: 7 cm/s for a body of one metre.
constexpr double kSleepSpeed = 0.015;
constexpr double kForever = std::numeric_limits<double>::infinity();

Keyframe read_keyframe(const JsonValue& value) {
  JsonObject object(value);
  Keyframe keyframe{object.get("time").number(kNotNegative), Vec3::Zero(), 0};
  if (const auto v = object.find("translate")) keyframe.translation = v->vector();
  if (const auto v = object.find("degrees")) keyframe.angle = v->any_number() * std::numbers::pi / 180;
  object.refuse_others();
  return keyframe;
}

HandleDescription read_handle(const JsonValue& value) {
  JsonObject object(value);
  HandleDescription handle{read_region(object.get("region")), read_motion(object.get("motion")), kForever};
  if (const auto v = object.find("release")) handle.release_time = v->number(kNotNegative);
  object.refuse_others();
  return handle;
}

BodyDescription read_body(const JsonValue& value, std::size_t number, const std::filesystem::path& folder,
                          const std::map<std::string, BodyMaterial>& materials) {
  JsonObject object(value);
  BodyDescription body;
  body.where = value.file() + ": " + value.path();
  body.name = fmt::format("body{}", number);
  if (const auto v = object.find("name")) body.name = v->text();
  body.mesh = read_mesh_source(object.get("mesh"), folder);
  if (const auto v = object.find("rest")) body.rest = read_mesh_source(*v, folder);
  if (const auto v = object.find("poses")) body.poses = read_poses(*v);
  body.place = read_placement(object);
  body.instances.emplace_back();
  if (const auto v = object.find("instances")) body.instances = read_instances(*v);
  if (const auto v = object.find("material")) body.material = find_material(*v, materials);
  if (const auto v = object.find("velocity")) body.velocity = v->vector();
  if (const auto v = object.find("pinned"))
    for (const JsonValue& item : v->items()) body.handles.push_back({read_region(item), {}, kForever});
  if (const auto v = object.find("handles"))
    for (const JsonValue& item : v->items()) body.handles.push_back(read_handle(item));
  object.refuse_others();
  return body;
}

constexpr std::array<std::string_view, 3> kSolvers{"xpbd", "newton", "vbd"};

/// @param solver  whose values stand under `key`
std::optional<JsonValue> find_of_solver(JsonObject& object, std::string_view key, SolverKind solver,
                                        const SceneDescription& scene) {
  const auto value = object.find(key);
  if (value && scene.solver != solver)
    value->fail(fmt::format("is not for the solver {}", kSolvers[static_cast<std::size_t>(scene.solver)]),
                fmt::format("leave it out, or set \"solver\": \"{}\"", kSolvers[static_cast<std::size_t>(solver)]));
  return value;
}

void read_minimiser(JsonObject& object, SceneDescription& scene) {
  if (const auto v = object.find("solver")) scene.solver = static_cast<SolverKind>(v->choice(kSolvers));
  if (const auto v = find_of_solver(object, "newton", SolverKind::kNewton, scene)) {
    constexpr std::array<std::string_view, 3> kLinear{"by-size", "conjugate-gradients", "direct"};
    JsonObject newton(*v);
    if (const auto w = newton.find("steps")) scene.newton.newton_steps = static_cast<int>(w->integer(1, 10'000));
    if (const auto w = newton.find("tolerance")) scene.newton.tolerance = w->number(kNotNegative);
    if (const auto w = newton.find("linear_solver"))
      scene.newton.linear_solver = static_cast<LinearSolver>(w->choice(kLinear));
    newton.refuse_others();
  }
  if (const auto v = find_of_solver(object, "residual", SolverKind::kVbd, scene))
    scene.vbd_residual = v->number(kNotNegative);
}

/// The implicit solvers need some compliance.
void refuse_rigid_springs(const SceneDescription& scene) {
  if (scene.solver == SolverKind::kXpbd) return;
  for (const BodyDescription& body : scene.bodies)
    if (const Material& material = body.material.solid;
        material.kind == MaterialKind::kMassSpring && !(material.edge_compliance > 0 && material.volume_compliance > 0))
      throw Error(body.where, "has a material of rigid springs, or of rigid volume",
                  "give edge_compliance and volume_compliance above 0, or use the solver xpbd");
}

void read_solver(JsonObject& object, SceneDescription& scene) {
  scene.options.deformation_damping = kDeformationDamping;
  scene.frames = 60;
  if (const auto v = object.find("frames")) scene.frames = static_cast<int>(v->integer(0, 1'000'000));
  if (const auto v = object.find("frames_per_second"))
    scene.frames_per_second = static_cast<int>(v->integer(1, 100'000));
  if (const auto v = object.find("substeps")) scene.substeps = static_cast<int>(v->integer(1, 100'000));
  read_minimiser(object, scene);
  if (scene.solver == SolverKind::kVbd) scene.options.iterations = VbdOptions().iterations;
  if (const auto v = object.find("iterations")) scene.options.iterations = static_cast<int>(v->integer(1, 10'000));
  if (const auto v = object.find("gravity")) scene.options.gravity = v->vector();
  if (const auto v = object.find("damping")) scene.options.velocity_damping = v->number(kNotNegative);
  if (const auto v = object.find("deformation_damping")) scene.options.deformation_damping = v->number(kNotNegative);
  scene.options.sleep_speed = kSleepSpeed;
  if (const auto v = object.find("sleep_speed")) scene.options.sleep_speed = v->number(kNotNegative);
  if (const auto v = object.find("max_speed")) scene.options.max_speed = v->number(kPositive);
  if (const auto v = object.find("contact")) read_contact(*v, scene);
  constexpr std::array<std::string_view, 2> kAnswers{"refuse", "allow"};
  if (const auto v = object.find("start_outside")) scene.allow_start_outside = v->choice(kAnswers) == 1;
  constexpr std::array<std::string_view, 2> kWays{"resolve", "simulate"};
  if (const auto v = object.find("start_tangled")) scene.resolves_tangled_start = v->choice(kWays) == 0;
}

/// Leaves out folders of files: their contents are part of a run, their places are not.
void forget_folders(Json& json) {
  if (json.is_array()) std::for_each(json.begin(), json.end(), forget_folders);
  if (!json.is_object()) return;
  for (auto& [key, value] : json.items()) {
    const bool names_file = key == "file" || key == "files" || key == "mesh" || key == "pc2";
    const auto forget = [](Json& name) {
      if (name.is_string()) name = std::filesystem::path(name.get<std::string>()).filename().string();
    };
    if (names_file && value.is_array()) std::for_each(value.begin(), value.end(), forget);
    if (names_file) forget(value);
    forget_folders(value);
  }
}

/// The document without what does not change a run.
std::string canonical_text(Json document) {
  for (const char* key : {"frames", "description", "$schema", "start_outside"}) document.erase(key);
  forget_folders(document);
  return nlohmann::json(document).dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
}

/// Values that are written at the top by mistake.
void refuse_misplaced(const JsonValue& scene) {
  constexpr const char* kBody = "a body, as in {\"bodies\": [{...}]}";
  constexpr const char* kContact = "\"contact\": {...}";
  constexpr std::array<std::pair<const char*, const char*>, 9> kPlaces{{{"mesh", kBody},
                                                                        {"material", kBody},
                                                                        {"velocity", kBody},
                                                                        {"pinned", kBody},
                                                                        {"handles", kBody},
                                                                        {"mode", kContact},
                                                                        {"guarantee", kContact},
                                                                        {"static_friction", kContact},
                                                                        {"dynamic_friction", kContact}}};
  for (const auto& [key, place] : kPlaces)
    if (scene.json().contains(key)) scene.member(key).fail("is not known here", fmt::format("write it in {}", place));
}

}  // namespace

Motion read_motion(const JsonValue& value) {
  JsonObject object(value);
  Motion motion;
  motion.axis = Vec3::UnitZ();
  motion.centre = Vec3::Zero();
  if (const auto v = object.find("axis")) motion.axis = v->direction();
  if (const auto v = object.find("centre")) motion.centre = v->vector();
  const JsonValue keyframes = object.get("keyframes");
  for (const JsonValue& item : keyframes.items()) {
    motion.keyframes.push_back(read_keyframe(item));
    const std::size_t last = motion.keyframes.size() - 1;
    if (last > 0 && !(motion.keyframes[last].time > motion.keyframes[last - 1].time))
      item.member("time").fail("is not after the keyframe before", "list keyframes in the order of time");
  }
  if (motion.keyframes.empty()) keyframes.fail("is empty", "give at least one keyframe");
  object.refuse_others();
  return motion;
}

void read_contact(const JsonValue& value, SceneDescription& scene) {
  JsonObject object(value);
  ContactOptions& contact = scene.options.contact;
  constexpr std::array<std::string_view, 4> kModes{"none", "ccd", "dcd", "hybrid"};
  constexpr std::array<std::string_view, 3> kRules{"shortest-path", "rest-pose", "euclidean"};
  if (const auto v = object.find("mode")) contact.mode = static_cast<DetectionMode>(v->choice(kModes));
  if (const auto v = object.find("rule")) contact.rule = static_cast<ClosestPointRule>(v->choice(kRules));
  if (const auto v = object.find("edges")) contact.detect_edges = v->boolean();
  if (const auto v = object.find("hold_back")) contact.hold_back = v->boolean();
  if (const auto v = object.find("interior_points")) contact.interior_points = v->boolean();
  if (const auto v = object.find("static_friction"))
    scene.options.friction.static_coefficient = v->number(kNotNegative);
  if (const auto v = object.find("dynamic_friction"))
    scene.options.friction.dynamic_coefficient = v->number(kNotNegative);
  if (const auto v = object.find("from_frame")) scene.contact_from_frame = v->integer(0, 1'000'000);
  if (const auto v = object.find("guarantee")) {
    contact.guarantee = v->boolean();
    const bool is_whole =
        contact.splits() && contact.detect_edges && contact.hold_back && scene.contact_from_frame == 0;
    if (contact.guarantee && !is_whole)
      v->fail("needs contact of mode 'hybrid' with 'edges' and 'hold_back', without 'interior_points' and 'from_frame'",
              "leave these out, or set it to false");
  }
  object.refuse_others();
}

SceneDescription describe_scene(std::string_view text, const std::filesystem::path& file, std::string_view scale,
                                std::span<const std::string> changes) {
  Json document = choose_scale(parse_json(text, file.string()), file.string(), scale);
  for (const std::string& change : changes) apply_change(document, change);
  JsonObject object(JsonValue(document, file.string()));
  SceneDescription scene;
  object.get("selvage_scene").integer(1, 1);
  for (const char* key : {"description", "$schema"})
    if (const auto v = object.find(key)) v->text();
  object.find("scales");  // choose_scale() has taken it out
  read_solver(object, scene);
  std::map<std::string, BodyMaterial> materials;
  if (const auto v = object.find("materials")) {
    if (!v->json().is_object()) v->fail("is no object", "use {\"name\": {...}, ...}");
    for (const auto& [name, ignored] : v->json().items()) materials.emplace(name, read_material(v->member(name)));
  }
  const JsonValue bodies = object.get("bodies");
  for (const JsonValue& item : bodies.items())
    scene.bodies.push_back(read_body(item, scene.bodies.size(), file.parent_path(), materials));
  if (scene.bodies.empty()) bodies.fail("is empty", "give at least one body");
  if (const auto v = object.find("colliders"))
    for (const JsonValue& item : v->items()) scene.colliders.push_back(read_collider(item, file.parent_path()));
  refuse_misplaced(JsonValue(document, file.string()));
  object.refuse_others();
  refuse_rigid_springs(scene);
  // The implicit solvers damp enough by themselves.
  const double damping = scene.solver == SolverKind::kXpbd ? kMaterialDamping : 0;
  for (BodyDescription& body : scene.bodies)
    for (double* own : {&body.material.solid.damping, &body.material.cloth.damping})
      if (*own == kNotGiven) *own = damping;
  scene.canonical = canonical_text(document);
  return scene;
}

}  // namespace selvage
