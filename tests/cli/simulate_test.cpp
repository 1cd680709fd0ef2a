#include "cli/program.h"

#include <spawn.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <csignal>
#include <map>
#include <random>
#include <thread>

namespace selvage::testing {
namespace {

using Simulate = ProgramTest;

const char* const kBlocks = R"({"selvage_scene": 1, "frames": 20, "substeps": 4,
  "bodies": [{"mesh": {"shape": "box", "size": [1, 1, 1], "cell": 0.25}, "material": {"youngs_modulus": 2e4},
              "translate": [0, 0, 0.05], "instances": {"list": [{}, {"translate": [0.3, 0.2, 1.05]}]},
              "velocity": [0, 0, -2]}],
  "colliders": [{"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}]})";

TEST_F(Simulate, WritesTheRunAndSaysWhatItDid) {
  write_text(file("blocks.json"), kBlocks);
  const Outcome outcome = run_well("simulate blocks.json -o run --frames 3 --vtu --surface obj");
  for (const char* word :
       {"blocks", "2 bodies", "frames", "12 of 0.00417 s", "penetrating vertices", "frames a minute"})
    EXPECT_NE(outcome.out.find(word), std::string::npos) << outcome.out << "without " << word;
  for (const char* name : {"run/frames/frame_000003.bin", "run/vtu/frame_000003.vtu", "run/surface/frame_000003.obj",
                           "run/statistics.csv", "run/summary.json", "run/frames.pvd"})
    EXPECT_TRUE(fs::exists(file(name))) << name;
  EXPECT_EQ(run_well("simulate blocks.json -o run --frames 4 --resume --quiet").out, "");
  const auto report = nlohmann::json::parse(run_well("simulate blocks.json -o run --resume --frames 5 --json -").out);
  EXPECT_EQ(report["schema"], 1);
  EXPECT_EQ(report["frames"], 5);
  EXPECT_EQ(report["vertices"], 250);
  EXPECT_EQ(lines_of(read_text(file("run/statistics.csv"))).size(), 7u);
}

TEST_F(Simulate, SaysAtTheStartThatBodiesOverlap) {
  write_text(file("blocks.json"), kBlocks);
  EXPECT_EQ(run_well("simulate blocks.json -o apart --frames 0").out.find("at the start"), std::string::npos);
  // 0.06 m into the block below: 3 x 4 vertices of each.
  std::string overlapping = kBlocks;
  overlapping.replace(overlapping.find("1.05]"), 5, "0.94]");
  write_text(file("overlapping.json"), overlapping);
  const std::string said = run_well("simulate overlapping.json -o over --frames 1").out;
  EXPECT_EQ(said.find("at the start     24 vertices inside bodies, at most 60 mm deep\n"), 0u) << said;
  EXPECT_EQ(run_well("simulate overlapping.json -o quiet --frames 1 -q").out, "");
  EXPECT_EQ(run_well("simulate overlapping.json -o over --frames 2 --resume").out.find("at the start"),
            std::string::npos);
  const auto report = nlohmann::json::parse(run_well("simulate overlapping.json -o json --frames 0 --json -").out);
  EXPECT_EQ(report["at_start"]["penetrating_vertices"], 24);
  EXPECT_NEAR(report["at_start"]["deepest_penetration"].get<double>(), 0.06, 1e-9);
}

TEST_F(Simulate, SaysWhatStandsInWhatByPairsOfBodiesAndColliders) {
  // Two cubes in one another, a third apart, and a wall between the vertices of the first.
  const std::string scene = R"({"selvage_scene": 1, "frames": 5, "gravity": [0, 0, 0],
    "contact": {"mode": "none"}, "start_outside": "allow",
    "bodies": [
      {"name": "a", "mesh": {"shape": "box", "size": [1, 1, 1], "cell": 0.5}},
      {"name": "b", "mesh": {"shape": "box", "size": [1, 1, 1], "cell": 0.5}, "translate": [0.9, 0.07, 0.03]},
      {"name": "c", "mesh": {"shape": "box", "size": [1, 1, 1], "cell": 0.5}, "translate": [5, 0, 0]}],
    "colliders": [{"plane": {"point": [0, 0, -9], "normal": [0, 0, 1]}},
                  {"mesh": {"shape": "box", "size": [0.1, 3, 3], "cell": 9}, "translate": [0.2, -1, -2.2]}]})";
  write_text(file("crossing.json"), scene);
  const std::string said = run_well("simulate crossing.json -o run --check-every 2 --json report.json").out;
  for (const char* word : {"frame 0 ", "frame 2 ", "frame 4 ", "pairs of triangles cross", "deepest 100 mm",
                           "in 'a' and 'b'", "colliders in bodies"})
    EXPECT_NE(said.find(word), std::string::npos) << said << "without " << word;
  EXPECT_EQ(said.find("frame 3 "), std::string::npos);
  EXPECT_TRUE(fs::exists(file("run/checks/frame_000004.json")));
  EXPECT_FALSE(fs::exists(file("run/checks/frame_000005.json")));
  const auto check = nlohmann::json::parse(read_text(file("run/checks/frame_000002.json")));
  EXPECT_EQ(check["crosses"], true);
  const auto report = nlohmann::json::parse(read_text(file("report.json")));
  for (const auto& found : {check, report["at_end"]}) {
    ASSERT_EQ(found["body_pairs"].size(), 1u) << found;
    EXPECT_EQ(found["body_pairs"][0]["bodies"], nlohmann::json::parse(R"(["a", "b"])"));
    EXPECT_NEAR(found["body_pairs"][0]["deepest_vertex"].get<double>(), 0.1, 1e-9);
    EXPECT_NEAR(found["body_pairs"][0]["deepest_edge"].get<double>(), 0.1, 1e-9);
    EXPECT_GT(found["body_pairs"][0]["triangle_pairs"], 0);
    ASSERT_EQ(found["colliders"].size(), 1u) << found;
    EXPECT_EQ(found["colliders"][0]["collider"], 1);
    EXPECT_GT(found["colliders"][0]["points"], 0);
  }
  expect_refused("simulate crossing.json -o refused --set /start_outside=refuse", 2,
                 {"body 'a': colliders[1] starts in it", "m deep; move one of the two"});
  write_text(file("blocks.json"), kBlocks);
  const std::string free = run_well("simulate blocks.json -o free --frames 2 --check-every 1").out;
  EXPECT_NE(free.find("frame 1          free\n"), std::string::npos) << free;
  EXPECT_EQ(free.find("colliders in bodies"), std::string::npos);
  expect_refused("simulate blocks.json -o no --check-every 0", 2, {"--check-every"});
}

TEST_F(Simulate, SaysThatABodyIsBroughtOutOfItself) {
  write_text(file("crossed.json"), R"({"selvage_scene": 1, "bodies": [
      {"mesh": {"shape": "rod", "elements": 400}, "poses": [{"pose": "self-crossing", "crossings": 1}]}]})");
  const auto run_with = [&](const std::string& changes) {
    const std::string said = run_well("simulate crossed.json --frames 2 --json report.json -o run" + changes).out;
    const auto report = nlohmann::json::parse(read_text(file("report.json")));
    return std::pair(said, report["at_start"]["resolved_bodies"]);
  };
  const auto [said, count] = run_with("1");
  EXPECT_NE(said.find("inside bodies, at most"), std::string::npos) << said;
  EXPECT_NE(said.find("before frame 1   1 body tangled in itself brought out, "), std::string::npos) << said;
  EXPECT_EQ(count, 1);
  const auto [other, none] = run_with("2 --set /start_tangled=simulate");
  EXPECT_EQ(other.find("brought out"), std::string::npos) << other;
  EXPECT_EQ(none, 0);
}

