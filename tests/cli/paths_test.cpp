#include "cli/program.h"
#include "selvage/boundary_path/boundary_path.h"
#include "selvage/io/mesh_file.h"

#include <nlohmann/json.hpp>

namespace selvage::testing {
namespace {

using nlohmann::json;

const std::vector<std::string> kColumns{"query", "x",  "y",  "z",       "element", "found",  "face",       "face_id",
                                        "b0",    "b1", "b2", "sx",      "sy",      "sz",     "distance",   "feature",
                                        "nx",    "ny", "nz", "volumes", "faces",   "culled", "traversals", "elements"};

class PathsTest : public ProgramTest {
 protected:
  json paths(const std::string& arguments) const {
    return json::parse(run_well("paths " + arguments + " --json -").out);
  }

  void make_tangled() const { run_well("make octopus --pose swirl -o tangled.t -q"); }
  void make_box() const { run_well("make box --cell 0.5 -o box.t -q"); }
};

TEST_F(PathsTest, JsonHasTheSchemaAndEveryColumnInOrder) {
  make_tangled();
  const std::string text = run_well("paths tangled.t --json -").out;
  const auto result = nlohmann::ordered_json::parse(text);
  EXPECT_EQ(result["schema"], 1);
  EXPECT_EQ(result["kind"], "paths");
  EXPECT_EQ(result["mesh"], "tangled.t");
  ASSERT_GT(result["queries"], 10);
  EXPECT_EQ(result["queries"], result["paths"].size());
  EXPECT_EQ(result["found"], result["queries"]);
  double deepest = 0;
  std::int64_t traversals = 0;
  for (const auto& path : result["paths"]) {
    std::vector<std::string> columns;
    for (const auto& [name, value] : path.items()) columns.push_back(name);
    ASSERT_EQ(columns, kColumns);
    deepest = std::max(deepest, path["distance"].get<double>());
    traversals += path["traversals"].get<std::int64_t>();
  }
  EXPECT_EQ(result["deepest"], deepest);
  EXPECT_LE(result["median"], result["deepest"]);
  EXPECT_EQ(result["statistics"]["traversals"], traversals);
  EXPECT_GT(traversals, 0);
  EXPECT_TRUE(result["seconds"].contains("paths"));
}

TEST_F(PathsTest, CsvSaysTheSameAsJson) {
  make_tangled();
  run_well("paths tangled.t --json paths.json --csv paths.csv -q");
  const json rows = json::parse(read_text(file("paths.json")))["paths"];
  const auto lines = lines_of(read_text(file("paths.csv")));
  ASSERT_EQ(lines.size(), rows.size() + 1);
  EXPECT_EQ(split(lines[0], ','), kColumns);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto fields = split(lines[i + 1], ',');
    ASSERT_EQ(fields.size(), kColumns.size());
    for (std::size_t c = 0; c < fields.size(); ++c) {
      const json& value = rows[i][kColumns[c]];
      if (kColumns[c] == "face") {
        const auto ids = split(fields[c], ' ');
        ASSERT_EQ(ids.size(), 3u);
        for (int k = 0; k < 3; ++k) EXPECT_EQ(std::stoi(ids[k]), value[k].get<int>());
      } else if (value.is_string()) {
        EXPECT_EQ(fields[c], value.get<std::string>());
      } else {
        EXPECT_EQ(std::stod(fields[c]), value.get<double>()) << kColumns[c];
      }
    }
  }
}

TEST_F(PathsTest, RowsAreTheLibrarysAnswersBitForBit) {
  make_tangled();
  const json rows = paths("tangled.t")["paths"];
  const IndexedMesh mesh = read_mesh(file("tangled.t"));
  const TetMesh topology(static_cast<Index>(mesh.positions.size()), mesh.tetrahedra);
  const BoundaryPathFinder<3> finder(topology, mesh.positions);
  const auto queries = finder.find_penetrating_vertices();
  const auto found = finder.find_paths(queries);
  ASSERT_EQ(rows.size(), queries.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i]["query"], queries[i].source[0]);
    EXPECT_EQ(rows[i]["element"], queries[i].element);
    EXPECT_EQ(rows[i]["x"].get<double>(), queries[i].point[0]);
    EXPECT_EQ(rows[i]["face_id"], found[i].face);
    EXPECT_EQ(rows[i]["distance"].get<double>(), found[i].distance);
    EXPECT_EQ(rows[i]["sz"].get<double>(), found[i].point[2]);
    EXPECT_EQ(rows[i]["b2"].get<double>(), found[i].barycentric[2]);
    EXPECT_EQ(rows[i]["ny"].get<double>(), found[i].normal[1]);
    EXPECT_EQ(rows[i]["face"].get<std::vector<Index>>()[1], topology.boundary_faces()[found[i].face][1]);
  }
}

