#include "cli/program/output.h"

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

/// Where a link leads, so that it stays a link.
fs::path place_of(const fs::path& path) {
  return fs::is_symlink(path) ? normal_path(path) : path;
}

/// Lets `write` write at `staged` what users know by another name; in messages, too.
void write_under_name(const fs::path& name, const fs::path& staged, const std::function<void(const fs::path&)>& write) {
  const auto renamed = [&](const Error& error) {
    std::string message = error.what();
    const std::string known = fs::path(name).replace_extension().string();
    const std::string unknown = fs::path(staged).replace_extension().string();
    const std::size_t at = message.find(unknown);
    return at == std::string::npos ? message : message.replace(at, unknown.size(), known);
  };
  try {
    write(staged);
  } catch (const SystemError& error) {
    throw Failure(renamed(error));
  } catch (const Error& error) {
    throw Error("", renamed(error));
  }
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
  if (!fs::is_directory(folder)) throw Error(path, "the folder does not exist", "create it first");
  if (fs::is_directory(path)) throw Error(path, "is a folder", "name a file");
  if (access(folder.c_str(), W_OK) != 0) throw Error(path, "the folder of this output cannot be written to");
  const fs::path place = normal_path(path);
  for (const fs::path& input : inputs) {
    if (normal_path(input) == place) throw Error(path, "would replace an input file", "choose another name");
  }
  if (std::find(expected_.begin(), expected_.end(), place) != expected_.end()) {
    throw Error(path, "is given for two outputs", "choose two names");
  }
  expected_.push_back(place);
}

fs::path OutputFiles::stage(const std::string& path) {
  const fs::path place = place_of(path);
  const std::string name =
      fmt::format(".{}.{}.{}{}", place.stem().string(), getpid(), staged_.size(), place.extension().string());
  stage_at(place.parent_path() / name, place);
  return staged_.back().temporary;
}

void OutputFiles::stage_at(const fs::path& temporary, const fs::path& place) {
  staged_.push_back({temporary, place});
  newest_staged_path = new StagedPath{temporary.string(), newest_staged_path};
}

void OutputFiles::write_file(const std::string& path, const std::function<void(const fs::path&)>& write) {
  write_under_name(path, stage(path), write);
}

void OutputFiles::write_mesh(const std::string& path, const IndexedMesh& mesh, FileEncoding encoding) {
  const auto write = [&](const fs::path& to) { selvage::write_mesh(to, mesh, encoding); };
  if (is_special(path)) return write_under_name(path, path, write);
  const fs::path staged = stage(path);
  const auto temporaries = files_of_mesh(staged), places = files_of_mesh(path);
  for (std::size_t i = 1; i < places.size(); ++i) stage_at(temporaries[i], place_of(places[i]));
  write_under_name(path, staged, write);
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
  // Asked before anything is moved, so that none appears without the others.
  for (const Staged& file : staged_)
    if (fs::is_directory(file.place)) throw Failure(fmt::format("{}: cannot write (is a folder)", file.place.string()));
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
