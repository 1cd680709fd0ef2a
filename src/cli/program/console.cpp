#include "cli/program/console.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace selvage::cli {

void Stopwatch::lap(std::string phase) {
  const auto now = Clock::now();
  laps_.emplace_back(std::move(phase), std::chrono::duration<double>(now - last_).count());
  last_ = now;
}

double Stopwatch::total() const {
  return std::chrono::duration<double>(last_ - start_).count();
}

namespace {

/// Whether a line on standard error can be drawn over.
bool shows_progress() {
  const char* terminal = std::getenv("TERM");
  return isatty(STDERR_FILENO) && terminal != nullptr && std::string_view(terminal) != "dumb";
}

}  // namespace

ProgressBar::ProgressBar(std::string_view task, bool quiet) : task_(task), visible_(!quiet && shows_progress()) {}

ProgressBar::~ProgressBar() {
  clear();
}

void ProgressBar::clear() {
  if (!drawn_.empty()) fmt::print(stderr, "\r\033[K");
  drawn_.clear();
}

std::string progress_line(std::string_view task, double fraction, std::string_view note, int columns) {
  constexpr int kMaxWidth = 30, kMinWidth = 8;
  const std::string percent = fmt::format("{:3.0f}%", 100 * std::clamp(fraction, 0.0, 1.0));
  const int others = static_cast<int>(task.size() + percent.size() + note.size()) + 6;
  const int width = std::min(columns - others, kMaxWidth);
  std::string line;
  if (width < kMinWidth) {
    line = fmt::format("{} {}  {}", task, percent, note);
  } else {
    const int filled = static_cast<int>(std::clamp(fraction, 0.0, 1.0) * width);
    line = fmt::format("{} [{:=<{}}{:{}}] {}  {}", task, "", filled, "", width - filled, percent, note);
  }
  if (static_cast<int>(line.size()) > columns) line.resize(static_cast<std::size_t>(std::max(columns, 0)));
  return line;
}

void ProgressBar::show(double fraction, std::string_view note) {
  const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  if (!visible_ || elapsed < 0.5) return;
  // A line that is full could not be wiped.
  std::string line = progress_line(task_, fraction, note, terminal_width(STDERR_FILENO, 80) - 1);
  if (line == drawn_) return;
  fmt::print(stderr, "\r{}\033[K", line);
  std::fflush(stderr);
  drawn_ = std::move(line);
}

int terminal_width(int descriptor, int otherwise) {
  winsize size{};
  return ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : otherwise;
}

std::string grouped(std::int64_t count) {
  const std::string digits = fmt::format("{}", count);
  std::string result;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    const bool starts_group = i > 0 && (digits.size() - i) % 3 == 0 && digits[i - 1] != '-';
    if (starts_group) result += ',';
    result += digits[i];
  }
  return result;
}

std::string readable_seconds(double seconds) {
  if (seconds >= 1) return fmt::format("{:.2f} s", seconds);
  if (seconds >= 1e-3) return fmt::format("{:.1f} ms", 1e3 * seconds);
  return fmt::format("{:.1f} us", 1e6 * seconds);
}

std::string readable_duration(double seconds) {
  const auto whole = std::llround(seconds);
  if (whole >= 3600) return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
  if (whole >= 60) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return readable_seconds(seconds);
}

void Table::add(std::string_view name, std::string_view value) {
  rows_.emplace_back(name, value);
}

void Table::print() const {
  std::size_t width = 0;
  for (const auto& [name, value] : rows_) width = std::max(width, name.size());
  for (const auto& [name, value] : rows_) fmt::print("{:<{}}  {}\n", name, width, value);
}

}  // namespace selvage::cli
