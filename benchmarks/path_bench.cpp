#include <benchmark/benchmark.h>

#include "selvage/boundary_path/boundary_path.h"
#include "selvage/shapes/shapes.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>

// Paths near many inverted elements, on one thread: from every 61st centroid, or from the penetrating vertices.
namespace {

using selvage::Index;
using selvage::IndexedMesh;
using selvage::Vec3;

IndexedMesh ball() {
  return selvage::make_shape("ball", {.elements = 62000});
}

/// The vertices nearer to the middle than half of the radius are mirrored at it, so that the elements around them are
/// drawn right through the core.
IndexedMesh turned_core() {
  IndexedMesh mesh = ball();
  double radius = 0;
  for (const Vec3& x : mesh.positions) radius = std::max(radius, x.norm());
  for (Vec3& x : mesh.positions)
    if (x.norm() < 0.5 * radius) x = -x;
  return mesh;
}

/// A box in folds of the given width along x: each goes forward, back, and forward again.
IndexedMesh folded(double width, double cell) {
  IndexedMesh mesh = selvage::make_box(Vec3(2, 1, 1), cell);
  for (Vec3& x : mesh.positions) {
    const double all = x[0] / width, fold = std::floor(all / 3), part = all - 3 * fold;
    const double place = part < 1.2 ? part : part < 1.8 ? 1.2 - 1.2 * (part - 1.2) : 0.48 + 0.9 * (part - 1.8);
    x[0] = (1.5 * fold + place) * width + 0.01 * std::sin(7 * x[1] + 5 * x[2]);
    x[1] += 0.013 * std::sin(9 * x[2] + 4 * x[0]);
    x[2] += 0.02 * std::sin(11 * x[0]);
  }
  return mesh;
}

/// One half of a ball is pushed through the other.
IndexedMesh pushed_half() {
  IndexedMesh mesh = ball();
  for (Vec3& x : mesh.positions)
    if (x[0] > 0) x = Vec3(x[0] - 2.28 * x[0] * std::exp(-2 * x[0] * x[0]), 0.97 * x[1] + 0.003, x[2] + 0.011);
  return mesh;
}

void inverted_paths(benchmark::State& state, const IndexedMesh& file, bool from_centroids) {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const selvage::TetMesh mesh(static_cast<Index>(file.positions.size()), file.tetrahedra);
  const selvage::BoundaryPathFinder<3> finder(mesh, file.positions);
  std::vector<selvage::PathQuery<3>> queries;
  for (Index e = 0; from_centroids && e < mesh.element_count(); e += 61) {
    Vec3 middle = Vec3::Zero();
    for (const Index v : mesh.elements()[e]) middle += 0.25 * file.positions[v];
    queries.push_back({middle, e});
  }
  if (!from_centroids) queries = finder.find_penetrating_vertices();
  std::vector<selvage::PathCounters> counters(queries.size());
  benchmark::DoNotOptimize(finder.find_paths(queries, {}, counters));
  for (auto _ : state) benchmark::DoNotOptimize(finder.find_paths(queries));
  selvage::PathCounters all;
  for (const selvage::PathCounters& one : counters) all += one;
  const double count = static_cast<double>(queries.size());
  state.counters["inverted"] = static_cast<double>(finder.defects().inverted_elements);
  state.counters["segments"] = static_cast<double>(all.traversals) / count;
  state.counters["elements"] = static_cast<double>(all.elements_visited) / count;
  state.counters["time_a_query"] =
      benchmark::Counter(count, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

BENCHMARK_CAPTURE(inverted_paths, turned_core, turned_core(), true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(inverted_paths, layers, folded(0.5, 0.06), false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(inverted_paths, finer_layers, folded(0.25, 0.05), false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(inverted_paths, pushed_half, pushed_half(), false)->Unit(benchmark::kMillisecond);

}  // namespace
