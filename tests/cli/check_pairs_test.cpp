// What `check` finds between two meshes, within a distance, and of files with polygons, groups or no shared vertices.
#include "cli/program.h"
#include "selvage/io/mesh_file.h"
#include "selvage/self_collision/proximity.h"

#include <nlohmann/json.hpp>

namespace selvage::testing {
namespace {

using nlohmann::json;

class CheckPairsTest : public ProgramTest {
 protected:
  json check(const std::string& arguments, int status) const {
    const Outcome outcome = run("check " + arguments + " --json -");
    EXPECT_EQ(outcome.status, status) << arguments << "\n" << outcome.err;
    EXPECT_EQ(outcome.err, "") << arguments;
    return outcome.out.empty() ? json() : json::parse(outcome.out);
  }
  /// A triangle in the plane z = `z`.
  void write_flat(const std::string& name, double z, const std::string& more = "") const {
    const std::string height = std::to_string(z);
    write_text(file(name), "v 0 0 " + height + "\nv 4 0 " + height + "\nv 0 4 " + height + "\nf 1 2 3\n" + more);
  }
  /// Two triangles through each other, and one above both.
  void write_body() const {
    write_text(file("body.obj"),
               "v 1 1 -1\nv 1 1 1\nv 3 3 1\nv 9 9 9\nv 9 8 9\nv 9 9 8\nv 0 1 0.5\nv 4 1 0.5\nv 0 9 0.5\n"
               "f 4 5 6\nf 1 2 3\nf 7 8 9\n");
  }
};

TEST_F(CheckPairsTest, TwoMeshesHavePairsBetweenThem) {
  write_flat("cloth.obj", 0);
  write_body();
  const json result = check("cloth.obj --against body.obj --segments", 1);
  EXPECT_EQ(result["kind"], "discrete");
  EXPECT_EQ(result["against"], "body.obj");
  EXPECT_EQ(result["triangle_pairs"], json::parse("[[0,1]]")) << "and none within the body";
  EXPECT_EQ(result["contacts"], json::parse("[\"crossing\"]"));
  EXPECT_EQ(result["segments"].size(), 1u);
  EXPECT_EQ(check("body.obj", 1)["triangle_pairs"], json::parse("[[1,2]]"));
  write_flat("high.obj", 5);
  EXPECT_EQ(check("high.obj --against body.obj", 0)["triangle_pairs"], json::array());
  const std::string text = run("check cloth.obj --against body.obj").out;
  for (const char* word : {"against", "body.obj, 3 triangles", "1 crossing"})
    EXPECT_NE(text.find(word), std::string::npos) << word << "\n" << text;
  for (const char* option : {"--adjacent", "--rings 2", "--groups pieces"})
    expect_refused("check cloth.obj --against body.obj " + std::string(option), 2, {"two meshes"});
  expect_refused("check cloth.obj --against none.obj", 2, {"none.obj"});
}

TEST_F(CheckPairsTest, TwoSolidsAreTheirBoundaries) {
  run_well("make ball --cell 0.3 -o ball.t -q");
  run_well("make box --cell 0.3 -o box.vtu -q");
  const json result = check("ball.t --against box.vtu", 1);
  // The same as of one mesh that holds both, but for the numbers.
  const IndexedMesh ball = read_mesh(file("ball.t")), box = read_mesh(file("box.vtu"));
  IndexedMesh both = ball;
  for (VertexTuple<4> tet : box.tetrahedra) {
    for (Index& v : tet) v += static_cast<Index>(ball.positions.size());
    both.tetrahedra.push_back(tet);
  }
  both.positions.insert(both.positions.end(), box.positions.begin(), box.positions.end());
  write_mesh(file("both.vtu"), both);
  json expected = check("both.vtu", 1)["triangle_pairs"];
  const auto first = result["triangles"].size();
  for (auto& pair : expected) pair[1] = pair[1].get<std::size_t>() - first;
  EXPECT_EQ(result["triangle_pairs"], expected);
  EXPECT_GT(expected.size(), 10u);
  EXPECT_GT(result["triangles_against"].size(), 10u);
}

TEST_F(CheckPairsTest, ThicknessGivesDistances) {
  write_flat("low.obj", 0, "v 1 1 0.25\nv 1 2 0.25\nv 2 1 1\nf 4 5 6\nv 9 1 0.25\nv 9 2 0.25\nv 9 1 1\nf 7 8 9\n");
  const json result = check("low.obj --thickness 0.5", 1);
  EXPECT_EQ(result["kind"], "near");
  EXPECT_EQ(result["thickness"], 0.5);
  EXPECT_EQ(result["triangle_pairs"], json::array());
  EXPECT_EQ(result["vertex_face"], json::parse("[[3,0],[4,0]]"));
  EXPECT_EQ(result["vertex_face_distances"], json::parse("[0.25,0.25]"));
  EXPECT_EQ(result["edge_edge"].size(), result["edge_edge_distances"].size());
  EXPECT_EQ(check("low.obj --thickness 0.2", 0)["vertex_face"], json::array());
  const std::string text = run("check low.obj --thickness 0.5").out;
  EXPECT_NE(text.find("least 0.25 m"), std::string::npos) << text;
  EXPECT_NE(text.find("colliding pairs     none"), std::string::npos) << text;
  expect_refused("check low.obj --thickness 0", 2, {"--thickness", "above 0"});
  expect_refused("check low.obj --thickness thin", 2, {"--thickness", "not a number"});
}

TEST_F(CheckPairsTest, DistancesAreTheLibrarys) {
  run_well("make rod --cell 0.1 --pose self-crossing -o rod.vtu -q");
  const json result = check("rod.vtu --thickness 0.05 --rings 3", 1);
  const IndexedMesh mesh = read_mesh(file("rod.vtu"));
  const TriangleMesh surface = boundary_surface(TetMesh(static_cast<Index>(mesh.positions.size()), mesh.tetrahedra));
  PairFilters filters;
  filters.neighbour_rings = 3;
  const NearPairs near = ProximityFinder(surface, mesh.positions, 0.05, filters).find_pairs();
  ASSERT_EQ(result["vertex_face"].size(), near.vertex_face.size());
  ASSERT_EQ(result["edge_edge"].size(), near.edge_edge.size());
  EXPECT_GT(near.edge_edge.size(), 10u);
  for (std::size_t i = 0; i < near.vertex_face.size(); ++i) {
    EXPECT_EQ(result["vertex_face"][i][0], near.vertex_face[i].vertex);
    EXPECT_EQ(result["vertex_face_distances"][i].get<double>(), near.vertex_face[i].distance);
  }
  EXPECT_GT(result["triangle_pairs"].size(), 0u) << "what meets is told, too";
  EXPECT_GT(check("rod.vtu --thickness 0.05", 1)["vertex_face"].size(), near.vertex_face.size());
}

TEST_F(CheckPairsTest, DistancesBetweenTwoMeshesSayWhoseEachPartIs) {
  write_flat("cloth.obj", 0);
  write_text(file("body.obj"), "v 9 9 9\nv 1 1 0.25\nv 1 2 0.25\nv 2 1 3\nf 2 3 4\n");
  const json up = check("cloth.obj --against body.obj --thickness 0.5", 1);
  EXPECT_EQ(up["vertex_face"], json::array());
  EXPECT_EQ(up["face_vertex"], json::parse("[[0,1],[0,2]]"));
  EXPECT_EQ(up["face_vertex_distances"], json::parse("[0.25,0.25]"));
  const json down = check("body.obj --against cloth.obj --thickness 0.5", 1);
  EXPECT_EQ(down["vertex_face"], json::parse("[[1,0],[2,0]]"));
  EXPECT_EQ(down["face_vertex"], json::array());
  // A step of the cloth, while the body stands still.
  write_flat("raised.obj", 2);
  const json step = check("cloth.obj --to raised.obj --against body.obj", 1);
  EXPECT_EQ(step["face_vertex"], json::parse("[[0,1],[0,2]]"));
  EXPECT_NEAR(step["free_step"].get<double>(), 0.125, 1e-6);
  const json thick = check("cloth.obj --to raised.obj --against body.obj --thickness 0.05", 1);
  EXPECT_NEAR(thick["separated_step"].get<double>(), 0.1, 1e-3);
}

TEST_F(CheckPairsTest, FacesAreThoseOfTheFile) {
  write_text(file("quads.obj"),
             "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 9 9 9\nv 9 8 9\nv 9 9 8\nv 9 8 8\nv 1 2 -1\nv 1 3 -1\n"
             "v 1 3 1\nv 1 2 1\nf 5 6 7 8\nf 1 2 3 4\nf 9 10 11 12\n");
  const json result = check("quads.obj", 1);
  EXPECT_EQ(result["faces"], json::parse("[0,0,1,1,2,2]"));
  EXPECT_EQ(result["face_pairs"], json::parse("[[1,2]]"));
  EXPECT_GT(result["triangle_pairs"].size(), 1u);
  const std::string text = run("check quads.obj --vtu marked.vtu").out;
  EXPECT_NE(text.find("6 triangles of 3 faces"), std::string::npos) << text;
  EXPECT_NE(text.find("faces in pairs"), std::string::npos) << text;
  EXPECT_NE(read_text(file("marked.vtu")).find("Name=\"face\""), std::string::npos);
  write_flat("cloth.obj", 0);
  EXPECT_FALSE(check("cloth.obj", 0).contains("faces"));
}

TEST_F(CheckPairsTest, GroupsAndRingsLeavePairsOut) {
  // Pieces 0 and 1 cross, and 1 cuts itself; the file names two objects.
  write_text(file("two.obj"),
             "v 0 0 0\nv 4 0 0\nv 0 4 0\nv 1 1 -1\nv 1 1 1\nv 3 3 1\nv 3 3 -1\nv 0 2 0.5\nv 4 2 0.5\n"
             "o a\nf 1 2 3\no b\nf 4 5 6\nf 4 6 7\nf 7 8 9\n");
  const json all = check("two.obj", 1)["triangle_pairs"];
  EXPECT_NE(std::find(all.begin(), all.end(), json::parse("[1,3]")), all.end()) << all;
  for (const char* how : {"pieces", "names"}) {
    const json between = check("two.obj --groups " + std::string(how), 1)["triangle_pairs"];
    EXPECT_GT(between.size(), 0u);
    for (const auto& pair : between) EXPECT_EQ(pair[0], 0) << how;
  }
  write_text(file("groups.txt"), "5\n5 # both\n-1\n-1\n");
  const json by_file = check("two.obj --groups groups.txt", 1)["triangle_pairs"];
  EXPECT_EQ(by_file.size() + 1, all.size());
  EXPECT_EQ(std::find(by_file.begin(), by_file.end(), json::parse("[0,1]")), by_file.end());
  const json far = check("two.obj --rings 1", 1)["triangle_pairs"];
  EXPECT_EQ(std::find(far.begin(), far.end(), json::parse("[1,3]")), far.end()) << "an edge of [2] joins them";
  write_text(file("short.txt"), "0\n");
  expect_refused("check two.obj --groups short.txt", 2, {"short.txt", "1 lines", "4 faces"});
  write_text(file("wrong.txt"), "0\n1\nx\n2\n");
  expect_refused("check two.obj --groups wrong.txt", 2, {"wrong.txt:3", "'x'"});
  expect_refused("check two.obj --groups nowhere.txt", 2, {"nowhere.txt", "pieces or names"});
  write_flat("cloth.obj", 0);
  expect_refused("check cloth.obj --groups names", 2, {"cloth.obj", "'o' or 'g'"});
}

TEST_F(CheckPairsTest, WeldJoinsTheVerticesOfAnStl) {
  run_well("make ball --cell 0.4 -o ball.vtu -q");
  run_well("paths ball.vtu -q");
  IndexedMesh ball = read_mesh(file("ball.vtu"));
  const TriangleMesh surface = boundary_surface(TetMesh(static_cast<Index>(ball.positions.size()), ball.tetrahedra));
  ball.triangles.assign(surface.triangles().begin(), surface.triangles().end());
  ball.tetrahedra.clear();
  write_mesh(file("ball.stl"), ball);
  const Outcome apart = run("check ball.stl");
  EXPECT_EQ(apart.status, 1);
  EXPECT_NE(apart.out.find("hint"), std::string::npos) << apart.out;
  EXPECT_NE(apart.out.find("ball.stl: no triangles share a vertex"), std::string::npos) << apart.out;
  EXPECT_NE(apart.out.find("--weld"), std::string::npos) << apart.out;
  EXPECT_TRUE(check("ball.stl", 1).contains("hint"));
  run_well("make box --cell 0.5 -o box.obj -q");
  const Outcome against = run("check box.obj --against ball.stl");
  EXPECT_EQ(against.out.find("touching; try"), std::string::npos) << against.out;
  EXPECT_NE(against.out.find("ball.stl: no triangles share a vertex, so that vertices and edges count once"),
            std::string::npos)
      << against.out;
  const json welded = check("ball.stl --weld", 0);
  EXPECT_EQ(welded["weld"], true);
  EXPECT_FALSE(welded.contains("hint"));
  EXPECT_EQ(welded["triangle_pairs"], json::array());
  expect_refused("check ball.vtu --weld", 2, {"ball.vtu", "--weld"});
  // A triangle without area goes; the numbers of the others stay.
  write_text(file("seam.off"),
             "OFF\n9 3 0\n0 0 0\n0 0 0\n4 0 0\n0 0 0\n4 0 0\n0 4 0\n1 1 -1\n1 1 1\n3 3 1\n3 0 1 2\n3 3 4 5\n3 6 7 8\n");
  EXPECT_EQ(check("seam.off --weld", 1)["triangle_pairs"], json::parse("[[1,2]]"));
}

TEST_F(CheckPairsTest, ColoursAndPictureShowWhatCollides) {
  write_flat("cloth.obj", 0);
  write_body();
  EXPECT_EQ(run("check cloth.obj --against body.obj -q --ply marked.ply --picture marked.png --vtu marked.vtu").status,
            1);
  const std::string ply = read_text(file("marked.ply"));
  EXPECT_NE(ply.find("property uchar red"), std::string::npos);
  EXPECT_EQ(read_mesh(file("marked.ply")).triangles.size(), 4u);
  // Triangles 0 and 2 of the four are vermilion: the last 16 bytes each.
  const auto colour = [&](std::size_t triangle) { return ply.substr(ply.size() - 16 * (4 - triangle) + 13, 3); };
  EXPECT_EQ(colour(0), "\xd5\x5e" + std::string(1, '\0'));
  EXPECT_EQ(colour(2), colour(0));
  EXPECT_NE(colour(1), colour(0));
  EXPECT_EQ(read_text(file("marked.png")).substr(1, 3), "PNG");
  EXPECT_NE(read_text(file("marked.vtu")).find("Name=\"mesh\""), std::string::npos);
  expect_refused("check cloth.obj --picture marked.jpg", 2, {"marked.jpg", ".png"});
  expect_refused("check cloth.obj --ply marked.obj", 2, {"marked.obj", ".ply"});
}

TEST_F(CheckPairsTest, ResultsCanBeDrawn) {
  write_flat("cloth.obj", 0);
  write_flat("raised.obj", 2);
  write_body();
  for (const char* arguments : {"cloth.obj --against body.obj", "cloth.obj --against body.obj --thickness 0.6",
                                "cloth.obj --to raised.obj --against body.obj", "body.obj --thickness 0.6 --weld",
                                "body.obj --weld --groups pieces"}) {
    EXPECT_EQ(run("check " + std::string(arguments) + " -q --json pairs.json").status, 1) << arguments;
    run_well("render pairs.json -o pairs.png -q");
    run_well("view pairs.json -o pairs.html -q");
  }
}

}  // namespace
}  // namespace selvage::testing
