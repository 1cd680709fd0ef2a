#include <benchmark/benchmark.h>

#include <fstream>
#include <string>

#include "selvage/mesh/simplex_mesh.h"
#include "selvage/shapes/shapes.h"

// Time and memory to build the topology of a box of tetrahedra, with all threads: seconds a mesh, and bytes a tet at
// the worst moment, the tets' own 16 among them.
namespace {

using namespace selvage;

/// A line of /proc/self/status in bytes: VmRSS is the memory in use, VmHWM the most there ever was.
double memory_in_use(const std::string& name) {
  std::ifstream status("/proc/self/status");
  std::string word;
  double kilobytes = 0;
  while (status >> word)
    if (word == name + ":") status >> kilobytes;
  return 1024 * kilobytes;
}

void reset_peak() {
  std::ofstream("/proc/self/clear_refs") << 5;
}

void build_topology(benchmark::State& state) {
  ShapeOptions options;
  options.elements = state.range(0);
  const IndexedMesh box = make_shape("box", options);
  const auto count = static_cast<double>(box.tetrahedra.size());
  double peak = 0, kept = 0;
  for (auto _ : state) {
    state.PauseTiming();
    const double before = memory_in_use("VmRSS");
    auto elements = box.tetrahedra;
    reset_peak();
    state.ResumeTiming();
    const TetMesh mesh(static_cast<Index>(box.positions.size()), std::move(elements));
    state.PauseTiming();
    benchmark::DoNotOptimize(mesh.neighbours().data());
    peak = std::max(peak, memory_in_use("VmHWM") - before);
    kept = std::max(kept, memory_in_use("VmRSS") - before);
    state.ResumeTiming();
  }
  state.counters["tets"] = count;
  state.counters["bytes/tet"] = peak / count;
  state.counters["bytes/tet kept"] = kept / count;
}

BENCHMARK(build_topology)
    ->Arg(1'000'000)
    ->Arg(11'000'000)
    ->Iterations(1)
    ->Repetitions(3)
    ->UseRealTime()
    ->Unit(benchmark::kSecond);

}  // namespace
