#pragma once

#include "selvage/self_collision/self_collision.h"

#include <mutex>

namespace selvage {

/// Reports the progress of a parallel loop to SelfCollisionOptions::on_progress.
class SearchProgress {
 public:
  /// @param count  items of the loop, or of several that follow one another
  SearchProgress(const SelfCollisionOptions& options, std::int64_t count)
      : report_(options.on_progress), count_(count) {}

  /// Thread-safe.
  void add(std::int64_t items) {
    if (!report_) return;
    const std::lock_guard lock(mutex_);
    done_ += items;
    report_(static_cast<double>(done_) / static_cast<double>(count_));
  }

 private:
  const std::function<void(double)>& report_;
  std::int64_t count_, done_ = 0;
  std::mutex mutex_;
};

}  // namespace selvage
