#include "cli/program.h"

namespace selvage::testing {
namespace {

using UsageTest = ProgramTest;

const std::vector<std::string> kCommands{"info", "make", "check", "paths", "bench"};

TEST_F(UsageTest, HelpNamesEveryCommandAndExitStatus) {
  const Outcome help = run_well("--help");
  for (const std::string& command : kCommands) EXPECT_NE(help.out.find(command), std::string::npos) << command;
  EXPECT_NE(help.out.find("Exit status"), std::string::npos);
}

TEST_F(UsageTest, EveryCommandHasHelpWithAnExampleAndTheCommonOptions) {
  for (const std::string& command : kCommands) {
    for (const char* flag : {" --help", " -h"}) {
      const Outcome help = run_well(command + flag);
      const std::size_t example = help.out.find("Example:\n  selvage ");
      ASSERT_NE(example, std::string::npos) << help.out;
      EXPECT_NE(help.out.find("  selvage " + command + " ", example), std::string::npos) << help.out;
      for (const char* option : {"--threads", "--quiet", "--json"}) {
        EXPECT_NE(help.out.find(option), std::string::npos) << command << " has no " << option;
      }
    }
  }
}

TEST_F(UsageTest, VersionIsPrinted) {
  EXPECT_EQ(run_well("--version").out.rfind("selvage ", 0), 0u);
}

TEST_F(UsageTest, BadUsageIsOneLineAndStatusTwo) {
  expect_refused("", 2, {"--help"});
  expect_refused("resolv", 2, {"resolv"});
  expect_refused("info", 2, {"mesh", "selvage info --help"});
  expect_refused("info --wrong a.t", 2, {"--wrong"});
  expect_refused("info a.t --threads 0", 2, {"--threads"});
  expect_refused("info a.t --threads many", 2, {"--threads"});
  expect_refused("make box", 2, {"--output"});
  expect_refused("make box -o box.t --cell 1 --elements 5", 2, {"--elements"});
  expect_refused("make rod --curve circle -o rod.t", 2, {"circle"});
  expect_refused("make box -o a.t b.t", 2, {"b.t"});
  EXPECT_TRUE(files().empty());
}

TEST_F(UsageTest, BadInputIsOneLineAndStatusTwo) {
  for (const char* command : {"info", "check", "paths"}) {
    expect_refused(std::string(command) + " missing.t", 2, {"missing.t"});
    write_text(file("bad.t"), "Vertex 0 0 0 0\nVertex 1 1 0 x\n");
    expect_refused(std::string(command) + " bad.t", 2, {"bad.t:2"});
    write_text(file("mesh.what"), "1");
    expect_refused(std::string(command) + " mesh.what", 2, {"mesh.what"});
  }
}

TEST_F(UsageTest, OptionsThatAShapeOrPoseDoesNotHaveAreRefused) {
  expect_refused("make cube -o a.t", 2, {"cube", "box"});
  expect_refused("make box --tentacles 5 -o a.t", 2, {"tentacles"});
  expect_refused("make box --curve coil -o a.t", 2, {"--curve"});
  expect_refused("make box --size 1 -1 1 -o a.t", 2, {});
  expect_refused("make box --pose knot -o a.t", 2, {"knot", "bend"});
  expect_refused("make box --pose bend,core=1 -o a.t", 2, {"core"});
  expect_refused("make box --pose bend,turns=lots -o a.t", 2, {"lots", "turns"});
  expect_refused("make box --pose bend,axis=w -o a.t", 2, {"'w'"});
  expect_refused("make box --pose bend,twice -o a.t", 2, {"twice"});
  expect_refused("make box --pose bend,speed=1 -o a.t", 2, {"speed"});
  EXPECT_TRUE(files().empty());
}

TEST_F(UsageTest, BenchSaysHowToBuildItOrRuns) {
  const bool built = fs::exists(fs::path(SELVAGE_PROGRAM).parent_path() / "selvage_bench");
  if (built) GTEST_SKIP() << "the benchmarks are built";
  expect_refused("bench", 2, {"cmake --preset benchmark"});
}

TEST_F(UsageTest, BenchPassesItsOptionsToTheProgramBesideIt) {
  fs::copy_file(SELVAGE_PROGRAM, file("selvage"));
  write_text(file("selvage_bench"), "#!/bin/sh\necho \"$@\"\n");
  fs::permissions(file("selvage_bench"), fs::perms::owner_all);
  const Outcome passed = run("--version > /dev/null; ./selvage bench boundary-path --quick --threads 3");
  EXPECT_EQ(passed.out, "boundary-path --threads 3 --quick\n") << passed.err;
  const Outcome scenes = run("--version > /dev/null; ./selvage bench simulation --frames 3 --scene two_balls");
  EXPECT_EQ(scenes.out, "simulation --frames 3 --scene two_balls\n") << scenes.err;
  const Outcome quiet = run("--version > /dev/null; ./selvage bench --quiet");
  EXPECT_EQ(quiet.status, 0);
  EXPECT_EQ(quiet.out, "");

  write_text(file("selvage_bench"), "#!/bin/sh\necho half > \"$3\"\nexit 7\n");
  const Outcome failed = run("--version > /dev/null; ./selvage bench boundary-path --json result.json");
  EXPECT_EQ(failed.status, 3);
  EXPECT_NE(failed.err.find("status 7"), std::string::npos) << failed.err;
  EXPECT_EQ(files(), (std::vector<std::string>{"selvage", "selvage_bench"}));
}

}  // namespace
}  // namespace selvage::testing
