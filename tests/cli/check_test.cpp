#include "cli/program.h"
#include "selvage/io/mesh_file.h"
#include "selvage/mesh/simplex_mesh.h"
#include "selvage/self_collision/self_collision.h"

#include <nlohmann/json.hpp>

namespace selvage::testing {
namespace {

using nlohmann::json;

class CheckTest : public ProgramTest {
 protected:
  /// Two triangles through each other; then one that touches the first in a corner, and one beside all.
  void write_four() const {
    write_text(file("four.off"),
               "OFF\n12 4 0\n0 0 0\n4 0 0\n0 4 0\n1 1 -1\n1 1 1\n3 3 1\n4 0 0\n5 0 1\n5 1 0\n9 9 9\n9 8 9\n9 9 8\n"
               "3 0 1 2\n3 3 4 5\n3 6 7 8\n3 9 10 11\n");
  }
  void make_tangled() const { run_well("make octopus --pose swirl -o tangled.t -q"); }

  json check(const std::string& arguments, int status) const {
    const Outcome outcome = run("check " + arguments + " --json -");
    EXPECT_EQ(outcome.status, status) << arguments << "\n" << outcome.err;
    EXPECT_EQ(outcome.err, "") << arguments;
    return json::parse(outcome.out);
  }
};

TEST_F(CheckTest, JsonHasTheSchema) {
  write_four();
  const std::string text = run("check four.off --json -").out;
  const auto result = nlohmann::ordered_json::parse(text);
  std::vector<std::string> names;
  for (const auto& [name, value] : result.items()) names.push_back(name);
  EXPECT_EQ(names, (std::vector<std::string>{"schema", "kind", "mesh", "method", "triangle_pairs", "contacts",
                                             "statistics", "seconds"}));
  EXPECT_EQ(result["schema"], 1);
  EXPECT_EQ(result["kind"], "discrete");
  EXPECT_EQ(result["method"], "auto");
  EXPECT_EQ(result["triangle_pairs"], nlohmann::ordered_json::parse("[[0,1],[0,2]]"));
  EXPECT_EQ(result["contacts"], nlohmann::ordered_json::parse("[\"crossing\",\"touching\"]"));
  EXPECT_EQ(result["statistics"]["triangles"], 4);
  EXPECT_EQ(result["statistics"]["pairs"], 2);
  EXPECT_TRUE(result["seconds"].contains("pairs"));
}

TEST_F(CheckTest, TellsWhatPairsHaveInCommon) {
  write_four();
  const json segments = check("four.off --segments", 1)["segments"];
  ASSERT_EQ(segments.size(), 2u);
  const json low = json::parse("[1.0,1.0,0.0]"), high = json::parse("[2.0,2.0,0.0]"),
             corner = json::parse("[4.0,0.0,0.0]");
  EXPECT_TRUE(segments[0] == json({low, high}) || segments[0] == json({high, low})) << segments[0];
  EXPECT_EQ(segments[1], json({corner, corner}));
  EXPECT_FALSE(check("four.off", 1).contains("segments"));
  write_text(file("flat.off"), "OFF\n6 2 0\n0 0 0\n4 0 0\n0 4 0\n1 1 0\n5 1 0\n1 5 0\n3 0 1 2\n3 3 4 5\n");
  EXPECT_EQ(check("flat.off --segments", 1)["segments"], json::parse("[null]"));
  expect_refused("check four.off --to four.off --segments", 2, {"--segments"});
  expect_refused("check four.off --segments", 2, {"--segments", "--json"});
}

TEST_F(CheckTest, ExitStatusTellsWhetherThereAreCollisions) {
  write_four();
  EXPECT_EQ(run("check four.off -q").status, 1);
  EXPECT_EQ(run("check four.off -q").out, "");
  run_well("make ball --cell 0.3 -o ball.t -q");
  EXPECT_EQ(run("check ball.t -q").status, 0);
  const json result = check("ball.t", 0);
  EXPECT_EQ(result["triangle_pairs"], json::array());
  EXPECT_EQ(result["contacts"], json::array());
}

TEST_F(CheckTest, TetrahedralMeshListsItsBoundary) {
  make_tangled();
  const json result = check("tangled.t", 1);
  const IndexedMesh mesh = read_mesh(file("tangled.t"));
  const TetMesh topology(static_cast<Index>(mesh.positions.size()), mesh.tetrahedra);
  const std::vector<VertexTuple<3>> boundary(topology.boundary_faces().begin(), topology.boundary_faces().end());
  EXPECT_EQ(result["triangles"].get<std::vector<VertexTuple<3>>>(), boundary);
  const TriangleMesh surface(topology.vertex_count(), boundary);
  const auto pairs = SelfCollisionFinder(surface, mesh.positions).find_pairs();
  ASSERT_EQ(result["triangle_pairs"].size(), pairs.size());
  EXPECT_GT(pairs.size(), 10u);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    EXPECT_EQ(result["triangle_pairs"][i][0], pairs[i].first);
    EXPECT_EQ(result["triangle_pairs"][i][1], pairs[i].second);
  }
}

TEST_F(CheckTest, AdjacentTrianglesCountOnRequest) {
  // Folded onto each other about an edge; the third pierces the first from their common vertex.
  write_text(file("fold.off"), "OFF\n6 3 0\n0 0 0\n4 0 0\n0 4 0\n1 1 0\n2 1 1\n2 1 -1\n3 0 1 2\n3 1 0 3\n3 0 4 5\n");
  EXPECT_EQ(check("fold.off", 0)["triangle_pairs"], json::array());
  const json result = check("fold.off --adjacent", 1);
  EXPECT_EQ(result["triangle_pairs"], json::parse("[[0,1],[0,2],[1,2]]"));
  EXPECT_EQ(result["contacts"][0], "coplanar overlap");
  EXPECT_EQ(result["contacts"][1], "crossing");
}

TEST_F(CheckTest, NeitherThreadsNorInstructionsNorMethodChangeTheAnswer) {
  make_tangled();
  const json expected = check("tangled.t --adjacent", 1);
  for (const char* way : {"baseline", "avx2", "avx512"}) {
    for (const char* threads : {" --threads 1", " --threads 5", " --method bvh"}) {
      const Outcome outcome =
          run(std::string("check tangled.t --adjacent --json -") + threads, std::string("export SELVAGE_ISA=") + way);
      const json result = json::parse(outcome.out);
      for (const char* name : {"triangle_pairs", "contacts"}) EXPECT_EQ(result[name], expected[name]);
      if (result["method"] == expected["method"]) {
        EXPECT_EQ(result["statistics"], expected["statistics"]);
      }
    }
  }
}

TEST_F(CheckTest, StepBetweenTwoPoses) {
  const std::string faces = "3 0 1 2\n3 3 4 5\n";
  write_text(file("start.off"), "OFF\n6 2 0\n0 0 0\n4 0 0\n0 4 0\n1 1 1\n1 1 2\n2 1 2\n" + faces);
  write_text(file("end.off"), "OFF\n6 2 0\n0 0 0\n4 0 0\n0 4 0\n1 1 -1\n1 1 0\n2 1 0\n" + faces);
  const json result = check("start.off --to end.off", 1);
  EXPECT_EQ(result["schema"], 1);
  EXPECT_EQ(result["kind"], "continuous");
  EXPECT_EQ(result["to"], "end.off");
  EXPECT_EQ(result["vertex_face"], json::parse("[[3,0],[4,0],[5,0]]"));
  EXPECT_EQ(result["edge_edge"], json::array());
  EXPECT_NEAR(result["free_step"].get<double>(), 0.5, 1e-6);
  EXPECT_FALSE(result.contains("triangle_pairs"));
  EXPECT_EQ(check("start.off --to start.off", 0)["free_step"], 1);
  const std::string text = run("check start.off --to end.off --vtu step.vtu").out;
  EXPECT_NE(text.find("3 of a vertex and a face"), std::string::npos) << text;
  EXPECT_NE(read_text(file("step.vtu")).find("PointData"), std::string::npos);
  write_text(file("other.off"), "OFF\n6 1 0\n0 0 0\n4 0 0\n0 4 0\n1 1 -1\n1 1 0\n2 1 0\n3 0 1 2\n");
  expect_refused("check start.off --to other.off", 2, {"other.off", "elements"});
  write_text(file("fewer.off"), "OFF\n3 1 0\n0 0 0\n4 0 0\n0 4 0\n3 0 1 2\n");
  expect_refused("check start.off --to fewer.off", 2, {"fewer.off", "3 vertices"});
  expect_refused("check start.off --to end.off --adjacent", 2, {"--adjacent"});
  expect_refused("check nowhere.off --to neither.off", 2, {"nowhere.off"});
  expect_refused("check start.off --to neither.off", 2, {"neither.off"});
  EXPECT_EQ(check("start.off --to end.off --method normal-cone", 1)["vertex_face"].size(), 3u);
}

TEST_F(CheckTest, VtuMarksTheTriangles) {
  write_four();
  EXPECT_EQ(run("check four.off -q --vtu four.vtu").status, 1);
  const std::string vtu = read_text(file("four.vtu"));
  EXPECT_NE(vtu.find("NumberOfCells=\"4\""), std::string::npos) << vtu.substr(0, 400);
  EXPECT_NE(vtu.find("Name=\"collisions\""), std::string::npos);
}

TEST_F(CheckTest, SummarySaysWhatWasFound) {
  write_four();
  const std::string text = run("check four.off").out;
  for (const char* word : {"four.off", "colliding pairs", "1 crossing, 1 touching", "where", "time"})
    EXPECT_NE(text.find(word), std::string::npos) << word << "\n" << text;
}

TEST_F(CheckTest, FailureLeavesNothing) {
  write_four();
  expect_refused("check four.off --method cones --json out.json", 2, {"cones", "bvh"});
  expect_refused("check four.off --vtu lines.txt", 2, {"lines.txt", ".vtu"});
  expect_refused("check four.off --json four.off", 2, {"input"});
  expect_refused("check none.off --json out.json", 2, {"none.off"});
  EXPECT_EQ(files(), (std::vector<std::string>{"four.off"}));
}

}  // namespace
}  // namespace selvage::testing