TEST_F(PathsTest, NeitherThreadsNorCullingChangeTheAnswers) {
  make_tangled();
  run_well("paths tangled.t --csv one.csv --threads 1 --vtu one.vtu -q");
  run_well("paths tangled.t --csv many.csv --threads 6 --vtu many.vtu -q");
  EXPECT_EQ(read_text(file("one.csv")), read_text(file("many.csv")));
  EXPECT_EQ(read_text(file("one.vtu")), read_text(file("many.vtu")));
  json with = paths("tangled.t"), without = paths("tangled.t --no-culling");
  EXPECT_EQ(without["statistics"]["culled"], 0);
  EXPECT_NE(with["statistics"]["culled"], 0);
  for (json* result : {&with, &without}) {
    for (json& row : (*result)["paths"]) {
      for (const char* counter : {"volumes", "faces", "culled", "traversals", "elements"}) row.erase(counter);
    }
  }
  EXPECT_EQ(with["paths"], without["paths"]);
}

TEST_F(PathsTest, PointsFileWithHeaderCommentsAndElements) {
  make_box();
  write_text(file("points.csv"),
             "# mine\nx,y,z\n0.31,0.37,0.1\n\n 0.31 , 0.37 , 0.9 \r\n5,5,5\n+0.6,0.4,0.1,0\n0.5,0.1,0.2,\n");
  const json result = paths("box.t --points points.csv");
  const json& rows = result["paths"];
  ASSERT_GE(rows.size(), 5u);
  EXPECT_EQ(rows[0]["query"], 0);
  EXPECT_NEAR(rows[0]["distance"].get<double>(), 0.1, 1e-15);
  EXPECT_EQ(rows[0]["nz"], -1);
  EXPECT_EQ(rows[0]["feature"], "face");
  EXPECT_EQ(rows[1]["nz"], 1);
  const json& outside = rows[2];
  EXPECT_EQ(outside["query"], 2);
  EXPECT_EQ(outside["found"], 0);
  for (const char* name : {"element", "face", "face_id", "b0", "sx", "distance", "feature", "nz"}) {
    EXPECT_TRUE(outside[name].is_null()) << name;
  }
  EXPECT_EQ(rows[3]["query"], 3);
  EXPECT_EQ(rows[3]["element"], 0);
  EXPECT_EQ(rows.back()["query"], 4);
  EXPECT_NE(rows.back()["element"], nullptr);
}

TEST_F(PathsTest, PointOnSharedFacesHasAnAnswerPerElement) {
  make_box();
  write_text(file("points.csv"), "0.5,0.5,0.5\n");
  const json rows = paths("box.t --points points.csv")["paths"];
  ASSERT_GT(rows.size(), 1u);
  for (const json& row : rows) {
    EXPECT_EQ(row["query"], 0);
    EXPECT_EQ(row["found"], 1);
    EXPECT_NEAR(row["distance"].get<double>(), 0.5, 1e-15);
  }
}

TEST_F(PathsTest, CsvLeavesUnknownFieldsEmpty) {
  make_box();
  write_text(file("points.csv"), "5,5,5\n");
  const auto lines = lines_of(run_well("paths box.t --points points.csv --csv -").out);
  EXPECT_EQ(lines_of(run_well("paths box.t --points - --csv - < points.csv").out), lines);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[1], "0,5,5,5,,0,,,,,,,,,,,,,,0,0,0,0,0");
}

TEST_F(PathsTest, BadPointsFilesAreNamedByLine) {
  make_box();
  const std::vector<std::pair<std::string, std::string>> bad{
      {"0,0,0\n1,2\n", ":2"},      {"x,y,z\n0,0,zero\n", ":2"}, {"0,0,nan\n", ":1"},   {"0,0,0\n0,0,inf\n", ":2"},
      {"0,0,0,99999\n", "99999"},  {"0,0,0,-1\n", "-1"},        {"0,0,0,1.5\n", ":1"}, {"0,0,0,1,1\n", ":1"},
      {"# nothing\n", "no point"}, {"0,0,1e999\n", ":1"},       {"1x,2,3\n", ":1"},    {"x,y,z\nx,y,z\n", ":2"}};
  for (const auto& [text, says] : bad) {
    write_text(file("points.csv"), text);
    expect_refused("paths box.t --points points.csv --csv out.csv", 2, {"points.csv", says});
  }
  expect_refused("paths box.t --points none.csv", 2, {"none.csv"});
  EXPECT_EQ(files(), (std::vector<std::string>{"box.t", "points.csv"}));
}

