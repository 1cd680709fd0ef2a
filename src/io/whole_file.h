#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace selvage {

/// Content of a file.
/// @throws Error  when it cannot be read
std::string read_whole_file(const std::filesystem::path& path);

struct FileContent {
  std::filesystem::path path;
  std::string_view bytes;
};

/// Writes several files, whole or not at all: each is written beside its place first, then all are renamed. (Should the
/// system refuse the second rename after the first, which it has no reason to, the first file is in place.)
/// A file that is not regular (a device, a pipe) is written to directly.
/// @throws SystemError  when one cannot be written; nothing is left behind
void write_whole_files(std::span<const FileContent> files);

}  // namespace selvage
