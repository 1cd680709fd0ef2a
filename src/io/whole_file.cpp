#include "io/whole_file.h"

#include "selvage/core/error.h"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <vector>

namespace selvage {

namespace {

namespace fs = std::filesystem;

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

[[noreturn]] void fail_to_read(const fs::path& path, int code) {
  throw Error(path.string(), fmt::format("cannot be read: {}", std::strerror(code)),
              "check the name and its permissions");
}

[[noreturn]] void fail_to_write(const fs::path& path, int code) {
  throw SystemError(path.string(), fmt::format("cannot be written: {}", std::strerror(code)),
                    "check that the folder exists, may be written and has space");
}

/// Files written beside their places: removed unless they were moved there.
class PendingFiles {
 public:
  ~PendingFiles() {
    std::error_code ignored;
    for (const auto& [temporary, target] : pending_) fs::remove(temporary, ignored);
  }

  void write(const FileContent& content) {
    // A name of its own for every process and call, so that writers do not meet; "x" never opens what exists.
    static std::atomic<unsigned> serial{0};
    std::error_code ignored;
    const fs::path target =
        fs::is_symlink(content.path, ignored) ? fs::weakly_canonical(content.path, ignored) : content.path;
    // Asked before anything is moved, so that the first file of a pair does not appear alone.
    if (fs::is_directory(target, ignored)) fail_to_write(content.path, EISDIR);
    const bool special = fs::exists(target, ignored) && !fs::is_regular_file(target, ignored);
    fs::path temporary = target;
    if (!special) temporary += fmt::format(".{}-{}.part", ::getpid(), serial++);
    File file(std::fopen(temporary.c_str(), special ? "wb" : "wbx"));
    if (!file) fail_to_write(content.path, errno);
    if (!special) pending_.push_back({temporary, target});
    const bool written = std::fwrite(content.bytes.data(), 1, content.bytes.size(), file.get()) == content.bytes.size();
    const int write_code = errno;
    const bool closed = std::fclose(file.release()) == 0;
    if (!written || !closed) fail_to_write(content.path, written ? errno : write_code);
  }

  void move_into_place() {
    for (const auto& [temporary, target] : pending_) {
      std::error_code code;
      fs::rename(temporary, target, code);
      if (code) fail_to_write(target, code.value());
    }
    pending_.clear();
  }

 private:
  std::vector<std::pair<fs::path, fs::path>> pending_;
};

}  // namespace

std::string read_whole_file(const fs::path& path) {
  std::error_code code;
  if (fs::is_directory(path, code)) fail_to_read(path, EISDIR);
  File file(std::fopen(path.c_str(), "rb"));
  if (!file) fail_to_read(path, errno);
  const auto size = fs::file_size(path, code);
  std::string bytes;
  // One byte more than the file has, so that its end is seen at once; pipes, which have no size, grow.
  constexpr std::size_t kMinRoom = 1 << 16;
  std::size_t filled = 0;
  std::size_t room = code ? kMinRoom : static_cast<std::size_t>(size) + 1;
  while (true) {
    bytes.resize(filled + room);
    filled += std::fread(bytes.data() + filled, 1, room, file.get());
    if (filled < bytes.size()) break;
    room = std::max(kMinRoom, filled / 2);
  }
  if (std::ferror(file.get())) fail_to_read(path, errno);
  bytes.resize(filled);
  return bytes;
}

void write_whole_files(std::span<const FileContent> files) {
  PendingFiles pending;
  for (const FileContent& file : files) pending.write(file);
  pending.move_into_place();
}

}  // namespace selvage