TEST_F(PathsTest, FailureLeavesNothingAndTouchesNothing) {
  make_box();
  write_text(file("old.csv"), "what stood here");
  expect_refused("paths box.t --csv old.csv --json no/where.json", 2, {"no/where.json"});
  expect_refused("paths box.t --csv old.csv --vtu lines.txt", 2, {"lines.txt", ".vtu"});
  expect_refused("paths box.t --csv old.csv --picture image.jpg", 2, {"image.jpg", ".png"});
  expect_refused("paths box.t --csv old.csv --planar", 2, {"--planar"});
  expect_refused("paths box.t --csv old.csv --picture-size 10 10", 2, {"--picture-size"});
  expect_refused("paths box.t --csv box.t", 2, {"input"});
  expect_refused("paths box.t --csv a.csv --json a.csv", 2, {"a.csv"});
  expect_refused("paths box.t --csv - --json -", 2, {"standard output"});
  expect_refused("paths old.csv --json out.json", 2, {"old.csv"});
  EXPECT_EQ(files(), (std::vector<std::string>{"box.t", "old.csv"}));
  EXPECT_EQ(read_text(file("old.csv")), "what stood here");
}

TEST_F(PathsTest, FullDiskIsAFailureOfTheComputation) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  make_tangled();
  const Outcome outcome = run("paths tangled.t --json - > /dev/full");
  EXPECT_EQ(outcome.status, 3);
  EXPECT_EQ(lines_of(outcome.err).size(), 1u) << outcome.err;
}

TEST_F(PathsTest, SurfaceInSpaceIsRefused) {
  write_text(file("surface.off"), "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 1\n3 0 1 2\n");
  expect_refused("paths surface.off", 2, {"surface.off", "tetrahedral"});
}

TEST_F(PathsTest, PlanarMeshOfTwoOverlappingTriangles) {
  write_text(file("plane.off"), "OFF\n6 2 0\n0 0 0\n4 0 0\n0 4 0\n1 0.5 0\n9 9 0\n8 9.5 0\n3 0 1 2\n3 3 4 5\n");
  for (const char* flag : {"", " --planar"}) {
    const json result = paths(std::string("plane.off") + flag);
    ASSERT_EQ(result["queries"], 1);
    const json& row = result["paths"][0];
    EXPECT_EQ(row["query"], 3);
    EXPECT_EQ(row["element"], 0);
    EXPECT_EQ(row["face"], json({0, 1}));
    EXPECT_EQ(row["distance"], 0.5);
    EXPECT_EQ(row["sx"], 1);
    EXPECT_EQ(row["sz"], 0);
    EXPECT_EQ(row["b2"], nullptr);
    EXPECT_EQ(row["ny"], -1);
  }
  write_text(file("points.csv"), "1,0.5,0.1\n");
  expect_refused("paths plane.off --points points.csv", 2, {"points.csv:1", "z"});
}

TEST_F(PathsTest, VtuHoldsOneLineAPathWithItsDepth) {
  make_tangled();
  run_well("paths tangled.t --vtu lines.vtu --json paths.json -q");
  const std::string vtu = read_text(file("lines.vtu"));
  const std::string found = std::to_string(json::parse(read_text(file("paths.json")))["found"].get<int>());
  EXPECT_NE(vtu.find("NumberOfCells=\"" + found + "\""), std::string::npos) << vtu.substr(0, 400);
  EXPECT_NE(vtu.find("Name=\"depth\""), std::string::npos);
  make_box();
  run_well("paths box.t --vtu empty.vtu -q");
  EXPECT_NE(read_text(file("empty.vtu")).find("NumberOfCells=\"0\""), std::string::npos);
}

TEST_F(PathsTest, PictureIsAPngOfTheSizeAskedFor) {
  make_tangled();
  run_well("paths tangled.t --picture a.png --picture-size 320 200 --threads 1 -q");
  run_well("paths tangled.t --picture b.png --picture-size 320 200 --threads 5 -q");
  run_well("paths tangled.t --picture c.png --picture-size 320 200 --view 0 -1 0 -q");
  const std::string png = read_text(file("a.png"));
  ASSERT_GT(png.size(), 1000u);
  EXPECT_EQ(png.substr(1, 3), "PNG");
  EXPECT_EQ(png.substr(16, 8), std::string("\0\0\1\x40\0\0\0\xc8", 8));
  EXPECT_EQ(png, read_text(file("b.png")));
  EXPECT_NE(png, read_text(file("c.png")));
}

TEST_F(PathsTest, SummarySaysWhatWasFound) {
  make_tangled();
  const std::string text = run_well("paths tangled.t").out;
  for (const char* word : {"penetrating points", "paths found", "deepest", "median depth", "time"}) {
    EXPECT_NE(text.find(word), std::string::npos) << word;
  }
  EXPECT_EQ(run_well("paths tangled.t --quiet").out, "");
}

}  // namespace
}  // namespace selvage::testing
