// Elements that hold points, against all pairs: groups of every size, points on every feature, every instruction set.
#include "boundary_path/location/containment.h"

#include "boundary_path/compare.h"
#include "boundary_path/location/group_order.h"
#include "core/isa.h"
#include "selvage/geometry/predicates.h"
#include "test_scale.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace selvage {
namespace {

// Vertices, middles of edges, faces and elements, and the same a little and very far off.
template <int D>
std::vector<Vec<D>> make_points(const families::Subject<D>& subject, std::size_t count, test::Random& random) {
  const auto& x = subject.judge.positions();
  std::vector<Vec<D>> points;
  while (points.size() < count) {
    const auto& element = subject.mesh.elements()[random.below(subject.mesh.element_count())];
    const Index corners = 1 + random.below(D + 1);
    Vec<D> p = Vec<D>::Zero();
    for (Index k = 0; k < corners; ++k) p += x[element[k]] / corners;
    const Index axis = random.below(D);
    switch (random.below(8)) {
      case 0:
        p[axis] = p[axis] != 0 ? std::nextafter(p[axis], HUGE_VAL) : 0x1p-60;
        break;
      case 1:
        p[axis] = p[axis] != 0 ? std::nextafter(p[axis], -HUGE_VAL) : -0x1p-60;
        break;
      case 2:
        p[axis] += 1e-7 * (x[element[1]][axis] - x[element[0]][axis]);
        break;
      case 3:
        p[axis] = random.below(2) == 0 ? 1e300 : -1e300;
        break;
      default:
        break;
    }
    points.push_back(p);
  }
  return points;
}

template <int D>
void expect_holders(const families::Subject<D>& subject, const std::vector<Vec<D>>& points,
                    const LocatedPoints<D>& located) {
  ASSERT_EQ(located.first.size(), points.size() + 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::vector<Index> right, found;
    for (Index e = 0; e < subject.mesh.element_count(); ++e)
      if (subject.judge.holds(e, points[i])) right.push_back(e);
    for (auto k = located.first[i]; k < located.first[i + 1]; ++k) found.push_back(located.queries[k].element);
    ASSERT_EQ(found, right) << "point " << i << " of " << points.size() << ": " << points[i].transpose();
  }
}

template <int D>
void locate_groups_of_every_size(std::size_t number) {
  const families::Subject<D> subject(families::all_families<D>()[number]);
  const PointLocator<D> locator(subject.mesh, subject.judge.positions());
  test::Random random(number);
  for (const std::size_t count : {1, 2, 3, 8, 15, 16, 17, 33}) {
    const auto points = make_points(subject, test::scaled(20) < 20 ? count % 17 : count, random);
    expect_holders<D>(subject, points, locator.locate(points));
  }
}

// The other points of a question change no answer.
template <int D>
void locate_alone_and_together(std::size_t number) {
  const families::Subject<D> subject(families::all_families<D>()[number]);
  const PointLocator<D> locator(subject.mesh, subject.judge.positions());
  test::Random random(100 + number);
  const auto points = make_points(subject, test::scaled(1000), random);
  const auto together = locator.locate(points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto alone = locator.locate(std::span(points).subspan(i, 1));
    ASSERT_EQ(static_cast<std::int64_t>(alone.queries.size()), together.first[i + 1] - together.first[i]) << i;
    for (std::size_t k = 0; k < alone.queries.size(); ++k)
      ASSERT_EQ(alone.queries[k].element, together.queries[together.first[i] + k].element) << i;
  }
}

// Groups and own elements are listed when the hierarchy is built: a refit, and a build elsewhere, must do as well.
template <int D>
void find_vertices_after_refit(std::size_t number) {
  const families::Subject<D> subject(families::all_families<D>()[number]);
  auto elsewhere = subject.judge.positions();
  std::reverse(elsewhere.begin(), elsewhere.end());
  PointLocator<D> locator(subject.mesh, elsewhere);
  locator.update(subject.judge.positions());
  const auto found = locator.find_penetrating_vertices();
  const auto right = subject.judge.penetrating_vertices();
  ASSERT_EQ(found.size(), right.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    ASSERT_EQ(found[i].source[0], right[i].vertex) << i;
    ASSERT_EQ(found[i].element, right[i].element) << i;
  }
}

// All of them, every third, and one alone; on the boundary or not.
template <int D>
void locate_some_vertices(std::size_t number) {
  const families::Subject<D> subject(families::all_families<D>()[number]);
  const std::span<const Vec<D>> x = subject.judge.positions();
  const PointLocator<D> locator(subject.mesh, x);
  for (const Index stride : {1, 3, subject.mesh.vertex_count()}) {
    std::vector<Index> asked;
    std::vector<std::pair<Index, Index>> right, found;
    for (Index v = 0; v < subject.mesh.vertex_count(); v += stride) {
      asked.push_back(v);
      for (Index e = 0; e < subject.mesh.element_count(); ++e)
        if (!std::ranges::count(subject.mesh.elements()[e], v) && subject.judge.holds(e, x[v])) right.push_back({v, e});
    }
    std::reverse(asked.begin(), asked.end());
    for (const PathQuery<D>& query : locator.locate_vertices(asked)) {
      found.push_back({query.source[0], query.element});
      EXPECT_EQ(query.point, x[query.source[0]]);
    }
    EXPECT_EQ(found, right) << stride;
  }
}

template <int D, std::size_t N>
std::array<Vec<D>, 2> extent_of(const std::array<Index, N>& vertices, std::span<const Vec<D>> x) {
  std::array<Vec<D>, 2> extent{x[vertices[0]], x[vertices[0]]};
  for (const Index v : vertices) extent = {extent[0].cwiseMin(x[v]), extent[1].cwiseMax(x[v])};
  return extent;
}

// Some may be found that are only near, but none may be missed, nor be found twice.
template <int D, typename Simplices>
void expect_all_that_meet(const NearbyItems& near, const std::vector<std::array<Vec<D>, 2>>& boxes,
                          const Simplices& simplices, std::span<const Vec<D>> x) {
  ASSERT_EQ(near.first.size(), boxes.size() + 1);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    std::vector<Index> found(near.found.begin() + near.first[i], near.found.begin() + near.first[i + 1]);
    std::sort(found.begin(), found.end());
    EXPECT_EQ(std::adjacent_find(found.begin(), found.end()), found.end());
    for (std::size_t k = 0; k < simplices.size(); ++k) {
      const auto [lower, upper] = extent_of<D>(simplices[k], x);
      const bool meets = (lower.array() <= boxes[i][1].array()).all() && (boxes[i][0].array() <= upper.array()).all();
      EXPECT_TRUE(!meets || std::binary_search(found.begin(), found.end(), static_cast<Index>(k))) << i << ' ' << k;
    }
  }
}

