#include "page/result_page.h"
#include "page/mesh_page.h"
#include "page/run_page.h"
#include "page_blocks.h"
#include "selvage/core/error.h"
#include "selvage/scene/frames.h"
#include "selvage/scene/run.h"
#include "selvage/shapes/shapes.h"
#include "temporary_folder.h"

namespace selvage {
namespace {

namespace fs = std::filesystem;
using test::block_of;
using test::has_block;
using test::head_of;
using test::read_text;
using test::TemporaryFolder;
using test::unpack;
using test::write_text;

/// Two blocks, one in the other from the start, over a plane that moves.
constexpr const char* kScene = R"({"selvage_scene": 1, "frames": 3, "substeps": 1, "iterations": 1,
  "contact": {"mode": "none"},
  "bodies": [
    {"name": "<low>", "mesh": {"shape": "box", "size": [1, 1, 1], "cell": 0.5}, "translate": [0, 0, 0.1]},
    {"name": "high", "mesh": {"shape": "box", "size": [1, 1, 1], "cell": 0.5}, "translate": [0.3, 0.2, 0.9]}],
  "colliders": [{"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]},
                 "motion": {"keyframes": [{"time": 0}, {"time": 1, "translate": [0, 0, 1]}]}},
                {"sphere": {"centre": [5, 0, 0], "radius": 1}}]})";

void write_run(const fs::path& folder) {
  RunOptions options;
  options.folder = folder;
  run_scene(parse_scene(kScene, "blocks.json"), options);
}

template <typename Call>
std::string refusal(Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "not refused";
}

void expect_words(const std::string& message, const std::vector<std::string>& words) {
  for (const std::string& word : words) EXPECT_NE(message.find(word), std::string::npos) << message;
}

struct ReadMarks {
  std::vector<std::int64_t> vertices, triangles, features, touch_vertices;
  std::vector<float> numbers;
  std::string kinds, touch_kinds, touch_places, touch_normals;

  explicit ReadMarks(const std::string& bytes) {
    std::array<std::int32_t, 4> counts{};
    std::memcpy(counts.data(), bytes.data(), sizeof counts);
    std::size_t at = sizeof counts;
    const auto take = [&](std::size_t size) {
      at += size;
      return bytes.substr(at - size, size);
    };
    const auto paths = static_cast<std::size_t>(counts[0]), pairs = static_cast<std::size_t>(counts[1]);
    vertices = unpack(take(4 * paths), 4, 1);
    numbers.resize(7 * paths);
    std::memcpy(numbers.data(), take(28 * paths).data(), 28 * paths);
    triangles = unpack(take(8 * pairs), 4, 2);
    if (counts[2] == 1) features = unpack(take(16 * pairs), 4, 4);
    kinds = take(pairs);
    const auto touches = static_cast<std::size_t>(counts[3]);
    touch_vertices = unpack(take(8 * touches), 4, 2);
    touch_kinds = take(touches);
    touch_places = take(touches);
    touch_normals = take(3 * touches);
    EXPECT_EQ(at, bytes.size());
  }
};

TEST(RunPage, HoldsWhatTheFolderHolds) {
  const TemporaryFolder folder;
  write_run(folder.path());
  const std::string page = print_run_page(folder.path());
  const auto head = head_of(page);
  EXPECT_EQ(head["kind"], "run");
  EXPECT_EQ(head["title"], "blocks");
  EXPECT_EQ(head["frames"], (std::vector<int>{0, 1, 2, 3}));
  EXPECT_NEAR(head["times"][3].get<double>(), 0.05, 1e-12);
  EXPECT_EQ(head["scene"]["bodies"][0]["name"], "<low>");
  EXPECT_EQ(head["scene"]["colliders"][0]["kind"], "plane");
  EXPECT_EQ(head["scene"]["colliders"][0]["motion"]["keyframes"][1]["translate"][2], 1.0);
  EXPECT_EQ(head["scene"]["colliders"][1]["radius"], 1.0);
  EXPECT_EQ(head["summary"]["outcome"], "finished");
  EXPECT_EQ(head["statistics"]["columns"][0], "frame");
  EXPECT_EQ(head["statistics"]["rows"].size(), 4u);
  EXPECT_EQ(head["statistics"]["rows"][2].size(), head["statistics"]["columns"].size());

  // Each block has 3^3 vertices, of which one lies within.
  EXPECT_EQ(head["vertices_of_mesh"], 54);
  ASSERT_EQ(head["vertices"], 52);
  const auto bodies = unpack(block_of(page, "bodies"), 4, 1);
  EXPECT_EQ(std::count(bodies.begin(), bodies.end(), 1), 26);
  EXPECT_EQ(block_of(page, "rest").size(), 52u * 12);
  EXPECT_TRUE(has_block(page, "pose3"));
  EXPECT_FALSE(has_block(page, "pose4"));
}

