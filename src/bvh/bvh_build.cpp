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
/// are leaves, larger ones are nodes of the next level. Nodes are numbered within their level of the part that they
/// are built in.
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

/// Splits of large ranges that are made ahead, those of both halves side by side: which of them a node takes is known
/// only when they are made, and nodes of the first levels are too few to keep threads busy. The same splits for any
/// number of threads, so that what is not taken moves primitives in the same way.
class SplitsAhead {
 public:
  SplitsAhead(RangeSplitter& splitter, const RefRange& whole, bool halve) : splitter_(splitter), halve_(halve) {
    prepare(kWhole, whole);
  }

  static constexpr int kWhole = 1;
  /// The places of the halves of a range; those of what is not split ahead are of no use.
  static int left_of(int place) { return 2 * place; }

  std::array<RefRange, 2> split(const RefRange& range, int place) {
    return is_ahead(place, range) ? halves_[place] : splitter_.split(range, halve_);
  }

 private:
  static constexpr int kPlaces = kWidth;  ///< of three rounds of halving, which give eight ranges
  static constexpr Index kMinSize = 1 << 13;

  static bool is_ahead(int place, const RefRange& range) { return place < kPlaces && range.size() >= kMinSize; }

  void prepare(int place, const RefRange& range) {
    if (!is_ahead(place, range)) return;
    halves_[place] = splitter_.split(range, halve_);
    parallel_invoke([&] { prepare(left_of(place), halves_[place][0]); },
                    [&] { prepare(left_of(place) + 1, halves_[place][1]); });
  }

  RangeSplitter& splitter_;
  bool halve_;
  std::array<std::array<RefRange, 2>, kPlaces> halves_;
};

/// Up to eight ranges that together are a node's primitives.
struct ChildRanges {
  std::array<RefRange, kWidth> ranges;
  std::array<float, kWidth> measures;
  std::array<int, kWidth> places;  ///< among splits made ahead
  int count = 0;

