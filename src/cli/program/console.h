#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace selvage::cli {

/// Seconds of each phase of a command, in order.
class Stopwatch {
 public:
  /// Ends a phase that began when the last one ended, or when the watch was made.
  void lap(std::string phase);
  double total() const;
  const std::vector<std::pair<std::string, double>>& laps() const { return laps_; }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now(), last_ = start_;
  std::vector<std::pair<std::string, double>> laps_;
};

/// A bar on standard error that shows how far long work has come. Silent unless standard error is a terminal, and for
/// the first half second.
class ProgressBar {
 public:
  ProgressBar(std::string_view task, bool quiet);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// @param note  stands behind the bar
  void show(double fraction, std::string_view note = {});
  /// Takes the bar off the screen.
  void clear();

 private:
  std::string task_;
  std::string drawn_;  ///< the text on the screen
  bool visible_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// What a progress bar shows: the task, a bar, per cent, the note. Where there is too little room the bar becomes
/// short, then goes; the note is cut only when it does not fit without.
std::string progress_line(std::string_view task, double fraction, std::string_view note, int columns);

/// Columns of the terminal behind a file descriptor; `otherwise` where it is none.
int terminal_width(int descriptor, int otherwise);

/// A count with its digits in groups of three: 12,345.
std::string grouped(std::int64_t count);

/// A time in the unit that reads best: 1.23 s, 45.6 ms.
std::string readable_seconds(double seconds);

/// A time in hours, minutes and seconds, as far as they matter: 2 h 05 min, 3 min 20 s, 1.2 s.
std::string readable_duration(double seconds);

/// Lines of a name and a value, the values one below the other.
class Table {
 public:
  void add(std::string_view name, std::string_view value);
  void print() const;

 private:
  std::vector<std::pair<std::string, std::string>> rows_;
};

}  // namespace selvage::cli