TEST(RunPage, MarksAreWhatTheStatisticsCount) {
  const TemporaryFolder folder;
  write_run(folder.path());
  const std::string page = print_run_page(folder.path());
  const auto head = head_of(page);
  const auto column = [&](const char* name) {
    const auto& columns = head["statistics"]["columns"];
    return static_cast<std::size_t>(std::find(columns.begin(), columns.end(), name) - columns.begin());
  };
  ASSERT_EQ(head["marked"][0], 0);
  const auto row = head["statistics"]["rows"][0];
  const ReadMarks marks(block_of(page, "marks0"));
  EXPECT_GT(marks.vertices.size(), 0u);
  EXPECT_EQ(marks.vertices.size(), row[column("penetrating_vertices")].get<std::size_t>());
  EXPECT_EQ(marks.kinds.size(), row[column("triangle_pairs")].get<std::size_t>());
  EXPECT_EQ(marks.kinds, std::string(marks.kinds.size(), '\2'));
  float deepest = 0;
  for (std::size_t i = 0; i < marks.vertices.size(); ++i) deepest = std::max(deepest, marks.numbers[7 * i]);
  EXPECT_NEAR(deepest, row[column("deepest_penetration")].get<double>(), 1e-6);
  EXPECT_NE(head["warnings"][0].get<std::string>().find("Before the first frame"), std::string::npos);

  RunPageOptions plain;
  plain.marks = false;
  EXPECT_TRUE(head_of(print_run_page(folder.path(), plain))["marked"].empty());
}

TEST(RunPage, TouchesAreThoseOfEachFrame) {
  const TemporaryFolder folder;
  // A block that rests on a plane from the start, and one that never comes near anything.
  std::string scene = kScene;
  const auto put = [&](const std::string& before, const std::string& after) {
    scene.replace(scene.find(before), before.size(), after);
  };
  put("[0, 0, 0.1]", "[0, 0, 0.001]");
  put("[0.3, 0.2, 0.9]", "[9, 9, 9]");
  put(R"("translate": [0, 0, 1]}]})", R"("translate": [0, 0, 0]}]})");
  RunOptions options;
  options.folder = folder.path();
  run_scene(parse_scene(scene, "blocks.json"), options);
  const std::string page = print_run_page(folder.path());
  const auto head = head_of(page);
  EXPECT_EQ(head["marked"], (std::vector<int>{0, 1, 2, 3}));
  EXPECT_GT(head["touching_distance"].get<double>(), 0.001);
  const ReadMarks marks(block_of(page, "marks0"));
  EXPECT_EQ(marks.vertices.size() + marks.kinds.size(), 0u);
  EXPECT_EQ(marks.touch_kinds, std::string(9, '\6'));  // the lower side has nine vertices
  EXPECT_EQ(marks.touch_places, std::string(9, '\0'));
  EXPECT_EQ(marks.touch_normals, std::string(18, '\0') + std::string(9, '\x7f'));
  const auto rest = block_of(page, "rest");
  for (std::size_t i = 0; i < 18; ++i) {
    float z = 0;
    std::memcpy(&z, rest.data() + 12 * static_cast<std::size_t>(marks.touch_vertices[i]) + 8, sizeof z);
    EXPECT_EQ(z, 0.001f);
  }
}

TEST(RunPage, LeavesOutFramesButNotTheLast) {
  const TemporaryFolder folder;
  write_run(folder.path());
  RunPageOptions options;
  options.every = 2;
  EXPECT_EQ(head_of(print_run_page(folder.path(), options))["frames"], (std::vector<int>{0, 2, 3}));
  options.every = 1000;
  EXPECT_EQ(head_of(print_run_page(folder.path(), options))["frames"], (std::vector<int>{0, 3}));
}

