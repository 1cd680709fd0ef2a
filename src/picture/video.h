#pragma once

#include "picture/drawing/image.h"

#include <filesystem>
#include <string>

namespace selvage {

/// The program that encodes videos, looked for in PATH.
/// @throws Error  where there is none
std::filesystem::path find_video_encoder();

/// A video that is written image by image: raw colours go down a pipe to `ffmpeg`.
class VideoWriter {
 public:
  /// @param path  ends in .mp4 (H.264) or .gif, which play in browsers
  /// @throws SystemError  when the encoder cannot be started
  VideoWriter(const std::filesystem::path& encoder, const std::filesystem::path& path, int width, int height,
              double images_per_second);
  ~VideoWriter();
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  /// @throws SystemError  with the encoder's own words, when it has stopped
  void add(const Image& image);

  /// Waits until the file is whole.
  /// @throws SystemError  likewise
  void finish();

 private:
  [[noreturn]] void fail();
  std::string wait();

  std::filesystem::path path_;
  int pipe_ = -1, errors_ = -1, process_ = -1;
  int width_, height_;
};

}  // namespace selvage
