#include "bvh/bvh_build.h"

#include "bvh/binned_split.h"
#include "core/parallel.h"

#include <algorithm>
#include <cassert>

namespace selvage {

namespace {

constexpr int kWidth = BvhNode::kWidth;

// From here on ranges are halved: a node's children have at most half of its primitives, so that 31 more levels hold
// all that an Index can count.
constexpr int kFirstHalvedLevel = Bvh::kMaxLevels / 2;

/// A node while the tree is built: its primitives, and where those of its children begin. Children of one primitive
/// are leaves, larger ones are nodes of the next level.
struct BuildNode {
  Index parent;
  Index child_count;
  Index first_child_node;
  std::array<Index, kWidth + 1> begin;

  bool is_leaf(int child) const { return begin[child + 1] - begin[child] == 1; }
};

/// Ranges that remain to be split.
struct PendingNode {
  Index begin;
  Index end;
  Index parent;
};

/// Up to eight ranges that together are a node's primitives.
struct ChildRanges {
  std::array<RefRange, kWidth> ranges;
  std::array<float, kWidth> measures;
  int count = 0;

  void add(const RefRange& range, float measure) {
    ranges[count] = range;
    measures[count++] = measure;
  }
  void set(int i, const RefRange& range, float measure) {
    ranges[i] = range;
    measures[i] = measure;
  }
  /// Replaces a range by its primitives.
  void open(int i) {
    RefRange single = ranges[i];
    const Index end = single.end;
    single.end = single.begin + 1;
    for (set(i, single, 0); single.end < end; add(single, 0)) single.begin = single.end++;
  }
  /// The range with the largest surface among those of more than eight primitives, or -1.
  int largest_to_split() const {
    int best = -1;
    for (int i = 0; i < count; ++i)
      if (ranges[i].size() > kWidth && (best < 0 || measures[i] > measures[best])) best = i;
    return best;
  }
  /// Whether all primitives of a range find a place in this node.
  bool may_open(int i) const { return ranges[i].size() > 1 && count - 1 + ranges[i].size() <= kWidth; }
  /// The range with the largest surface among those, or -1.
  int largest_to_open() const {
    int best = -1;
    for (int i = 0; i < count; ++i)
      if (may_open(i) && (best < 0 || measures[i] > measures[best])) best = i;
    return best;
  }
};

/// Splits the range of largest surface until there are eight ranges or none has more than eight primitives (those are
/// full leaf nodes), then fills what is left with the primitives of small ranges, which saves their nodes.
BuildNode split_node(RangeSplitter& splitter, const PendingNode& pending, bool halve) {
  if (const Index size = pending.end - pending.begin; size <= kWidth) {
    BuildNode leaf{pending.parent, size, 0, {}};
    for (int i = 0; i <= size; ++i) leaf.begin[i] = pending.begin + i;
    return leaf;
  }
  const RefRange whole = splitter.make_range(pending.begin, pending.end);
  // Ranges of at most a leaf node, only where they may find a place in this one.
  const auto measure = [&](const RefRange& range) {
    return range.size() > kWidth ? splitter.measure(range.bounds, whole.bounds) : 0;
  };
  ChildRanges children;
  children.add(whole, 1);
  while (children.count < kWidth) {
    const int largest = children.largest_to_split();
    if (largest < 0) break;
    const auto [left, right] = splitter.split(children.ranges[largest], halve);
    children.set(largest, left, measure(left));
    children.add(right, measure(right));
  }
  for (int i = 0; i < children.count; ++i)
    if (children.may_open(i)) {
      const RefRange small = splitter.make_range(children.ranges[i].begin, children.ranges[i].end);
      children.measures[i] = splitter.measure(small.bounds, whole.bounds);
    }
  for (int small = children.largest_to_open(); small >= 0; small = children.largest_to_open()) children.open(small);
  BuildNode node{pending.parent, children.count, 0, {}};
  for (int i = 0; i < children.count; ++i) node.begin[i] = children.ranges[i].begin;
  std::sort(node.begin.begin(), node.begin.begin() + children.count);
  node.begin[children.count] = pending.end;
  return node;
}

using Level = std::vector<BuildNode>;

/// Splits all nodes of a level, and lists those of the next one.
Level build_level(RangeSplitter& splitter, std::vector<PendingNode>& pending, Index first_node, bool halve) {
  const std::int64_t count = static_cast<std::int64_t>(pending.size());
  Level level(pending.size());
  parallel_for(count, std::max<std::int64_t>(1, count / 4096),
               [&](std::int64_t i) { level[i] = split_node(splitter, pending[i], halve); });
  std::vector<PendingNode> next;
  const Index first_next = first_node + static_cast<Index>(count);
  for (Index i = 0; i < static_cast<Index>(count); ++i) {
    level[i].first_child_node = first_next + static_cast<Index>(next.size());
    for (int child = 0; child < level[i].child_count; ++child)
      if (!level[i].is_leaf(child)) next.push_back({level[i].begin[child], level[i].begin[child + 1], first_node + i});
  }
  pending = std::move(next);
  return level;
}

/// Child nodes first, then primitives. Sets only members that are not 0.
void make_node(const BuildNode& built, const RangeSplitter& splitter, BvhNode& node) {
  node.parent = built.parent;
  node.child_count = built.child_count;
  int slot = 0;
  for (int child = 0; child < built.child_count; ++child)
    if (!built.is_leaf(child)) {
      node.children[slot] = ~(built.first_child_node + slot);
      ++slot;
    }
  for (int child = 0; child < built.child_count; ++child)
    if (built.is_leaf(child)) node.children[slot++] = splitter.primitive(built.begin[child]);
}

}  // namespace

BvhTopology build_topology(std::span<const Box> boxes, BuildQuality quality) {
  RangeSplitter splitter(boxes, quality);
  std::vector<Level> levels;
  std::vector<Index> level_starts = {0};
  std::vector<PendingNode> pending = {{0, static_cast<Index>(boxes.size()), kNone}};
  while (!pending.empty()) {
    const bool halve = static_cast<int>(levels.size()) >= kFirstHalvedLevel;
    levels.push_back(build_level(splitter, pending, level_starts.back(), halve));
    level_starts.push_back(level_starts.back() + static_cast<Index>(levels.back().size()));
  }
  assert(levels.size() <= Bvh::kMaxLevels);
  splitter.free_scratch();
  std::vector<BvhNode> nodes(level_starts.back());
  for (std::size_t level = 0; level < levels.size(); ++level)
    parallel_for(static_cast<std::int64_t>(levels[level].size()), 1024,
                 [&](std::int64_t i) { make_node(levels[level][i], splitter, nodes[level_starts[level] + i]); });
  return {std::move(nodes), std::move(level_starts), splitter.flat(), splitter.largest_extent()};
}

}  // namespace selvage
