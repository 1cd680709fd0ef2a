#include "picture/video.h"

#include "selvage/core/error.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <sstream>

extern char** environ;

namespace selvage {

namespace {

namespace fs = std::filesystem;

/// The encoder's arguments. Odd sizes get one more row or column of white, which H.264 asks for.
std::vector<std::string> arguments_of(const fs::path& encoder, const fs::path& path, int width, int height,
                                      double images_per_second) {
  std::vector<std::string> arguments{encoder.string(),
                                     "-hide_banner",
                                     "-loglevel",
                                     "error",
                                     "-y",
                                     "-f",
                                     "rawvideo",
                                     "-pix_fmt",
                                     "rgb24",
                                     "-s",
                                     fmt::format("{}x{}", width, height),
                                     "-r",
                                     fmt::format("{:.6g}", images_per_second),
                                     "-i",
                                     "-"};
  const auto add = [&](std::initializer_list<const char*> more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
  };
  if (path.extension() == ".gif") {
    add({"-vf", "split[a][b];[a]palettegen=stats_mode=diff[p];[b][p]paletteuse=dither=bayer:bayer_scale=4"});
  } else {
    add({"-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2:0:0:white", "-c:v", "libx264", "-pix_fmt", "yuv420p", "-crf", "19",
         "-preset", "medium", "-movflags", "+faststart"});
  }
  // One thread: the file does not depend on the machine.
  add({"-threads", "1"});
  arguments.push_back(path.string());
  return arguments;
}

}  // namespace

fs::path find_video_encoder() {
  const char* folders = std::getenv("PATH");
  std::istringstream list(folders == nullptr ? "" : folders);
  for (std::string folder; std::getline(list, folder, ':');) {
    const fs::path candidate = fs::path(folder) / "ffmpeg";
    if (access(candidate.c_str(), X_OK) == 0 && !fs::is_directory(candidate)) return candidate;
  }
  throw Error("ffmpeg", "is not installed, and videos need it", "install it, or write one frame as .png");
}

VideoWriter::VideoWriter(const fs::path& encoder, const fs::path& path, int width, int height, double images_per_second)
    : path_(path), width_(width), height_(height) {
  int to_encoder[2], from_encoder[2];
  if (pipe2(to_encoder, O_CLOEXEC) != 0) throw SystemError("ffmpeg", "cannot be started: no pipe is left");
  if (pipe2(from_encoder, O_CLOEXEC) != 0) {
    close(to_encoder[0]), close(to_encoder[1]);
    throw SystemError("ffmpeg", "cannot be started: no pipe is left");
  }
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, to_encoder[0], STDIN_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, from_encoder[1], STDERR_FILENO);
  const std::vector<std::string> arguments = arguments_of(encoder, path, width, height, images_per_second);
  std::vector<char*> pointers;
  for (const std::string& argument : arguments) pointers.push_back(const_cast<char*>(argument.c_str()));
  pointers.push_back(nullptr);
  const int failed = posix_spawn(&process_, encoder.c_str(), &actions, nullptr, pointers.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(to_encoder[0]), close(from_encoder[1]);
  pipe_ = to_encoder[1], errors_ = from_encoder[0];
  if (failed != 0) {
    process_ = -1;
    close(pipe_), close(errors_);
    pipe_ = errors_ = -1;
    throw SystemError(encoder.string(), "cannot be started");
  }
}

VideoWriter::~VideoWriter() {
  if (process_ > 0) kill(process_, SIGTERM);
  wait();
}

void VideoWriter::add(const Image& image) {
  if (image.width() != width_ || image.height() != height_)
    throw SystemError(path_.string(), "has images of two sizes");
  const auto bytes = srgb_bytes(image);
  // A write to a program that has ended must be an error, not the end of this one.
  struct sigaction ignore {
  }, before{};
  ignore.sa_handler = SIG_IGN;
  sigaction(SIGPIPE, &ignore, &before);
  const char* at = reinterpret_cast<const char*>(bytes.data());
  std::size_t left = bytes.size() * sizeof bytes[0];
  bool broken = false;
  while (left > 0 && !broken) {
    const ssize_t written = write(pipe_, at, left);
    if (written < 0 && errno == EINTR) continue;
    broken = written <= 0;
    if (!broken) at += written, left -= static_cast<std::size_t>(written);
  }
  sigaction(SIGPIPE, &before, nullptr);
  if (broken) fail();
}

/// Ends the pipe and the program; what it said, or "" where it succeeded.
std::string VideoWriter::wait() {
  if (pipe_ >= 0) close(pipe_);
  std::string words;
  char buffer[512];
  for (ssize_t got; errors_ >= 0 && (got = read(errors_, buffer, sizeof buffer)) > 0;) words.append(buffer, got);
  if (errors_ >= 0) close(errors_);
  int status = 0;
  if (process_ > 0) waitpid(process_, &status, 0);
  pipe_ = errors_ = process_ = -1;
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return "";
  while (!words.empty() && (words.back() == '\n' || words.back() == ' ')) words.pop_back();
  const std::size_t line = words.rfind('\n');
  if (line != std::string::npos) words = words.substr(line + 1);
  return words.empty() ? "it gave no reason" : words;
}

void VideoWriter::fail() {
  throw SystemError(path_.string(), fmt::format("cannot write the video (ffmpeg: {})", wait()));
}

void VideoWriter::finish() {
  const std::string words = wait();
  if (!words.empty()) throw SystemError(path_.string(), fmt::format("cannot write the video (ffmpeg: {})", words));
}

}  // namespace selvage
