#include "interrupts.h"

#include <thread>

namespace selvage::python {

namespace {

/// Pauses between two looks at signals, and between two reports.
constexpr std::chrono::milliseconds kCheckEvery{50}, kReportEvery{50};

/// The thread that imported the package first, which is that of Python's main program in all but odd cases; in those
/// PyErr_CheckSignals does nothing.
const std::thread::id kMainThread = std::this_thread::get_id();

/// Whether it is time; only one of several threads is told so.
bool is_due(std::atomic<std::chrono::steady_clock::rep>& next, std::chrono::milliseconds pause) {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  auto due = next.load(std::memory_order_relaxed);
  return now.count() >= due &&
         next.compare_exchange_strong(
             due, (now + std::chrono::duration_cast<std::chrono::steady_clock::duration>(pause)).count());
}

}  // namespace

Watch::Watch(nb::object progress) : progress_(std::move(progress)), reports_(!progress_.is_none()) {}

void Watch::begin() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  next_check_ = (now + std::chrono::duration_cast<std::chrono::steady_clock::duration>(kCheckEvery)).count();
}

void Watch::check() {
  if (std::this_thread::get_id() != kMainThread || !is_due(next_check_, kCheckEvery)) return;
  const nb::gil_scoped_acquire held;
  if (PyErr_CheckSignals() != 0) throw nb::python_error();
}

void Watch::operator()(double share) {
  check();
  if (!reports_ || (share < 1 && !is_due(next_report_, kReportEvery))) return;
  const nb::gil_scoped_acquire held;
  progress_(share);
}

std::function<void(double)> progress_of(const std::shared_ptr<Watch>& watch) {
  return [watch](double share) { (*watch)(share); };
}

}  // namespace selvage::python