template <int D>
void find_what_is_near(std::size_t number) {
  const families::Subject<D> subject(families::all_families<D>()[number]);
  const std::span<const Vec<D>> x = subject.judge.positions();
  PointLocator<D> locator(subject.mesh, x);
  const BoundaryPathFinder<D> finder(locator);
  std::vector<std::array<Vec<D>, 2>> boxes;
  for (const auto& face : subject.mesh.boundary_faces()) boxes.push_back(extent_of<D>(face, x));
  for (Index v = 0; v < subject.mesh.vertex_count(); ++v) boxes.push_back({x[v], x[v]});
  expect_all_that_meet<D>(locator.find_elements_near(boxes), boxes, subject.mesh.elements(), x);
  expect_all_that_meet<D>(finder.find_faces_near(boxes), boxes, subject.mesh.boundary_faces(), x);
}

// Points near a vertex, inside one of its elements, are in none of its others.
template <int D>
void locally_injective_vertices_are_covered_once(std::size_t number) {
  const families::Subject<D> subject(families::all_families<D>()[number]);
  const std::span<const Vec<D>> x = subject.judge.positions();
  const PointLocator<D> locator(subject.mesh, x);
  const auto corners = [&](Index e) {
    std::array<Vec<D>, D + 1> result;
    for (int k = 0; k <= D; ++k) result[k] = x[subject.mesh.elements()[e][k]];
    return result;
  };
  std::vector<Index> defective;
  for (Index e = 0; e < subject.mesh.element_count(); ++e)
    if (orientation(corners(e)) <= 0) defective.push_back(e);
  EXPECT_TRUE(std::ranges::equal(locator.defective_elements(), defective));

  families::Random random(200 + number);
  for (Index v = 0; v < subject.mesh.vertex_count(); ++v) {
    const auto around = subject.mesh.vertex_elements(v);
    if (locator.locally_injective_vertices()[v] == 0 || std::ranges::find_first_of(around, defective) != around.end())
      continue;
    for (const Index e : around) {
      Vec<D> p = Vec<D>::Zero();
      double sum = 0;
      for (const Vec<D>& corner : corners(e)) {
        const double weight = static_cast<double>(1 + random.below(100));
        p += weight * corner;
        sum += weight;
      }
      p = x[v] + (p / sum - x[v]) / 64;
      for (const Index other : around)
        EXPECT_FALSE(other != e && subject.judge.holds(e, p) && subject.judge.holds(other, p)) << v;
    }
  }
}

