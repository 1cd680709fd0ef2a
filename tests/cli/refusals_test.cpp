// Files that cannot be read, places that cannot be written, readers that have gone away: one line, the right status,
// and nothing left behind.
#include "cli/program.h"

#include <sys/stat.h>

namespace selvage::testing {
namespace {

class RefusalsTest : public ProgramTest {
 protected:
  void SetUp() override {
    ProgramTest::SetUp();
    run_well("make rod --length 12 --radius 0.2 --elements 4000 --pose self-crossing,crossings=2 -o tangled.t -q");
    run_well("make ball --elements 500 -o ball.node -q");
    before_ = files();
  }
  void TearDown() override {
    EXPECT_EQ(files(), before_);
    ProgramTest::TearDown();
  }

  /// The same for a command whose standard output is redirected.
  void expect_failure(const std::string& arguments, const std::vector<std::string>& words,
                      const std::string& before = "true") const {
    const Outcome outcome = run(arguments, before);
    EXPECT_EQ(outcome.status, 3) << arguments << "\n" << outcome.err;
    EXPECT_EQ(lines_of(outcome.err).size(), 1u) << arguments << "\n" << outcome.err;
    for (const std::string& word : words) {
      EXPECT_NE(outcome.err.find(word), std::string::npos) << arguments << "\n" << outcome.err;
    }
  }

  std::vector<std::string> before_;
};

bool is_device(const char* path) {
  struct stat status {};
  return stat(path, &status) == 0 && S_ISCHR(status.st_mode);
}

TEST_F(RefusalsTest, FilesThatCannotBeRead) {
  fs::create_directory(file("folder.t"));
  for (const std::string command : {"info ", "paths "}) {
    expect_refused(command + "missing.t", 2, {"missing.t: cannot be read: No such file"});
    expect_refused(command + "folder.t", 2, {"folder.t: cannot be read: Is a directory"});
    expect_refused(command + ".", 2, {"selvage: .: "});
    expect_refused(command + "''", 2, {"extension"});
    expect_refused(command + "/dev/null", 2, {"extension"});
  }
  expect_refused("paths tangled.t --points missing.csv", 2, {"missing.csv: cannot be read"});
  expect_refused("paths tangled.t --points folder.t", 2, {"folder.t"});
  expect_refused("paths tangled.t --points /dev/null", 2, {"there is no point"});
  fs::remove(file("folder.t"));
}

TEST_F(RefusalsTest, NumbersOfThreads) {
  for (const char* number : {"0", "-1", "1e9", "1000000000", "99999999999999999999", "2x", "''"}) {
    expect_refused(std::string("info tangled.t --threads ") + number, 2, {"--threads"});
  }
  run_well("paths tangled.t -q --threads 4096");
}

TEST_F(RefusalsTest, DirectionsAndExtensionsBeforeAnyWork) {
  for (const char* view : {"0 0 0", "nan 0 1", "0 inf 0"}) {
    expect_refused(std::string("paths missing.t --picture out.png --view ") + view, 2, {"--view: is not a direction"});
  }
  run_well("paths tangled.t -q --picture out.png --view 1e308 -1e308 1e308");
  fs::remove(file("out.png"));
  expect_refused("make box --elements 500000000 -o box.what", 2, {"box.what: the extension '.what' is unknown"});
}

TEST_F(RefusalsTest, OutputsInThePlaceOfInputs) {
  expect_refused("info tangled.t --json tangled.t", 2, {"would replace an input"});
  expect_refused("info ball.node --json ball.ele", 2, {"ball.ele: would replace an input"});
  expect_refused("paths ball.ele --csv ./ball.node", 2, {"ball.node: would replace an input"});
  expect_refused("paths tangled.t --points tangled.t --csv tangled.t", 2, {"would replace an input"});
  expect_refused("make ball -o new.node --json new.ele", 2, {"new.ele: is given for two outputs"});
}

TEST_F(RefusalsTest, FullDevices) {
  for (const char* command : {"info tangled.t --json ", "paths tangled.t --csv ", "paths tangled.t --json "}) {
    expect_failure(command + std::string("/dev/full"), {"/dev/full: cannot write (No space left on device)"});
    expect_failure(command + std::string("- > /dev/full"), {"standard output"});
  }
  for (const char* command : {"info tangled.t", "paths tangled.t", "--help", "info --help", "--version"}) {
    expect_failure(command + std::string(" > /dev/full"), {"standard output"});
  }
  EXPECT_TRUE(is_device("/dev/full")) << "a device is written to, never replaced";
}

TEST_F(RefusalsTest, DevicesAreWrittenToAndStay) {
  run_well("paths tangled.t -q --csv /dev/null");
  EXPECT_TRUE(is_device("/dev/null"));
  EXPECT_NE(run_well("info ball.ele -q --json /dev/stdout | cat").out.find("\"schema\""), std::string::npos);
}

TEST_F(RefusalsTest, FilesThatGrowTooLarge) {
  for (const char* command : {"make box --elements 9000 -o box.vtu", "make box --elements 9000 -o box.node",
                              "paths tangled.t --csv out.csv", "paths tangled.t --vtu out.vtu"}) {
    const std::string output = split(command, ' ').back();
    expect_failure(command, {"selvage: " + output + ": ", "File too large"}, "ulimit -f 16");
  }
  expect_failure("paths tangled.t --picture out.png", {"selvage: out.png: cannot write"}, "ulimit -f 16");
}

TEST_F(RefusalsTest, AReaderThatHasGoneAwayLeavesNoFile) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  constexpr int kPipe = 9;  // the shell knows single digits only
  ASSERT_EQ(dup2(ends[1], kPipe), kPipe);
  close(ends[0]);
  close(ends[1]);
  expect_failure("paths tangled.t --csv out.csv --json - >&9", {"standard output", "Broken pipe"});
  expect_failure("info tangled.t >&9", {"standard output"});
  close(kPipe);
}

TEST_F(RefusalsTest, ClosedStreamsAreNotTakenForFiles) {
  expect_failure("info tangled.t --json - >&-", {"standard output"});
  run_well("info tangled.t -q --json info.json <&- >&-");
  EXPECT_EQ(read_text(file("info.json")).front(), '{');
  fs::remove(file("info.json"));
  EXPECT_EQ(run("info missing.t >&- 2>&-").status, 2);
}

TEST_F(RefusalsTest, NamesThatAreNoText) {
  fs::copy_file(file("tangled.t"), file("\xff\xfe.t"));
  EXPECT_NE(run_well("info \xff\xfe.t --json -").out.find("\"schema\""), std::string::npos);
  EXPECT_NE(run_well("paths \xff\xfe.t --json -").out.find("\"schema\""), std::string::npos);
  fs::remove(file("\xff\xfe.t"));
}

}  // namespace
}  // namespace selvage::testing
