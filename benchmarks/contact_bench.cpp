#include <benchmark/benchmark.h>

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/exact/continuous_exact.h"
#include "random_points.h"
#include "selvage/geometry/continuous.h"
#include "selvage/geometry/triangle_triangle.h"

// Time of one call on inputs that stay in the cache. Triangles: `apart` lies on one side of the other's plane, `beside`
// needs the second stage, `crossing` is a yes, `flat` lies in one plane. Moving sets: `apart` is parted by an axis,
// `above` by the volume that is never zero, `beside` and `through` are decided by halving time, `touching` and what
// rests on something need the exact stage: there the sets are on a lattice, a vertex over a vertex or the middle or end
// of an edge of the face, an edge along an edge. They coincide, or do up to rounding, and then move together, or
// one by one as well, by 2^-12 of their size.
namespace {

using selvage::MovingPoints;
using selvage::Vec3;

struct TrianglePair {
  std::array<Vec3, 3> a, b;
};

const std::array<Vec3, 3> kFloor{Vec3{-1, -1, 0}, Vec3{1, -1, 0}, Vec3{0, 1, 0}};

std::vector<TrianglePair> triangle_pairs(const std::array<Vec3, 3>& second, double noise) {
  RandomPoints source;
  std::vector<TrianglePair> pairs(kCount);
  for (TrianglePair& pair : pairs) {
    pair = {kFloor, second};
    for (Vec3& p : pair.a) p += source.point(noise);
    for (Vec3& p : pair.b) p += source.point(noise);
  }
  return pairs;
}

void run_triangles_meet(benchmark::State& state, const std::vector<TrianglePair>& pairs) {
  std::int64_t met = 0;
  for (auto _ : state)
    for (const TrianglePair& pair : pairs) met += selvage::triangles_meet(pair.a, pair.b);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kCount));
  state.counters["met"] = static_cast<double>(met) / static_cast<double>(state.iterations() * kCount);
}

void run_meet_beyond_vertex(benchmark::State& state, std::vector<TrianglePair> pairs) {
  for (TrianglePair& pair : pairs) pair.b[0] = pair.a[0];
  std::int64_t met = 0;
  for (auto _ : state)
    for (const TrianglePair& pair : pairs) met += selvage::meet_beyond_vertex(pair.a, pair.b);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kCount));
  state.counters["met"] = static_cast<double>(met) / static_cast<double>(state.iterations() * kCount);
}

void run_intersection_segment(benchmark::State& state, const std::vector<TrianglePair>& pairs) {
  for (auto _ : state)
    for (const TrianglePair& pair : pairs) benchmark::DoNotOptimize(selvage::intersection_segment(pair.a, pair.b));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kCount));
}

/// The first points around one place, the others around 0, with a common motion and noise in all.
std::vector<MovingPoints> moving_points(const std::array<Vec3, 4>& shape, int first_count, const Vec3& start,
                                        const Vec3& end, double noise) {
  RandomPoints source;
  std::vector<MovingPoints> all(kCount);
  for (MovingPoints& points : all) {
    const Vec3 common = source.point();
    for (int i = 0; i < 4; ++i) {
      points.t0[i] = shape[i] + (i < first_count ? start : Vec3{0, 0, 0}) + source.point(noise);
      points.t1[i] = shape[i] + (i < first_count ? end : Vec3{0, 0, 0}) + source.point(noise) + common;
    }
  }
  return all;
}

const std::array<Vec3, 4> kVertexFace{Vec3{0, 0, 0}, kFloor[0], kFloor[1], kFloor[2]};
const std::array<Vec3, 4> kEdgeEdge{Vec3{-1, 0, 0}, Vec3{1, 0, 0}, Vec3{0, -1, 0}, Vec3{0, 1, 0}};

