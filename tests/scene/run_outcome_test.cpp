#include "scene/blocks.h"
#include "selvage/core/error.h"
#include "selvage/scene/frames.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <array>
#include <csignal>

namespace selvage {
namespace {

using namespace blocks;
using test::read_text;
using test::TemporaryFolder;

TEST(Run, NamesTheFrameOfAnExplosion) {
  const TemporaryFolder folder;
  // A speed that no double holds.
  const std::string text = R"({"selvage_scene": 1, "frames": 9, "frames_per_second": 1, "substeps": 1,
    "gravity": [0, 0, -1.7e308],
    "bodies": [{"mesh": {"shape": "box", "size": [1, 1, 1], "cell": 1}, "velocity": [0, 0, -1.7e308]}]})";
  const RunReport report = run_scene(parse_scene(text, "far.json"), to(folder.path()));
  EXPECT_EQ(report.outcome, RunOutcome::kExploded);
  EXPECT_NE(report.message.find("frame "), std::string::npos) << report.message;
  EXPECT_NE(report.message.find("vertex "), std::string::npos) << report.message;
  const std::int64_t last = report.frames.back().frame;
  EXPECT_LT(last, 9);
  EXPECT_NO_THROW(read_frame(frame_path(folder.path(), last)));
  EXPECT_EQ(read_checkpoint(checkpoint_path(folder.path())).header.frame, last);
  EXPECT_NE(read_text(folder.path() / "summary.json").find("\"exploded\""), std::string::npos);
  RunOptions to_last = to(folder.path() / "again");
  to_last.frames = last;
  EXPECT_EQ(run_scene(parse_scene(text, "far.json"), to_last).fingerprint, report.fingerprint);
}

TEST(Run, FramesHoldNothingInfinite) {
  // A speed that doubles hold for long and single precision does not, of a box that rounding does not flatten there.
  const TemporaryFolder folder;
  const std::string text = R"({"selvage_scene": 1, "frames": 9, "frames_per_second": 1, "substeps": 1,
    "bodies": [{"mesh": {"shape": "box", "size": [1e27, 1e27, 1e27], "cell": 1e27}, "velocity": [0, 1e38, 0]}]})";
  const RunReport report = run_scene(parse_scene(text, "far.json"), to(folder.path()));
  EXPECT_EQ(report.outcome, RunOutcome::kExploded);
  EXPECT_NE(report.message.find("frame 4: vertex 0"), std::string::npos) << report.message;
  ASSERT_EQ(report.frames.back().frame, 3);
  for (const Vec3& p : read_frame(frame_path(folder.path(), 3)).positions) EXPECT_TRUE(p.allFinite());
}

/// Two planes leave it no volume. Vertices that stood on one were thrown by the friction of contacts with others.
TEST(Run, ThrowsNothingOfABodyThatIsPressedFlat) {
  const TemporaryFolder folder;
  const RunReport report = run_scene(scene_of(R"({"selvage_scene": 1, "frames": 30,
    "bodies": [{"mesh": {"shape": "box", "size": [0.5, 0.5, 0.5], "cell": 0.12}, "translate": [-0.25, -0.25, 0.1],
      "material": {"youngs_modulus": 1e5, "poisson_ratio": 0.4, "density": 1000}}],
    "colliders": [{"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}},
      {"plane": {"point": [0, 0, 1], "normal": [0, 0, -1]},
       "motion": {"keyframes": [{"time": 0}, {"time": 0.4, "translate": [0, 0, -1]}]}}]})"),
                                     to(folder.path()));
  EXPECT_EQ(report.outcome, RunOutcome::kFinished) << report.message;
  for (const FrameStatistics& row : report.frames) EXPECT_LT(row.fastest, 10) << row.frame;
}

