#include "cli/program.h"
#include "selvage/io/mesh_file.h"

#include <nlohmann/json.hpp>

namespace selvage::testing {
namespace {

using Resolve = ProgramTest;

TEST_F(Resolve, WritesTheMeshAndSaysWhatItDid) {
  run_well("make box --cell 0.25 --pose overlap,dx=0.8,dy=0.1 -o tangled.vtu -q");
  EXPECT_EQ(run("check tangled.vtu").status, 1);
  const Outcome outcome = run_well("resolve tangled.vtu -o out.t --json report.json");
  for (const char* word : {"tangled.vtu", "resolved after", "triangle pairs", "moved", "volume", "elastic energy"})
    EXPECT_NE(outcome.out.find(word), std::string::npos) << outcome.out << "without " << word;
  EXPECT_EQ(run_well("check out.t").status, 0);
  EXPECT_EQ(read_mesh(file("out.t")).tetrahedra, read_mesh(file("tangled.vtu")).tetrahedra);

  const auto report = nlohmann::json::parse(read_text(file("report.json")));
  EXPECT_EQ(report["schema"], 1);
  EXPECT_EQ(report["kind"], "resolve");
  EXPECT_EQ(report["outcome"], "resolved");
  EXPECT_GT(report["before"]["triangle_pairs"], 0);
  EXPECT_EQ(report["after"]["triangle_pairs"], 0);
  EXPECT_EQ(report["after"]["penetrating_vertices"], 0);
  EXPECT_EQ(report["iterations"][0], report["before"]);
  EXPECT_EQ(report["iterations"].back(), report["after"]);
  EXPECT_GT(report["displacement"]["max"], 0);
  EXPECT_TRUE(report["tangled_elements"].empty());
  EXPECT_EQ(run_well("resolve tangled.vtu -o again.t -q --threads 1").out, "");
  EXPECT_EQ(read_text(file("again.t")), read_text(file("out.t")));
}

TEST_F(Resolve, CountsWhatIsAtInvertedElements) {
  run_well("make box --cell 0.25 --pose overlap,dx=0.8,dy=0.1 -o rest.vtu -q");
  IndexedMesh mesh = read_mesh(file("rest.vtu"));
  for (Vec3& x : mesh.positions)
    if ((x - Vec3(0.4, 0.1, 0)).norm() < 0.2) x[0] += 0.4;
  write_mesh(file("tangled.vtu"), mesh);
  const Outcome outcome = run_well("resolve tangled.vtu --rest rest.vtu -o out.vtu --json report.json");
  const auto report = nlohmann::json::parse(read_text(file("report.json")));
  ASSERT_GT(report["before"]["inverted_elements"], 0);
  ASSERT_GT(report["before"]["waiting_points"], 0);
  EXPECT_NE(outcome.out.find(" points at inverted elements"), std::string::npos) << outcome.out;
  EXPECT_EQ(report["after"]["waiting_points"], 0);
}

TEST_F(Resolve, WritesTheBoundaryWhereTheFormatHoldsSurfaces) {
  run_well("make box --cell 0.25 --pose overlap,dx=0.8,dy=0.1 -o tangled.vtu -q");
  run_well("resolve tangled.vtu -o out.vtu -q");
  run_well("resolve tangled.vtu -o out.OBJ --json report.json -q");
  run_well("resolve tangled.vtu -o out.stl -q");
  const IndexedMesh solid = read_mesh(file("out.vtu"));
  const TetMesh mesh(static_cast<Index>(solid.positions.size()), solid.tetrahedra);
  const IndexedMesh surface = read_mesh(file("out.OBJ"));
  EXPECT_EQ(surface.positions.size(), mesh.boundary_vertices().size());
  ASSERT_EQ(surface.triangles.size(), mesh.boundary_faces().size());
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(surface.positions[surface.triangles[t][k]], solid.positions[mesh.boundary_faces()[t][k]]);
  EXPECT_EQ(run("check out.OBJ -q").status, 0);
  EXPECT_EQ(run("check out.stl --weld -q").status, 0);
  run_well("view report.json -o page.html -q");
}

TEST_F(Resolve, KeepsThePoseUnlessItIsToStandUp) {
  run_well("make beam --size 8 0.5 0.5 --cell 0.25 -o rest.vtu -q");
  run_well("make rest.vtu --pose fold,axis=x,angle=3.3 -o bent.vtu -q");
  const auto mean = [&](const std::string& options) {
    const Outcome outcome = run_well("resolve bent.vtu --rest rest.vtu -o out.vtu --json report.json" + options);
    EXPECT_NE(outcome.out.find("% beside the rest, "), std::string::npos) << outcome.out;
    EXPECT_NE(outcome.out.find("% beside the mesh before"), std::string::npos) << outcome.out;
    const auto report = nlohmann::json::parse(read_text(file("report.json")));
    EXPECT_NEAR(report["volume"]["at_rest"].get<double>(), 2, 1e-9);
    return report["displacement"]["mean"].get<double>();
  };
  const double stayed = mean(""), stood_up = mean(" --to-rest");
  EXPECT_LT(stayed, 0.3 * stood_up);
  EXPECT_NE(run_well("resolve bent.vtu -o out.vtu").out.find("% beside the mesh before"), std::string::npos);
}

TEST_F(Resolve, LeavesAnUntangledMeshAsItIs) {
  run_well("make torus --elements 2000 -o torus.vtu -q");
  run_well("resolve torus.vtu -o out.vtu -q");
  EXPECT_EQ(read_text(file("out.vtu")), read_text(file("torus.vtu")));
}

TEST_F(Resolve, SaysWhatIsStuckAndWritesNoMesh) {
  run_well("make box --cell 0.25 --pose overlap,dx=0.8 -o tangled.vtu -q");
  expect_refused(
      "resolve tangled.vtu -o out.vtu --max-displacement 1e-6 --pin-box 0.7 -9 -9 0.79 9 9 --patience 3 "
      "--json report.json",
      3,
      {"tangled.vtu: is stuck after ", " iterations, with ", "pairs of triangles", "elements in the way",
       " pinned vertices are in it: "});
  EXPECT_EQ(files(), (std::vector<std::string>{"report.json", "tangled.vtu"}));
  const auto report = nlohmann::json::parse(read_text(file("report.json")));
  EXPECT_EQ(report["outcome"], "stuck");
  EXPECT_FALSE(report["tangled_elements"].empty());
  EXPECT_FALSE(report["holding_vertices"].empty());
  expect_refused("resolve tangled.vtu -o out.vtu --max-displacement 0.001 --patience 3", 3, {"is stuck"});
  expect_refused("resolve tangled.vtu -o out.vtu --iterations 1", 3, {"is not resolved after 1 iteration,"});
}

TEST_F(Resolve, SaysAtOnceWhatPinsHold) {
  run_well("make box --cell 0.25 --pose overlap,dx=0.8 -o tangled.vtu -q");
  expect_refused("resolve tangled.vtu -o out.vtu --pin-box -9 -9 -9 9 9 9 --json report.json", 3,
                 {"tangled.vtu: cannot be resolved with these pins", " elements: ", "; pin fewer vertices"});
  EXPECT_EQ(files(), (std::vector<std::string>{"report.json", "tangled.vtu"}));
  const auto report = nlohmann::json::parse(read_text(file("report.json")));
  EXPECT_EQ(report["outcome"], "held");
  EXPECT_EQ(report["iterations"].size(), 1u);
  EXPECT_FALSE(report["tangled_elements"].empty());
  EXPECT_FALSE(report["holding_vertices"].empty());
  EXPECT_EQ(report["displacement"]["moved_vertices"], 0);
}

TEST_F(Resolve, PinsWhatAFileLists) {
  run_well("make box --cell 0.25 --pose overlap,dx=0.8 -o tangled.vtu -q");
  write_text(file("pins.txt"), "# the first box's corner\n\n 0 # this\n1\r\n");
  const IndexedMesh before = read_mesh(file("tangled.vtu"));
  run_well("resolve tangled.vtu -o out.vtu --pin pins.txt --json report.json -q");
  EXPECT_EQ(nlohmann::json::parse(read_text(file("report.json")))["pinned_vertices"], 2);
  const IndexedMesh after = read_mesh(file("out.vtu"));
  EXPECT_EQ(after.positions[0], before.positions[0]);
  EXPECT_EQ(after.positions[1], before.positions[1]);
}

TEST_F(Resolve, RefusesWithOneLine) {
  run_well("make box --cell 0.5 -o box.vtu -q");
  run_well("make box --cell 0.25 -o finer.vtu -q");
  run_well("make cloth --cell 0.5 -o cloth.obj -q");
  write_text(file("far.txt"), "0\n1000\n");
  write_text(file("word.txt"), "zero\n");
  expect_refused("resolve none.vtu -o out.vtu", 2, {"none.vtu"});
  expect_refused("resolve cloth.obj -o out.vtu", 2, {"cloth.obj", "no tetrahedron"});
  expect_refused("resolve box.vtu", 2, {"--output"});
  expect_refused("resolve box.vtu -o -", 2, {"standard output"});
  expect_refused("resolve box.vtu -o box.vtu", 2, {"box.vtu"});
  expect_refused("resolve box.vtu -o out.xyz", 2, {"out.xyz"});
  expect_refused("resolve box.vtu -o out.vtu --to-rest", 2, {"--to-rest", "--rest MESH"});
  // Before the work.
  IndexedMesh with_surface = read_mesh(file("box.vtu"));
  with_surface.triangles = {{0, 1, 2}};
  write_mesh(file("surface.vtu"), with_surface);
  expect_refused("resolve surface.vtu --pin none.txt -o out.t", 2, {"out.t", "holds no triangles"});
  expect_refused("resolve box.vtu -o out.vtu --rest finer.vtu", 2,
                 {"finer.vtu", "differs from the mesh in its vertices or elements"});
  expect_refused("resolve box.vtu -o out.vtu --pin far.txt", 2, {"far.txt:2", "no vertex 1000"});
  expect_refused("resolve box.vtu -o out.vtu --pin word.txt", 2, {"word.txt:1", "'zero'"});
  expect_refused("resolve box.vtu -o out.vtu --pin-box 9 9 9 10 10 10", 2, {"--pin-box", "contains no vertex"});
  expect_refused("resolve box.vtu -o out.vtu --max-displacement 0", 2, {"--max-displacement"});
  expect_refused("resolve box.vtu -o out.vtu --clearance 2", 2, {"--clearance: is 2"});
  EXPECT_EQ(run("resolve --help").status, 0);
  EXPECT_FALSE(fs::exists(file("out.vtu")));
}

}  // namespace
}  // namespace selvage::testing
