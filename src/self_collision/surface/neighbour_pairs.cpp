#include "self_collision/surface/neighbour_pairs.h"

#include "bvh/traverse_pairs.h"
#include "core/parallel.h"

#include <algorithm>

namespace selvage {

namespace {

/// More neighbours a node are not listed: a vertex of n triangles makes n^2 pairs. Ordinary surfaces have far fewer.
constexpr std::size_t kMaxPerNode = 16;

class NeighbourLister {
 public:
  NeighbourLister(std::span<const BvhNode> nodes, std::span<const LeafVertices> leaves)
      : nodes_(nodes), leaves_(leaves), max_size_(kMaxPerNode * (nodes.size() + 64)) {
    list_.reserve(4 * nodes.size());
  }

  std::vector<NeighbourPair> take_all() {
    if (!nodes_.empty()) take(kRoots);
    return std::move(list_);
  }

 private:
  /// Lists a pair with what is below it. Returns false and lists nothing where there are no neighbours.
  bool take(NodePair pair) {
    const std::size_t place = list_.size();
    list_.push_back({pair, 0, 0});
    std::uint64_t neighbours = 0;
    if (place > max_size_)
      neighbours = NeighbourPair::kUnlisted;
    else
      traversal::compare_children<true>(
          nodes_, nodes_, pair,
          [&](NodePair next) {
            if (take(next)) neighbours |= children_in(pair, next);
          },
          [&](const PrimitivePairs& pairs) {
            neighbours |= pairs.bits & sharing_pairs(leaves_[pairs.first], leaves_[pairs.second]);
          });
    if (neighbours == 0 && pair.a != pair.b) {
      list_.resize(place);
      return false;
    }
    list_[place].end = static_cast<Index>(list_.size());
    list_[place].neighbours = neighbours;
    return true;
  }

  /// The bits, in a pair of nodes, of the children that a pair below it consists of.
  std::uint64_t children_in(NodePair pair, NodePair below) const {
    const auto all = [&](Index node, Index child, bool primitives) -> unsigned {
      if (primitives) return 0xff & ~traversal::inner_children(nodes_[node]);
      return 1u << (child - ~nodes_[node].children[0]);
    };
    const unsigned rows = all(pair.a, below.a, below.primitives_of_a);
    const unsigned columns = all(pair.b, below.b, below.primitives_of_b);
    std::uint64_t bits = 0;
    for (int i = 0; i < BvhNode::kWidth; ++i)
      if ((rows >> i & 1) != 0) bits |= std::uint64_t{columns} << BvhNode::kWidth * i;
    return bits;
  }

  std::span<const BvhNode> nodes_;
  std::span<const LeafVertices> leaves_;
  std::size_t max_size_;
  std::vector<NeighbourPair> list_;
};

}  // namespace

std::vector<LeafVertices> list_leaf_vertices(const Bvh& bvh, std::span<const VertexTuple<3>> triangles,
                                             std::span<const Index> triangle_of) {
  std::vector<LeafVertices> leaves(bvh.nodes().size());
  parallel_for(std::ssize(leaves), 1024, [&](std::int64_t n) {
    const BvhNode& node = bvh.nodes()[n];
    for (int i = 0; i < BvhNode::kWidth; ++i) {
      const bool is_leaf = i < node.child_count && node.children[i] >= 0;
      const Index t = !is_leaf ? kNone : triangle_of.empty() ? node.children[i] : triangle_of[node.children[i]];
      for (int k = 0; k < 3; ++k) leaves[n].corners[k][i] = is_leaf ? triangles[t][k] : kNone;
    }
  });
  return leaves;
}

std::vector<NeighbourPair> list_neighbours(const Bvh& bvh, std::span<const LeafVertices> leaves) {
  return NeighbourLister(bvh.nodes(), leaves).take_all();
}

std::size_t piece_count(const Bvh& bvh) {
  return std::clamp<std::size_t>(bvh.nodes().size() / 64, 16, 512);
}

SelfWork split_self_work(const Bvh& bvh, std::span<const NeighbourPair> neighbours, const CulledNodes& culled,
                         std::size_t wanted) {
  SelfWork work;
  const auto nodes = bvh.nodes();
  std::vector<SelfPiece> smaller;
  const auto add = [&](std::vector<SelfPiece>& pieces, const SelfPiece& piece) {
    if (!culled.holds(nodes.data(), piece.pair)) pieces.push_back(piece);
  };
  const auto add_listed = [&](std::vector<SelfPiece>& pieces, Index place) {
    const NeighbourPair& listed = neighbours[place];
    const bool is_listed = listed.neighbours != NeighbourPair::kUnlisted;
    add(pieces, {listed.pair, true, is_listed ? place : 0, is_listed ? listed.end : 0});
  };
  const auto cut = [&](const SelfPiece& piece) {
    const bool is_self = piece.pair.a == piece.pair.b;
    ++work.counters.node_pairs;
    work.counters.self_node_pairs += is_self;
    traversal::compare_children<true>(
        nodes, nodes, piece.pair,
        [&](NodePair pair) {
          if (!piece.is_listed()) add(smaller, {pair, piece.may_share});
        },
        [&](const PrimitivePairs& pairs) {
          traversal::visit_each(nodes, nodes, pairs, [&](Index i, Index j) { work.found.emplace_back(i, j); });
        });
    if (!piece.is_listed()) return;
    const BvhNode &a = nodes[piece.pair.a], &b = nodes[piece.pair.b];
    const std::uint64_t nonadjacent = traversal::meeting_children(a, b) & ~neighbours[piece.first].neighbours;
    traversal::hand_on_children(
        a, b, piece.pair, is_self ? nonadjacent & traversal::kAboveDiagonal : nonadjacent,
        [&](NodePair pair) {
          add(smaller, {pair, false});
        },
        [](const PrimitivePairs&) {});
    for (Index place = piece.first + 1; place < piece.last; place = neighbours[place].end) add_listed(smaller, place);
  };
  if (!neighbours.empty())
    add_listed(work.pieces, 0);
  else if (!nodes.empty())
    add(work.pieces, {{0, 0, false, false}, true});
  while (!work.pieces.empty() && work.pieces.size() < wanted) {
    smaller.clear();
    for (const SelfPiece& piece : work.pieces) cut(piece);
    std::swap(work.pieces, smaller);
  }
  return work;
}

}  // namespace selvage
