#include "scene/description/scene_description.h"

#include "selvage/core/error.h"
#include "selvage/scene/scene.h"

#include <gtest/gtest.h>

#include <numbers>

namespace selvage {
namespace {

/// A scene that uses everything.
const char* const kWhole = R"({
  "selvage_scene": 1,
  "description": "all that a scene may hold",
  "frames": 3, "frames_per_second": 50, "substeps": 4, "iterations": 2,
  "gravity": [0, 0, -9], "damping": 0.5, "max_speed": 20,
  "contact": {"mode": "dcd", "rule": "rest-pose", "edges": false, "interior_points": true, "from_frame": 2,
              "static_friction": 0.4, "dynamic_friction": 0.1},
  "materials": {"rubber": {"density": 900, "youngs_modulus": 2e5, "poisson_ratio": 0.3, "damping": 0.01},
                "springs": {"kind": "mass-spring", "edge_compliance": 1e-4, "volume_compliance": 1e-9},
                "soft": {"hydrostatic_compliance": 1e-5, "deviatoric_compliance": 2e-5}},
  "bodies": [
    {"name": "block", "mesh": {"shape": "box", "size": [1, 1, 1], "cell": 0.5}, "material": "rubber",
     "rest": {"shape": "box", "size": [1, 1, 1], "cell": 0.5},
     "poses": [{"matrix": [[1, 0, 0.1], [0, 1, 0], [0, 0, 2]]}, {"pose": "bend", "axis": "z", "turns": 0.05}],
     "scale": 2, "rotate": {"axis": [0, 0, 2], "degrees": 90}, "translate": [5, 0, 0],
     "pinned": [{"plane": {"point": [0, 0, 0.1], "normal": [0, 0, -1]}}],
     "handles": [{"region": {"box": {"min": [0, 0, 0.9], "max": [1, 1, 1.1]}}, "release": 0.5,
                  "motion": {"axis": [0, 0, 1], "centre": [1, 2, 3],
                             "keyframes": [{"time": 0}, {"time": 1, "translate": [0, 0, 1], "degrees": 180}]}}]},
    {"mesh": {"shape": "box", "size": [1, 1, 1], "cell": 1}, "scale": [1, 2, 3], "velocity": [1, 2, 3],
     "material": {"density": 100},
     "instances": {"grid": {"counts": [2, 1, 3], "spacing": [10, 10, 10]},
                   "jitter": {"translate": 0.1, "degrees": 20, "seed": 5}}}
  ],
  "colliders": [
    {"plane": {"point": [0, 0, -1], "normal": [0, 0, 3]}, "static_friction": 0.7, "dynamic_friction": 0.6},
    {"box": {"min": [-9, -9, -9], "max": [90, 90, 90]}},
    {"bowl": {"centre": [0, 0, 0], "radius": 50, "axis": [0, 0, 1]}},
    {"sphere": {"centre": [0, 0, -9], "radius": 1}, "motion": {"keyframes": [{"time": 0.5, "translate": [1, 0, 0]}]}},
    {"cylinder": {"centre": [0, 0, -9], "axis": [1, 0, 0], "radius": 1, "length": 2}},
    {"mesh": {"shape": "ball", "radius": 1}, "scale": 0.5, "translate": [0, 0, -20]}
  ],
  "scales": {"paper": {"/bodies/0/mesh/cell": 0.25, "/bodies/0/rest/cell": 0.25, "/substeps": 50, "/contact/mode": "ccd"}}
})";

constexpr const char* kFile = "folder/whole.json";

/// The scene with one value replaced, or, where the value is null, removed.
std::string patched(const std::string& place, const std::string& value) {
  Json json = Json::parse(kWhole);
  const Json::json_pointer pointer(place);
  if (value.empty())
    json.at(pointer.parent_pointer()).erase(pointer.back());
  else
    json[pointer] = Json::parse(value);
  return json.dump();
}

