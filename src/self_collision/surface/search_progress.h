#pragma once

#include "selvage/self_collision/self_collision.h"

#include <mutex>

namespace selvage {

/// Tells whoever asked how far a parallel loop has come.
class SearchProgress {
 public:
  /// @param count  items of the loop, or of several that follow one another
  SearchProgress(const SelfCollisionOptions& options, std::int64_t count) : tell_(options.on_progress), count_(count) {}

  /// Thread-safe.
  void add(std::int64_t items) {
    if (!tell_) return;
    const std::lock_guard one_at_a_time(telling_);
    done_ += items;
    tell_(static_cast<double>(done_) / static_cast<double>(count_));
  }

 private:
  const std::function<void(double)>& tell_;
  std::int64_t count_, done_ = 0;
  std::mutex telling_;
};

}  // namespace selvage
