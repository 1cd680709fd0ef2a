#include <benchmark/benchmark.h>

#include "contact/penetration_search.h"
#include "core/parallel.h"
#include "selvage/boundary_path/boundary_path.h"
#include "selvage/shapes/poses.h"
#include "selvage/shapes/shapes.h"

// Which boundary vertices (and edges) are inside an element, step after step of a motion: all looked for, or only what
// is near a crossing of the boundary with itself. Two balls with arms that overlap, and a bar that is bent through
// itself; both turn by 100 degrees, fly 1 m and sway by 30 cm a second, at the given number of steps a second.
namespace {

using selvage::Index;
using selvage::IndexedMesh;
using selvage::TetMesh;
using selvage::TriangleMesh;
using selvage::Vec3;

class Scene {
 public:
  explicit Scene(const IndexedMesh& file)
      : mesh(static_cast<Index>(file.positions.size()), file.tetrahedra),
        surface(boundary_surface(mesh)),
        start_(file.positions),
        positions_(file.positions) {}

  std::span<const Vec3> at(double time) {
    const Eigen::AngleAxisd turn(1.75 * time, Vec3(1, 2, 3).normalized());
    const Eigen::Matrix3d turning = turn.toRotationMatrix();
    const Vec3 flight = time * Vec3(0.95, 0, 0.3);
    selvage::parallel_for(std::ssize(start_), 4096, [&](std::int64_t v) {
      const Vec3& x = start_[v];
      const double phase = 3 * x[0] + 2 * x[1] + 30 * time;
      positions_[v] = turning * Vec3(x + 0.01 * std::sin(phase) * Vec3(0.3, -0.5, 1)) + flight;
    });
    return positions_;
  }

  TetMesh mesh;
  TriangleMesh surface;

 private:
  std::vector<Vec3> start_, positions_;
};

IndexedMesh balls() {
  selvage::ShapeOptions options;
  options.elements = 80000;
  options.tentacles = 24;
  const IndexedMesh ball = selvage::make_shape("squishy-ball", options);
  IndexedMesh both = selvage::concatenate(std::array{ball, ball});
  for (std::size_t v = ball.positions.size(); v < both.positions.size(); ++v) both.positions[v] += Vec3(2.6, 0.1, 0.2);
  return both;
}

IndexedMesh bar() {
  selvage::ShapeOptions options;
  options.elements = 67000;
  IndexedMesh file = selvage::make_shape("beam", options);
  selvage::apply_pose(file, "bend");
  return file;
}

void every_element(benchmark::State& state, const IndexedMesh& file, double rate) {
  Scene scene(file);
  selvage::BoundaryPathFinder<3> finder(scene.mesh, scene.at(0));
  double step = 0;
  std::size_t found = 0;
  for (auto _ : state) {
    finder.update(scene.at(++step / rate));
    found = finder.find_penetrating_vertices().size();
  }
  state.counters["found"] = static_cast<double>(found);
}

void near_crossings(benchmark::State& state, const IndexedMesh& file, bool with_edges, double rate) {
  Scene scene(file);
  selvage::PenetrationSearch search(scene.mesh, scene.surface, scene.mesh.boundary_face_count(), with_edges,
                                    scene.at(0));
  selvage::PenetrationCounters counters;
  double step = 0;
  std::size_t found = 0;
  for (auto _ : state) {
    search.place(scene.at(++step / rate));
    found = search.find_all(counters).size();
  }
  const double steps = static_cast<double>(state.iterations());
  state.counters["found"] = static_cast<double>(found);
  state.counters["features"] = static_cast<double>(search.feature_count());
  state.counters["searched"] = static_cast<double>(counters.searched) / steps;
  state.counters["tested"] = static_cast<double>(counters.elements_tested) / steps;
  state.counters["crossings"] = static_cast<double>(counters.crossings) / steps;
}

/// The motion alone, which is in all of the others.
void motion(benchmark::State& state, const IndexedMesh& file) {
  Scene scene(file);
  double step = 0;
  for (auto _ : state) benchmark::DoNotOptimize(scene.at(++step / 300));
}

void new_search(benchmark::State& state, const IndexedMesh& file, bool with_edges) {
  Scene scene(file);
  const auto start = scene.at(0);
  for (auto _ : state)
    selvage::PenetrationSearch(scene.mesh, scene.surface, scene.mesh.boundary_face_count(), with_edges, start);
}

#define SELVAGE_STEPS UseRealTime()->Unit(benchmark::kMillisecond)->Iterations(100)
BENCHMARK_CAPTURE(motion, balls, balls())->SELVAGE_STEPS;
BENCHMARK_CAPTURE(every_element, balls, balls(), 300)->SELVAGE_STEPS;
BENCHMARK_CAPTURE(near_crossings, balls_at_300, balls(), false, 300)->SELVAGE_STEPS;
BENCHMARK_CAPTURE(near_crossings, balls_at_3000, balls(), false, 3000)->SELVAGE_STEPS;
BENCHMARK_CAPTURE(near_crossings, balls_with_edges_at_300, balls(), true, 300)->SELVAGE_STEPS;
BENCHMARK_CAPTURE(near_crossings, balls_with_edges_at_3000, balls(), true, 3000)->SELVAGE_STEPS;
BENCHMARK_CAPTURE(new_search, balls, balls(), false)->UseRealTime()->Unit(benchmark::kMillisecond)->Iterations(3);
BENCHMARK_CAPTURE(every_element, bar, bar(), 300)->SELVAGE_STEPS;
BENCHMARK_CAPTURE(near_crossings, bar_at_300, bar(), false, 300)->SELVAGE_STEPS;
BENCHMARK_CAPTURE(near_crossings, bar_at_3000, bar(), false, 3000)->SELVAGE_STEPS;
BENCHMARK_CAPTURE(near_crossings, bar_with_edges_at_300, bar(), true, 300)->SELVAGE_STEPS;
BENCHMARK_CAPTURE(near_crossings, bar_with_edges_at_3000, bar(), true, 3000)->SELVAGE_STEPS;

}  // namespace
