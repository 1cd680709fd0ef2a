#pragma once

#include <chrono>

namespace selvage {

/// Runs `body`, and adds the seconds that it took to `seconds`.
template <typename Body>
void timed(double& seconds, Body&& body) {
  const auto start = std::chrono::steady_clock::now();
  body();
  seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace selvage
