#pragma once

#include "kernels/arithmetic.h"
#include "selvage/core/parallel.h"
#include "simulation/material_blocks.h"

#include <chrono>
#include <thread>

namespace selvage::bench {

/// Arithmetic on doubles in the kernel for one Neo-Hookean element, as written: additions, subtractions,
/// multiplications; a square root and two divisions besides. Damping has more to do.
inline constexpr double kOperationsPerElement = 334, kOperationsPerDampedElement = 404;

/// What an iteration over Neo-Hookean elements moves at least: batches are read, their multipliers written; vertices
/// read and written once, and read as they were at the start of the step where they are damped. [bytes]
inline double material_bytes(double elements, double vertices, bool damped) {
  return elements * (sizeof(ElementBatch) + 2 * 8 * kBatch) / kBatch + (damped ? 3 : 2) * vertices * sizeof(VertexRow);
}

/// Best of twenty, in seconds: other threads may take a while until they come.
template <typename Body>
double best_seconds(Body&& body) {
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 20; ++i) {
    const auto start = std::chrono::steady_clock::now();
    body();
    best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return best;
}

/// What this machine does at most on some threads, measured: doubles multiplied and added in registers, and bytes read
/// and written in passes over 256 MiB.
struct MachineLimit {
  double operations_per_second = 0;
  double bytes_per_second = 0;

  static MachineLimit measure(int threads) {
    MachineLimit limit;
    std::vector<std::int64_t> operations(threads);
    std::vector<double> sinks(threads), numbers(std::size_t{1} << 25, 1.0);
    const double seconds = best_seconds([&] {
      parallel_for(threads, 1,
                   [&](std::int64_t t) { operations[t] = SELVAGE_DISPATCH(run_arithmetic, 4'000'000, sinks[t]); });
    });
    limit.operations_per_second = static_cast<double>(operations[0]) * threads / seconds;
    limit.bytes_per_second =
        16 * static_cast<double>(numbers.size()) / best_seconds([&] {
          parallel_ranges(std::ssize(numbers), 1 << 16, [&](std::int64_t first, std::int64_t last) {
            for (std::int64_t i = first; i < last; ++i) numbers[i] *= 1.0000001;
          });
        });
    return limit;
  }

  /// The larger of both: a machine's pace changes.
  void raise_to(const MachineLimit& other) {
    operations_per_second = std::max(operations_per_second, other.operations_per_second);
    bytes_per_second = std::max(bytes_per_second, other.bytes_per_second);
  }

  /// What an iteration over Neo-Hookean bodies takes at least: of arithmetic or of memory, whichever is more.
  double seconds(std::span<const Body> bodies) const {
    double operations = 0, bytes = 0;
    for (const Body& body : bodies) {
      const bool damped = body.material.damping > 0;
      operations += body.element_count * (damped ? kOperationsPerDampedElement : kOperationsPerElement);
      bytes += material_bytes(body.element_count, body.vertex_count, damped);
    }
    return std::max(operations / operations_per_second, bytes / bytes_per_second);
  }
};

}  // namespace selvage::bench
