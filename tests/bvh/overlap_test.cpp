#include "bvh/overlap.h"

#include "bvh/test_boxes.h"
#include "core/isa.h"
#include "kernels/traverse_queries.h"
#include "threads.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace selvage {
namespace {

using test::Boxes;
using test::Random;

std::vector<IndexPair> brute_force_pairs(const Boxes& a, const Boxes& b) {
  std::vector<IndexPair> pairs;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j)
      if (test::overlap(a[i], b[j])) pairs.emplace_back(i, j);
  return pairs;
}

std::vector<IndexPair> brute_force_self_pairs(const Boxes& boxes) {
  std::vector<IndexPair> pairs = brute_force_pairs(boxes, boxes);
  std::erase_if(pairs, [](const IndexPair& pair) { return pair.first >= pair.second; });
  return pairs;
}

struct PairVariant {
  const char* name;
  Isa needs;
  decltype(&baseline::list_pairs) list_pairs;
  decltype(&baseline::list_self_pairs) list_self_pairs;
};

std::vector<PairVariant> usable_pair_variants() {
  std::vector<PairVariant> variants = {{"scalar", Isa::baseline, &scalar::list_pairs, &scalar::list_self_pairs},
                                       {"baseline", Isa::baseline, &baseline::list_pairs, &baseline::list_self_pairs},
                                       {"avx2", Isa::avx2, &avx2::list_pairs, &avx2::list_self_pairs},
                                       {"avx512", Isa::avx512, &avx512::list_pairs, &avx512::list_self_pairs}};
  std::erase_if(variants, [](const PairVariant& variant) { return variant.needs > active_isa(); });
  return variants;
}

class Overlap : public testing::TestWithParam<test::BoxFamily> {};
INSTANTIATE_TEST_SUITE_P(All, Overlap, testing::ValuesIn(test::box_families()),
                         [](const auto& family) { return family.param.name; });

TEST_P(Overlap, FindsAllPairsOfTwoTrees) {
  Random random(21);
  for (const auto& [count_a, count_b] : {std::pair{300, 200}, {1, 150}, {150, 1}, {9, 500}, {5, 3}}) {
    const Boxes a = GetParam().make(count_a, random);
    const Boxes b = test::moved_boxes(GetParam().make(count_b, random), random);
    const Bvh tree_a(a), tree_b(b);
    const auto expected = brute_force_pairs(a, b);
    EXPECT_EQ(overlapping_pairs(tree_a, tree_b), expected);
    for (const PairVariant& variant : usable_pair_variants()) {
      auto found = variant.list_pairs(tree_a, tree_b);
      std::sort(found.begin(), found.end());
      ASSERT_EQ(found, expected) << variant.name;
    }
  }
}

TEST_P(Overlap, FindsEachPairOfOneTreeOnce) {
  Random random(22);
  for (const Index count : {1, 2, 9, 70, 400}) {
    const Boxes built = GetParam().make(count, random);
    const Boxes moved = test::moved_boxes(built, random);
    Bvh bvh(built);
    for (const Boxes& boxes : {built, moved}) {
      bvh.refit(boxes);
      const auto expected = brute_force_self_pairs(boxes);
      EXPECT_EQ(self_overlapping_pairs(bvh), expected);
      for (const PairVariant& variant : usable_pair_variants()) {
        auto found = variant.list_self_pairs(bvh);
        std::sort(found.begin(), found.end());
        ASSERT_EQ(found, expected) << variant.name;
      }
    }
  }
}

TEST(Overlap, EmptyTreesMeetNothing) {
  const Boxes boxes(3, test::make_box(0, 0, 0, 1, 1, 1));
  const Bvh empty, full(boxes);
  EXPECT_TRUE(overlapping_pairs(empty, full).empty());
  EXPECT_TRUE(overlapping_pairs(full, empty).empty());
  EXPECT_TRUE(self_overlapping_pairs(empty).empty());
  EXPECT_EQ(self_overlapping_pairs(full).size(), 3u);
}

TEST(Overlap, IsTheSameForAnyNumberOfThreads) {
  Random random(23);
  const Boxes boxes = test::make_boxes(
      40000, [&](Index) { return test::make_box(random.unit(), random.unit(), random.unit(), 0.03, 0.03, 0.03); });
  const Bvh bvh(boxes);
  const auto first = test::same_for_any_threads([&] { return self_overlapping_pairs(bvh); });
  EXPECT_TRUE(std::is_sorted(first.begin(), first.end()));
  EXPECT_GT(first.size(), 100000u);
  // A tree against its own copy: both orders of each pair, and each primitive with itself.
  EXPECT_EQ(overlapping_pairs(bvh, Bvh(boxes)).size(), 2 * first.size() + boxes.size());
}

TEST(Overlap, SplittingLosesAndRepeatsNothing) {
  Random random(24);
  const Boxes boxes = test::scaled_boxes(2000, random, 1, 0);
  const Bvh bvh(boxes);
  const auto expected = brute_force_self_pairs(boxes);
  for (const std::size_t wanted : {1, 10, 300, 1000000}) {
    const PairWork work = split_self_pair_work(bvh, wanted);
    EXPECT_TRUE(work.pieces.size() >= wanted || work.pieces.empty()) << wanted;
    auto found = baseline::list_self_pairs_of_pieces(bvh, work.pieces);
    found.insert(found.end(), work.found.begin(), work.found.end());
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, expected) << wanted;
  }
}

}  // namespace
}  // namespace selvage