TEST(RunPage, RefusesFoldersThatAreBroken) {
  const TemporaryFolder folder;
  const auto refused = [](const fs::path& run) { return refusal([&] { print_run_page(run); }); };
  expect_words(refused(folder.path()), {"holds no run", "simulate -o"});
  const auto broken = [&](const std::string& name, const auto& damage) {
    const fs::path run = folder.path() / name;
    write_run(run);
    damage(run);
    return refused(run);
  };
  expect_words(broken("a", [](const fs::path& run) { fs::remove(checkpoint_path(run)); }),
               {"checkpoint.bin", "missing"});
  expect_words(broken("b", [](const fs::path& run) { fs::resize_file(frame_path(run, 2), 100); }),
               {"frame_000002.bin", "shorter than its header"});
  expect_words(broken("c", [](const fs::path& run) { fs::remove(frame_path(run, 1)); }), {"frame_000001.bin"});
  expect_words(broken("d",
                      [](const fs::path& run) {
                        fs::copy_file(rest_path(run), frame_path(run, 1), fs::copy_options::overwrite_existing);
                        std::string bytes = read_text(frame_path(run, 1));
                        bytes[56] = static_cast<char>(bytes[56] + 1);
                        write_text(frame_path(run, 1), bytes);
                      }),
               {"frame_000001.bin", "another run"});
  expect_words(broken("e", [](const fs::path& run) { write_text(scene_path(run), "{"); }), {"scene.json", "no JSON"});
  expect_words(broken("f", [](const fs::path& run) { write_text(run / "statistics.csv", "frame\n"); }),
               {"statistics.csv", "other columns"});
  expect_words(broken("g",
                      [](const fs::path& run) {
                        std::string bytes = read_text(topology_path(run));
                        bytes[bytes.size() - 1] = '\x40';
                        write_text(topology_path(run), bytes);
                      }),
               {"topology.bin", "face of no vertex"});
  expect_words(broken("h",
                      [](const fs::path& run) {
                        std::string bytes = read_text(frame_path(run, 1));
                        const float nan = std::numeric_limits<float>::quiet_NaN();
                        std::memcpy(bytes.data() + 64, &nan, sizeof nan);
                        write_text(frame_path(run, 1), bytes);
                      }),
               {"frame_000001.bin", "not finite"});
}

TEST(RunPage, ShowsFoldersOfEarlierVersionsWithoutColliders) {
  const TemporaryFolder folder;
  write_run(folder.path());
  fs::remove(scene_path(folder.path()));
  fs::remove(rest_path(folder.path()));
  fs::remove(folder.path() / "summary.json");
  const auto head = head_of(print_run_page(folder.path()));
  EXPECT_FALSE(head.contains("scene"));
  EXPECT_NE(head["warnings"].dump().find("colliders are not shown"), std::string::npos);
}

IndexedMesh tetrahedra(const Vec3& shift) {
  IndexedMesh mesh;
  for (const Vec3& p : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)})
    mesh.positions.push_back(p + shift);
  mesh.tetrahedra = {{0, 1, 2, 3}};
  return mesh;
}

TEST(MeshPage, ShowsTheBoundary) {
  const TemporaryFolder folder;
  write_mesh(folder.path() / "a.vtu", tetrahedra({0, 0, 0}));
  const auto head = head_of(print_mesh_page(folder.path() / "a.vtu"));
  EXPECT_EQ(head["kind"], "mesh");
  EXPECT_EQ(head["title"], "a.vtu");
  EXPECT_EQ(head["triangles"], 4);
  EXPECT_EQ(head["times"].size(), 1u);
}

TEST(ResultPage, PairsOfTrianglesOfOnePoseAndOfAStep) {
  const TemporaryFolder folder;
  write_mesh(folder.path() / "a.vtu", tetrahedra({0, 0, 0}));
  write_mesh(folder.path() / "b.vtu", tetrahedra({0, 0, 2}));
  // The mesh is found beside the result.
  const fs::path json = folder.path() / "pairs.json";
  write_text(json, R"({"schema": 1, "kind": "discrete", "mesh": "a.vtu", "method": "auto",
    "triangle_pairs": [[0, 3], [1, 2]], "contacts": ["touching", "coplanar overlap"]})");
  const std::string page = print_result_page(json);
  const ReadMarks marks(block_of(page, "marks0"));
  EXPECT_EQ(marks.triangles, (std::vector<std::int64_t>{0, 3, 1, 2}));
  EXPECT_EQ(marks.kinds, std::string("\1\3"));

  write_text(json, R"({"schema": 1, "kind": "continuous", "mesh": "a.vtu", "to": "b.vtu",
    "vertex_face": [[3, 0]], "edge_edge": [[0, 1, 2, 3]], "free_step": 0.5})");
  const std::string step = print_result_page(json);
  const ReadMarks moving(block_of(step, "marks0"));
  EXPECT_EQ(moving.kinds, std::string("\4\5"));
  EXPECT_EQ(moving.features, (std::vector<std::int64_t>{3, 0, -1, -1, 0, 1, 2, 3}));
  EXPECT_EQ(head_of(step)["times"], (std::vector<double>{0, 1}));
}