std::string refusal(const std::string& text, std::string_view scale = {}) {
  try {
    describe_scene(text, kFile, scale);
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

TEST(SceneReader, ReadsEveryKey) {
  const SceneDescription scene = describe_scene(kWhole, kFile, "");
  EXPECT_EQ(scene.frames, 3);
  EXPECT_EQ(scene.substeps, 4);
  EXPECT_EQ(scene.options.iterations, 2);
  EXPECT_EQ(scene.options.gravity, Vec3(0, 0, -9));
  EXPECT_EQ(scene.options.velocity_damping, 0.5);
  EXPECT_EQ(scene.options.max_speed, 20);
  EXPECT_EQ(scene.options.friction.static_coefficient, 0.4);
  EXPECT_EQ(scene.options.friction.dynamic_coefficient, 0.1);
  EXPECT_EQ(scene.options.contact.mode, DetectionMode::kDcd);
  EXPECT_EQ(scene.options.contact.rule, ClosestPointRule::kRestPose);
  EXPECT_FALSE(scene.options.contact.detect_edges);
  EXPECT_TRUE(scene.options.contact.interior_points);
  EXPECT_EQ(scene.contact_from_frame, 2);
  ASSERT_EQ(scene.bodies.size(), 2u);
  EXPECT_EQ(scene.bodies[0].name, "block");
  EXPECT_EQ(scene.bodies[1].name, "body1");
  EXPECT_EQ(scene.bodies[0].material.solid.density, 900);
  EXPECT_EQ(scene.bodies[0].poses.size(), 2u);
  ASSERT_EQ(scene.bodies[0].handles.size(), 2u);
  EXPECT_TRUE(scene.bodies[0].handles[0].motion.keyframes.empty());
  EXPECT_NEAR(scene.bodies[0].handles[1].motion.keyframes[1].angle, std::numbers::pi, 1e-15);
  EXPECT_EQ(scene.bodies[0].handles[1].release_time, 0.5);
  EXPECT_EQ(scene.bodies[1].instances.size(), 6u);
  ASSERT_EQ(scene.colliders.size(), 6u);
  EXPECT_EQ(std::get<PlaneShape>(scene.colliders[0].collider.shape).normal, Vec3(0, 0, 1));
  EXPECT_EQ(scene.colliders[0].collider.friction.static_coefficient, 0.7);
  EXPECT_TRUE(scene.colliders[5].mesh.has_value());
}

TEST(SceneReader, ScalesReplaceValues) {
  const SceneDescription scene = describe_scene(kWhole, kFile, "paper");
  EXPECT_EQ(scene.bodies[0].mesh.options.cell, 0.25);
  EXPECT_EQ(scene.substeps, 50);
  EXPECT_EQ(scene.options.contact.mode, DetectionMode::kCcd);
  EXPECT_NE(scene.canonical, describe_scene(kWhole, kFile, "").canonical);
}

TEST(SceneReader, TakesMoreStepsWhereDensitiesDifferAndDampsWhatSwings) {
  const auto text = [](const std::string& densities, const std::string& more) {
    std::string bodies;
    for (const char density : densities)
      bodies +=
          fmt::format(R"({}{{"mesh": {{"shape": "box"}}, "material": {{"density": {}}}}})", bodies.empty() ? "" : ", ",
                      density == 'l'   ? 10
                      : density == 'm' ? 50
                                       : 5000);
    return fmt::format(R"({{"selvage_scene": 1, "bodies": [{}]{}}})", bodies, more);
  };
  // Cubes of 1 m that are 6.4 edges across: 8.5 * (100 / 5)^0.7 * 6.4 / 3.3 * sqrt(0.4), rounded up.
  EXPECT_EQ(parse_scene(text("mh", ""), kFile).substeps, 85);
  EXPECT_EQ(parse_scene(text("l", ""), kFile).substeps, 5);
  EXPECT_EQ(parse_scene(text("hl", ""), kFile).substeps, 200);
  EXPECT_EQ(parse_scene(text("hl", R"(, "gravity": [0, 0, 0])"), kFile).substeps, 50);
  EXPECT_EQ(parse_scene(text("hl", R"(, "frames_per_second": 600)"), kFile).substeps, 50);
  EXPECT_EQ(parse_scene(text("hl", R"(, "substeps": 7)"), kFile).substeps, 7);
  EXPECT_EQ(parse_scene(text("hl", R"(, "solver": "newton")"), kFile).substeps, 5);
  const std::string given = R"(, "substeps": 7, "frames_per_second": 50)";
  EXPECT_EQ(parse_scene(text("hl", given), kFile).options.time_step, 1.0 / (50 * 7));
  EXPECT_EQ(parse_scene(text("mh", ""), kFile).options.time_step, 1.0 / (60 * 85));
  const SceneDescription scene = describe_scene(text("mh", ""), kFile, "");
  EXPECT_EQ(scene.options.deformation_damping, 1);
  EXPECT_EQ(scene.bodies[0].material.solid.damping, 0.002);
  EXPECT_EQ(describe_scene(text("l", R"(, "deformation_damping": 0)"), kFile, "").options.deformation_damping, 0);
  EXPECT_EQ(describe_scene(text("l", R"(, "solver": "vbd")"), kFile, "").bodies[0].material.solid.damping, 0);
  const std::string soft = R"({"selvage_scene": 1, "bodies": [{"mesh": {"shape": "box"}}]})";
  EXPECT_EQ(describe_scene(soft, kFile, "").bodies[0].material.solid.damping, 0.002);
}

TEST(SceneReader, CompliancesAreModuli) {
  const std::string scene = patched("/bodies/0/material", "\"soft\"");
  const Material material = describe_scene(scene, kFile, "").bodies[0].material.solid;
  const double e = material.youngs_modulus, nu = material.poisson_ratio;
  EXPECT_NEAR(e * nu / ((1 + nu) * (1 - 2 * nu)), 1e5, 1e-6);
  EXPECT_NEAR(e / (2 * (1 + nu)), 5e4, 1e-6);
}

struct WrongValue {
  const char* place;
  const char* value;  ///< as JSON; empty: removed
  std::vector<std::string> words;
};

TEST(SceneReader, NamesThePlaceOfEachErrorAndTheAllowedValues) {
  const std::vector<WrongValue> cases{
      {"/selvage_scene", "2", {"selvage_scene", "2 is out of range", "from 1 to 1"}},
      {"/selvage_scene", "", {"has no 'selvage_scene'"}},
      {"/frames", "-1", {"whole.json: frames: -1 is out of range", "from 0 to 1000000"}},
      {"/frames", "2.5", {"frames", "no whole number"}},
      {"/substeps", "0", {"substeps", "from 1"}},
      {"/frames_per_second", "\"60\"", {"frames_per_second", "\"60\" is no whole number"}},
      {"/iterations", "18446744073709551615", {"iterations", "out of range"}},
      {"/gravity", "[0, 0]", {"gravity", "no vector", "[x, y, z]"}},
      {"/gravity", "[0, \"down\", 0]", {"gravity[1]", "no number"}},
      {"/damping", "-0.1", {"damping", "from 0"}},
      {"/max_speed", "0", {"max_speed", "above 0"}},
      {"/solver", "\"fem\"", {"solver", "xpbd, newton, vbd"}},
      {"/newton", "{}", {"newton", "is not for the solver xpbd", "\"solver\": \"newton\""}},
      {"/residual", "1e-6", {"residual", "is not for the solver xpbd"}},
      {"/start_outside", "\"no\"", {"start_outside", "refuse, allow"}},
      {"/start_tangled", "\"no\"", {"start_tangled", "resolve, simulate"}},
      {"/description", "3", {"description", "no text"}},
      {"/colour", "1", {"colour", "not known", "; allowed are selvage_scene"}},
      {"/handles", "[]", {"handles", "not known here", "write it in a body"}},
      {"/guarantee", "true", {"guarantee", "not known here", "write it in \"contact\""}},
      {"/substep", "4", {"substep", "did you mean 'substeps'?"}},
      {"/contact/mode", "\"fast\"", {"contact.mode", "\"fast\"", "none, ccd, dcd, hybrid"}},
      {"/contact/rule", "1", {"contact.rule", "shortest-path, rest-pose, euclidean"}},
      {"/contact/edges", "1", {"contact.edges", "true or false"}},
      {"/contact/static_fricton", "1", {"contact.static_fricton", "did you mean 'static_friction'?"}},
      {"/contact/from_frame", "-3", {"contact.from_frame", "from 0"}},
      {"/materials", "[]", {"materials", "no object"}},
      {"/materials/rubber/poisson_ratio", "0.5", {"materials.rubber.poisson_ratio", "0 to 0.499"}},
      {"/materials/rubber/youngs_modulus", "0", {"materials.rubber.youngs_modulus", "above 0"}},
      {"/materials/rubber/kind", "\"jelly\"", {"materials.rubber.kind", "neo-hookean, mass-spring"}},
      {"/materials/rubber/edge_compliance", "1", {"materials.rubber.edge_compliance", "not known"}},
      {"/materials/rubber/hydrostatic_compliance", "1", {"materials.rubber", "both moduli and compliances"}},
      {"/materials/soft/deviatoric_compliance", "1e20", {"materials.soft", "Poisson's ratio below 0.5"}},
      {"/materials/soft/deviatoric_compliance", "1e-310", {"materials.soft", "too small"}},
      {"/materials/soft/deviatoric_compliance", "", {"materials.soft", "one compliance of two"}},
      {"/bodies", "", {"has no 'bodies'"}},
      {"/bodies", "[]", {"bodies", "at least one body"}},
      {"/bodies", "{}", {"bodies", "no list"}},
      {"/bodies/0", "7", {"bodies[0]", "no object"}},
      {"/bodies/1/material/poisson_ratio", "-1", {"bodies[1].material.poisson_ratio", "-1 is out of range"}},
      {"/bodies/0/material", "\"wood\"", {"bodies[0].material", "\"rubber\", \"soft\", \"springs\""}},
      {"/bodies/0/mesh", "{}", {"bodies[0].mesh", "give one of file, shape"}},
      {"/bodies/0/mesh/file", "\"a.t\"", {"bodies[0].mesh", "both 'file' and 'shape'"}},
      {"/bodies/0/mesh/shape", "\"cube\"", {"bodies[0].mesh.shape", "box, beam"}},
      {"/bodies/0/mesh/cell", "0", {"bodies[0].mesh.cell", "above 0"}},
      {"/bodies/0/mesh/tentacles", "0", {"bodies[0].mesh.tentacles", "from 1"}},
      {"/bodies/0/poses/1/pose", "\"knot\"", {"bodies[0].poses[1].pose", "twist"}},
      {"/bodies/0/poses/1/axis", "\"w\"", {"bodies[0].poses[1].axis", "x, y, z"}},
      {"/bodies/0/poses/0/matrix", "[[1,0,0],[0,1,0],[0,0,-1]]", {"bodies[0].poses[0].matrix", "positive determinant"}},
      {"/bodies/0/poses/0/matrix", "[[1,0,0]]", {"bodies[0].poses[0].matrix", "no matrix"}},
      {"/bodies/0/scale", "-1", {"bodies[0].scale", "above 0"}},
      {"/bodies/0/scale", "[1, 0, 1]", {"bodies[0].scale", "inverts the mesh"}},
      {"/bodies/0/rotate/axis", "[0, 0, 0]", {"bodies[0].rotate.axis", "no direction"}},
      {"/bodies/0/rotate/degrees", "", {"bodies[0].rotate", "has no 'degrees'"}},
      {"/bodies/0/pinned/0/plane/normal", "", {"bodies[0].pinned[0].plane", "has no 'normal'"}},
      {"/bodies/0/handles/0/region/box/min", "[2, 0, 0]", {"bodies[0].handles[0].region.box", "min above its max"}},
      {"/bodies/0/handles/0/motion/keyframes", "[]", {"handles[0].motion.keyframes", "at least one"}},
      {"/bodies/0/handles/0/motion/keyframes/1/time", "0", {"keyframes[1].time", "order of time"}},
      {"/bodies/0/handles/0/release", "-1", {"handles[0].release", "from 0"}},
      {"/bodies/1/instances/grid/counts", "[1000, 1000, 1000]", {"instances.grid.counts", "at most 100000"}},
      {"/bodies/1/instances/grid/counts", "[1, 2]", {"instances.grid.counts", "columns, rows, layers"}},
      {"/bodies/1/instances/list", "[]", {"bodies[1].instances", "both 'grid' and 'list'"}},
      {"/bodies/1/instances/jitter/degrees", "181", {"instances.jitter.degrees", "0 to 180"}},
      {"/colliders/0/plane/normal", "[0, 0, 0]", {"colliders[0].plane.normal", "no direction"}},
      {"/colliders/0/sphere", "{}", {"colliders[0]", "both 'plane' and 'sphere'"}},
      {"/colliders/1/box/max", "[-9, 0, 0]", {"colliders[1].box", "no inside"}},
      {"/colliders/2/bowl/radius", "-2", {"colliders[2].bowl.radius", "above 0"}},
      {"/colliders/4/cylinder/length", "", {"colliders[4].cylinder", "has no 'length'"}},
      {"/colliders/5/mesh/shape", "\"blob\"", {"colliders[5].mesh.shape"}},
      {"/colliders/0/static_friction", "-1", {"colliders[0].static_friction", "from 0"}},
      {"/scales", "[]", {"scales", "no object"}},
  };
  for (const WrongValue& wrong : cases) {
    const std::string message = refusal(patched(wrong.place, wrong.value));
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    for (const std::string& word : wrong.words)
      EXPECT_NE(message.find(word), std::string::npos) << wrong.place << "\nsays: " << message << "\nwithout: " << word;
  }
}

TEST(SceneReader, KnowsEachSolverAndItsValues) {
  EXPECT_EQ(describe_scene(kWhole, kFile, "").solver, SolverKind::kXpbd);
  Json json = Json::parse(kWhole);
  json["solver"] = "newton";
  json["newton"] = Json::parse(R"({"steps": 1, "tolerance": 0.5, "linear_solver": "direct"})");
  const SceneDescription newton = describe_scene(json.dump(), kFile, "");
  EXPECT_EQ(newton.solver, SolverKind::kNewton);
  EXPECT_EQ(newton.newton.newton_steps, 1);
  EXPECT_EQ(newton.newton.tolerance, 0.5);
  EXPECT_EQ(newton.newton.linear_solver, LinearSolver::kDirect);
  json.erase("newton");
  json.erase("iterations");
  json["solver"] = "vbd";
  json["residual"] = 1e-6;
  const SceneDescription vbd = describe_scene(json.dump(), kFile, "");
  EXPECT_EQ(vbd.solver, SolverKind::kVbd);
  EXPECT_EQ(vbd.vbd_residual, 1e-6);
  EXPECT_EQ(vbd.options.iterations, VbdOptions().iterations);
  json["bodies"][0]["material"] = Json::parse(R"({"kind": "mass-spring"})");
  EXPECT_NE(refusal(json.dump()).find("bodies[0]: has a material of rigid springs"), std::string::npos);
  json["solver"] = "newton";
  EXPECT_NE(refusal(json.dump()).find("residual: is not for the solver newton"), std::string::npos);
}

TEST(SceneReader, NamesWrongScales) {
  EXPECT_NE(refusal(kWhole, "huge").find("no scale 'huge'; use one of paper"), std::string::npos);
  for (const char* place : {"bodies", "/bodies/7/mesh", "/nothing/here", "/bodies/-", "/bodies/x"}) {
    Json json = Json::parse(kWhole);
    json["scales"]["paper"] = Json{{place, 1}};
    const std::string message = refusal(json.dump(), "paper");
    EXPECT_NE(message.find("is no place in the scene"), std::string::npos) << place << ": " << message;
    EXPECT_NE(message.find("scales.paper"), std::string::npos) << message;
  }
  // Values that a scale puts in are checked like all others.
  const std::string wrong = patched("/scales/paper/~1substeps", "-2");
  EXPECT_NE(refusal(wrong, "paper").find("substeps: -2 is out of range"), std::string::npos);
}

TEST(SceneReader, RefusesTextThatIsNoJson) {
  EXPECT_NE(refusal("{\"frames\": 3,\n \"bodies\": [}").find("line 2, column"), std::string::npos);
  EXPECT_NE(refusal("").find("whole.json"), std::string::npos);
  EXPECT_NE(refusal("[1]").find("no object"), std::string::npos);
}

TEST(SceneReader, NamesThePlaceOfWhatTheParserFinds) {
  EXPECT_NE(refusal(R"({"a": {"frames": 1, "frames": 2}})").find("whole.json: a.frames: is there twice"),
            std::string::npos);
  EXPECT_NE(refusal(R"({"b": [[1, {"x": 2}], {"c": []}, {"d": 1, "e": 2, "d": 3}], "b": 1})").find("b[2].d: is there"),
            std::string::npos);
  EXPECT_NE(refusal(R"({"frames": 1, "b": [{}, [1, 2, 1e999]]})").find("whole.json: b[1][2]: is a number too large"),
            std::string::npos);
  EXPECT_NE(refusal(R"({"b": [{}], "c d": -1e999})").find("whole.json: [\"c d\"]: is a number too large"),
            std::string::npos);
}

TEST(Scene, BodiesHaveTheirPlacement) {
  const Scene scene = parse_scene(kWhole, kFile);
  ASSERT_EQ(scene.model.bodies.size(), 7u);
  EXPECT_EQ(scene.model.bodies[1].name, "body1[0]");
  EXPECT_EQ(scene.model.mesh.element_count(), 48 + 6 * 6);
  // A quarter turn about z takes x to y, and y to -x; twice as large; shifted by 5 in x.
  Vec3 least = scene.model.rest_positions[0], most = least;
  for (Index v = 0; v < scene.model.bodies[0].vertex_count; ++v) {
    least = least.cwiseMin(scene.model.rest_positions[v]);
    most = most.cwiseMax(scene.model.rest_positions[v]);
  }
  EXPECT_NEAR((least - Vec3(3, 0, 0)).norm(), 0, 1e-12);
  EXPECT_NEAR((most - Vec3(5, 2, 2)).norm(), 0, 1e-12);
  EXPECT_EQ(scene.initial_state.velocities.back(), Vec3(1, 2, 3));
  ASSERT_EQ(scene.handles.size(), 2u);
  EXPECT_EQ(scene.handles[0].vertices.size(), 9u);
  EXPECT_EQ(scene.handles[1].vertices.size(), 9u);
  EXPECT_FALSE(std::get<MeshShape>(scene.colliders[5].shape).triangles.empty());
}

std::string build_refusal(const std::string& text) {
  try {
    parse_scene(text, kFile);
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Scene, NamesThePlaceOfWhatCannotBeBuilt) {
  const std::vector<WrongValue> cases{
      {"/bodies/0/mesh", R"({"file": "nothing.t"})", {"bodies[0].mesh", "folder/nothing.t", "cannot be read"}},
      {"/bodies/0/mesh/tentacles", "3", {"bodies[0].mesh", "has no tentacles"}},
      {"/bodies/0/mesh", R"({"shape": "cloth"})", {"bodies[0].mesh", "is a surface"}},
      {"/colliders/5",
       R"({"mesh": {"shape": "cloth"}})",
       {"whole.json: colliders[5].mesh", "edge of its vertices", "give a closed surface"}},
      {"/bodies/0/rest/cell", "1", {"bodies[0].rest", "has not the elements of the mesh"}},
      {"/bodies/0/poses/1", R"({"pose": "overlap"})", {"bodies[0].poses[1]", "adds an object"}},
      {"/bodies/0/pinned/0/plane/point",
       "[0, 0, -5]",
       {"bodies[0].pinned[0]", "holds no vertex", "reaches from [0, 0, 0]"}},
      {"/bodies/0/pinned/0/plane/point", "[0, 0, 5]", {"bodies[0].handles[0].region", "another handle holds"}},
      {"/bodies/1/translate", "[1e18, 0, 0]", {"bodies[1]: element 0 of its mesh is flat or inverted at rest"}},
      {"/bodies/0/poses/0/matrix", "[[1e100, 0, 0], [0, 1, 0], [0, 0, 1]]", {"bodies: vertex", "single precision"}},
  };
  for (const WrongValue& wrong : cases) {
    const std::string message = build_refusal(patched(wrong.place, wrong.value));
    for (const std::string& word : wrong.words)
      EXPECT_NE(message.find(word), std::string::npos) << wrong.place << "\nsays: " << message << "\nwithout: " << word;
  }
}

/// A block of 27 vertices from the origin to (1, 1, 1), pinned at its bottom where asked, and a collider.
std::string block_beside(const std::string& collider, const std::string& more = "", const std::string& body = "") {
  return R"({"selvage_scene": 1, "bodies": [{"name": "block", "mesh": {"shape": "box", "size": [1, 1, 1], "cell": 0.5})" +
         body + R"(}], "colliders": [{"plane": {"point": [0, 0, -9], "normal": [0, 0, 1]}}, )" + collider + "]" + more +
         "}";
}

TEST(Scene, RefusesBodiesThatStartOutsideContainersOrInsideSolids) {
  const std::vector<std::pair<const char*, std::string>> cases{
      {R"({"box": {"min": [3, 0, 0], "max": [4, 1, 1]}})",
       R"(27 of 27 vertices start outside colliders[1], a container; a solid box is {"mesh": {"shape": "box"}})"},
      {R"({"box": {"min": [0, 0, 0.1], "max": [1, 1, 1]}})",
       "9 of 27 vertices start outside colliders[1], a container"},
      {R"({"bowl": {"centre": [0.5, 0.5, 1.1], "radius": 1}})",
       "9 of 27 vertices start outside colliders[1], a container; move one of the two"},
      {R"({"plane": {"point": [0, 0, 0.6], "normal": [0, 0, 1]}})",
       "18 of 27 vertices start inside colliders[1]; move"},
      {R"({"sphere": {"centre": [0, 0, 0], "radius": 0.6}})", "4 of 27 vertices start inside colliders[1]"},
      {R"({"cylinder": {"centre": [0, 0, 0], "axis": [0, 0, 1], "radius": 0.1, "length": 1.5}})", "2 of 27 vertices"},
      {R"({"mesh": {"shape": "box", "size": [1, 1, 1]}, "translate": [0.6, 0.6, 0.6]})", "1 of 27 vertices"},
      // Where it is when the run begins.
      {R"({"sphere": {"centre": [9, 0, 0], "radius": 0.2}, "motion": {"keyframes": [{"time": 0, "translate": [-9, 0, 0]}]}})",
       "1 of 27 vertices"},
  };
  for (const auto& [collider, message] : cases) {
    const std::string said = build_refusal(block_beside(collider));
    EXPECT_EQ(said.find("folder/whole.json: body 'block': " + message), 0u) << collider << "\nsays: " << said;
    EXPECT_NE(said.find(R"("start_outside": "allow")"), std::string::npos) << said;
    EXPECT_EQ(build_refusal(block_beside(collider, R"(, "start_outside": "allow")")), "accepted") << collider;
  }
}

TEST(Scene, RefusesCollidersThatStandInBodiesBetweenTheirVertices) {
  const std::vector<std::pair<const char*, const char*>> cases{
      {R"({"mesh": {"shape": "box", "size": [0.1, 9, 9]}, "translate": [0.2, -4, -4]})", "m deep"},
      {R"({"mesh": {"shape": "box", "size": [0.1, 0.1, 1]}, "translate": [0.2, 0.2, 0.9]})", "0.1 m deep"},
      {R"({"sphere": {"centre": [0.25, 0.25, 0.25], "radius": 0.4}})", "m deep"},
      {R"({"cylinder": {"centre": [0.25, 0.25, 0], "axis": [0, 0, 1], "radius": 0.02, "length": 1}})", "m deep"},
      {R"({"cylinder": {"centre": [0.25, 0, 0], "axis": [1, 0, 0], "radius": 9, "length": 0.1}})", "m deep"},
  };
  for (const auto& [collider, depth] : cases) {
    const std::string said = build_refusal(block_beside(collider));
    EXPECT_EQ(said.find("folder/whole.json: body 'block': colliders[1] starts in it, "), 0u) << collider << said;
    EXPECT_NE(said.find(depth), std::string::npos) << said;
    EXPECT_NE(said.find(R"("start_outside": "allow")"), std::string::npos) << said;
    EXPECT_EQ(build_refusal(block_beside(collider, R"(, "start_outside": "allow")")), "accepted") << collider;
  }
}

TEST(Scene, AcceptsBodiesThatTouchCollidersOrArePinnedInThem) {
  for (const char* collider : {R"({"box": {"min": [0, 0, 0], "max": [1, 1, 1]}})",
                               R"({"plane": {"point": [0, 0, 0.00005], "normal": [0, 0, 1]}})",
                               R"({"mesh": {"shape": "box", "size": [1, 1, 1]}, "translate": [1, 0, 0]})"})
    EXPECT_EQ(build_refusal(block_beside(collider)), "accepted") << collider;
  const char* floor = R"({"plane": {"point": [0, 0, 0.1], "normal": [0, 0, 1]}})";
  const char* pin = R"(, "pinned": [{"plane": {"point": [0, 0, 0.1], "normal": [0, 0, -1]}}])";
  EXPECT_EQ(build_refusal(block_beside(floor, "", pin)), "accepted");
  EXPECT_NE(build_refusal(block_beside(floor)), "accepted");
}

TEST(Scene, LimitsInitialVelocities) {
  const Scene scene = parse_scene(patched("/max_speed", "3"), kFile);
  for (const Body& body : scene.model.bodies)
    for (Index v = body.first_vertex; v < body.first_vertex + body.vertex_count; ++v)
      EXPECT_NEAR(scene.initial_state.velocities[v].norm(), std::min(body.initial_velocity.norm(), 3.0), 1e-12);
  EXPECT_EQ(parse_scene(kWhole, kFile).initial_state.velocities.back(), Vec3(1, 2, 3));
}

TEST(Scene, FingerprintTellsScenesApart) {
  const std::uint64_t print = parse_scene(kWhole, kFile).fingerprint;
  EXPECT_EQ(parse_scene(patched("/frames", "99"), kFile).fingerprint, print);
  EXPECT_EQ(parse_scene(patched("/description", "\"other words\""), kFile).fingerprint, print);
  EXPECT_NE(parse_scene(patched("/gravity", "[0, 0, -9.1]"), kFile).fingerprint, print);
  EXPECT_NE(parse_scene(patched("/bodies/0/translate", "[5, 0, 1e-9]"), kFile).fingerprint, print);
  EXPECT_NE(parse_scene(patched("/bodies/1/instances/jitter/seed", "6"), kFile).fingerprint, print);
}

TEST(NearestName, TakesTheFewestChanges) {
  const std::vector<std::string_view> names{"radius", "density", "damping"};
  EXPECT_EQ(nearest_name("raduis", names), "radius");
  EXPECT_EQ(nearest_name("dampning", names), "damping");
  EXPECT_EQ(nearest_name("", names), "radius");
}

}  // namespace
}  // namespace selvage