using Found = std::vector<std::pair<Index, Index>>;

template <int D>
using Kernel = void (*)(const ContainmentInput<D>&, const PointBatch<D>&, std::vector<PointInElement>&);

// All vertices in the order of their numbers, which is none of space, with no element as their own.
template <int D>
void compare_kernels(std::size_t number) {
  const families::Subject<D> subject(families::all_families<D>()[number]);
  const auto& mesh = subject.mesh;
  const PathTopology<D> topology(mesh);
  DeformedMesh<D> pose(mesh, topology);
  pose.rebuild(subject.judge.positions());
  const ContainmentInput<D> input{pose.positions().data(), mesh.elements().data(), pose.rounded_positions().data(),
                                  pose.rounding(), pose.elements().nodes()};
  std::vector<Index> ids(mesh.vertex_count());
  std::iota(ids.begin(), ids.end(), 0);
  const OwnElements no_own{kBeyondAllNodes, {}};
  const std::vector<const OwnElements*> own((ids.size() + kPacketSize - 1) / kPacketSize, &no_own);
  const PointBatch<D> batch{input.positions, input.rounded, ids, own};

  Found right;
  for (Index v : ids)
    for (Index e = 0; e < mesh.element_count(); ++e)
      if (subject.judge.holds(e, subject.judge.positions()[v])) right.emplace_back(v, e);
  const std::pair<Isa, Kernel<D>> kernels[] = {{Isa::baseline, &baseline::find_containing},
                                               {Isa::avx2, &avx2::find_containing},
                                               {Isa::avx512, &avx512::find_containing}};
  for (const auto& [isa, kernel] : kernels) {
    if (isa > active_isa()) continue;
    std::vector<PointInElement> pairs;
    kernel(input, batch, pairs);
    Found found;
    for (const auto& [point, element] : pairs) found.emplace_back(point, element);
    std::sort(found.begin(), found.end());
    ASSERT_EQ(found, right) << isa_name(isa);
  }
}

class PlanarContainment : public testing::TestWithParam<std::size_t> {};
class SolidContainment : public testing::TestWithParam<std::size_t> {};

TEST_P(PlanarContainment, OfGroupsOfEverySize) {
  locate_groups_of_every_size<2>(GetParam());
}
TEST_P(SolidContainment, OfGroupsOfEverySize) {
  locate_groups_of_every_size<3>(GetParam());
}
TEST_P(PlanarContainment, IsTheSameAloneAndTogether) {
  locate_alone_and_together<2>(GetParam());
}
TEST_P(SolidContainment, IsTheSameAloneAndTogether) {
  locate_alone_and_together<3>(GetParam());
}
TEST_P(PlanarContainment, OfVerticesAfterARefit) {
  find_vertices_after_refit<2>(GetParam());
}
TEST_P(SolidContainment, OfVerticesAfterARefit) {
  find_vertices_after_refit<3>(GetParam());
}
TEST_P(PlanarContainment, OfSomeVertices) {
  locate_some_vertices<2>(GetParam());
}
TEST_P(SolidContainment, OfSomeVertices) {
  locate_some_vertices<3>(GetParam());
}
TEST_P(PlanarContainment, OfBoxesMissesNothingThatMeetsThem) {
  find_what_is_near<2>(GetParam());
}
TEST_P(SolidContainment, OfBoxesMissesNothingThatMeetsThem) {
  find_what_is_near<3>(GetParam());
}
TEST_P(PlanarContainment, OfDirectionsIsSingleAtLocallyInjectiveVertices) {
  locally_injective_vertices_are_covered_once<2>(GetParam());
}
TEST_P(SolidContainment, OfDirectionsIsSingleAtLocallyInjectiveVertices) {
  locally_injective_vertices_are_covered_once<3>(GetParam());
}
TEST_P(PlanarContainment, IsThatOfAllPairsForEveryInstructionSet) {
  compare_kernels<2>(GetParam());
}
TEST_P(SolidContainment, IsThatOfAllPairsForEveryInstructionSet) {
  compare_kernels<3>(GetParam());
}

