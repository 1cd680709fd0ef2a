#include "selvage/scene/scene.h"
#include "selvage/self_collision/continuous_collision.h"

#include <tbb/global_control.h>

#include <benchmark/benchmark.h>

#include <map>

// What a step costs in a loop of a user's own, update() and find_pairs() of a kept finder on one thread: when it may
// reuse what it knows from the steps before, and when each step is searched as if it were alone. The steps are those of
// the bodies of scenes/first/heap.json, with smaller elements: as they fall, as they hit, as they settle, at rest, and
// asleep.
// One time through them is an iteration.
// selvage_microbench --benchmark_filter=Steps --benchmark_enable_random_interleaving=true --benchmark_repetitions=3
//                    --benchmark_min_time=1.2
namespace selvage {
namespace {

constexpr int kSteps = 60;

/// Frames of the scene after which steps are recorded, and what is seen there. In the last nothing moves at all.
struct Stage {
  const char* name;
  int frame;
};
constexpr std::array kStages{Stage{"falling", 20}, Stage{"bouncing", 60}, Stage{"settling", 150},
                             Stage{"slow", 300},   Stage{"resting", 400}, Stage{"asleep", 400}};

struct Recording {
  std::vector<Vec3> positions;  ///< of the scene at the start
  TriangleMesh surface;
  std::array<std::vector<std::vector<Vec3>>, kStages.size()> steps;  ///< kSteps + 1 poses of each stage
};

Recording record() {
  const Scene scene = read_scene(std::filesystem::path(SELVAGE_SCENES) / "first/heap.json", {},
                                 std::array<std::string, 3>{"/bodies/0/mesh/cell=0.05", "/bodies/1/mesh/elements=6000",
                                                            "/bodies/2/mesh/cell=0.05"});
  Recording made{scene.initial_state.positions, boundary_surface(scene.model.mesh), {}};
  State state = scene.initial_state;
  XpbdSolver solver(scene.model, state, scene.handles, scene.colliders, scene.options);
  for (std::size_t stage = 0; stage < kStages.size(); ++stage) {
    while (state.steps < std::int64_t{kStages[stage].frame} * scene.substeps) solver.step(state);
    auto& poses = made.steps[stage];
    poses.push_back(state.positions);
    for (int step = 0; step < kSteps; ++step) {
      if (stage + 1 < kStages.size()) solver.step(state);
      poses.push_back(state.positions);
    }
  }
  return made;
}

const Recording& recorded() {
  static const Recording kRecording = record();
  return kRecording;
}

void run_steps(benchmark::State& state) {
  const Recording& recording = recorded();
  const auto& poses = recording.steps[static_cast<std::size_t>(state.range(0))];
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
  SelfCollisionOptions options;
  options.reuse = state.range(1) != 0;
  ContinuousCollisionFinder finder(recording.surface, poses[0], poses[1], options);
  std::size_t found = 0;
  ContinuousCounters counters;
  for (auto _ : state)
    for (int step = 0; step < kSteps; ++step) {
      finder.update(poses[step], poses[step + 1]);
      const ContinuousPairs pairs = finder.find_pairs(&counters);
      found += pairs.vertex_face.size() + pairs.edge_edge.size();
    }
  double way = 0;
  for (std::size_t v = 0; v < poses[0].size(); ++v) way += (poses[kSteps][v] - poses[kSteps - 1][v]).norm();
  const double steps = kSteps * static_cast<double>(state.iterations());
  state.SetLabel(kStages[static_cast<std::size_t>(state.range(0))].name);
  state.counters["s/step"] = benchmark::Counter(steps, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["triangles"] = static_cast<double>(recording.surface.triangle_count());
  state.counters["way"] = way / static_cast<double>(poses[0].size());
  state.counters["pairs"] = static_cast<double>(found) / steps;
  state.counters["nodes"] = static_cast<double>(counters.node_pairs) / steps;
}

/// The poses at the ends of the same steps, each by itself: there is nothing that is reused but the hierarchy.
void run_poses(benchmark::State& state) {
  const Recording& recording = recorded();
  const auto& poses = recording.steps[static_cast<std::size_t>(state.range(0))];
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
  SelfCollisionFinder finder(recording.surface, poses[0]);
  for (auto _ : state)
    for (int step = 0; step < kSteps; ++step) {
      finder.update(poses[step + 1]);
      benchmark::DoNotOptimize(finder.find_pairs());
    }
  const double steps = kSteps * static_cast<double>(state.iterations());
  state.SetLabel(kStages[static_cast<std::size_t>(state.range(0))].name);
  state.counters["s/step"] = benchmark::Counter(steps, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

BENCHMARK(run_steps)
    ->Name("Steps")
    ->ArgNames({"stage", "reuse"})
    ->ArgsProduct({{0, 1, 2, 3, 4, 5}, {0, 1}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

BENCHMARK(run_poses)
    ->Name("StepPoses")
    ->ArgName("stage")
    ->DenseRange(0, 5)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace selvage