TEST_F(Simulate, TakesValuesInPlaceOfTheScenes) {
  write_text(file("blocks.json"), kBlocks);
  const auto run_with = [&](const std::string& changes) {
    return nlohmann::json::parse(run_well("simulate blocks.json -o run" + changes + " --json -").out);
  };
  EXPECT_EQ(run_with("0 --frames 0")["vertices"], 250);
  EXPECT_EQ(run_with("1 --set /frames=0 --set /bodies/0/mesh/cell=0.5")["vertices"], 54);
  // A whole object; a member that was not there; the last of two; a text.
  EXPECT_EQ(run_with("2 --frames 0 --set '/bodies/0/mesh={\"shape\": \"box\", \"cell\": 1}'")["vertices"], 16);
  EXPECT_EQ(run_with("3 --set /frames=3 --set /frames=1 --set /contact/mode=none")["frames"], 1);
  EXPECT_EQ(run_with("4 --frames 0 --set /bodies/0/name=brick")["frames"], 0);
  EXPECT_NE(read_text(file("run4/scene.json")).find("brick[1]"), std::string::npos);
  // Another value is another scene.
  expect_refused("simulate blocks.json -o run1 --resume", 2, {"another scene"});
  EXPECT_EQ(run_with("1 --resume --set /frames=0 --set /bodies/0/mesh/cell=0.5")["frames"], 0);
}

