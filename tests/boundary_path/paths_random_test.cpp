// The library against the oracle: every family of meshes, queries of every kind.
#include "boundary_path/compare.h"
#include "test_scale.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

// Together at least 200,000 queries a dimension.
constexpr std::int64_t kQueries = 210000;

template <int D>
void compare_with_oracle(std::size_t number) {
  const auto& all = families::all_families<D>();
  const families::Subject<D> subject(all[number]);
  const std::int64_t count = test::scaled(kQueries / static_cast<std::int64_t>(all.size()) + 1);
  const auto queries = subject.maker.make_many(count, test::seed(1000 + number));
  const BoundaryPathFinder<D> finder(subject.mesh, subject.judge.positions());
  const auto found =
      families::expect_right_paths<D>(subject, queries, finder.find_paths(families::to_library<D>(queries)));
  EXPECT_EQ(found > 0, subject.family.name != "mirrored");  // there every element is inverted: no candidates
}

template <int D>
void compare_penetrating_vertices(std::size_t number) {
  const families::Subject<D> subject(families::all_families<D>()[number]);
  const BoundaryPathFinder<D> finder(subject.mesh, subject.judge.positions());
  const auto found = finder.find_penetrating_vertices();
  const auto right = subject.judge.penetrating_vertices();
  ASSERT_EQ(found.size(), right.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    ASSERT_EQ(found[i].source[0], right[i].vertex) << i;
    ASSERT_EQ(found[i].source[1], kNone) << i;
    ASSERT_EQ(found[i].element, right[i].element) << i;
    ASSERT_EQ(found[i].point, subject.judge.positions()[right[i].vertex]) << i;
  }
}

// Elements that hold points, among them vertices and midpoints.
template <int D>
void compare_located_elements(std::size_t number) {
  const families::Subject<D> subject(families::all_families<D>()[number]);
  const BoundaryPathFinder<D> finder(subject.mesh, subject.judge.positions());
  std::vector<Vec<D>> points;
  for (const auto& q : subject.maker.make_many(test::scaled(60), test::seed(5))) points.push_back(q.point);
  const auto located = finder.locate(points);
  ASSERT_EQ(located.first.size(), points.size() + 1);
  ASSERT_EQ(located.first.back(), static_cast<std::int64_t>(located.queries.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::vector<Index> right, found;
    for (Index e = 0; e < subject.mesh.element_count(); ++e) {
      if (subject.judge.holds(e, points[i])) right.push_back(e);
    }
    for (auto k = located.first[i]; k < located.first[i + 1]; ++k) {
      found.push_back(located.queries[k].element);
      EXPECT_EQ(located.queries[k].point, points[i]);
      EXPECT_EQ(located.queries[k].source[0], kNone);
    }
    ASSERT_EQ(found, right) << "point " << i;
  }
}

class PlanarPaths : public testing::TestWithParam<std::size_t> {};
class SolidPaths : public testing::TestWithParam<std::size_t> {};

TEST_P(PlanarPaths, AreThoseOfTheOracle) {
  compare_with_oracle<2>(GetParam());
}
TEST_P(SolidPaths, AreThoseOfTheOracle) {
  compare_with_oracle<3>(GetParam());
}
TEST_P(PlanarPaths, PenetratingVerticesAreThoseOfBruteForce) {
  compare_penetrating_vertices<2>(GetParam());
}
TEST_P(SolidPaths, PenetratingVerticesAreThoseOfBruteForce) {
  compare_penetrating_vertices<3>(GetParam());
}
TEST_P(PlanarPaths, LocatedElementsAreThoseOfBruteForce) {
  compare_located_elements<2>(GetParam());
}
TEST_P(SolidPaths, LocatedElementsAreThoseOfBruteForce) {
  compare_located_elements<3>(GetParam());
}

INSTANTIATE_TEST_SUITE_P(Families, PlanarPaths, testing::Range<std::size_t>(0, families::planar_families().size()),
                         families::family_name<2>);
INSTANTIATE_TEST_SUITE_P(Families, SolidPaths, testing::Range<std::size_t>(0, families::solid_families().size()),
                         families::family_name<3>);

}  // namespace
}  // namespace selvage
