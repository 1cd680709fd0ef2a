#include "cli/program/output.h"

#include "cli/program.h"
#include "cli/program/console.h"
#include "selvage/core/error.h"
#include "selvage/shapes/shapes.h"

#include <pty.h>

#include <csignal>

namespace selvage::cli {
namespace {

namespace fs = std::filesystem;
using testing::read_text;
using testing::write_text;

class OutputTest : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::size_t file_count() const { return folder_.file_count(); }

  test::TemporaryFolder folder_;
};

TEST_F(OutputTest, FilesAppearWithTheCommit) {
  OutputFiles outputs;
  outputs.expect(path("a.csv"));
  outputs.expect(path("b.json"));
  outputs.write_text(path("a.csv"), "a");
  outputs.write_text(path("b.json"), "b");
  EXPECT_FALSE(fs::exists(path("a.csv")));
  outputs.commit();
  EXPECT_EQ(read_text(path("a.csv")), "a");
  EXPECT_EQ(read_text(path("b.json")), "b");
  EXPECT_EQ(file_count(), 2u);
}

TEST_F(OutputTest, BothFilesOfAMeshAppearWithTheCommit) {
  const IndexedMesh mesh = make_box(Vec3::Ones(), 1);
  for (const bool committed : {false, true}) {
    OutputFiles outputs;
    outputs.write_mesh(path("a.node"), mesh);
    outputs.write_text(path("b.json"), "b");
    EXPECT_EQ(file_count(), 3u);
    for (const char* name : {"a.node", "a.ele", "b.json"}) EXPECT_FALSE(fs::exists(path(name))) << name;
    if (committed) outputs.commit();
  }
  EXPECT_EQ(file_count(), 3u);
  EXPECT_EQ(read_mesh(path("a.ele")).tetrahedra, mesh.tetrahedra);
}

TEST_F(OutputTest, AMeshThatCannotBeWrittenIsCalledByItsName) {
  OutputFiles outputs;
  try {
    outputs.write_mesh(path("a.stl"), make_box(Vec3::Ones(), 1));
    ADD_FAILURE() << "written";
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find(path("a.stl") + ": "), 0u) << error.what();
  }
}

TEST_F(OutputTest, NothingStaysWithoutTheCommit) {
  write_text(path("a.csv"), "old");
  {
    OutputFiles outputs;
    outputs.expect(path("a.csv"));
    outputs.write_text(path("a.csv"), "new");
    write_text(outputs.stage(path("c.vtu")), "lines");
    EXPECT_EQ(file_count(), 3u);
  }
  EXPECT_EQ(read_text(path("a.csv")), "old");
  EXPECT_EQ(file_count(), 1u);
}

TEST_F(OutputTest, NothingStaysAfterAnInterrupt) {
  write_text(path("a.csv"), "old");
  const pid_t child = fork();
  if (child == 0) {
    OutputFiles outputs;
    for (const char* name : {"a.csv", "b.vtu"}) write_text(outputs.stage(path(name)), "new");
    std::signal(SIGINT, end_without_staged_files);
    std::raise(SIGINT);
    _exit(0);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGINT);
  EXPECT_EQ(file_count(), 1u);
  EXPECT_EQ(read_text(path("a.csv")), "old");
}

TEST_F(OutputTest, StagedFileKeepsFolderAndExtension) {
  OutputFiles outputs;
  const fs::path staged = outputs.stage(path("lines.vtu"));
  EXPECT_EQ(staged.parent_path(), folder_.path());
  EXPECT_EQ(staged.extension(), ".vtu");
  EXPECT_NE(staged.filename(), "lines.vtu");
  EXPECT_NE(outputs.stage(path("lines.vtu")), staged);
}

TEST_F(OutputTest, FailedCommitLeavesNoTemporaryFile) {
  {
    OutputFiles outputs;
    outputs.expect(path("a.csv"));
    outputs.write_text(path("a.csv"), "a");
    outputs.write_text(path("b.csv"), "b");
    fs::create_directories(path("a.csv") + "/in the way");
    EXPECT_THROW(outputs.commit(), Failure);
  }
  EXPECT_EQ(file_count(), 1u) << "one of two appeared alone";
}

TEST_F(OutputTest, PlacesThatCannotWorkAreRefusedAtOnce) {
  OutputFiles outputs;
  fs::create_directory(path("folder"));
  EXPECT_THROW(outputs.expect(path("none/a.csv")), Error);
  EXPECT_THROW(outputs.expect(path("folder")), Error);
  EXPECT_THROW(outputs.expect(path("mesh.t"), {path("folder/../mesh.t")}), Error);
  outputs.expect(path("a.csv"));
  EXPECT_THROW(outputs.expect(path("./a.csv")), Error);
  outputs.expect("");
  outputs.expect("");
  EXPECT_FALSE(outputs.uses_standard_output());
  outputs.expect("-");
  EXPECT_TRUE(outputs.uses_standard_output());
  EXPECT_THROW(outputs.expect("-"), Error);
}