INSTANTIATE_TEST_SUITE_P(Families, PlanarContainment,
                         testing::Range<std::size_t>(0, families::planar_families().size()), families::family_name<2>);
INSTANTIATE_TEST_SUITE_P(Families, SolidContainment, testing::Range<std::size_t>(0, families::solid_families().size()),
                         families::family_name<3>);

TEST(OrderInSpace, KeepsNeighboursInGroups) {
  constexpr Index kCount = 40 * kPacketSize + 7;
  std::vector<RoundedPosition> line(kCount);
  std::vector<Index> numbers(kCount);
  for (Index i = 0; i < kCount; ++i) {
    numbers[i] = i;
    line[i] = {1, static_cast<float>(i * 331 % kCount), 1, 0};  // each place once
  }
  order_in_space(line, numbers);
  for (Index i = 0; i < kCount; ++i)
    EXPECT_EQ(static_cast<Index>(line[numbers[i]][1]) / kPacketSize, i / kPacketSize) << i;
}

TEST(OrderInSpace, TakesPointsAtOnePlace) {
  const std::vector<RoundedPosition> here(1000, RoundedPosition{1, 2, 3, 0});
  std::vector<Index> numbers(here.size()), all(here.size());
  std::iota(all.rbegin(), all.rend(), 0);
  numbers = all;
  order_in_space(here, numbers);
  EXPECT_TRUE(std::is_permutation(numbers.begin(), numbers.end(), all.begin()));
}

TEST(OrderAlongCurve, KeepsTogetherWhatIsNearInBothKinds) {
  constexpr int kSide = 8;
  std::vector<PlacePair> places;
  for (int i = 0; i < 2 * kSide * kSide * kSide; ++i) {
    const int k = i * 331 % (2 * kSide * kSide * kSide);  // each once
    const auto at = [&](int n) { return static_cast<float>(k / n % kSide); };
    const float sheet = k < kSide * kSide * kSide ? 0.0f : 7.0f;  // two that overlap in space
    places.push_back({{{at(1), at(kSide), at(kSide * kSide), 0}, {sheet, 0, 0, 0}}});
  }
  const std::vector<Index> order = order_along_curve(places);
  std::vector<Index> sorted = order;
  std::sort(sorted.begin(), sorted.end());
  for (Index i = 0; i < std::ssize(sorted); ++i) ASSERT_EQ(sorted[i], i);
  for (std::size_t first = 0; first < order.size(); first += 8)
    for (std::size_t i = first + 1; i < first + 8; ++i)
      for (int kind = 0; kind < 2; ++kind)
        for (int axis = 0; axis < 3; ++axis)
          EXPECT_LE(std::abs(places[order[i]][kind][axis] - places[order[first]][kind][axis]), 1.0f) << first;
}

TEST(OrderAlongCurve, TakesPlacesAnywhere) {
  const float infinity = std::numeric_limits<float>::infinity();
  const std::vector<PlacePair> places = {{{{infinity, 0, 0, 0}, {0, 0, 0, 0}}},
                                         {{{0, -infinity, 0, 0}, {0, 0, 0, 0}}},
                                         {{{1, 2, 3, 0}, {4, 5, 6, 0}}},
                                         {{{1, 2, 3, 0}, {4, 5, 6, 0}}},
                                         {{{3e38f, 0, 0, 0}, {0, 0, 0, 0}}}};
  std::vector<Index> order = order_along_curve(places);
  std::sort(order.begin(), order.end());
  EXPECT_EQ(order, (std::vector<Index>{0, 1, 2, 3, 4}));
  EXPECT_TRUE(order_along_curve({}).empty());
}

}  // namespace
}  // namespace selvage
