#pragma once

#include "kernels/arithmetic.h"
#include "simulation/xpbd/material_blocks.h"

#include <atomic>
#include <barrier>
#include <chrono>
#include <numeric>
#include <thread>

namespace selvage::bench {

/// Additions, subtractions and multiplications of doubles in the kernel for one Neo-Hookean element, as written;
/// damping has more to do, and the first iteration of a step, whose multipliers are nothing yet, less. Two divisions, a
/// square root and two maxima besides, and what brings numbers to where they are needed.
inline constexpr double kOperationsPerElement = 329, kOperationsPerDampedElement = 398, kFewerAtFirst = 5;

/// Least memory traffic of an iteration over Neo-Hookean elements: batches are read, their multipliers written;
/// vertices read and written once, and read as they were at the start of the step where they are damped. [bytes]
inline double material_bytes(double elements, double vertices, bool damped) {
  return elements * (sizeof(ElementBatch) + 2 * 8 * kBatch) / kBatch + (damped ? 3 : 2) * vertices * sizeof(StepVertex);
}

/// Highest speed of this machine on some threads.
struct MachineLimit {
  double operations_per_second = 0;
  double bytes_per_second = 0;

  /// Least time of the iterations of a step over Neo-Hookean bodies: of arithmetic or of memory, whichever is
  /// more.
  double seconds(std::span<const Body> bodies, int iterations) const {
    double operations = 0, bytes = 0;
    for (const Body& body : bodies) {
      const bool damped = body.material.damping > 0;
      const double of_element = damped ? kOperationsPerDampedElement : kOperationsPerElement;
      operations += body.element_count * (iterations * of_element - kFewerAtFirst);
      bytes += iterations * material_bytes(body.element_count, body.vertex_count, damped);
    }
    return std::max(operations / operations_per_second, bytes / bytes_per_second);
  }

  MachineLimit mean_with(const MachineLimit& other) const {
    return {(operations_per_second + other.operations_per_second) / 2, (bytes_per_second + other.bytes_per_second) / 2};
  }
};

/// How long a cache line takes from one thread to another: half of a way there and back. A virtual machine may move its
/// processors to cores that share no cache, and then what threads do in turns takes longer. [s]
inline double measure_handover() {
  constexpr int kTurns = 1000;
  std::atomic<int> turn = 0;
  std::jthread other([&] {
    for (int i = 0; i < kTurns; ++i) {
      while (turn.load(std::memory_order_acquire) != 2 * i + 1) {
      }
      turn.store(2 * i + 2, std::memory_order_release);
    }
  });
  turn.store(1, std::memory_order_release);
  while (turn.load(std::memory_order_acquire) != 2) {
  }
  const auto start = std::chrono::steady_clock::now();
  for (int i = 1; i < kTurns; ++i) {
    turn.store(2 * i + 1, std::memory_order_release);
    while (turn.load(std::memory_order_acquire) != 2 * i + 2) {
    }
  }
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  return seconds.count() / (2 * (kTurns - 1));
}

/// Measures the limit whenever it is asked, in some ten milliseconds: doubles multiplied and added in registers, and
/// beside that as many divided and taken the root of as an element has; and doubles multiplied in passes over so much
/// memory, be it in caches or not.
class LimitMeter {
 public:
  LimitMeter(int threads, double bytes)
      : threads_(threads), numbers_(static_cast<std::size_t>(std::max(bytes / sizeof(double), 1.0)), 1.0) {}

  MachineLimit measure() {
    std::vector<double> sinks(threads_);
    const double operations = measure_pace(
        [&](int thread) { return static_cast<double>(SELVAGE_DISPATCH(run_arithmetic, 12'000, sinks[thread])); });
    const double bytes = measure_pace([&](int thread) {
      const std::size_t first = numbers_.size() * thread / threads_, last = numbers_.size() * (thread + 1) / threads_;
      for (std::size_t i = first; i < last; ++i) numbers_[i] *= 1.0000001;
      return 16 * static_cast<double>(last - first);
    });
    return {operations, bytes};
  }

 private:
  /// The sum over threads, at the same time, of the best that each does in ten tries. `work(thread)` returns how much
  /// it did.
  template <typename Work>
  double measure_pace(Work&& work) const {
    std::vector<double> paces(threads_, 0);
    std::barrier together(threads_);
    const auto measure = [&](int thread) {
      together.arrive_and_wait();
      for (int i = 0; i < 10; ++i) {
        const auto start = std::chrono::steady_clock::now();
        const double done = work(thread);
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
        paces[thread] = std::max(paces[thread], done / seconds.count());
      }
    };
    {
      std::vector<std::jthread> others;
      for (int t = 1; t < threads_; ++t) others.emplace_back(measure, t);
      measure(0);
    }
    return std::accumulate(paces.begin(), paces.end(), 0.0);
  }

  int threads_;
  std::vector<double> numbers_;
};

}  // namespace selvage::bench