TEST_F(Simulate, RefusesPlacesThatNoSceneHas) {
  write_text(file("blocks.json"), kBlocks);
  const auto refused = [&](const std::string& change, const std::vector<std::string>& words) {
    expect_refused("simulate blocks.json -o run --set " + change, 2, words);
  };
  refused("/bodies/7/mesh/cell=1", {"/bodies/7/mesh/cell=1", "/bodies has no item '7'", "use 0 to 0"});
  refused("/bodies/-/name=1", {"/bodies has no item '-'"});
  refused("/bodies/0/mesh/lenght=3", {"bodies[0].mesh.lenght", "did you mean 'length'?"});
  refused("/bodys/0/mesh/cell=3", {"bodys", "did you mean 'bodies'?"});
  refused("/bodies/0/mesh/cell/x=3", {"/bodies/0/mesh/cell is 0.25, which has no 'x'"});
  refused("/bodies/0/mesh/cell=fine", {"bodies[0].mesh.cell", "\"fine\" is no number"});
  refused("/scales/paper=3", {"--scale"});
  refused("/bodies/~2=3", {"'/bodies/~2' is no place"});
  refused("frames=3", {"frames=3: does not say what to set", "/bodies/0/mesh/length=3"});
  refused("/frames", {"/frames: does not say what to set"});
  EXPECT_FALSE(fs::exists(file("run")));
}

TEST_F(Simulate, NamesBodiesInObj) {
  write_text(file("two.json"), R"({"selvage_scene": 1, "bodies": [
    {"name": "the box", "mesh": {"shape": "box", "cell": 1}},
    {"name": "ball", "mesh": {"shape": "ball", "cell": 0.8}, "translate": [5, 0, 0]}]})");
  run_well("simulate two.json -o run --frames 1 --surface obj -q");
  const std::vector<std::string> lines = lines_of(read_text(file("run/surface/frame_000001.obj")));
  EXPECT_EQ(std::count(lines.begin(), lines.end(), "o the_box"), 1);
  const auto ball = std::find(lines.begin(), lines.end(), "o ball");
  ASSERT_NE(ball, lines.end());
  const auto is_face = [](const std::string& line) { return line[0] == 'f'; };
  EXPECT_EQ(std::count_if(lines.begin(), ball, is_face), 12);
  EXPECT_GT(std::count_if(ball, lines.end(), is_face), 20);
}

