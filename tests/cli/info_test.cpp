#include "cli/program.h"

#include <nlohmann/json.hpp>

namespace selvage::testing {
namespace {

using nlohmann::json;

class InfoTest : public ProgramTest {
 protected:
  json info(const std::string& mesh) const { return json::parse(run_well("info " + mesh + " --json -").out); }
};

constexpr const char* kTet =
    "Vertex 0 0 0 0\nVertex 1 1 0 0\nVertex 2 0 1 0\nVertex 3 0 0 1\nVertex 4 9 9 9\nTet 0 0 1 2 3\n";

TEST_F(InfoTest, OneTetrahedron) {
  write_text(file("one.t"), kTet);
  const json one = info("one.t");
  EXPECT_EQ(one["schema"], 1);
  EXPECT_EQ(one["kind"], "info");
  EXPECT_EQ(one["vertices"], 5);
  EXPECT_EQ(one["unused_vertices"], 1);
  EXPECT_EQ(one["tetrahedra"], 1);
  EXPECT_EQ(one["boundary_faces"], 4);
  EXPECT_EQ(one["boundary_ridges"], 6);
  EXPECT_EQ(one["boundary_vertices"], 4);
  EXPECT_EQ(one["boundary_components"], 1);
  EXPECT_NEAR(one["volume"].get<double>(), 1.0 / 6, 1e-15);
  EXPECT_NEAR(one["quality"]["smallest_angle"].get<double>(), 54.735610317245346, 1e-9);
  EXPECT_NEAR(one["quality"]["largest_angle"].get<double>(), 90, 1e-9);
  // Inradius 1 / (3 + sqrt 3), circumradius sqrt 3 / 2.
  EXPECT_NEAR(one["quality"]["worst_radius_ratio"].get<double>(), 0.7320508075688773, 1e-12);
  EXPECT_EQ(one["bounding_box"]["upper"], json({9, 9, 9}));
}

TEST_F(InfoTest, InvertedAndFlatElementsAreCounted) {
  write_text(file("bad.t"),
             "Vertex 0 0 0 0\nVertex 1 1 0 0\nVertex 2 0 1 0\nVertex 3 0 0 1\n"
             "Vertex 4 5 0 0\nVertex 5 6 0 0\nVertex 6 5 1 0\nVertex 7 7 3 0\nTet 0 0 1 3 2\nTet 1 4 5 6 7\n");
  const json bad = info("bad.t");
  EXPECT_EQ(bad["inverted_elements"], 1);
  EXPECT_EQ(bad["degenerate_elements"], 1);
  EXPECT_EQ(bad["components"], 2);
  EXPECT_EQ(bad["quality"]["worst_radius_ratio"], 0);
  EXPECT_LT(bad["volume"], 0);
}

TEST_F(InfoTest, TwoObjectsAndAHollowOne) {
  run_well("make box --cell 0.5 --pose overlap -o two.t -q");
  EXPECT_EQ(info("two.t")["components"], 2);
  EXPECT_NEAR(info("two.t")["volume"].get<double>(), 2, 1e-12);
}

TEST_F(InfoTest, RegularTriangleHasTheBestQuality) {
  write_text(file("regular.off"), "OFF\n3 1 0\n0 0 1\n1 0 1\n0.5 0.8660254037844386 1\n3 0 1 2\n");
  const json regular = info("regular.off");
  EXPECT_NEAR(regular["quality"]["worst_radius_ratio"].get<double>(), 1, 1e-12);
  EXPECT_NEAR(regular["quality"]["smallest_angle"].get<double>(), 60, 1e-9);
  EXPECT_NEAR(regular["quality"]["largest_angle"].get<double>(), 60, 1e-9);
  EXPECT_NEAR(regular["area"].get<double>(), 0.4330127018922193, 1e-12);
}

TEST_F(InfoTest, SurfaceWithBordersFinsAndLoosePieces) {
  // Three triangles on the edge 0 1, a loose triangle, and one without area.
  write_text(file("fins.off"),
             "OFF\n10 5 0\n0 0 0\n1 0 0\n0 1 0\n0 -1 0\n0 0 1\n5 5 5\n6 5 5\n5 6 5\n7 5 5\n8 5 5\n"
             "3 0 1 2\n3 0 1 3\n3 0 1 4\n3 5 6 7\n3 6 8 9\n");
  const json fins = info("fins.off");
  EXPECT_EQ(fins["triangles"], 5);
  EXPECT_EQ(fins["edges"], 13);
  EXPECT_EQ(fins["border_edges"], 12);
  EXPECT_EQ(fins["non_manifold_edges"], 1);
  EXPECT_EQ(fins["components"], 3);
  EXPECT_EQ(fins["degenerate_elements"], 1);
  EXPECT_FALSE(fins.contains("inverted_elements"));
}

TEST_F(InfoTest, PlanarMeshTellsInvertedTriangles) {
  write_text(file("plane.off"), "OFF\n6 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 0\n4 0 0\n3 1 0\n3 0 1 2\n3 3 5 4\n");
  const json plane = info("plane.off");
  EXPECT_EQ(plane["inverted_elements"], 1);
  EXPECT_EQ(plane["boundary_faces"], 6);
  EXPECT_EQ(plane["components"], 2);
}

TEST_F(InfoTest, HumanTextSaysTheSame) {
  run_well("make ball --cell 0.1 -o ball.t -q");
  const json ball = info("ball.t");
  const std::string text = run_well("info ball.t").out;
  const std::string vertices = std::to_string(ball["vertices"].get<int>());
  ASSERT_GE(vertices.size(), 4u);
  const std::string grouped = vertices.substr(0, vertices.size() - 3) + "," + vertices.substr(vertices.size() - 3);
  EXPECT_NE(text.find(grouped), std::string::npos) << text;
  for (const char* word : {"inverted elements", "overwound interior ridges", "dihedral angles", "bounding box"}) {
    EXPECT_NE(text.find(word), std::string::npos) << word;
  }
  EXPECT_EQ(run_well("info ball.t --quiet").out, "");
}

TEST_F(InfoTest, ThreadsDoNotChangeTheAnswer) {
  run_well("make octopus --pose swirl -o octopus.t -q");
  json one = json::parse(run_well("info octopus.t --json - --threads 1").out);
  json many = json::parse(run_well("info octopus.t --json - --threads 7").out);
  one.erase("seconds");
  many.erase("seconds");
  EXPECT_EQ(one, many);
}

}  // namespace
}  // namespace selvage::testing