void run_vertex_face(benchmark::State& state, const Vec3& start, const Vec3& end, double noise) {
  const std::vector<MovingPoints> all = moving_points(kVertexFace, 1, start, end, noise);
  std::int64_t met = 0;
  for (auto _ : state)
    for (const MovingPoints& points : all) met += selvage::vertex_meets_face(points);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kCount));
  state.counters["met"] = static_cast<double>(met) / static_cast<double>(state.iterations() * kCount);
}

void run_edge_edge(benchmark::State& state, const Vec3& start, const Vec3& end, double noise) {
  const std::vector<MovingPoints> all = moving_points(kEdgeEdge, 2, start, end, noise);
  std::int64_t met = 0;
  for (auto _ : state)
    for (const MovingPoints& points : all) met += selvage::edge_meets_edge(points);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kCount));
  state.counters["met"] = static_cast<double>(met) / static_cast<double>(state.iterations() * kCount);
}

void run_vertex_face_exactly(benchmark::State& state, const Vec3& start, const Vec3& end, double noise) {
  const std::vector<MovingPoints> all = moving_points(kVertexFace, 1, start, end, noise);
  for (auto _ : state)
    for (const MovingPoints& points : all)
      benchmark::DoNotOptimize(selvage::meets_exactly(selvage::ContinuousPair::kVertexFace, points));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kCount));
}

void run_vertex_face_impact(benchmark::State& state, const Vec3& start, const Vec3& end, double noise) {
  const std::vector<MovingPoints> all = moving_points(kVertexFace, 1, start, end, noise);
  for (auto _ : state)
    for (const MovingPoints& points : all) benchmark::DoNotOptimize(selvage::vertex_face_impact(points));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kCount));
}

enum class Resting { kExactly, kNearly, kNearlyAndLoose };

/// Points of a lattice in the plane z = 0.3.
std::vector<MovingPoints> resting_points(const std::array<Vec3, 4>& shape, int first_count, Resting kind) {
  RandomPoints source;
  constexpr double kCell = 0.05, kReach = 0x1p-12 * kCell;
  std::vector<MovingPoints> all(kCount);
  for (std::size_t n = 0; n < all.size(); ++n) {
    const Vec3 velocity = source.point(kReach);
    const auto shift = static_cast<double>(n % 3);
    for (int i = 0; i < 4; ++i) {
      Vec3 p = (shape[i] + (i < first_count ? Vec3{shift, 0, 0} : Vec3{0, 0, 0})) * kCell + Vec3{0, 0, 0.3};
      if (kind != Resting::kExactly) p += source.point(0x1p-54);
      all[n].t0[i] = p;
      all[n].t1[i] = p + (i < first_count ? velocity : Vec3{0, 0, 0});
      if (kind == Resting::kNearlyAndLoose) all[n].t1[i] += source.point(0.1 * kReach);
    }
  }
  return all;
}

const std::array<Vec3, 4> kVertexOnFace{Vec3{0, 0, 0}, Vec3{0, 0, 0}, Vec3{2, 0, 0}, Vec3{0, 2, 0}};
const std::array<Vec3, 4> kEdgeOnEdge{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{1, 0, 0}, Vec3{2, 0, 0}};

void run_vertex_rests(benchmark::State& state, Resting kind) {
  const std::vector<MovingPoints> all = resting_points(kVertexOnFace, 1, kind);
  std::int64_t met = 0;
  for (auto _ : state)
    for (const MovingPoints& points : all) met += selvage::vertex_meets_face(points);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kCount));
  state.counters["met"] = static_cast<double>(met) / static_cast<double>(state.iterations() * kCount);
}

void run_edge_rests(benchmark::State& state, Resting kind) {
  const std::vector<MovingPoints> all = resting_points(kEdgeOnEdge, 2, kind);
  std::int64_t met = 0;
  for (auto _ : state)
    for (const MovingPoints& points : all) met += selvage::edge_meets_edge(points);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kCount));
  state.counters["met"] = static_cast<double>(met) / static_cast<double>(state.iterations() * kCount);
}

