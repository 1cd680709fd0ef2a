#include "selvage/scene/scene.h"

#include <tbb/global_control.h>

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>

// What the dearest frame costs of a body that colliders leave no room, beside a frame of that body as it lies on a
// floor: a box of 6,000 elements in a container, under a plane that goes through the container's floor, between two
// such planes at right angles, and under one in a container of its own width; there also a hundred times as stiff, and
// down to the floor. One thread. The time of an iteration is that of the dearest frame.
// selvage_microbench --benchmark_filter=crush
namespace selvage {
namespace {

constexpr int kFrames = 60, kRepetitions = 3;

/// Young's moduli [Pa].
constexpr const char* kSoft = "1e5";
constexpr const char* kStiff = "1e7";
constexpr const char* kWide = R"({"box": {"min": [-0.5, -0.5, 0], "max": [0.5, 0.5, 1]}})";
constexpr const char* kNarrow = R"({"box": {"min": [-0.25, -0.25, 0], "max": [0.25, 0.25, 1]}})";
constexpr const char* kFromAbove = R"(, {"plane": {"point": [0, 0, 1], "normal": [0, 0, -1]},
    "motion": {"keyframes": [{"time": 0}, {"time": 0.5, "translate": [0, 0, -1.1]}]}})";
constexpr const char* kToTheFloor = R"(, {"plane": {"point": [0, 0, 1], "normal": [0, 0, -1]},
    "motion": {"keyframes": [{"time": 0}, {"time": 0.5, "translate": [0, 0, -1]}]}})";
constexpr const char* kFromTheSide = R"(, {"plane": {"point": [-1, 0, 0], "normal": [1, 0, 0]},
    "motion": {"keyframes": [{"time": 0}, {"time": 0.5, "translate": [1.1, 0, 0]}]}})";

std::string scene_of(const std::string& youngs_modulus, const std::string& colliders) {
  return R"({"selvage_scene": 1, "sleep_speed": 0, "bodies": [{"mesh": {"shape": "box", "size": [0.5, 0.5, 0.5],
    "cell": 0.05}, "translate": [-0.25, -0.25, 0.1], "material": {"youngs_modulus": )" +
         youngs_modulus + R"(, "poisson_ratio": 0.4, "density": 1000}}], "colliders": [)" + colliders + "]}";
}

/// Seconds of each frame: of several runs, which all do the same, the least.
std::vector<double> seconds_of_frames(const std::string& text) {
  const Scene scene = parse_scene(text, "crush");
  std::vector<double> least(kFrames, HUGE_VAL);
  for (int repetition = 0; repetition < kRepetitions; ++repetition) {
    State state = scene.initial_state;
    XpbdSolver solver(scene.model, state, scene.handles, scene.colliders, scene.options);
    for (double& seconds : least) {
      const auto begin = std::chrono::steady_clock::now();
      for (int step = 0; step < scene.substeps; ++step) solver.step(state);
      seconds = std::min(seconds, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    }
  }
  return least;
}

void crush(benchmark::State& state, const std::string& youngs_modulus, const std::string& colliders) {
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
  std::vector<double> rest = seconds_of_frames(scene_of(youngs_modulus, kWide));
  std::nth_element(rest.begin(), rest.begin() + kFrames / 2, rest.end());
  for (auto _ : state) {
    const std::vector<double> crushed = seconds_of_frames(scene_of(youngs_modulus, colliders));
    const double dearest = *std::max_element(crushed.begin(), crushed.end());
    state.SetIterationTime(dearest);
    state.counters["frames at rest"] = dearest / rest[kFrames / 2];
  }
}

BENCHMARK_CAPTURE(crush, a_plane, kSoft, std::string(kWide) + kFromAbove)
    ->Name("simulation/crush/plane")
    ->Iterations(1)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(crush, two_planes, kSoft, std::string(kWide) + kFromAbove + kFromTheSide)
    ->Name("simulation/crush/two planes")
    ->Iterations(1)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(crush, narrow, kSoft, std::string(kNarrow) + kFromAbove)
    ->Name("simulation/crush/own width")
    ->Iterations(1)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(crush, stiff, kStiff, std::string(kNarrow) + kToTheFloor)
    ->Name("simulation/crush/own width, stiff")
    ->Iterations(1)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace selvage
