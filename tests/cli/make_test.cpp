#include "cli/program.h"
#include "selvage/io/mesh_file.h"
#include "selvage/shapes/poses.h"
#include "selvage/shapes/shapes.h"

#include <nlohmann/json.hpp>

namespace selvage::testing {
namespace {

using MakeTest = ProgramTest;
using nlohmann::json;

/// Options that keep each shape small.
std::string small(std::string_view shape) {
  if (shape == "nested-knot" || shape == "nested-overhand" || shape == "gear") return "--elements 20000";
  if (shape == "octopus" || shape == "squishy-ball") return shape == "octopus" ? "" : "--tentacles 8";
  return "--elements 3000";
}

TEST_F(MakeTest, EveryShapeGoesThroughInfoAndPaths) {
  for (const std::string_view shape : shape_names()) {
    const std::string name(shape);
    const bool solid = name != "cloth" && name != "sleeve";
    run_well("make " + name + " " + small(shape) + " -o mesh.vtu --json make.json --quiet");
    run_well("info mesh.vtu --json info.json --quiet");
    const json made = json::parse(read_text(file("make.json"))), info = json::parse(read_text(file("info.json")));
    const char* elements = solid ? "tetrahedra" : "triangles";
    EXPECT_EQ(made["schema"], 1);
    EXPECT_EQ(made["kind"], "make");
    EXPECT_GT(made[elements], 0) << name;
    EXPECT_EQ(info[elements], made[elements]) << name;
    EXPECT_EQ(info["vertices"], made["vertices"]) << name;
    EXPECT_EQ(info["unused_vertices"], 0) << name;
    EXPECT_EQ(info["components"], 1) << name;
    EXPECT_EQ(info["degenerate_elements"], 0) << name;
    if (name == "sleeve") continue;  // a surface in space has no inside
    EXPECT_EQ(info["inverted_elements"], 0) << name;
    run_well("paths mesh.vtu --json paths.json --quiet");
    const json paths = json::parse(read_text(file("paths.json")));
    EXPECT_EQ(paths["queries"], 0) << name << " is not tangled yet";
    EXPECT_EQ(paths["deepest"], nullptr);
  }
}

TEST_F(MakeTest, TangledExamplesHavePathsWithoutInvertedElements) {
  for (const auto& [shape, pose] : tangled_examples()) {
    const std::string name(shape);
    if (name == "cloth" || (name != "octopus" && name != "rod" && name != "torus" && name != "box")) continue;
    run_well("make " + name + " --pose " + std::string(pose) + " -o mesh.t -q");
    run_well("paths mesh.t --json paths.json -q");
    const json paths = json::parse(read_text(file("paths.json")));
    EXPECT_GT(paths["queries"], 0) << name << " " << pose;
    EXPECT_EQ(paths["found"], paths["queries"]) << name << " " << pose;
    EXPECT_EQ(paths["defects"]["inverted_elements"], 0) << name << " " << pose;
  }
}

TEST_F(MakeTest, RodFollowsItsCurve) {
  for (const auto& [curve, shape] : {std::pair("straight", "rod"), {"trefoil", "trefoil"}, {"coil", "noodle"}}) {
    run_well("make rod --curve " + std::string(curve) + " --length 20 --radius 0.2 -o a.t -q");
    run_well("make " + std::string(shape) + " --length 20 --radius 0.2 -o b.t -q");
    EXPECT_EQ(read_text(file("a.t")), read_text(file("b.t"))) << curve;
  }
}

TEST_F(MakeTest, OptionsReachTheShape) {
  run_well("make box --size 1 2 3 --cell 0.5 -o box.t -q");
  const IndexedMesh box = read_mesh(file("box.t")), wanted = make_box({1, 2, 3}, 0.5);
  EXPECT_EQ(box.positions, wanted.positions);
  EXPECT_EQ(box.tetrahedra, wanted.tetrahedra);
  run_well("make octopus --seed 1 -o one.t -q");
  run_well("make octopus --seed 2 -o two.t -q");
  EXPECT_NE(read_text(file("one.t")), read_text(file("two.t")));
}

TEST_F(MakeTest, PosesAreAppliedInTurn) {
  run_well("make beam -o beam.t --pose bend,axis=x,turns=0.5 --pose overlap,dx=0.5,dz=0.25 -q");
  IndexedMesh wanted = make_shape("beam");
  PoseOptions bend, overlap;
  bend.axis = 0;
  bend.turns = 0.5;
  overlap.offset = Vec3(0.5, 0, 0.25);
  apply_pose(wanted, "bend", bend);
  apply_pose(wanted, "overlap", overlap);
  EXPECT_EQ(read_mesh(file("beam.t")).positions, wanted.positions);
}

TEST_F(MakeTest, CentresTheResult) {
  for (const std::string shape : {"box --size 1 2 3 --cell 1", "rod", "tube", "cloth", "rod --pose bend"}) {
    const std::string name = shape.find("cloth") == 0 ? "mesh.ply" : "mesh.t";
    run_well("make " + shape + " --centre -o " + name + " -q");
    Vec3 lower = Vec3::Constant(HUGE_VAL), upper = -lower;
    for (const Vec3& p : read_mesh(file(name)).positions) lower = lower.cwiseMin(p), upper = upper.cwiseMax(p);
    EXPECT_LT((lower + upper).norm(), 1e-12) << shape;
  }
}

/// What the help says of where shapes lie.
TEST_F(MakeTest, ShapesLieWhereTheHelpSays) {
  const auto box_of = [](const std::string& shape) {
    Eigen::AlignedBox3d box;
    for (const Vec3& p : make_shape(shape).positions) box.extend(p);
    return box;
  };
  for (const char* shape : {"box", "beam", "cloth", "rod"}) EXPECT_LT(std::abs(box_of(shape).min()[0]), 1e-12) << shape;
  for (const char* shape : {"box", "beam", "cloth"}) EXPECT_EQ(box_of(shape).min()[1], 0) << shape;
  for (const char* shape : {"tube", "gear", "cloth", "sleeve"})
    EXPECT_LT(std::abs(box_of(shape).min()[2]), 1e-12) << shape;
  EXPECT_NEAR(box_of("noodle").min()[2], -0.1, 0.02) << "the middle of its end is in the plane";
  EXPECT_EQ(box_of("cloth").max()[2], 0);
  EXPECT_NEAR(box_of("rod").min()[1], -box_of("rod").max()[1], 1e-12);
  for (const char* shape : {"overhand", "nested-overhand"})
    EXPECT_NEAR(box_of(shape).min()[0], -box_of(shape).max()[0], 0.1) << shape;
  for (const char* shape : {"trefoil", "nested-knot", "torus", "ball", "octopus"}) {
    const Eigen::AlignedBox3d box = box_of(shape);
    EXPECT_TRUE(box.contains(Eigen::Vector3d::Zero())) << shape;
    EXPECT_LT(box.center().norm(), 0.2 * box.diagonal().norm()) << shape;
  }
  EXPECT_NEAR(box_of("squishy-ball").max()[0], 2, 0.2);
}

TEST_F(MakeTest, WritesTheBoundaryWhereTheFormatHoldsSurfaces) {
  run_well("make box --cell 0.25 --size 1 1 1 -o box.vtu -q");
  const Outcome outcome = run_well("make box --cell 0.25 --size 1 1 1 -o box.stl");
  EXPECT_NE(outcome.out.find("192 triangles"), std::string::npos) << outcome.out;
  run_well("make box.vtu -o box.obj --json made.json -q");
  const IndexedMesh surface = read_mesh(file("box.obj"));
  EXPECT_EQ(surface.triangles.size(), 192u);
  EXPECT_EQ(surface.positions.size(), 98u);
  EXPECT_EQ(json::parse(read_text(file("made.json")))["vertices"], 98);
  EXPECT_EQ(json::parse(read_text(file("made.json")))["tetrahedra"], 0);
}

TEST_F(MakeTest, PosesAMeshOfYourOwn) {
  run_well("make beam -o own.msh -q");
  const Outcome outcome = run_well("make own.msh --pose bend,turns=0.5 -o bent.vtu --json made.json");
  EXPECT_NE(outcome.out.find("bent.vtu: "), std::string::npos);
  IndexedMesh wanted = make_shape("beam");
  apply_pose(wanted, "bend", {.turns = 0.5});
  EXPECT_EQ(read_mesh(file("bent.vtu")).positions, wanted.positions);
  EXPECT_EQ(json::parse(read_text(file("made.json")))["shape"], "own.msh");
  run_well("make box --cell 0.25 -o short.vtu -q");
  expect_refused("make short.vtu --pose twist -o out.vtu", 2, {"turn inside out"});
  run_well("make short.vtu --pose twist,crossings=0,turns=0.2 -o turned.vtu -q");
  EXPECT_EQ(run("check turned.vtu -q").status, 0);
  // A surface keeps its objects; the format may change.
  write_text(file("own.obj"), "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0.5\no cape\nf 1 2 3\nf 1 3 4\n");
  run_well("make own.obj --centre -o moved.obj -q");
  EXPECT_NE(read_text(file("moved.obj")).find("o cape\nf 1 2 3\n"), std::string::npos);
  EXPECT_EQ(read_mesh(file("moved.obj")).positions[0], Vec3(-0.5, -0.5, -0.25));
  expect_refused("make own.msh --pose bend -o own.msh", 2, {"own.msh", "input"});
  expect_refused("make own.msh --cell 0.1 -o out.vtu", 2, {"--cell", "not for a mesh of your own"});
  expect_refused("make own.msh --size 1 2 3 -o out.vtu", 2, {"--size"});
  expect_refused("make own.obj -o out.t", 2, {"out.t", "holds no triangles"});
  expect_refused("make none.msh -o out.vtu", 2, {"none.msh"});
  expect_refused("make own.what -o out.vtu", 2, {"own.what"});
}

TEST_F(MakeTest, AsciiAndBinaryHoldTheSameMesh) {
  for (const char* extension : {"msh", "vtk", "vtu"}) {
    const std::string ascii = std::string("ascii.") + extension, binary = std::string("binary.") + extension;
    run_well("make ball -o " + ascii + " --ascii -q");
    run_well("make ball -o " + binary + " -q");
    EXPECT_NE(read_text(file(ascii)), read_text(file(binary)));
    EXPECT_EQ(read_mesh(file(ascii)).positions, read_mesh(file(binary)).positions) << extension;
    EXPECT_EQ(read_mesh(file(ascii)).tetrahedra, read_mesh(file(binary)).tetrahedra) << extension;
  }
}

TEST_F(MakeTest, OffIsTextUnlessBinaryIsAskedFor) {
  run_well("make cloth -o usual.off -q");
  run_well("make cloth -o ascii.off --ascii -q");
  run_well("make cloth -o binary.off --binary -q");
  EXPECT_EQ(read_text(file("usual.off")), read_text(file("ascii.off")));
  EXPECT_EQ(read_text(file("binary.off")).rfind("OFF BINARY\n", 0), 0u);
  EXPECT_EQ(read_mesh(file("binary.off")).triangles, read_mesh(file("ascii.off")).triangles);
  expect_refused("make cloth -o both.off --ascii --binary", 2, {"--ascii"});
}

TEST_F(MakeTest, FailureLeavesNothingAndTouchesNothing) {
  write_text(file("old.t"), "what stood here");
  expect_refused("make cloth -o old.t --json result.json", 2, {"old.t"});  // .t holds no triangles
  expect_refused("make ball -o ball.what --json result.json", 2, {"ball.what"});
  expect_refused("make ball -o nowhere/ball.t --json result.json", 2, {"nowhere/ball.t"});
  expect_refused("make ball -o ball.t --json nowhere/result.json", 2, {"nowhere/result.json"});
  expect_refused("make ball -o same.t --json ./same.t", 2, {"same.t"});
  expect_refused("make ball -o -", 2, {"standard output"});
  EXPECT_EQ(files(), std::vector<std::string>{"old.t"});
  EXPECT_EQ(read_text(file("old.t")), "what stood here");
}

TEST_F(MakeTest, TooLittleMemoryIsAFailureOfTheComputation) {
#ifdef SELVAGE_SANITIZED
  GTEST_SKIP() << "a sanitizer needs the address space";
#endif
  const Outcome outcome = run("make box --cell 0.0025 --threads 1 -o box.t", "ulimit -v 500000");
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  EXPECT_EQ(lines_of(outcome.err).size(), 1u) << outcome.err;
  EXPECT_TRUE(files().empty());
}

}  // namespace
}  // namespace selvage::testing
