#include "cli/output.h"

#include "selvage/core/error.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>

namespace selvage::cli {

namespace fs = std::filesystem;

namespace {

fs::path normal_path(const fs::path& path) {
  std::error_code error;
  const fs::path normal = fs::weakly_canonical(fs::absolute(path), error);
  return error ? path : normal;
}

[[noreturn]] void fail_to_write(const std::string& name) {
  throw Failure(fmt::format("{}: cannot write ({})", name, std::strerror(errno)));
}

/// Writes all of the text and makes sure that it has arrived.
void write_all(std::FILE* file, std::string_view text, const std::string& name) {
  const bool written = std::fwrite(text.data(), 1, text.size(), file) == text.size() && std::fflush(file) == 0;
  if (!written) fail_to_write(name);
}

/// A device or a pipe, which must not be replaced by a file.
bool is_special(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored) && !fs::is_regular_file(path, ignored) && !fs::is_directory(path, ignored);
}

/// Every path that was ever staged, for a signal handler: linked at once, never freed. The process is part of the
/// names, so that a path which is no longer staged belongs to nobody else.
struct StagedPath {
  std::string path;
  const StagedPath* next;
};
std::atomic<const StagedPath*> newest_staged_path = nullptr;

}  // namespace

OutputFiles::~OutputFiles() {
  std::error_code ignored;
  for (const Staged& file : staged_) fs::remove(file.temporary, ignored);
}

void OutputFiles::expect(const std::string& path, const std::vector<fs::path>& inputs) {
  if (path.empty()) return;
  if (path == "-") {
    if (standard_output_) throw Error("-", "two outputs cannot both go to standard output");
    standard_output_ = true;
    return;
  }
  if (is_special(path)) return;
  const fs::path folder = fs::path(path).has_parent_path() ? fs::path(path).parent_path() : fs::path(".");
  if (!fs::is_directory(folder)) throw Error(path, "the folder of this output does not exist", "make it first");
  if (fs::is_directory(path)) throw Error(path, "is a folder", "name a file");
  if (access(folder.c_str(), W_OK) != 0) throw Error(path, "the folder of this output cannot be written to");
  const fs::path place = normal_path(path);
  for (const fs::path& input : inputs) {
    if (normal_path(input) == place) throw Error(path, "would replace an input file", "choose another name");
  }
  if (std::find(expected_.begin(), expected_.end(), place) != expected_.end()) {
    throw Error(path, "is named for two outputs", "choose two names");
  }
  expected_.push_back(place);
}

fs::path OutputFiles::stage(const std::string& path) {
  const fs::path place = fs::is_symlink(path) ? normal_path(path) : fs::path(path);
  const std::string name =
      fmt::format(".{}.{}.{}{}", place.stem().string(), getpid(), staged_.size(), place.extension().string());
  staged_.push_back({place.parent_path() / name, place});
  newest_staged_path = new StagedPath{staged_.back().temporary.string(), newest_staged_path};
  return staged_.back().temporary;
}

void OutputFiles::write_file(const std::string& path, const std::function<void(const fs::path&)>& write) {
  const fs::path staged = stage(path);
  try {
    write(staged);
  } catch (const SystemError& error) {
    std::string message = error.what();
    const std::size_t name = message.find(staged.string());
    if (name != std::string::npos) message.replace(name, staged.string().size(), path);
    throw Failure(message);
  }
}

void OutputFiles::write_text(const std::string& path, std::string_view text) {
  if (path.empty()) return;
  if (path == "-") return write_all(stdout, text, "standard output");
  const fs::path written = is_special(path) ? fs::path(path) : stage(path);
  std::FILE* file = std::fopen(written.c_str(), "wb");
  if (file == nullptr) fail_to_write(path);
  try {
    write_all(file, text, path);
  } catch (...) {
    std::fclose(file);
    throw;
  }
  if (std::fclose(file) != 0) fail_to_write(path);
}

void OutputFiles::commit() {
  while (!staged_.empty()) {
    std::error_code error;
    fs::rename(staged_.back().temporary, staged_.back().place, error);
    if (error) throw Failure(fmt::format("{}: cannot write ({})", staged_.back().place.string(), error.message()));
    staged_.pop_back();
  }
}

void end_without_staged_files(int signal) {
  for (const StagedPath* staged = newest_staged_path; staged != nullptr; staged = staged->next) {
    unlink(staged->path.c_str());
  }
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

}  // namespace selvage::cli
