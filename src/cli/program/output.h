#pragma once

#include "cli/program/command.h"
#include "selvage/io/mesh_file.h"

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace selvage::cli {

/// Output files that appear all together when a command has succeeded, or not at all.
///
/// Each is written beside its place under another name and renamed by commit(); without commit() nothing stays, and
/// what stood at a file's place before is untouched. What is no regular file (a device, a pipe) is written to directly.
class OutputFiles {
 public:
  OutputFiles() = default;
  ~OutputFiles();
  OutputFiles(const OutputFiles&) = delete;
  OutputFiles& operator=(const OutputFiles&) = delete;

  /// Announces an output, before the work starts. An empty path is none; "-" is standard output.
  /// @param inputs  files that no output may replace
  /// @throws Error  when the folder does not exist, the place is a folder, or two outputs are the same
  void expect(const std::string& path, const std::vector<std::filesystem::path>& inputs = {});

  /// A path beside `path`, with the same extension, where the output is to be written; an output was expected there.
  std::filesystem::path stage(const std::string& path);

  /// Lets `write` write an output at the path that it is given: that of stage().
  /// @throws Failure  when it raises a SystemError, with the output's own name in the message
  /// @throws Error    the one that it raises, likewise
  void write_file(const std::string& path, const std::function<void(const std::filesystem::path&)>& write);

  /// The same for a mesh; both files of a TetGen pair.
  void write_mesh(const std::string& path, const IndexedMesh& mesh, FileEncoding encoding = FileEncoding::kUsual);

  /// Writes text to its place: standard output and devices at once, a file when commit() is called.
  /// @throws Failure  when it cannot be written
  void write_text(const std::string& path, std::string_view text);

  /// Puts all staged files in their places.
  /// @throws Failure  when one cannot be renamed
  void commit();

  /// Whether an expected output goes to standard output, so that nothing else may.
  bool uses_standard_output() const { return standard_output_; }

 private:
  struct Staged {
    std::filesystem::path temporary, place;
  };

  void stage_at(const std::filesystem::path& temporary, const std::filesystem::path& place);

  std::vector<std::filesystem::path> expected_;
  std::vector<Staged> staged_;
  bool standard_output_ = false;
};

/// Handler of signals that end the program: removes every staged file first, then lets the signal do its work.
void end_without_staged_files(int signal);

}  // namespace selvage::cli
