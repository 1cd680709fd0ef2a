#include "bvh/traverse.h"

#include "bvh/test_boxes.h"
#include "kernels/traverse_queries.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace selvage {
namespace {

using test::Boxes;
using test::Random;

/// The traversals compiled for one instruction set.
struct Variant {
  const char* name;
  Isa needs;
  decltype(&baseline::list_within) list_within;
  decltype(&baseline::find_nearest) find_nearest;
  decltype(&baseline::list_overlaps) list_overlaps;
  decltype(&baseline::count_overlaps_up_to) count_overlaps_up_to;
  decltype(&baseline::check_simd) check_simd;
};

#define SELVAGE_VARIANT(isa, needs)                                                                      \
  Variant {                                                                                              \
#isa, needs, &isa::list_within, &isa::find_nearest, &isa::list_overlaps, &isa::count_overlaps_up_to, \
        &isa::check_simd                                                                                 \
  }

std::vector<Variant> usable_variants() {
  std::vector<Variant> variants = {SELVAGE_VARIANT(scalar, Isa::baseline), SELVAGE_VARIANT(baseline, Isa::baseline),
                                   SELVAGE_VARIANT(avx2, Isa::avx2), SELVAGE_VARIANT(avx512, Isa::avx512)};
  std::erase_if(variants, [](const Variant& variant) { return variant.needs > active_isa(); });
  return variants;
}

/// Queries inside, around and far from the boxes: boxes of the family, shrunk to points, moved, and unbounded.
Boxes make_queries(const Boxes& boxes, Random& random) {
  Boxes queries;
  for (int i = 0; i < 8; ++i) {
    Box query = boxes[random.below(static_cast<Index>(boxes.size()))];
    if (test::is_empty(query)) continue;
    queries.push_back(query);
    for (int axis = 0; axis < 3; ++axis)
      if (std::isfinite(query.lower[axis])) query.upper[axis] = query.lower[axis];
    queries.push_back(query);
  }
  const Boxes moved = test::moved_boxes(queries, random);
  queries.insert(queries.end(), moved.begin(), moved.end());
  queries.push_back({{0, 0, 0}, {0, 0, 0}});
  queries.push_back(enclosing_box<3>(Vec3(1e300, -1e300, 3), Vec3(1e300, -1e300, 3)));
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  queries.push_back({{-kInfinity, -kInfinity, -kInfinity}, {kInfinity, kInfinity, kInfinity}});
  return queries;
}

class Traverse : public testing::TestWithParam<test::BoxFamily> {};
INSTANTIATE_TEST_SUITE_P(All, Traverse, testing::ValuesIn(test::box_families()),
                         [](const auto& family) { return family.param.name; });

template <typename Check>
void for_trees_and_queries(const test::BoxFamily& family, Check&& check) {
  Random random(11);
  for (const Index count : {1, 9, 400}) {
    const Boxes built = family.make(count, random);
    const Boxes moved = test::moved_boxes(built, random);
    Bvh bvh(built);
    for (const Boxes& boxes : {built, moved}) {
      bvh.refit(boxes);
      for (const Box& query : make_queries(boxes, random)) check(bvh, boxes, query);
    }
  }
}

TEST_P(Traverse, VisitsAllWithinABound) {
  const auto variants = usable_variants();
  for_trees_and_queries(GetParam(), [&](const Bvh& bvh, const Boxes& boxes, const Box& query) {
    std::vector<long double> distances;
    for (const Box& box : boxes) distances.push_back(test::squared_distance(box, query));
    // Bounds that fall on a distance are the hardest.
    for (const float bound :
         {0.0f, round_up(static_cast<double>(distances[0])), round_up(static_cast<double>(distances[boxes.size() / 2])),
          std::numeric_limits<float>::infinity()})
      for (const Variant& variant : variants) {
        const NearestVisits visits = variant.list_within(bvh, query, bound);
        std::vector<int> seen(boxes.size(), 0);
        for (std::size_t i = 0; i < visits.primitives.size(); ++i) {
          const Index primitive = visits.primitives[i];
          ++seen[primitive];
          ASSERT_LE(visits.bounds[i], bound);
          if (!test::is_empty(boxes[primitive])) {
            ASSERT_LE(visits.bounds[i], distances[primitive]);
          }
        }
        for (std::size_t i = 0; i < boxes.size(); ++i) {
          ASSERT_LE(seen[i], 1);
          if (test::is_empty(boxes[i])) continue;
          if (distances[i] <= bound) {
            ASSERT_EQ(seen[i], 1) << variant.name;
          }
          // Not much more than asked for: the slack is small, unless squares leave the floats.
          if (distances[i] > bound * 1.001L && distances[i] > 1e-36L && distances[i] < 1e37L) {
            ASSERT_EQ(seen[i], 0) << variant.name << " " << static_cast<double>(distances[i]) << " > " << bound;
          }
        }
      }
  });
}

TEST_P(Traverse, FindsTheNearestWithAShrinkingBound) {
  const auto variants = usable_variants();
  for_trees_and_queries(GetParam(), [&](const Bvh& bvh, const Boxes& boxes, const Box& query) {
    long double nearest = std::numeric_limits<long double>::infinity();
    for (const Box& box : boxes)
      if (!test::is_empty(box)) nearest = std::min(nearest, test::squared_distance(box, query));
    std::vector<Index> first_visits;
    for (const Variant& variant : variants) {
      const auto visits = variant.find_nearest(bvh, boxes, query, std::numeric_limits<float>::infinity());
      long double found = std::numeric_limits<long double>::infinity();
      for (const Index primitive : visits.primitives)
        if (!test::is_empty(boxes[primitive])) found = std::min(found, test::squared_distance(boxes[primitive], query));
      ASSERT_EQ(found, nearest) << variant.name;
      if (first_visits.empty()) first_visits = visits.primitives;
      ASSERT_EQ(visits.primitives, first_visits) << variant.name << " visits in another order";
    }
  });
}

TEST_P(Traverse, FindsAllOverlaps) {
  const auto variants = usable_variants();
  for_trees_and_queries(GetParam(), [&](const Bvh& bvh, const Boxes& boxes, const Box& query) {
    std::vector<Index> expected;
    for (std::size_t i = 0; i < boxes.size(); ++i)
      if (test::overlap(boxes[i], query)) expected.push_back(static_cast<Index>(i));
    for (const Variant& variant : variants) {
      std::vector<Index> found = variant.list_overlaps(bvh, query);
      std::sort(found.begin(), found.end());
      ASSERT_EQ(found, expected) << variant.name;
      const auto all = static_cast<std::int64_t>(expected.size());
      ASSERT_EQ(variant.count_overlaps_up_to(bvh, query, 3), std::min<std::int64_t>(all, 3)) << variant.name;
    }
  });
}

TEST(Traverse, EmptyTreeAnswersNothing) {
  const Bvh bvh;
  const Box everywhere{{-1e30f, -1e30f, -1e30f}, {1e30f, 1e30f, 1e30f}};
  for (const Variant& variant : usable_variants()) {
    EXPECT_TRUE(variant.list_overlaps(bvh, everywhere).empty());
    EXPECT_TRUE(variant.list_within(bvh, everywhere, 1e30f).primitives.empty());
  }
}

TEST(Traverse, NegativeBoundEndsTheSearch) {
  Random random(12);
  const Boxes boxes = test::scaled_boxes(100, random, 1, 0);
  const Bvh bvh(boxes);
  int visited = 0;
  visit_nearest(bvh.nodes(), boxes[0], 1.0f, [&](Index, float) { return ++visited, -1.0f; });
  EXPECT_EQ(visited, 1);
}

TEST(Traverse, NearestVisitsFewNodes) {
  Random random(13);
  const Boxes boxes = test::make_boxes(
      20000, [&](Index) { return test::make_box(random.unit(), random.unit(), random.unit(), 0.01, 0.01, 0.01); });
  const Bvh bvh(boxes);
  std::int64_t nodes = 0;
  for (int i = 0; i < 200; ++i) {
    const Box point = test::make_box(random.unit(), random.unit(), random.unit(), 0, 0, 0);
    float bound = std::numeric_limits<float>::infinity();
    visit_nearest(
        bvh.nodes(), point, bound,
        [&](Index primitive, float) {
          return bound =
                     std::min(bound, round_up(static_cast<double>(test::squared_distance(boxes[primitive], point))));
        },
        nodes);
  }
  EXPECT_LT(nodes / 200, 40);
}

TEST(Simd, EveryVariantDoesTheSame) {
  for (const Variant& variant : usable_variants()) EXPECT_TRUE(variant.check_simd()) << variant.name;
}

}  // namespace
}  // namespace selvage
