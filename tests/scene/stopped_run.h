#pragma once

#include "selvage/scene/run.h"
#include "temporary_folder.h"
#include "threads.h"

#include <gtest/gtest.h>

namespace selvage::test {

/// Runs a scene by one thread, and by two with a stop, and expects the same bits of both.
/// @param stop  the frame after which the second run stops and goes on
/// @returns     the report of the first
inline RunReport run_with_and_without_stop(const Scene& scene, std::int64_t frames, std::int64_t stop) {
  const auto run = [&](const TemporaryFolder& folder, std::int64_t last, int threads, bool is_resumed) {
    RunOptions options;
    options.folder = folder.path();
    options.frames = last;
    options.resume = is_resumed;
    return with_threads(threads, [&] { return run_scene(scene, options); });
  };
  const TemporaryFolder whole, stopped;
  RunReport report = run(whole, frames, 1, false);
  EXPECT_EQ(report.outcome, RunOutcome::kFinished) << report.message;
  run(stopped, stop, 2, false);
  EXPECT_EQ(run(stopped, frames, 2, true).fingerprint, report.fingerprint);
  return report;
}

}  // namespace selvage::test
