#pragma once

#include "core/parallel.h"
#include "selvage/core/types.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <span>
#include <thread>
#include <vector>

namespace selvage {
namespace detail {

/// Threads that go through the same phases together. Each has a share of every phase, which it takes from the front;
/// a thread whose share is done takes from the backs of the others.
class PhaseCrew {
 public:
  PhaseCrew(std::span<const Index> phase_first, int shares) : phase_first_(phase_first), taken_(shares) {}

  /// Takes part until all phases are done; a thread may come late, or not at all.
  template <typename Body>
  void work(int own, const Body& body) {
    const auto shares = static_cast<int>(taken_.size());
    Index end = 0;
    for (Index phase = 0; phase < phase_count(); ++phase) {
      end += phase_first_[phase + 1] - phase_first_[phase];
      const Index later = std::min(first_of(phase + 1 < phase_count() ? phase + 1 : 0, own), phase_first_.back() - 1);
      for (int i = 0; i < shares && done_.load(std::memory_order_acquire) < end; ++i) {
        const int share = (own + i) % shares;
        const Index last = first_of(phase, share + 1);
        Index count = 0;
        for (Index item; (item = take(phase, share, i == 0)) != kNone; ++count)
          body(item, i == 0 && item + 1 < last ? item + 1 : later);
        if (count > 0) done_.fetch_add(count, std::memory_order_acq_rel);
      }
      for (int spins = 0; done_.load(std::memory_order_acquire) < end; ++spins) pause(spins);
    }
  }

 private:
  /// Of a share, in the latest phase in which any was taken: counted from 1, so that at first there is none.
  struct Taken {
    std::uint64_t phase : 16, front : 24, back : 24;
  };
  /// On a cache line of its own.
  struct alignas(64) Share {
    std::atomic<Taken> taken = Taken{0, 0, 0};
  };
  static_assert(std::atomic<Taken>::is_always_lock_free);

  Index phase_count() const { return static_cast<Index>(phase_first_.size()) - 1; }

  Index first_of(Index phase, int share) const {
    const std::int64_t first = phase_first_[phase], count = phase_first_[phase + 1] - first;
    return static_cast<Index>(first + share * count / std::ssize(taken_));
  }

  /// An item of a share that nobody has taken; kNone: there is none.
  Index take(Index phase, int share, bool from_front) {
    const auto number = static_cast<std::uint64_t>(phase) + 1;
    const Index first = first_of(phase, share), last = first_of(phase, share + 1);
    std::atomic<Taken>& taken = taken_[share].taken;
    Taken seen = taken.load(std::memory_order_relaxed), next{};
    do {
      if (seen.phase > number) return kNone;
      next = seen.phase == number ? seen : Taken{number, 0, 0};
      if (static_cast<Index>(next.front + next.back) >= last - first) return kNone;
      if (from_front)
        ++next.front;
      else
        ++next.back;
    } while (!taken.compare_exchange_weak(seen, next, std::memory_order_relaxed));
    return from_front ? first + static_cast<Index>(next.front) - 1 : last - static_cast<Index>(next.back);
  }

  /// Others are mostly some microseconds behind; where they are not even running they need the processor.
  static void pause(int spins) {
    if (spins > 1'000) std::this_thread::yield();
#ifdef __x86_64__
    __builtin_ia32_pause();
#endif
  }

  std::span<const Index> phase_first_;
  std::vector<Share> taken_;
  alignas(64) std::atomic<Index> done_ = 0;  ///< items, of all phases
};

}  // namespace detail

/// Goes through phases of a few items of a few microseconds each; no item begins before all of the phases before are
/// done. Calls `body(item, next)` once for each item, on all cores that the caller's oneTBB arena or global_control
/// allows; `next` is what the same thread will most likely be given next, so that it can be fetched. The body must not
/// throw.
///
/// A phase costs two or three transfers of a cache line from core to core, where a parallel_for costs some thirty, and
/// in every call a thread is given the same items first, whose memory it may still have in its cache.
///
/// @param phase_first  (n_phases + 1) the first item of each
template <typename Body>
void parallel_phases(std::span<const Index> phase_first, const Body& body) {
  if constexpr (detail::kPlainThreads) {
    detail::PhaseCrew crew(phase_first, 4);
    std::array<std::future<void>, 3> others;
    for (int i = 0; i < 3; ++i) others[i] = std::async(std::launch::async, [&, i] { crew.work(i + 1, body); });
    crew.work(0, body);
    for (auto& other : others) other.get();
  } else {
    using Control = tbb::global_control;
    const auto allowed = static_cast<int>(Control::active_value(Control::max_allowed_parallelism));
    const int threads = std::min(tbb::this_task_arena::max_concurrency(), allowed);
    detail::PhaseCrew crew(phase_first, threads);
    const auto work = [&] { crew.work(std::max(tbb::this_task_arena::current_thread_index(), 0) % threads, body); };
    tbb::task_group others;
    for (int i = 1; i < threads; ++i) others.run(work);
    work();
    others.wait();
  }
}

}  // namespace selvage
