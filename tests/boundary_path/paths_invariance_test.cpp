// Nothing but the question changes an answer: not threads, switches, warm starts, refits, nor where the mesh lies.
#include "boundary_path/compare.h"
#include "test_scale.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

namespace selvage {
namespace {

template <int D>
struct Case {
  explicit Case(std::size_t number)
      : subject(families::all_families<D>()[number]),
        finder(subject.mesh, subject.judge.positions()),
        queries(families::to_library<D>(subject.maker.make_many(test::scaled(150), test::seed(9000 + number)))),
        answers(finder.find_paths(queries)) {}

  families::Subject<D> subject;
  BoundaryPathFinder<D> finder;
  std::vector<PathQuery<D>> queries;
  std::vector<BoundaryPath<D>> answers;
};

template <int D>
void expect_identical(const Case<D>& c, const std::vector<BoundaryPath<D>>& paths, const std::string& what) {
  ASSERT_EQ(paths.size(), c.answers.size());
  for (std::size_t i = 0; i < paths.size(); ++i) {
    ASSERT_TRUE(families::is_identical<D>(paths[i], c.answers[i]))
        << what << ", query " << i << ": distance " << paths[i].distance << " to face " << paths[i].face << ", was "
        << c.answers[i].distance << " to face " << c.answers[i].face << "; status " << int(paths[i].status) << ", was "
        << int(c.answers[i].status);
  }
}

template <int D>
void check_threads(const Case<D>& c) {
  std::vector<PathCounters> first;
  for (const std::size_t threads : {1, 2, 4}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    const BoundaryPathFinder<D> finder(c.subject.mesh, c.subject.judge.positions());
    std::vector<PathCounters> counters(c.queries.size());
    expect_identical(c, finder.find_paths(c.queries, {}, counters), std::to_string(threads) + " threads");
    if (first.empty()) first = counters;
    for (std::size_t i = 0; i < counters.size(); ++i) {
      ASSERT_EQ(counters[i].volumes_visited, first[i].volumes_visited) << threads << ' ' << i;
      ASSERT_EQ(counters[i].faces_visited, first[i].faces_visited) << threads << ' ' << i;
      ASSERT_EQ(counters[i].elements_visited, first[i].elements_visited) << threads << ' ' << i;
    }
  }
}

// Searches descend in company, and start from each other's answers.
template <int D>
void check_company(const Case<D>& c) {
  const std::size_t n = c.queries.size();
  std::vector<BoundaryPath<D>> alone;
  for (const PathQuery<D>& query : c.queries) alone.push_back(c.finder.find_paths(std::span(&query, 1)).front());
  expect_identical(c, alone, "alone");
  for (const std::size_t step : {7, 50}) {
    std::vector<PathQuery<D>> some;
    for (std::size_t i = 0; i < n; i += step) some.push_back(c.queries[n - 1 - i]);
    const auto paths = c.finder.find_paths(some);
    for (std::size_t i = 0; i < paths.size(); ++i)
      ASSERT_TRUE(families::is_identical<D>(paths[i], c.answers[n - 1 - i * step])) << step << ' ' << i;
  }
}

template <int D>
void check_switches(const Case<D>& c) {
  for (const bool cull : {false, true}) {
    for (const bool hints : {false, true}) {
      const BoundaryPathFinder<D> finder(c.subject.mesh, c.subject.judge.positions(), {cull, hints});
      std::vector<PathCounters> counters(c.queries.size());
      expect_identical(c, finder.find_paths(c.queries, {}, counters),
                       std::string(cull ? "culling" : "no culling") + (hints ? ", hints" : ", no hints"));
      for (std::size_t i = 0; i < counters.size(); ++i) {
        if (!cull) {
          ASSERT_EQ(counters[i].culled, 0);
        }
        ASSERT_GE(counters[i].faces_visited, counters[i].traversals + counters[i].culled) << i;
        if (c.answers[i].status == PathStatus::kFound) {
          ASSERT_GE(counters[i].faces_visited, 1) << i;
        }
      }
    }
  }
}

template <int D>
void check_warm_starts(const Case<D>& c) {
  test::Random random(3);
  std::vector<Index> right, wrong, any;
  for (const auto& answer : c.answers) {
    right.push_back(answer.status == PathStatus::kFound ? answer.face : kNone);
    any.push_back(random.below(c.subject.judge.faces().size() + 1) - 1);
  }
  wrong.assign(right.rbegin(), right.rend());
  expect_identical(c, c.finder.find_paths(c.queries, right), "the right warm start");
  expect_identical(c, c.finder.find_paths(c.queries, wrong), "another query's answer as warm start");
  expect_identical(c, c.finder.find_paths(c.queries, any), "any warm start");
}

template <int D>
void check_refits(const Case<D>& c) {
  const auto& positions = c.subject.judge.positions();
  auto elsewhere = positions;
  for (auto& x : elsewhere) x = (x * 0.25).reverse().eval();
  std::reverse(elsewhere.begin(), elsewhere.end());
  BoundaryPathFinder<D> finder(c.subject.mesh, elsewhere);
  finder.update(positions);
  expect_identical(c, finder.find_paths(c.queries), "refit");
  finder.update(elsewhere);
  finder.rebuild(positions);
  expect_identical(c, finder.find_paths(c.queries), "rebuilt");
  PointLocator<D> locator(c.subject.mesh, positions);
  BoundaryPathFinder<D> beside(locator);
  expect_identical(c, beside.find_paths(c.queries), "beside a locator");
  locator.update(elsewhere);
  locator.update(positions);
  beside.update();
  expect_identical(c, beside.find_paths(c.queries), "after two poses of the locator");
  locator.rebuild(elsewhere);
  locator.update(positions);
  beside.update();
  expect_identical(c, beside.find_paths(c.queries), "after a locator that was rebuilt");
}

// Answers of the mesh moved by an exact map of space; distances multiplied by `factor`, to `tolerance`.
template <int D, typename Map>
void check_map(const Case<D>& c, std::vector<PathQuery<D>> queries, const Map& map, double factor, double tolerance,
               const std::string& what) {
  const auto answers = c.finder.find_paths(queries);
  auto positions = c.subject.judge.positions();
  for (auto& x : positions) x = map(x);
  for (auto& q : queries) q.point = map(q.point);
  const BoundaryPathFinder<D> finder(c.subject.mesh, positions);
  const auto paths = finder.find_paths(queries);
  for (std::size_t i = 0; i < paths.size(); ++i) {
    ASSERT_EQ(paths[i].status, answers[i].status) << what << ", query " << i;
    if (paths[i].status != PathStatus::kFound) continue;
    const double right = answers[i].distance * factor;
    ASSERT_LE(std::abs(paths[i].distance - right), tolerance * right)
        << what << ", query " << i << ": " << paths[i].distance << ", not " << right << " to face " << paths[i].face
        << ", was " << answers[i].face;
  }
}

template <int D>
void check_maps(const Case<D>& c) {
  const bool is_scaled = c.subject.family.name.find("scaled_") == 0;
  // Small integers: a turn and a move change no bit of what is seen from a point, and a rounded point may be anywhere.
  if (c.subject.family.is_exact && !is_scaled) {
    auto queries = c.queries;
    for (auto& q : queries) q.point = (q.point.array() * 0x1p12).round() * 0x1p-12;
    const auto turn = [](const Vec<D>& x) {
      Vec<D> y = x;
      y[0] = -x[1];
      y[1] = x[0];
      return y;
    };
    check_map<D>(c, queries, turn, 1, 1e-12, "a quarter turn");
    check_map<D>(
        c, queries, [](const Vec<D>& x) { return Vec<D>(x.array() + 4096.0); }, 1, 1e-12, "moved");
  }
  for (const int power : {-300, -7, 9, 300}) {
    if (is_scaled && std::abs(power) > 9) continue;
    const double factor = std::ldexp(1.0, power);
    const auto scale = [=](const Vec<D>& x) { return Vec<D>(x * factor); };
    check_map<D>(c, c.queries, scale, factor, 0, "scaled by 2^" + std::to_string(power));
  }
}

class PlanarInvariance : public testing::TestWithParam<std::size_t> {};
class SolidInvariance : public testing::TestWithParam<std::size_t> {};

TEST_P(PlanarInvariance, Threads) {
  check_threads(Case<2>(GetParam()));
}
TEST_P(SolidInvariance, Threads) {
  check_threads(Case<3>(GetParam()));
}
TEST_P(PlanarInvariance, Company) {
  check_company(Case<2>(GetParam()));
}
TEST_P(SolidInvariance, Company) {
  check_company(Case<3>(GetParam()));
}
TEST_P(PlanarInvariance, SwitchesAndCounters) {
  check_switches(Case<2>(GetParam()));
}
TEST_P(SolidInvariance, SwitchesAndCounters) {
  check_switches(Case<3>(GetParam()));
}
TEST_P(PlanarInvariance, WarmStarts) {
  check_warm_starts(Case<2>(GetParam()));
}
TEST_P(SolidInvariance, WarmStarts) {
  check_warm_starts(Case<3>(GetParam()));
}
TEST_P(PlanarInvariance, RefitAndRebuild) {
  check_refits(Case<2>(GetParam()));
}
TEST_P(SolidInvariance, RefitAndRebuild) {
  check_refits(Case<3>(GetParam()));
}
TEST_P(PlanarInvariance, TurnsAndScales) {
  check_maps(Case<2>(GetParam()));
}
TEST_P(SolidInvariance, TurnsAndScales) {
  check_maps(Case<3>(GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Families, PlanarInvariance, testing::Range<std::size_t>(0, families::planar_families().size()),
                         families::family_name<2>);
INSTANTIATE_TEST_SUITE_P(Families, SolidInvariance, testing::Range<std::size_t>(0, families::solid_families().size()),
                         families::family_name<3>);

}  // namespace
}  // namespace selvage
