#include "core/parallel.h"
#include "material_limit.h"
#include "selvage/shapes/shapes.h"
#include "simulation/xpbd/material_solver.h"

#include <tbb/global_control.h>

#include <benchmark/benchmark.h>

#include <map>

// The material solve alone: constraints a second, and what part of the machine's limit that is. Two limits are
// measured beside it: how fast memory streams, and how fast this processor does the same lanes' arithmetic out of
// registers; the one that would take longer for the work of an iteration binds.
namespace selvage {
namespace {

Model make_block(Index elements, MaterialKind kind) {
  ShapeOptions options;
  options.elements = elements;
  const IndexedMesh box = make_shape("box", options);
  const auto vertices = static_cast<Index>(box.positions.size()), count = static_cast<Index>(box.tetrahedra.size());
  Material material;
  material.kind = kind;
  material.edge_compliance = material.volume_compliance = 1e-9;
  return make_model(TetMesh(vertices, box.tetrahedra), box.positions, {{"box", 0, vertices, 0, count, material}});
}

const Model& shared_block(Index elements, MaterialKind kind) {
  static std::map<std::pair<Index, MaterialKind>, Model> models;
  auto found = models.find({elements, kind});
  if (found == models.end()) found = models.emplace(std::pair(elements, kind), make_block(elements, kind)).first;
  return found->second;
}

void solve(benchmark::State& state, MaterialKind kind) {
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, static_cast<int>(state.range(1)));
  const Model& model = shared_block(static_cast<Index>(state.range(0)), kind);
  MaterialSolver solver(model, 1.0 / 3000);
  std::vector<StepVertex> rows;
  for (Index v = 0; v < model.mesh.vertex_count(); ++v) {
    const Vec3& p = model.rest_positions[v];
    rows.push_back({{1.01 * p[0], p[1] + 0.02 * p[2], p[2]}, model.inverse_masses[v]});
  }
  constexpr int kIterations = 3;
  for (auto _ : state) solver.solve(rows, {}, 0, kIterations);
  const double iterations = kIterations * static_cast<double>(state.iterations());
  const auto rate = [](double count) { return benchmark::Counter(count, benchmark::Counter::kIsRate); };
  state.counters["constraints/s"] = rate(iterations * static_cast<double>(solver.constraint_count()));
  const double elements = model.mesh.element_count();
  state.counters["elements/s"] = rate(iterations * elements);
  if (kind == MaterialKind::kNeoHookean) {
    state.counters["flop/s"] = rate(iterations * elements * bench::kOperationsPerElement);
    const double bytes = bench::material_bytes(elements, static_cast<double>(rows.size()), false);
    state.counters["bytes/s"] = rate(iterations * bytes);
  }
}

/// Time of streaming through memory: read and write of as much as an iteration over a large mesh touches.
void stream(benchmark::State& state) {
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, static_cast<int>(state.range(0)));
  std::vector<double> numbers(std::size_t{1} << 27, 1.0);  // 1 GiB
  for (auto _ : state)
    parallel_ranges(std::ssize(numbers), 1 << 16, [&](std::int64_t first, std::int64_t last) {
      for (std::int64_t i = first; i < last; ++i) numbers[i] *= 1.0000001;
    });
  state.counters["bytes/s"] =
      benchmark::Counter(2 * 8 * static_cast<double>(numbers.size()) * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate);
}

/// Time of multiplying and adding in registers, on each thread.
void multiply_and_add(benchmark::State& state) {
  std::int64_t operations = 0;
  double sink = 0;
  for (auto _ : state) operations += SELVAGE_DISPATCH(run_arithmetic, 1'000'000, sink);
  benchmark::DoNotOptimize(sink);
  state.counters["flop/s"] = benchmark::Counter(static_cast<double>(operations), benchmark::Counter::kIsRate);
}

BENCHMARK_CAPTURE(solve, neo_hookean, MaterialKind::kNeoHookean)
    ->Name("simulation/material/neo-hookean")
    ->ArgsProduct({{20'000, 300'000, 3'000'000}, {1, 2}})
    ->ArgNames({"elements", "threads"})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(solve, mass_spring, MaterialKind::kMassSpring)
    ->Name("simulation/material/mass-spring")
    ->ArgsProduct({{300'000}, {1, 2}})
    ->ArgNames({"elements", "threads"})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(multiply_and_add)->Name("simulation/arithmetic")->ThreadRange(1, 2)->UseRealTime();
BENCHMARK(stream)->Name("simulation/stream")->Arg(1)->Arg(2)->ArgName("threads")->UseRealTime();

}  // namespace
}  // namespace selvage
