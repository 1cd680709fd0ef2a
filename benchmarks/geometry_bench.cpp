#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "random_points.h"
#include "selvage/geometry/closest_point.h"
#include "selvage/geometry/predicates.h"

// Time of one call on inputs that stay in the cache: `random` is decided by the filter, `flat_grid` and `flat_rounded`
// need the exact stage (differences that are exact, and ones that are not), `flat_extreme` the integers.
namespace {

using selvage::Vec3;

struct Query {
  std::array<Vec3, 4> simplex;
  Vec3 point;
};

std::vector<Query> random_queries(double reach) {
  RandomPoints source;
  std::vector<Query> queries(kCount);
  for (Query& query : queries) {
    for (Vec3& vertex : query.simplex) vertex = source.point();
    query.point = 0.25 * (query.simplex[0] + query.simplex[1] + query.simplex[2] + query.simplex[3]);
    query.point += reach * source.point();
  }
  return queries;
}

std::vector<Query> flat_queries(double scale, double grid) {
  RandomPoints source;
  std::vector<Query> queries(kCount);
  for (Query& query : queries) {
    for (Vec3& vertex : query.simplex) {
      vertex = source.point();
      if (grid > 0)
        for (int k = 0; k < 3; ++k) vertex[k] = std::round(vertex[k] * grid);
    }
    const auto& s = query.simplex;
    query.simplex[3] = s[0] + 2 * (s[1] - s[0]) - (s[2] - s[0]);
    for (Vec3& vertex : query.simplex) vertex *= scale;
    query.point = query.simplex[0];
  }
  return queries;
}

void run_orient3d(benchmark::State& state, const std::vector<Query>& queries) {
  for (auto _ : state)
    for (const Query& query : queries) benchmark::DoNotOptimize(selvage::orientation(query.simplex));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(queries.size()));
}

void run_locate(benchmark::State& state, const std::vector<Query>& queries) {
  for (auto _ : state)
    for (const Query& query : queries)
      benchmark::DoNotOptimize(selvage::locate_in_simplex<3>(query.simplex, query.point));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(queries.size()));
}

void run_closest_on_triangle(benchmark::State& state, const std::vector<Query>& queries) {
  for (auto _ : state)
    for (const Query& query : queries) {
      const auto& s = query.simplex;
      benchmark::DoNotOptimize(selvage::closest_point_on_triangle(query.point, s[0], s[1], s[2]));
    }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(queries.size()));
}

void run_closest_on_tetrahedron(benchmark::State& state, const std::vector<Query>& queries) {
  for (auto _ : state)
    for (const Query& query : queries) {
      const auto& s = query.simplex;
      benchmark::DoNotOptimize(selvage::closest_point_on_tetrahedron(query.point, s[0], s[1], s[2], s[3]));
    }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(queries.size()));
}

BENCHMARK_CAPTURE(run_orient3d, random, random_queries(1));
BENCHMARK_CAPTURE(run_orient3d, flat_grid, flat_queries(1, 64));
BENCHMARK_CAPTURE(run_orient3d, flat_rounded, flat_queries(0.1, 64));
BENCHMARK_CAPTURE(run_orient3d, flat_extreme, flat_queries(0x1p-400, 64));
BENCHMARK_CAPTURE(run_locate, inside, random_queries(0));
BENCHMARK_CAPTURE(run_locate, near, random_queries(0.5));
BENCHMARK_CAPTURE(run_locate, flat_at_vertex, flat_queries(0.1, 64));
BENCHMARK_CAPTURE(run_closest_on_triangle, near, random_queries(0.5));
BENCHMARK_CAPTURE(run_closest_on_triangle, far, random_queries(10));
BENCHMARK_CAPTURE(run_closest_on_tetrahedron, inside, random_queries(0));
BENCHMARK_CAPTURE(run_closest_on_tetrahedron, near, random_queries(0.5));

}  // namespace