TEST(Run, NamesTheBodyWithoutVolume) {
  const auto press = [](const char* by) {
    const TemporaryFolder folder;
    const RunReport report = run_scene(scene_of(fmt::format(R"({{"selvage_scene": 1, "frames": 8, "gravity": [0, 0, 0],
      "bodies": [{{"name": "free", "mesh": {{"shape": "box", "size": [1, 1, 1], "cell": 1}}, "translate": [5, 0, 0]}},
        {{"name": "pressed", "mesh": {{"shape": "box", "size": [1, 1, 1], "cell": 1}},
         "pinned": [{{"box": {{"min": [-1, -1, -1], "max": [2, 2, 0.5]}}}}],
         "handles": [{{"region": {{"box": {{"min": [-1, -1, 0.6], "max": [2, 2, 2]}}}},
                      "motion": {{"keyframes": [{{"time": 0}}, {{"time": 0.1, "translate": [0, 0, -{}]}}]}}}}]}}]}})",
                                                            by)),
                                       to(folder.path()));
    EXPECT_NE(read_text(folder.path() / "summary.json")
                  .find(report.outcome == RunOutcome::kFinished ? "\"finished\"" : "\"outcome\": \"no volume\""),
              std::string::npos);
    return report;
  };
  const RunReport report = press("0.9995");
  EXPECT_EQ(report.outcome, RunOutcome::kNoVolume);
  EXPECT_EQ(report.message.find("frame 6: body 'pressed' has no volume left"), 0u) << report.message;
  EXPECT_EQ(report.frames.back().frame, 5);
  EXPECT_EQ(press("0.998").outcome, RunOutcome::kFinished);
}

TEST(Run, NamesTheElementThatHandlesInvert) {
  const TemporaryFolder folder;
  const std::string text = R"({"selvage_scene": 1, "frames": 30, "substeps": 2, "gravity": [0, 0, 0],
    "bodies": [{"mesh": {"shape": "box", "size": [1, 1, 1], "cell": 1},
      "pinned": [{"box": {"min": [-1, -1, -1], "max": [2, 2, 0.5]}}],
      "handles": [{"region": {"box": {"min": [-1, -1, 0.6], "max": [2, 2, 2]}},
                   "motion": {"keyframes": [{"time": 0}, {"time": 0.1, "translate": [0, 0, -2.2]}]}}]}]})";
  const RunReport report = run_scene(parse_scene(text, "press.json"), to(folder.path()));
  EXPECT_EQ(report.outcome, RunOutcome::kImpossibleHandles);
  EXPECT_NE(report.message.find("frame 3: handles invert element"), std::string::npos) << report.message;
  EXPECT_EQ(report.frames.back().frame, 2);
}

/// Limits the size of files, as a full disk does.
class FileLimit {
 public:
  explicit FileLimit(rlim_t bytes) {
    std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, SIG_DFL);
  }

 private:
  rlimit before_{};
};

TEST(Run, NamesTheFrameWhereTheDiskIsFullAndKeepsTheFramesBefore) {
  // Of few vertices, so that the table of statistics is the first file to grow too large; and of more, so that it is
  // the checkpoint.
  const std::string small = R"({"selvage_scene": 1, "frames": 9, "substeps": 1,
    "bodies": [{"mesh": {"shape": "box", "size": [1, 1, 1], "cell": 1}}]})";
  const std::array<std::pair<std::string, rlim_t>, 2> cases{{{small, 1500}, {falling_blocks(), 5000}}};
  for (const auto& [text, limit] : cases) {
    const Scene scene = scene_of(text);
    const TemporaryFolder whole, folder;
    run_scene(scene, to(whole.path()));
    RunOptions options = to(folder.path());
    options.frames = 0;
    run_scene(scene, options);
    options.frames.reset();
    options.resume = true;
    std::string message;
    {
      const FileLimit full(limit);
      try {
        run_scene(scene, options);
      } catch (const SystemError& error) {
        message = error.what();
      }
    }
    EXPECT_EQ(message.find("frame "), 0u) << message;
    EXPECT_NE(message.find("cannot be written"), std::string::npos) << message;
    EXPECT_NO_THROW(read_checkpoint(checkpoint_path(folder.path())));
    run_scene(scene, options);
    EXPECT_EQ(differences(files_of(folder.path()), files_of(whole.path())), std::vector<std::string>())
        << "limit " << limit;
  }
}

}  // namespace
}  // namespace selvage
