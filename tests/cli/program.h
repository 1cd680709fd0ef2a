#pragma once

#include "temporary_folder.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

namespace selvage::testing {

namespace fs = std::filesystem;

/// The result of a run of the program.
struct Outcome {
  int status = -1;
  std::string out, err;
};

using test::read_text;
using test::write_text;

inline std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == separator) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

/// The lines of a text, without the empty one after the last.
inline std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines = split(text, '\n');
  if (lines.back().empty()) lines.pop_back();
  return lines;
}

/// Runs the built program in an empty folder of its own.
class ProgramTest : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directory(folder_ / "work"); }

  /// @param arguments  as typed after `selvage`, redirections included
  /// @param before     shell commands that come first
  Outcome run(const std::string& arguments, const std::string& before = "true") const {
    const fs::path out = folder_ / "out", err = folder_ / "err";
    const std::string command = "cd '" + (folder_ / "work").string() + "' && " + before + " && { '" + SELVAGE_PROGRAM +
                                "' " + arguments + "; } > '" + out.string() + "' 2> '" + err.string() + "'";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_text(out), read_text(err)};
  }

  /// Expects the run to succeed in silence on standard error.
  Outcome run_well(const std::string& arguments) const {
    Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 0) << "selvage " << arguments << "\n" << outcome.err;
    EXPECT_EQ(outcome.err, "") << "selvage " << arguments;
    return outcome;
  }

  /// Expects one line on standard error that says all of `words`, and nothing on standard output.
  void expect_refused(const std::string& arguments, int status, const std::vector<std::string>& words) const {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, status) << "selvage " << arguments << "\n" << outcome.err;
    EXPECT_EQ(outcome.out, "") << "selvage " << arguments;
    EXPECT_EQ(lines_of(outcome.err).size(), 1u) << "selvage " << arguments << "\n" << outcome.err;
    for (const std::string& word : words) {
      EXPECT_NE(outcome.err.find(word), std::string::npos)
          << "selvage " << arguments << "\nsays: " << outcome.err << "without: " << word;
    }
  }

  fs::path file(const std::string& name) const { return folder_ / "work" / name; }

  /// Names of all files in the folder, hidden ones too, ascending.
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_ / "work")) names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
  }

 private:
  test::TemporaryFolder folder_;
};

}  // namespace selvage::testing