  void add(const RefRange& range, float measure, int place = 0) { set(count++, range, measure, place); }
  void set(int i, const RefRange& range, float measure, int place = 0) {
    ranges[i] = range;
    measures[i] = measure;
    places[i] = place;
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
  SplitsAhead splits(splitter, whole, halve);
  ChildRanges children;
  children.add(whole, 1, SplitsAhead::kWhole);
  while (children.count < kWidth) {
    const int largest = children.largest_to_split();
    if (largest < 0) break;
    const int left_place = SplitsAhead::left_of(children.places[largest]);
    const auto [left, right] = splits.split(children.ranges[largest], children.places[largest]);
    children.set(largest, left, measure(left), left_place);
    children.add(right, measure(right), left_place + 1);
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

/// Numbers the nodes of the next level, and lists what they hold.
std::vector<PendingNode> list_next(Level& level) {
  std::vector<PendingNode> next;
  for (Index i = 0; i < static_cast<Index>(level.size()); ++i) {
    level[i].first_child_node = static_cast<Index>(next.size());
    for (int child = 0; child < level[i].child_count; ++child)
      if (!level[i].is_leaf(child)) next.push_back({level[i].begin[child], level[i].begin[child + 1], i});
  }
  return next;
}

bool is_halved(std::size_t level) {
  return level >= kFirstHalvedLevel;
}

/// Everything below a node of the top, built by one thread, which has its primitives in its own cache: what another
/// core wrote takes longer to fetch than to split.
std::vector<Level> build_subtree(RangeSplitter& splitter, const PendingNode& root, std::size_t first_level) {
  std::vector<Level> levels;
  std::vector<PendingNode> pending = {root};
  while (!pending.empty()) {
    const bool halve = is_halved(first_level + levels.size());
    Level& level = levels.emplace_back();
    level.reserve(pending.size());
    for (const PendingNode& node : pending) level.push_back(split_node(splitter, node, halve));
    pending = list_next(level);
  }
  return levels;
}

/// A tree while it is built: the first levels, whose nodes are split side by side, and below them subtrees, in the
/// order of their roots, which are the first level without a node in the top.
struct BuildTree {
  std::vector<Level> top;
  std::vector<std::vector<Level>> subtrees;
  std::vector<std::vector<Index>> subtree_starts;  ///< per level below the top and subtree, in the tree's level

  std::vector<Index> number_nodes();
  void make_subtree_nodes(const RangeSplitter& splitter, std::span<const Index> level_starts, std::size_t subtree,
                          BvhNode* nodes) const;
};

BuildTree build_tree(RangeSplitter& splitter, Index primitive_count) {
  constexpr Index kMaxSubtree = 1 << 12;  ///< primitives, which a core's cache holds
  BuildTree tree;
  std::vector<PendingNode> pending = {{0, primitive_count, kNone}};
  const auto is_large = [](const PendingNode& node) { return node.end - node.begin > kMaxSubtree; };
  while (tree.top.empty() || std::any_of(pending.begin(), pending.end(), is_large)) {
    const bool halve = is_halved(tree.top.size());
    Level& level = tree.top.emplace_back(pending.size());
    parallel_for(std::ssize(pending), 1, [&](std::int64_t i) { level[i] = split_node(splitter, pending[i], halve); });
    pending = list_next(level);
  }
  tree.subtrees.resize(pending.size());
  parallel_for(std::ssize(pending), 1,
               [&](std::int64_t i) { tree.subtrees[i] = build_subtree(splitter, pending[i], tree.top.size()); });
  return tree;
}

/// Level by level: the first node of each, and the number of all.
std::vector<Index> BuildTree::number_nodes() {
  std::vector<Index> level_starts = {0};
  for (const Level& level : top) level_starts.push_back(level_starts.back() + static_cast<Index>(level.size()));
  for (Index in_level = 1; in_level > 0;) {
    const std::size_t depth = subtree_starts.size();
    std::vector<Index>& starts = subtree_starts.emplace_back(subtrees.size());
    in_level = 0;
    for (std::size_t s = 0; s < subtrees.size(); ++s) {
      starts[s] = in_level;
      if (depth < subtrees[s].size()) in_level += static_cast<Index>(subtrees[s][depth].size());
    }
    if (in_level > 0) level_starts.push_back(level_starts.back() + in_level);
  }
  return level_starts;
}

/// Child nodes first, then primitives.
///
/// @param first_of_parents, first_of_children  of the levels that the numbers in `built` count in
void make_node(const BuildNode& built, const RangeSplitter& splitter, Index first_of_parents, Index first_of_children,
               BvhNode& node) {
  node = {};
  node.parent = built.parent == kNone ? kNone : first_of_parents + built.parent;
  node.child_count = built.child_count;
  int slot = 0;
  for (int child = 0; child < built.child_count; ++child)
    if (!built.is_leaf(child)) {
      node.children[slot] = ~(first_of_children + built.first_child_node + slot);
      ++slot;
    }
  for (int child = 0; child < built.child_count; ++child)
    if (built.is_leaf(child)) node.children[slot++] = splitter.primitive(built.begin[child]);
}

void BuildTree::make_subtree_nodes(const RangeSplitter& splitter, std::span<const Index> level_starts,
                                   std::size_t subtree, BvhNode* nodes) const {
  const auto start = [&](std::size_t depth) {  // there may be no such level below the last one
    const std::size_t level = std::min(top.size() + depth, level_starts.size() - 1);
    return level_starts[level] + subtree_starts[depth][subtree];
  };
  Index first_of_parents = level_starts[top.size() - 1];
  for (std::size_t depth = 0; depth < subtrees[subtree].size(); ++depth) {
    const Level& level = subtrees[subtree][depth];
    for (std::size_t i = 0; i < level.size(); ++i)
      make_node(level[i], splitter, first_of_parents, start(depth + 1), nodes[start(depth) + i]);
    first_of_parents = start(depth);
  }
}

}  // namespace

BvhTopology build_topology(std::span<const Box> boxes, BuildQuality quality) {
  RangeSplitter splitter(boxes, quality);
  BuildTree tree = build_tree(splitter, static_cast<Index>(boxes.size()));
  std::vector<Index> level_starts = tree.number_nodes();
  assert(level_starts.size() <= Bvh::kMaxLevels + 1);
  splitter.free_scratch();
  UnsetVector<BvhNode> nodes(level_starts.back());
  for (std::size_t level = 0; level < tree.top.size(); ++level) {
    const Index parents = level == 0 ? 0 : level_starts[level - 1];
    for (std::size_t i = 0; i < tree.top[level].size(); ++i)
      make_node(tree.top[level][i], splitter, parents, level_starts[level + 1], nodes[level_starts[level] + i]);
  }
  parallel_for(std::ssize(tree.subtrees), 1,
               [&](std::int64_t s) { tree.make_subtree_nodes(splitter, level_starts, s, nodes.data()); });
  return {std::move(nodes), std::move(level_starts), splitter.flat(), splitter.largest_extent()};
}

}  // namespace selvage