TEST(ResultPage, WaysOutOfVerticesAndOfFreePoints) {
  const TemporaryFolder folder;
  write_mesh(folder.path() / "a.vtu", tetrahedra({0, 0, 0}));
  const fs::path json = folder.path() / "paths.json";
  write_text(json, R"({"schema": 1, "kind": "paths", "mesh": "a.vtu", "paths": [
    {"query": 3, "x": 0, "y": 0, "z": 1, "found": 1, "sx": 0, "sy": 0, "sz": 3, "distance": 2},
    {"query": 1, "x": 0.5, "y": 0, "z": 0, "found": 0, "sx": null, "sy": null, "sz": null, "distance": null}]})");
  const ReadMarks marks(block_of(print_result_page(json), "marks0"));
  EXPECT_EQ(marks.vertices, (std::vector<std::int64_t>{3, -1}));
  EXPECT_EQ(marks.numbers, (std::vector<float>{2, 0, 0, 1, 0, 0, 3, -1, 0.5, 0, 0, 0.5, 0, 0}));
}

TEST(ResultPage, TheMeshBeforeAndAfterResolve) {
  const TemporaryFolder folder;
  write_mesh(folder.path() / "a.vtu", tetrahedra({0, 0, 0}));
  write_mesh(folder.path() / "b.vtu", tetrahedra({0, 0, 2}));
  const fs::path json = folder.path() / "report.json";
  write_text(json, R"({"schema": 1, "kind": "resolve", "mesh": "a.vtu", "outcome": "resolved", "output": "b.vtu"})");
  EXPECT_EQ(head_of(print_result_page(json))["times"].size(), 2u);
  write_text(json, R"({"schema": 1, "kind": "resolve", "mesh": "a.vtu", "outcome": "stuck"})");
  expect_words(refusal([&] { print_result_page(json); }), {"report.json", "not resolved"});
  EXPECT_EQ(head_of(print_result_page(json, folder.path() / "b.vtu"))["times"].size(), 2u);
}

TEST(ResultPage, RefusesWhatIsNoResultOrDoesNotFit) {
  const TemporaryFolder folder;
  write_mesh(folder.path() / "a.vtu", tetrahedra({0, 0, 0}));
  IndexedMesh two = tetrahedra({0, 0, 0});
  two.positions.emplace_back(5, 5, 5);
  write_mesh(folder.path() / "two.vtu", two);
  const fs::path json = folder.path() / "r.json";
  const auto refused = [&](const std::string& text, const std::vector<std::string>& words) {
    write_text(json, text);
    const std::string message = refusal([&] { print_result_page(json); });
    expect_words(message, words);
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  };
  refused("{", {"r.json", "is no JSON"});
  refused("[]", {"no result of selvage"});
  refused(R"({"kind": 3})", {"no result of selvage"});
  refused(R"({"kind": "discrete", "schema": 2})", {"schema"});
  refused(R"({"kind": "discrete", "schema": 1})", {"names no mesh"});
  refused(R"({"kind": "discrete", "schema": 1, "mesh": "none.vtu"})", {"none.vtu"});
  refused(R"({"kind": "simulation", "schema": 1, "mesh": "a.vtu"})", {"'simulation'", "cannot be shown"});
  refused(R"({"kind": "discrete", "schema": 1, "mesh": "a.vtu"})", {"has no triangle_pairs"});
  const std::string pairs = R"({"kind": "discrete", "schema": 1, "mesh": "a.vtu", "contacts": ["crossing"], )";
  refused(pairs + R"("triangle_pairs": [[0, 4]]})", {"does not fit the mesh a.vtu"});
  refused(pairs + R"("triangle_pairs": [[-1, 1]]})", {"does not fit"});
  refused(pairs + R"("triangle_pairs": [[0.5, 1]]})", {"does not fit"});
  refused(pairs + R"("triangle_pairs": [3]})", {"does not fit"});
  refused(pairs + R"("triangle_pairs": []})", {"other numbers"});
  refused(R"({"kind": "paths", "schema": 1, "mesh": "a.vtu", "paths": [{"x": 0}]})", {"a path without a place"});
  refused(R"({"kind": "resolve", "schema": 1, "mesh": "a.vtu", "output": "two.vtu"})", {"two.vtu", "other vertices"});
  refused(R"({"kind": "continuous", "schema": 1, "mesh": "two.vtu", "to": "two.vtu", "edge_edge": [],
             "vertex_face": [[4, 0]]})",
          {"no triangle has"});
}

}  // namespace
}  // namespace selvage
