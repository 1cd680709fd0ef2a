#include "bvh/bvh.h"
#include "core/isa.h"
#include "kernels/bvh_queries.h"

#include <benchmark/benchmark.h>

#include <cmath>
#include <map>
#include <random>

namespace selvage {
namespace {

/// The triangles of a bumpy ball, in scattered order as meshes have them.
struct Ball {
  std::vector<Box> boxes;
  std::vector<Vec3> centres;
};

Vec3 ball_point(double u, double v) {
  const double latitude = M_PI * v, longitude = 2 * M_PI * u;
  const double radius = 1 + 0.1 * std::sin(9 * longitude) * std::sin(7 * latitude);
  return radius *
         Vec3(std::sin(latitude) * std::cos(longitude), std::sin(latitude) * std::sin(longitude), std::cos(latitude));
}

Ball make_ball(Index count) {
  const int rows = static_cast<int>(std::sqrt(count / 4.0)), columns = 2 * rows;
  Ball ball;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      for (int half = 0; half < 2; ++half) {
        const auto corner = [&](int c, int r) {
          return ball_point((column + c) / double(columns), (row + r) / double(rows));
        };
        const Vec3 points[3] = {corner(half, half), corner(1 - half, half), corner(half, 1 - half)};
        ball.boxes.push_back(bounding_box<3>(std::span<const Vec3>(points)));
        ball.centres.push_back((points[0] + points[1] + points[2]) / 3);
      }
  std::mt19937 engine(1);
  for (std::size_t i = ball.boxes.size() - 1; i > 0; --i) {
    const std::size_t other = i - engine() % std::min<std::size_t>(i + 1, 1000);
    std::swap(ball.boxes[i], ball.boxes[other]);
    std::swap(ball.centres[i], ball.centres[other]);
  }
  return ball;
}

const Ball& shared_ball(std::int64_t count) {
  static std::map<std::int64_t, Ball> balls;
  auto found = balls.find(count);
  if (found == balls.end()) found = balls.emplace(count, make_ball(static_cast<Index>(count))).first;
  return found->second;
}

/// Points inside the ball, at `depth` of its radius below the surface, near one another in turn.
std::vector<Vec3> inner_points(double depth) {
  std::vector<Vec3> points(4000);
  for (int i = 0; i < 4000; ++i) {
    const int row = i / 63, column = i % 63;
    points[i] = (1 - depth) * ball_point(0.3 + 0.2 * column / 63.0, 0.2 + 0.6 * row / 64.0);
  }
  return points;
}

void build(benchmark::State& state) {
  const Ball& ball = shared_ball(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(Bvh(ball.boxes).nodes().data());
  const Bvh bvh(ball.boxes);
  state.counters["fill"] = static_cast<double>(ball.boxes.size()) / static_cast<double>(bvh.nodes().size());
  state.counters["levels"] = static_cast<double>(bvh.levels().size() - 1);
}

void refit(benchmark::State& state) {
  const Ball& ball = shared_ball(state.range(0));
  Bvh bvh(ball.boxes);
  for (auto _ : state) bvh.refit(ball.boxes);
}

void nearest(benchmark::State& state) {
  const Ball& ball = shared_ball(state.range(0));
  const Bvh bvh(ball.boxes);
  const std::vector<Vec3> queries = inner_points(static_cast<double>(state.range(1)) * 0.01);
  QuerySums sums;
  for (auto _ : state) {
    sums = SELVAGE_DISPATCH(find_nearest_points, bvh, ball.centres, queries);
    benchmark::DoNotOptimize(sums);
  }
  const auto count = static_cast<double>(queries.size());
  state.counters["nodes"] = static_cast<double>(sums.nodes) / count;
  state.counters["primitives"] = static_cast<double>(sums.primitives) / count;
  state.counters["per_query"] =
      benchmark::Counter(count, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void overlaps(benchmark::State& state) {
  const Ball& ball = shared_ball(state.range(0));
  const Bvh bvh(ball.boxes);
  const std::span<const Box> queries = std::span(ball.boxes).first(4000);
  QuerySums sums;
  for (auto _ : state) {
    sums = SELVAGE_DISPATCH(find_overlaps, bvh, queries);
    benchmark::DoNotOptimize(sums);
  }
  const auto count = static_cast<double>(queries.size());
  state.counters["nodes"] = static_cast<double>(sums.nodes) / count;
  state.counters["primitives"] = static_cast<double>(sums.primitives) / count;
  state.counters["per_query"] =
      benchmark::Counter(count, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

BENCHMARK(build)->Name("bvh/build")->Arg(10000)->Arg(65000)->Arg(1000000)->Unit(benchmark::kMillisecond);
BENCHMARK(refit)->Name("bvh/refit")->Arg(10000)->Arg(65000)->Arg(1000000)->Unit(benchmark::kMillisecond);
BENCHMARK(nearest)
    ->Name("bvh/nearest")
    ->ArgsProduct({{10000, 100000, 1000000}, {1, 10, 50}})
    ->ArgNames({"primitives", "depth_percent"})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(overlaps)->Name("bvh/overlaps")->Arg(10000)->Arg(1000000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace selvage
