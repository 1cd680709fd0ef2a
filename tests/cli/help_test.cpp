#include "cli/program/help.h"

#include "cli/program.h"

#include <sstream>

namespace selvage::testing {
namespace {

class HelpTest : public ProgramTest {
 protected:
  const std::vector<std::string> kCommands{"info",     "make", "check",  "paths",  "resolve",
                                           "simulate", "view", "render", "export", "bench"};

  /// The lines of a command's help behind the one that begins with `title`, up to an empty one.
  std::vector<std::string> lines_below(const std::string& command, const std::string& title) const {
    std::vector<std::string> below;
    bool found = false;
    for (const std::string& line : lines_of(run_well(command + " --help").out)) {
      if (found && line.empty()) break;
      if (found) below.push_back(line);
      if (line.rfind(title, 0) == 0) found = true;
    }
    EXPECT_FALSE(below.empty()) << command << ": " << title;
    return below;
  }

  /// Runs a line as it stands in the help.
  Outcome run_line(const std::string& line) const {
    return run("--version > /dev/null; PATH=.:$PATH; " + line, "ln -sf '" SELVAGE_PROGRAM "' selvage");
  }
};

TEST_F(HelpTest, FitsAPlainTerminal) {
  for (const std::string& command : kCommands) {
    for (const std::string& line : lines_of(run_well(command + " --help").out)) EXPECT_LE(line.size(), 80u) << line;
  }
}

TEST_F(HelpTest, UsageNamesAllThatIsNeeded) {
  const auto has = [&](const std::string& command, const std::string& usage) {
    const std::string help = run_well(command + " --help").out;
    EXPECT_NE(help.find("Usage: " + usage + " [OPTIONS]\n"), std::string::npos) << help;
  };
  has("", "selvage COMMAND");
  has("info", "selvage info MESH");
  has("make", "selvage make SHAPE -o MESH");
  has("resolve", "selvage resolve MESH -o OUT");
  has("bench", "selvage bench [NAME...]");
}

TEST_F(HelpTest, IsAWordToo) {
  EXPECT_EQ(run_well("help").out, run_well("--help").out);
  EXPECT_EQ(run_well("help make").out, run_well("make --help").out);
  expect_refused("help mend", 2, {"there is no command 'mend'"});
}

TEST_F(HelpTest, ExamplesRunAsTheyStand) {
  for (const std::string command : {"info", "make", "check", "paths", "resolve"}) {
    for (std::string line : lines_below(command, "Example:")) {
      if (line[0] != ' ') continue;
      line = line.substr(0, line.find(" | jq"));
      const Outcome outcome = run_line(line);
      EXPECT_TRUE(outcome.status == 0 || (command == "check" && outcome.status == 1)) << line << "\n" << outcome.err;
      EXPECT_EQ(outcome.err, "") << line;
    }
  }
}

TEST_F(HelpTest, DefaultsOfShapesAreWhatItSays) {
  for (const std::string& line : lines_below("make", "Shapes,")) {
    std::istringstream words(line);
    std::string shape;
    words >> shape;
    if (shape == "squishy-ball") continue;  // two of them take a second
    const std::string extension = shape == "cloth" || shape == "sleeve" ? ".ply" : ".vtu";
    run_well("make " + shape + " -q -o plain" + extension);
    run_well("make " + line + " -q -o told" + extension);
    EXPECT_EQ(read_text(file("plain" + extension)), read_text(file("told" + extension))) << line;
  }
}

TEST_F(HelpTest, DefaultsOfPosesAreWhatItSays) {
  std::istringstream words(lines_below("make", "Poses,").front());
  int count = 0;
  for (std::string pose; words >> pose; ++count) {
    const std::string name = pose.substr(0, pose.find(','));
    run_well("make rod -q -o plain.vtu --pose " + name);
    run_well("make rod -q -o told.vtu --pose " + pose);
    EXPECT_EQ(read_text(file("plain.vtu")), read_text(file("told.vtu"))) << pose;
  }
  EXPECT_EQ(count, 4);
}

TEST_F(HelpTest, WhatIsMistypedIsNamed) {
  expect_refused("--verison", 2, {"no option '--verison'"});
  expect_refused("chekc a.ply b.ply", 2, {"no command 'chekc'"});
  expect_refused("make box -o box.t --turns 2", 2, {"no option '--turns'", "make --help"});
  expect_refused("info a.t b.t", 2, {"unexpected argument 'b.t'"});
  expect_refused("make box -o box.t --elements 1e5", 2, {"--elements: '1e5' is not a whole number"});
  expect_refused("make box -o box.t --cell thin", 2, {"--cell: 'thin' is not a number"});
  expect_refused("bench speed", 2, {"speed", "boundary-path"});
  expect_refused("make box -o box.t --size 1 2", 2, {"--size: 2 lengths", "give 3"});
  expect_refused("make cloth -o cloth.ply --size 1 2 3", 2, {"--size: 3 lengths", "give 2"});
  expect_refused("paths box.t --view 1 1 1", 2, {"--view", "--picture"});
  expect_refused("paths box.t --picture-size 100 100", 2, {"--picture-size", "--picture FILE"});
}

TEST(Wrap, BreaksAtBlanksOnly) {
  using cli::wrap;
  EXPECT_EQ(wrap("", 10, 2), "");
  EXPECT_EQ(wrap("one two three", 20, 2), "one two three");
  EXPECT_EQ(wrap("one two three", 7, 2), "one two\n  three");
  EXPECT_EQ(wrap("one two three", 6, 0), "one\ntwo\nthree");
  EXPECT_EQ(wrap("immeasurable one", 4, 1), "immeasurable\n one");
  EXPECT_EQ(wrap("a\n\n  laid out already\nb c", 1, 0), "a\n\n  laid out already\nb\nc");
}

}  // namespace
}  // namespace selvage::testing