TEST_F(OutputTest, LinkToAnInputIsTheInput) {
  write_text(path("mesh.t"), "mesh");
  fs::create_symlink(path("mesh.t"), path("link.t"));
  OutputFiles outputs;
  EXPECT_THROW(outputs.expect(path("link.t"), {path("mesh.t")}), Error);
}

TEST(Console, CountsAreGrouped) {
  EXPECT_EQ(grouped(0), "0");
  EXPECT_EQ(grouped(999), "999");
  EXPECT_EQ(grouped(1000), "1,000");
  EXPECT_EQ(grouped(1234567), "1,234,567");
  EXPECT_EQ(grouped(-123), "-123");
  EXPECT_EQ(grouped(-1234), "-1,234");
}

TEST(Console, SecondsHaveTheirUnit) {
  EXPECT_EQ(readable_seconds(12.345), "12.35 s");
  EXPECT_EQ(readable_seconds(0.0123), "12.3 ms");
  EXPECT_EQ(readable_seconds(4.5e-6), "4.5 us");
}

TEST(Console, StopwatchKeepsThePhasesInOrder) {
  Stopwatch watch;
  watch.lap("b");
  watch.lap("a");
  ASSERT_EQ(watch.laps().size(), 2u);
  EXPECT_EQ(watch.laps()[0].first, "b");
  EXPECT_NEAR(watch.total(), watch.laps()[0].second + watch.laps()[1].second, 1e-9);
}

/// The text that a progress bar writes while standard error is `descriptor`.
std::string bar_output(int descriptor, int readable, bool quiet, std::string_view note = {}) {
  const int saved = dup(STDERR_FILENO);
  dup2(descriptor, STDERR_FILENO);
  {
    ProgressBar bar("work", quiet);
    bar.show(0.1);  // too early to be worth a word
    usleep(550000);
    bar.show(0.5, note);
  }
  dup2(saved, STDERR_FILENO);
  close(saved);
  if (write(descriptor, "\n", 1) != 1) return "cannot write";
  // A terminal hands on what it is given piece by piece.
  std::string text;
  char piece[1000];
  for (ssize_t count = 1; count > 0 && text.find('\n') == std::string::npos;) {
    count = read(readable, piece, sizeof piece);
    text.append(piece, static_cast<std::size_t>(std::max<ssize_t>(0, count)));
  }
  return text;
}

TEST(Console, ProgressBarIsForTerminalsOnly) {
  int terminal = -1, other_end = -1;
  if (openpty(&other_end, &terminal, nullptr, nullptr, nullptr) != 0)
    GTEST_SKIP() << "there are no pseudo-terminals here";
  const std::string seen = bar_output(terminal, other_end, false);
  EXPECT_NE(seen.find("work ["), std::string::npos) << seen;
  EXPECT_NE(seen.find(" 50%"), std::string::npos) << seen;
  EXPECT_EQ(seen.find(" 10%"), std::string::npos) << seen;
  EXPECT_NE(seen.find("\033[K"), std::string::npos) << "the bar is wiped at the end";
  EXPECT_EQ(bar_output(terminal, other_end, true), "\r\n");
  close(terminal);
  close(other_end);
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  EXPECT_EQ(bar_output(ends[1], ends[0], false), "\n");
  close(ends[0]);
  close(ends[1]);
}

TEST(Console, ProgressBarIsShorterWhereItsNoteIsLong) {
  int terminal = -1, other_end = -1;
  winsize size{};
  size.ws_col = 60;
  if (openpty(&other_end, &terminal, nullptr, nullptr, &size) != 0)
    GTEST_SKIP() << "there are no pseudo-terminals here";
  const std::string note = "12 of 60, 140 frames a minute";
  const std::string seen = bar_output(terminal, other_end, false, note);
  EXPECT_NE(seen.find("work [========        ]  50%  " + note), std::string::npos) << seen;
  const std::string longer = note + ", 21 s left, and more than fits in";
  const std::string cut = bar_output(terminal, other_end, false, longer);
  EXPECT_NE(cut.find("work  50%  " + longer.substr(0, 59 - 11) + "\033"), std::string::npos) << cut;
  close(terminal);
  close(other_end);
}

TEST(ProgressLine, GivesUpTheBarBeforeTheNote) {
  EXPECT_EQ(progress_line("work", 0.5, "note", 79), "work [===============               ]  50%  note");
  EXPECT_EQ(progress_line("work", 0.5, "note", 26), "work [====    ]  50%  note");
  EXPECT_EQ(progress_line("work", 0.5, "note", 25), "work  50%  note");
  EXPECT_EQ(progress_line("work", 2, "note", 12), "work 100%  n");
  EXPECT_EQ(progress_line("work", 0, "note", 0), "");
}

}  // namespace
}  // namespace selvage::cli