const std::array<Vec3, 3> kUpright{Vec3{0, 0, -1}, Vec3{0, 0, 1}, Vec3{1, 0, 0}};
const std::array<Vec3, 3> kAbove{Vec3{0, 0, 0.2}, Vec3{1, 0, 0.2}, Vec3{0, 1, 1}};
const std::array<Vec3, 3> kBeside{Vec3{1, 1, -1}, Vec3{1, 1, 1}, Vec3{2, 1, 0}};
BENCHMARK_CAPTURE(run_triangles_meet, apart, triangle_pairs(kAbove, 0.05));
BENCHMARK_CAPTURE(run_triangles_meet, beside, triangle_pairs(kBeside, 0.05));
BENCHMARK_CAPTURE(run_triangles_meet, crossing, triangle_pairs(kUpright, 0.05));
BENCHMARK_CAPTURE(run_triangles_meet, flat, triangle_pairs(kFloor, 0));
BENCHMARK_CAPTURE(run_triangles_meet, random, triangle_pairs(kFloor, 1));
BENCHMARK_CAPTURE(run_meet_beyond_vertex, random, triangle_pairs(kFloor, 1));
BENCHMARK_CAPTURE(run_intersection_segment, crossing, triangle_pairs(kUpright, 0.05));

BENCHMARK_CAPTURE(run_vertex_face, apart, Vec3{0, 0, 2}, Vec3{0, 0, 1}, 0.05);
BENCHMARK_CAPTURE(run_vertex_face, above, Vec3{0, 0, 0.2}, Vec3{0, 0, 0.2}, 0.08);
BENCHMARK_CAPTURE(run_vertex_face, beside, Vec3{0.7, 0.6, 0.5}, Vec3{0.7, 0.6, -0.5}, 0.05);
BENCHMARK_CAPTURE(run_vertex_face, through, Vec3{0, 0, 1}, Vec3{0, 0, -1}, 0.05);
BENCHMARK_CAPTURE(run_vertex_face, random, Vec3{0, 0, 0.5}, Vec3{0, 0, -0.5}, 1);
BENCHMARK_CAPTURE(run_vertex_face, touching, Vec3{0.5, 0, 1}, Vec3{0.5, 0, -1}, 0);
BENCHMARK_CAPTURE(run_vertex_face_exactly, through, Vec3{0, 0, 1}, Vec3{0, 0, -1}, 0.05);
BENCHMARK_CAPTURE(run_vertex_face_impact, through, Vec3{0, 0, 1}, Vec3{0, 0, -1}, 0.05);
BENCHMARK_CAPTURE(run_edge_edge, apart, Vec3{0, 0, 2}, Vec3{0, 0, 1}, 0.05);
BENCHMARK_CAPTURE(run_edge_edge, above, Vec3{0, 0, 0.2}, Vec3{0, 0, 0.2}, 0.08);
BENCHMARK_CAPTURE(run_edge_edge, beside, Vec3{0.8, 1.2, 0.5}, Vec3{0.8, 1.2, -0.5}, 0.05);
BENCHMARK_CAPTURE(run_edge_edge, through, Vec3{0, 0, 1}, Vec3{0, 0, -1}, 0.05);
BENCHMARK_CAPTURE(run_edge_edge, random, Vec3{0, 0, 0.5}, Vec3{0, 0, -0.5}, 1);
BENCHMARK_CAPTURE(run_vertex_rests, exactly, Resting::kExactly);
BENCHMARK_CAPTURE(run_vertex_rests, nearly, Resting::kNearly);
BENCHMARK_CAPTURE(run_vertex_rests, nearly_and_loose, Resting::kNearlyAndLoose);
BENCHMARK_CAPTURE(run_edge_rests, exactly, Resting::kExactly);
BENCHMARK_CAPTURE(run_edge_rests, nearly, Resting::kNearly);
BENCHMARK_CAPTURE(run_edge_rests, nearly_and_loose, Resting::kNearlyAndLoose);

}  // namespace