TEST_F(Simulate, RefusesWithOneLine) {
  write_text(file("blocks.json"), kBlocks);
  write_text(file("wrong.json"), R"({"selvage_scene": 1, "bodies": [{"mesh": {"shape": "bux"}}]})");
  expect_refused("simulate wrong.json -o run", 2, {"wrong.json: bodies[0].mesh.shape", "box"});
  expect_refused("simulate none.json -o run", 2, {"none.json"});
  std::string outside = kBlocks;
  outside.replace(outside.find("\"point\": [0, 0, 0]"), 18, "\"point\": [0, 0, 9]");
  write_text(file("outside.json"), outside);
  expect_refused("simulate outside.json -o run", 2,
                 {"outside.json: body 'body0[0]': 125 of 125 vertices start inside colliders[0]"});
  write_text(file("typo.json"), R"({"selvage_scene": 1, "scale": {}, "bodies": [{"mesh": {"shape": "box"}}]})");
  expect_refused("simulate typo.json -o run", 2, {"typo.json: scale: is not known", "did you mean 'scales'?"});
  write_text(file("mesh.obj"), "v 0 0 0\n");
  expect_refused("simulate mesh.obj -o run", 2, {"mesh.obj", "line 1, column 1", "a scene in JSON"});
  expect_refused("simulate blocks.json", 2, {"--output"});
  expect_refused("simulate blocks.json -o run --scale paper", 2, {"no scale 'paper'"});
  expect_refused("simulate blocks.json -o run --surface stl", 2, {"--surface"});
  expect_refused("simulate blocks.json -o blocks.json", 2, {"blocks.json: is a file", "name a folder"});
  run_well("simulate blocks.json -o run --frames 1 -q");
  expect_refused("simulate blocks.json -o run", 2, {"holds a run already", "--resume"});
  EXPECT_EQ(run("simulate --help").status, 0);
}

TEST_F(Simulate, FailsWhereTheSceneExplodes) {
  write_text(file("far.json"), R"({"selvage_scene": 1, "frames": 9, "frames_per_second": 1, "substeps": 1,
    "gravity": [0, 0, -1.7e308],
    "bodies": [{"mesh": {"shape": "box", "size": [1, 1, 1], "cell": 1}, "velocity": [0, 0, -1.7e308]}]})");
  expect_refused("simulate far.json -o run -q", 3, {"far.json: frame ", "vertex "});
  EXPECT_TRUE(fs::exists(file("run/summary.json")));
}

/// All files of a run, without what it cost.
std::map<std::string, std::string> files_of(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = fs::relative(entry.path(), folder).string();
    if (!entry.is_regular_file() || name == "summary.json" || name == "report.html") continue;
    std::string text = read_text(entry.path());
    if (name == "statistics.csv") {
      const std::vector<std::string> lines = lines_of(text);
      text.clear();
      for (const std::string& line : lines) {
        const std::vector<std::string> cells = split(line, ',');
        for (std::size_t i = 0; i + 11 < cells.size(); ++i) text += cells[i] + ",";
        text += "\n";
      }
    }
    files[name] = text;
  }
  return files;
}

/// Runs the program and ends it by SIGKILL after some time; false if it was done before.
bool run_and_kill(const std::string& scene, const std::string& folder, std::chrono::microseconds time) {
  std::vector<std::string> words{SELVAGE_PROGRAM, "simulate", scene,           "-o", folder,
                                 "--resume",      "--vtu",    "--check-every", "3",  "--quiet"};
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  pid_t child = 0;
  if (posix_spawn(&child, SELVAGE_PROGRAM, nullptr, nullptr, pointers.data(), environ) != 0) return false;
  std::this_thread::sleep_for(time);
  kill(child, SIGKILL);
  int status = 0;
  waitpid(child, &status, 0);
  return WIFSIGNALED(status);
}

TEST_F(Simulate, KilledAtAnyMomentItEndsAsIfItHadNeverStopped) {
  write_text(file("blocks.json"), kBlocks);
  const auto start = std::chrono::steady_clock::now();
  run_well("simulate blocks.json -o whole --vtu --check-every 3 -q");
  const auto whole_time =
      std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - start);
  const auto expected = files_of(file("whole"));
  ASSERT_EQ(expected.count("frames/frame_000020.bin"), 1u);

  std::mt19937 engine(4);
  std::uniform_int_distribution<std::int64_t> moment(0, whole_time.count() / 3);
  int kills = 0;
  for (int round = 0; kills < 20; ++round) {
    ASSERT_LT(round, 20);
    const std::string name = "killed" + std::to_string(round);
    while (run_and_kill(file("blocks.json"), file(name), std::chrono::microseconds(moment(engine)))) ++kills;
    run_well("simulate blocks.json -o " + name + " --resume --vtu --check-every 3 -q");
    EXPECT_TRUE(files_of(file(name)) == expected) << "after " << kills << " kills";
  }
}

}  // namespace
}  // namespace selvage::testing
