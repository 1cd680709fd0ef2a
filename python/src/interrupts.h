#pragma once

#include <nanobind/nanobind.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <memory>

namespace selvage::python {

namespace nb = nanobind;

/// Between pieces of long work that has let go of the interpreter: gives Python its turn to handle signals, a few times
/// a second, and reports progress to a user's function. What Python raises (KeyboardInterrupt, say) is thrown.
class Watch {
 public:
  /// @param progress  called with the share that is done; may be None
  explicit Watch(nb::object progress = nb::none());

  /// At the start of a query: short ones neither report nor wait for the interpreter.
  void begin();

  /// Only the main thread of Python handles signals; on others this does nothing but report.
  void operator()(double share);
  void operator()() { check(); }
  /// Reports that all is done.
  void end() { (*this)(1); }

  /// For the garbage collector.
  nb::object& progress() { return progress_; }

 private:
  using Clock = std::chrono::steady_clock;
  void check();

  nb::object progress_;
  bool reports_;
  std::atomic<Clock::rep> next_check_{0}, next_report_{0};
};

/// A function for the library that calls the watch.
std::function<void(double)> progress_of(const std::shared_ptr<Watch>& watch);

/// Calls `body(first, last)` on consecutive pieces of [0, count) of about a tenth of a second each, and lets Python
/// handle signals in between. For work whose result does not depend on how it is cut.
template <typename Body>
void in_pieces(std::int64_t count, Watch& watch, Body&& body) {
  using Clock = std::chrono::steady_clock;
  std::int64_t piece = 1 << 14;
  for (std::int64_t first = 0; first < count;) {
    const auto start = Clock::now();
    const std::int64_t last = std::min(count, first + piece);
    body(first, last);
    first = last;
    const std::chrono::duration<double> taken = Clock::now() - start;
    piece = taken.count() < 0.05 ? piece * 2 : taken.count() > 0.2 ? std::max<std::int64_t>(piece / 2, 256) : piece;
    if (first < count) watch(static_cast<double>(first) / static_cast<double>(count));
  }
  watch.end();
}

}  // namespace selvage::python
