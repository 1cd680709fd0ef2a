#include "selvage/self_collision/self_collision.h"
#include "selvage/shapes/sequences.h"
#include "selvage/shapes/shapes.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <map>

// Discrete self-collision by every culling method, a frame at a time: update() to a pose, then find_pairs().
// selvage_microbench --benchmark_filter=Culling

namespace selvage {
namespace {

struct Surface {
  TriangleMesh mesh;
  std::vector<Vec3> positions;
};

Surface cloth(int cells, void (*bend)(Vec3&)) {
  IndexedMesh file = make_cloth(1, 1, 1.0 / cells);
  for (Vec3& x : file.positions) bend(x);
  return {TriangleMesh(static_cast<Index>(file.positions.size()), file.triangles), file.positions};
}

void wave(Vec3& x) {
  x[2] = 0.05 * std::sin(9 * x[0]) * std::cos(7 * x[1]);
}

/// Folds as fine as a dozen cells, with some thousand pairs.
void crumple(Vec3& x) {
  const double u = x[0], v = x[1];
  x[0] += 0.06 * std::sin(23 * v + 5 * u) + 0.03 * std::sin(47 * u + 31 * v);
  x[1] += 0.06 * std::sin(19 * u + 2) + 0.03 * std::sin(53 * v - 29 * u);
  x[2] = 0.08 * std::sin(17 * u + 11 * v) + 0.05 * std::sin(31 * v - 13 * u);
}

/// A hollow pipe bent so far that one end runs into the other.
Surface pipe() {
  constexpr int kAround = 130, kAlong = 300;
  std::vector<Vec3> positions;
  std::vector<VertexTuple<3>> triangles;
  for (int j = 0; j <= kAlong; ++j)
    for (int i = 0; i < kAround; ++i) {
      const double a = 2 * M_PI * i / kAround, s = j / double(kAlong), t = s * 2 * M_PI * 1.02;
      const Vec3 out(std::cos(t), std::sin(t), 0);
      positions.push_back((1 + 0.12 * std::cos(a)) * out + Vec3(0, 0, 0.05 * s + 0.12 * std::sin(a)));
    }
  for (int j = 0; j < kAlong; ++j)
    for (int i = 0; i < kAround; ++i) {
      const Index a = j * kAround + i, b = j * kAround + (i + 1) % kAround;
      triangles.push_back({a, b, b + kAround});
      triangles.push_back({a, b + kAround, a + kAround});
    }
  return {TriangleMesh(static_cast<Index>(positions.size()), triangles), positions};
}

const Surface& surface_of(int kind) {
  static std::map<int, Surface> made;
  auto found = made.find(kind);
  if (found == made.end())
    found = made.emplace(kind, kind == 0 ? cloth(180, wave) : kind == 1 ? pipe() : cloth(180, crumple)).first;
  return found->second;
}

void culling(benchmark::State& state) {
  constexpr const char* kNames[] = {"waved cloth", "pipe", "crumpled sheet"};
  const Surface& surface = surface_of(static_cast<int>(state.range(0)));
  SelfCollisionOptions options;
  options.method = static_cast<CullingMethod>(state.range(1));
  SelfCollisionFinder finder(surface.mesh, surface.positions, options);
  SelfCollisionCounters counters;
  std::size_t pairs = 0;
  for (auto _ : state) {
    counters = {};
    finder.update(surface.positions);
    pairs = finder.find_pairs(&counters).size();
  }
  state.SetLabel(std::string(kNames[state.range(0)]) + ", " +
                 std::string(culling_method_names()[static_cast<std::size_t>(state.range(1))]));
  state.counters["pairs"] = static_cast<double>(pairs);
  state.counters["culled"] =
      static_cast<double>(counters.culled_triangles) / static_cast<double>(surface.mesh.triangle_count());
  state.counters["box_pairs"] = static_cast<double>(counters.box_pairs);
}
BENCHMARK(culling)->Name("Culling")->ArgsProduct({{0, 1, 2}, {0, 1, 2, 3, 4, 5, 6}})->Unit(benchmark::kMillisecond);

/// A surface is checked once: topology, hierarchy and search. benchmarks/python/overhead.py asks the same from Python.
void check_once(benchmark::State& state) {
  const SurfaceSequence pipe("pipe", state.range(0));
  const std::vector<Vec3> positions = pipe.positions(pipe.frame_count() - 1);
  SelfCollisionOptions options;
  options.asked_once = true;
  for (auto _ : state) {
    const TriangleMesh mesh(pipe.vertex_count(), pipe.triangles());
    SelfCollisionFinder finder(mesh, positions, options);
    benchmark::DoNotOptimize(finder.find_pairs());
  }
}
BENCHMARK(check_once)
    ->Name("self_collision/check_once")
    ->Arg(1000000)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(1)
    ->Repetitions(9)
    ->ReportAggregatesOnly()
    ->ComputeStatistics("min", [](const std::vector<double>& times) { return *std::ranges::min_element(times); });

}  // namespace
}  // namespace selvage
