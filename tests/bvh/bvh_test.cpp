#include "bvh/bvh.h"

#include "bvh/test_boxes.h"
#include "selvage/core/error.h"

#include <tbb/global_control.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

namespace selvage {
namespace {

using test::Boxes;
using test::Random;

constexpr Index kCounts[] = {1, 2, 7, 8, 9, 17, 64, 65, 500, 3000};
constexpr BuildQuality kQualities[] = {BuildQuality::kBest, BuildQuality::kFast};

Box bounds_of(const BvhNode& node) {
  Box box = Box::empty();
  for (int child = 0; child < node.child_count; ++child) box.merge(node.box(child));
  return box;
}

/// Everything that the header promises of the nodes.
void check_nodes(const Bvh& bvh, const Boxes& boxes) {
  const auto nodes = bvh.nodes();
  const auto levels = bvh.levels();
  ASSERT_FALSE(nodes.empty());
  ASSERT_EQ(levels.front(), 0);
  ASSERT_EQ(levels[1], 1);
  ASSERT_EQ(levels.back(), static_cast<Index>(nodes.size()));
  ASSERT_LE(levels.size() - 1, static_cast<std::size_t>(Bvh::kMaxLevels));
  EXPECT_EQ(nodes[0].parent, kNone);
  std::vector<int> seen(boxes.size(), 0);
  Index next_node = 1;
  for (std::size_t level = 0; level + 1 < levels.size(); ++level)
    for (Index n = levels[level]; n < levels[level + 1]; ++n) {
      const BvhNode& node = nodes[n];
      ASSERT_GE(node.child_count, nodes.size() == 1 ? 1 : 2);
      ASSERT_LE(node.child_count, BvhNode::kWidth);
      bool primitives_began = false;
      for (int i = 0; i < BvhNode::kWidth; ++i) {
        if (i >= node.child_count) {
          for (int axis = 0; axis < 3; ++axis) EXPECT_GT(node.lower[axis][i], node.upper[axis][i]);
          continue;
        }
        const Index child = node.children[i];
        if (child >= 0) {
          primitives_began = true;
          ++seen[child];
          EXPECT_EQ(node.box(i), boxes[child]);
        } else {
          EXPECT_FALSE(primitives_began);
          ASSERT_EQ(~child, next_node++);
          ASSERT_LT(~child, levels[std::min(level + 2, levels.size() - 1)]);
          EXPECT_EQ(nodes[~child].parent, n);
          EXPECT_EQ(node.box(i), bounds_of(nodes[~child]));
        }
      }
    }
  EXPECT_EQ(next_node, static_cast<Index>(nodes.size()));
  for (const int times : seen) ASSERT_EQ(times, 1);
}

class BvhFamily : public testing::TestWithParam<test::BoxFamily> {};
INSTANTIATE_TEST_SUITE_P(All, BvhFamily, testing::ValuesIn(test::box_families()),
                         [](const auto& family) { return family.param.name; });

TEST_P(BvhFamily, NodesAreInOrderWhenBuiltAndWhenRefitted) {
  Random random(3);
  for (const BuildQuality quality : kQualities)
    for (const Index count : kCounts) {
      const Boxes boxes = GetParam().make(count, random);
      Bvh bvh(boxes, quality);
      ASSERT_EQ(bvh.primitive_count(), count);
      ASSERT_NO_FATAL_FAILURE(check_nodes(bvh, boxes));
      EXPECT_EQ(bvh.quality_loss(), 1);
      const Boxes moved = test::moved_boxes(boxes, random);
      bvh.refit(moved);
      ASSERT_NO_FATAL_FAILURE(check_nodes(bvh, moved));
      EXPECT_GT(bvh.quality_loss(), 0);
      bvh.refit(boxes);
      EXPECT_EQ(bvh.quality_loss(), 1);
    }
}

TEST_P(BvhFamily, RefitsFromBoxesThatTheCallerComputes) {
  Random random(9);
  const Boxes boxes = GetParam().make(3000, random), moved = test::moved_boxes(boxes, random);
  Bvh bvh(boxes), twin(boxes);
  twin.refit(moved);
  bvh.refit_from([&](BvhNode* nodes, Index first, Index last) {
    for (Index n = first; n < last; ++n)
      for (int i = 0; i < BvhNode::kWidth; ++i) {
        const Index child = nodes[n].children[i];
        const Box box = i < nodes[n].child_count && child >= 0 ? moved[child] : Box::empty();
        for (int axis = 0; axis < 3; ++axis) {
          nodes[n].lower[axis][i] = box.lower[axis];
          nodes[n].upper[axis][i] = box.upper[axis];
        }
      }
  });
  EXPECT_EQ(std::memcmp(bvh.nodes().data(), twin.nodes().data(), bvh.nodes().size_bytes()), 0);
  EXPECT_EQ(bvh.quality_loss(), twin.quality_loss());
}

TEST_P(BvhFamily, LeafOrderIsAPermutation) {
  Random random(4);
  const Boxes boxes = GetParam().make(1000, random);
  std::vector<Index> order = Bvh(boxes).leaf_order();
  std::sort(order.begin(), order.end());
  ASSERT_EQ(order.size(), boxes.size());
  for (Index i = 0; i < 1000; ++i) EXPECT_EQ(order[i], i);
}

TEST(Bvh, HasNoNodesWithoutPrimitives) {
  Bvh bvh{std::span<const Box>()};
  EXPECT_TRUE(bvh.nodes().empty());
  EXPECT_EQ(bvh.levels().size(), 1u);
  EXPECT_TRUE(bvh.leaf_order().empty());
  bvh.refit({});
  EXPECT_EQ(bvh.quality_loss(), 1);
  EXPECT_TRUE(Bvh().nodes().empty());
}

TEST(Bvh, RefusesAnotherNumberOfBoxes) {
  Random random(5);
  const Boxes boxes = test::scaled_boxes(10, random, 1, 0);
  Bvh bvh(boxes);
  EXPECT_THROW(bvh.refit(std::span(boxes).first(9)), Error);
}

TEST(Bvh, IsTheSameForAnyNumberOfThreads) {
  Random random(6);
  // Large enough that ranges are split in parallel and levels are refitted in several chunks.
  const Boxes boxes = test::scaled_boxes(150000, random, 1, 0);
  const Boxes moved = test::moved_boxes(boxes, random);
  for (const BuildQuality quality : kQualities) {
    std::vector<BvhNode> built, refitted;
    double quality_loss = 0;
    for (const int threads : {1, 2, 4}) {
      const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
      Bvh bvh(boxes, quality);
      const std::vector<BvhNode> nodes(bvh.nodes().begin(), bvh.nodes().end());
      bvh.refit(moved);
      const std::vector<BvhNode> nodes_moved(bvh.nodes().begin(), bvh.nodes().end());
      if (threads == 1) {
        built = nodes;
        refitted = nodes_moved;
        quality_loss = bvh.quality_loss();
      }
      ASSERT_EQ(nodes.size(), built.size());
      EXPECT_EQ(std::memcmp(nodes.data(), built.data(), nodes.size() * sizeof(BvhNode)), 0) << threads;
      EXPECT_EQ(std::memcmp(nodes_moved.data(), refitted.data(), nodes.size() * sizeof(BvhNode)), 0) << threads;
      EXPECT_EQ(bvh.quality_loss(), quality_loss) << threads;
    }
    ASSERT_NO_FATAL_FAILURE(check_nodes(Bvh(boxes, quality), boxes));
  }
}

TEST(Bvh, FillsItsNodes) {
  Random random(7);
  for (const BuildQuality quality : kQualities)
    for (const test::BoxFamily& family : test::box_families()) {
      const Bvh bvh(family.make(5000, random), quality);
      EXPECT_GE(5000.0 / static_cast<double>(bvh.nodes().size()), 3.5) << family.name;
    }
}

/// The area of all nodes but the root.
double area_of_nodes(const Bvh& bvh) {
  double area = 0;
  for (const BvhNode& node : bvh.nodes())
    for (int i = 0; i < node.child_count && node.children[i] < 0; ++i) {
      const Box box = node.box(i);
      double e[3];
      for (int axis = 0; axis < 3; ++axis) e[axis] = double{box.upper[axis]} - box.lower[axis];
      area += e[0] * e[1] + e[1] * e[2] + e[2] * e[0];
    }
  return area;
}

TEST(Bvh, BuiltFastIsNearlyAsGood) {
  Random random(10);
  for (const Index count : {200, 3000, 30000}) {
    const Boxes boxes = test::make_boxes(count, [&](Index) {
      return test::make_box(random.unit(), random.unit(), 0.1 * random.unit(), 0.004, 0.004, 0.004);
    });
    const double best = area_of_nodes(Bvh(boxes)), fast = area_of_nodes(Bvh(boxes, BuildQuality::kFast));
    EXPECT_LT(fast, 1.25 * best) << count;
  }
}

TEST(Bvh, QualityKnowsALooseTreeFromATightOne) {
  Random random(8);
  Boxes boxes = test::make_boxes(
      4000, [&](Index) { return test::make_box(random.unit(), random.unit(), random.unit(), 0.02, 0.02, 0.02); });
  Bvh bvh(boxes);
  // Scaled as a whole: as good as before.
  Boxes scaled = boxes;
  for (Box& box : scaled)
    for (int axis = 0; axis < 3; ++axis) {
      box.lower[axis] *= 8;
      box.upper[axis] *= 8;
    }
  bvh.refit(scaled);
  EXPECT_NEAR(bvh.quality_loss(), 1, 1e-4);
  // Shuffled: neighbours in the tree are strangers in space.
  std::rotate(boxes.begin(), boxes.begin() + 2000, boxes.end());
  bvh.refit(boxes);
  EXPECT_GT(bvh.quality_loss(), 10 * Bvh::kRebuildAbove);
}

}  // namespace
}  // namespace selvage
