#include "scene/blocks.h"
#include "selvage/core/error.h"
#include "selvage/scene/frames.h"
#include "selvage/self_collision/self_collision.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>

namespace selvage {
namespace {

namespace fs = std::filesystem;
using namespace blocks;
using test::read_text;
using test::TemporaryFolder;
using test::write_text;

TEST(Run, WritesTheFilesOfEachFrame) {
  const TemporaryFolder folder;
  const Scene scene = scene_of(falling_blocks());
  RunOptions options = to(folder.path() / "deep" / "run");
  options.vtu = true;
  options.surface = SurfaceFormat::kPly;
  std::vector<std::int64_t> seen;
  options.on_frame = [&](const FrameStatistics& row) { seen.push_back(row.frame); };
  std::vector<std::array<std::int64_t, 3>> steps;
  options.on_step = [&](const StepProgress& step) { steps.push_back({step.frame, step.step, step.steps}); };
  const RunReport report = run_scene(scene, options);
  EXPECT_EQ(report.outcome, RunOutcome::kFinished);
  ASSERT_EQ(steps.size(), 18u);
  EXPECT_EQ(steps[3], (std::array<std::int64_t, 3>{2, 1, 3}));
  EXPECT_EQ(seen, (std::vector<std::int64_t>{0, 1, 2, 3, 4, 5, 6}));
  ASSERT_EQ(report.frames.size(), 7u);
  EXPECT_EQ(report.frames[6].steps, 18);
  EXPECT_NEAR(report.frames[6].time, 0.1, 1e-12);
  EXPECT_GT(report.frames[6].collider_contacts, 0);
  EXPECT_EQ(report.frames[6].inverted_elements, 0);
  EXPECT_EQ(report.frames[0].fastest, 2);

  const auto files = files_of(options.folder);
  for (const char* name : {"topology.bin", "checkpoint.bin", "statistics.csv", "frames/frame_000000.bin",
                           "frames/frame_000006.bin", "vtu/frame_000006.vtu", "frames.pvd", "surface/frame_000003.ply"})
    EXPECT_EQ(files.count(name), 1u) << name;
  EXPECT_EQ(files.count("frames/frame_000007.bin"), 0u);
  EXPECT_EQ(read_frame(frame_path(options.folder, 6)).header.fingerprint, scene.fingerprint);
  EXPECT_NE(read_text(options.folder / "summary.json").find("\"outcome\": \"finished\""), std::string::npos);
  EXPECT_NE(files.at("frames.pvd").find("vtu/frame_000004.vtu"), std::string::npos);
}

TEST(Run, FingerprintIsThatOfTheLastState) {
  const auto run = [](const std::string& text, std::int64_t frames) {
    const TemporaryFolder folder;
    RunOptions options = to(folder.path());
    options.frames = frames;
    const RunReport report = run_scene(scene_of(text), options);
    EXPECT_NE(read_text(folder.path() / "summary.json").find(fmt::format("{:016x}", report.fingerprint)),
              std::string::npos);
    return report.fingerprint;
  };
  const std::uint64_t print = run(falling_blocks(), 3);
  {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(run(falling_blocks(), 3), print);
  }
  EXPECT_NE(run(falling_blocks(), 2), print);
  EXPECT_NE(run(falling_blocks(R"(,"gravity": [0, 0, -9.80001])"), 3), print);
  // At the beginning the scenes are alike.
  EXPECT_EQ(run(falling_blocks(R"(,"gravity": [0, 0, -9.80001])"), 0), run(falling_blocks(), 0));
}

TEST(Run, EndsWithTheSameFilesWhereverItWasInterrupted) {
  const Scene scene = scene_of(falling_blocks());
  const TemporaryFolder whole;
  RunOptions options = to(whole.path());
  options.vtu = true;
  const std::uint64_t print = run_scene(scene, options).fingerprint;
  const auto expected = files_of(whole.path());
  for (int cut = 0; cut < 6; ++cut) {
    const TemporaryFolder folder;
    RunOptions first = options;
    first.folder = folder.path();
    first.frames = cut;
    run_scene(scene, first);
    // A killed run may leave behind: a frame and a row without their checkpoint, a half line, a file half written.
    write_text(frame_path(folder.path(), cut + 1), "half a frame");
    write_text(folder.path() / "frames" / "frame_000009.bin.1-1.part", "x");
    write_text(folder.path() / "statistics.csv", read_text(folder.path() / "statistics.csv") + "7,0.1,3");
    first.frames.reset();
    first.resume = true;
    const RunReport report = run_scene(scene, first);
    EXPECT_EQ(report.first_frame, cut);
    EXPECT_EQ(report.frames.size(), 7u);
    EXPECT_EQ(report.fingerprint, print);
    EXPECT_EQ(differences(files_of(folder.path()), expected), std::vector<std::string>()) << "cut after frame " << cut;
  }
}

TEST(Run, EndsWithTheSameFilesWithEachSolverWhereverItWasInterrupted) {
  for (const std::string changes : {R"(,"solver": "newton", "newton": {"steps": 3})", R"(,"solver": "vbd")"}) {
    const Scene scene = scene_of(falling_blocks(changes));
    const TemporaryFolder whole, parts;
    const RunReport report = run_scene(scene, to(whole.path()));
    EXPECT_EQ(report.outcome, RunOutcome::kFinished) << report.message;
    std::int64_t steps = 0, contacts = 0;
    for (const FrameStatistics& row : report.frames) {
      steps += row.newton_steps;
      contacts += row.vertex_faces + row.edge_edges;
      EXPECT_EQ(row.constraints, 0);
      EXPECT_EQ(row.penetrating_vertices, 0);
    }
    EXPECT_GE(steps, 18);
    EXPECT_GT(contacts, 0);
    EXPECT_GT(report.frames.back().residual, 0);
    for (const std::int64_t frames : {2, 3, 6}) {
      RunOptions options = to(parts.path());
      options.frames = frames;
      options.resume = true;
      run_scene(scene, options);
    }
    EXPECT_EQ(differences(files_of(whole.path()), files_of(parts.path())), std::vector<std::string>());
  }
}

TEST(Run, RemovesOnlyItsOwnFiles) {
  const Scene scene = scene_of(falling_blocks());
  const TemporaryFolder folder;
  const std::vector<std::string> others{"frame_000001.png",        "frame_000002.bin",   "notes.part",
                                        "frames/frame_000003.png", "frames/frame_3.bin", "vtu/frame_000004.vtu.gz",
                                        "surface/frame_000005.stl"};
  const std::vector<std::string> parts{"checkpoint.bin.1-1.part", "frames/frame_000001.bin.1-2.part",
                                       "surface/frame_000001.obj.1-3.part", "vtu/frame_000009.vtu.1-4.part"};
  for (const char* name : {"frames", "vtu", "surface"}) fs::create_directory(folder.path() / name);
  for (const std::string& name : others) write_text(folder.path() / name, name);
  for (const int frames : {2, 3}) {
    for (const std::string& name : parts) write_text(folder.path() / name, "x");
    RunOptions options = to(folder.path());
    options.frames = frames;
    options.resume = true;
    run_scene(scene, options);
    for (const std::string& name : others) EXPECT_EQ(read_text(folder.path() / name), name);
    for (const std::string& name : parts) EXPECT_FALSE(fs::exists(folder.path() / name)) << name;
  }
}

TEST(Run, IsContinuedBeyondItsEnd) {
  const Scene scene = scene_of(falling_blocks());
  const TemporaryFolder folder, whole;
  run_scene(scene, to(folder.path()));
  RunOptions longer = to(folder.path());
  longer.resume = true;
  longer.frames = 8;
  EXPECT_EQ(run_scene(scene, longer).frames.back().frame, 8);
  RunOptions at_once = to(whole.path());
  at_once.frames = 8;
  run_scene(scene, at_once);
  EXPECT_EQ(differences(files_of(folder.path()), files_of(whole.path())), std::vector<std::string>());
  // Fewer frames than there are: nothing to do, nothing lost.
  longer.frames = 2;
  EXPECT_EQ(run_scene(scene, longer).frames.back().frame, 8);
  EXPECT_EQ(differences(files_of(folder.path()), files_of(whole.path())), std::vector<std::string>());
}

std::string refusal(const Scene& scene, const RunOptions& options) {
  try {
    run_scene(scene, options);
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Run, RefusesImpossibleOptions) {
  const Scene scene = scene_of(falling_blocks());
  EXPECT_NE(refusal(scene, {}).find("folder: is not named"), std::string::npos);
  const TemporaryFolder folder;
  RunOptions options = to(folder.path());
  options.frames = -1;
  EXPECT_NE(refusal(scene, options).find("frames: are -1"), std::string::npos);
  EXPECT_TRUE(files_of(folder.path()).empty());
}

TEST(Run, RefusesFoldersOfOtherRuns) {
  const TemporaryFolder folder;
  run_scene(scene_of(falling_blocks()), to(folder.path()));
  const auto before = files_of(folder.path());
  EXPECT_NE(refusal(scene_of(falling_blocks()), to(folder.path())).find("holds a run already"), std::string::npos);
  RunOptions resume = to(folder.path());
  resume.resume = true;
  EXPECT_NE(refusal(scene_of(falling_blocks(R"(,"gravity": [0, 0, -3])")), resume).find("another scene"),
            std::string::npos);
  EXPECT_EQ(differences(files_of(folder.path()), before), std::vector<std::string>());
  // Frames whose other files somebody has removed.
  fs::remove(folder.path() / "topology.bin");
  EXPECT_NE(refusal(scene_of(falling_blocks()), to(folder.path())).find("holds a run already"), std::string::npos);
  run_scene(scene_of(falling_blocks()), resume);
  EXPECT_EQ(differences(files_of(folder.path()), before), std::vector<std::string>());
  fs::remove(folder.path() / "checkpoint.bin");
  fs::remove(folder.path() / "topology.bin");
  const auto remaining = files_of(folder.path());
  EXPECT_NE(refusal(scene_of(falling_blocks()), to(folder.path())).find("holds a run already"), std::string::npos);
  EXPECT_NE(refusal(scene_of(falling_blocks()), resume).find("checkpoint.bin: is missing"), std::string::npos);
  EXPECT_EQ(differences(files_of(folder.path()), remaining), std::vector<std::string>());
  // A second process at the same time; here, a second run from within the first.
  const TemporaryFolder shared;
  RunOptions outer = to(shared.path());
  std::string message;
  outer.on_frame = [&](const FrameStatistics&) { message = refusal(scene_of(falling_blocks()), to(shared.path())); };
  run_scene(scene_of(falling_blocks()), outer);
  EXPECT_NE(message.find("another process"), std::string::npos) << message;
}

TEST(Run, IsContinuedAfterItsUserStoppedItInAStep) {
  const TemporaryFolder whole, part;
  const Scene scene = scene_of(falling_blocks());
  const RunReport report = run_scene(scene, to(whole.path()));
  struct Enough {};
  RunOptions options = to(part.path());
  int steps = 0;
  options.on_step = [&](const StepProgress&) {
    if (++steps == 8) throw Enough();
  };
  EXPECT_THROW(run_scene(scene, options), Enough);
  RunOptions resume = to(part.path());
  resume.resume = true;
  const RunReport continued = run_scene(scene, resume);
  EXPECT_EQ(continued.first_frame, 2);  // of three steps a frame
  EXPECT_EQ(continued.fingerprint, report.fingerprint);
}

TEST(Run, ContactsBeginInTheFrameThatTheSceneGives) {
  const TemporaryFolder folder;
  const Scene scene = scene_of(falling_blocks(R"(,"contact": {"from_frame": 3})"));
  const RunReport report = run_scene(scene, to(folder.path()));
  for (const FrameStatistics& row : report.frames) {
    if (row.frame > 3) break;
    EXPECT_EQ(row.vertex_faces + row.edge_edges + row.vertex_paths + row.edge_paths, 0) << row.frame;
  }
}

TEST(Run, CountsTrianglesThatCrossWhereNoVertexIsInside) {
  const TemporaryFolder folder;
  // Two bars across one another, with vertices at their ends alone.
  const Scene scene = scene_of(R"({"selvage_scene": 1, "frames": 1, "gravity": [0, 0, 0], "contact": {"mode": "none"},
    "bodies": [{"mesh": {"shape": "box", "size": [1, 1, 1], "cell": 1}, "scale": [3, 1, 1], "translate": [0, 1, 0]},
               {"mesh": {"shape": "box", "size": [1, 1, 1], "cell": 1}, "scale": [0.6, 3, 0.6],
                "translate": [1.2, 0, 0.2]}]})");
  const RunReport report = run_scene(scene, to(folder.path()));
  const TriangleMesh surface = boundary_surface(scene.model.mesh);
  const auto pairs = SelfCollisionFinder(surface, scene.initial_state.positions).find_pairs();
  for (const FrameStatistics& row : report.frames) {
    EXPECT_EQ(row.penetrating_vertices, 0);
    EXPECT_EQ(row.triangle_pairs,
              std::ranges::count(pairs, TriangleContact::kCrossing, [](const auto& pair) { return pair.contact; }));
    EXPECT_GE(row.triangle_pairs, 8);  // each of four sides of the one passes two sides of the other
    EXPECT_EQ(row.flat_elements, 0);
  }
  EXPECT_NE(read_text(folder.path() / "summary.json").find(fmt::format("\"triangle_pairs\": {}", pairs.size())),
            std::string::npos);
}

TEST(Run, CountsFlatElementsApartFromInvertedOnes) {
  const auto first_row = [](const char* matrix) {
    const TemporaryFolder folder;
    RunOptions options = to(folder.path());
    options.frames = 0;
    return run_scene(scene_of(fmt::format(R"({{"selvage_scene": 1, "bodies": [
      {{"mesh": {{"shape": "box", "size": [1, 1, 1], "cell": 0.5}}, "poses": [{{"matrix": {}}}]}}]}})",
                                          matrix)),
                     options)
        .frames.front();
  };
  EXPECT_EQ(first_row("[[1, 0, 0], [0, 1, 0], [0, 0, 1e-10]]").flat_elements, 48);
  const FrameStatistics thin = first_row("[[1, 0, 0], [0, 1, 0], [0, 0, 1e-8]]");
  EXPECT_EQ(thin.flat_elements, 0);
  EXPECT_EQ(thin.inverted_elements, 0);
}

}  // namespace
}  // namespace selvage
