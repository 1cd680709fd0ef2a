#include "self_collision/discrete/discrete_kernel.h"

#include "bvh/traverse_pairs.h"
#include "self_collision/discrete/pair_batch.h"

namespace selvage {
inline namespace SELVAGE_ISA {

namespace {

/// Pairs of triangles that share kShared vertices: the position of the other vertices decides.
template <int kShared>
class AdjacentBatch {
 public:
  AdjacentBatch(const DiscreteInput& input, DiscreteResult& result) : input_(input), result_(result) {}

  /// @param a, b  the vertices of both, the shared ones first
  void add(Index first, Index second, const VertexTuple<3>& a, const VertexTuple<3>& b) {
    a_[pairs_.count] = a;
    b_[pairs_.count] = b;
    if (pairs_.add(first, second)) flush();
  }

  void flush() {
    if (pairs_.count == 0) return;
    for (int i = pairs_.count; i < EightPairs::kSize; ++i) {
      a_[i] = a_[0];
      b_[i] = b_[0];
    }
    const unsigned lanes = pairs_.fill();
    WideVec3 a[3], b[3];
    gather_triangles(
        input_.a, [&](int lane) -> const VertexTuple<3>& { return a_[lane]; }, a);
    gather_triangles(
        input_.b, [&](int lane) -> const VertexTuple<3>& { return b_[lane]; }, b);
    const WideVec3 rest_a[3] = {a[kShared], a[2], a[2]}, rest_b[3] = {b[kShared], b[2], b[2]};
    unsigned apart = beside_plane(a, rest_b) | beside_plane(b, rest_a);
    // A triangle flat beside its neighbour is not beside its plane.
    if constexpr (kShared == 1)
      apart |= apart_but_for_vertex({a[1] - a[0], a[2] - a[0]}, {b[1] - a[0], b[2] - a[0]});
    else
      apart |= apart_but_for_edge(a[1] - a[0], a[2] - a[0], b[2] - a[0]);
    decide_all(input_, pairs_.first, pairs_.second, lanes & ~apart, result_);
    pairs_.count = 0;
  }

 private:
  const DiscreteInput& input_;
  DiscreteResult& result_;
  EightPairs pairs_;
  VertexTuple<3> a_[EightPairs::kSize], b_[EightPairs::kSize];  ///< the shared vertices first
};

/// Puts the vertices that the triangles share first, in one order. Returns how many there are.
int bring_shared_first(VertexTuple<3>& a, VertexTuple<3>& b) {
  int shared = 0;
  for (int i = 0; i < 3; ++i)
    for (int k = shared; k < 3; ++k) {
      if (a[i] != b[k]) continue;
      const Index common = a[i];
      a[i] = a[shared];
      b[k] = b[shared];
      a[shared] = b[shared] = common;
      ++shared;
      break;
    }
  return shared;
}

/// One piece of a search: the hierarchy decides which triangles are tested.
class Search {
 public:
  Search(const DiscreteInput& input, DiscreteResult& result)
      : input_(input),
        result_(result),
        takes_all_(input.in_subset == nullptr && input.a.thickness == nullptr && input.b.thickness == nullptr),
        disjoint_(input, result),
        by_vertex_(input, result),
        by_edge_(input, result) {}

  /// All below a pair of nodes.
  template <bool kSelf>
  void search_below(NodePair start, bool may_share) {
    traversal::visit_meeting<kSelf>(
        input_.a.nodes, input_.b.nodes, start,
        [&](NodePair pair) {
          if (!may_enter<kSelf>(pair)) return false;
          if (may_share)
            for (const LeafVertices* leaves : {input_.a.leaves + pair.a, input_.b.leaves + pair.b}) {
              prefetch(leaves);
              prefetch(leaves->corners[2]);
            }
          return true;
        },
        [&](const PrimitivePairs& pairs) {
          take(pairs,
               may_share ? pairs.bits & sharing_pairs(input_.a.leaves[pairs.first], input_.b.leaves[pairs.second]) : 0);
        });
  }

  /// Listed neighbours one after the other, and all pairs that are met below them.
  void search_listed(Index first, Index last) {
    constexpr Index kAhead = 3;
    const BvhNode* const nodes = input_.a.nodes.data();
    for (Index place = first; place < last;) {
      const NeighbourPair& listed = input_.neighbours[place];
      if (place + kAhead < last) {
        traversal::prefetch_node(nodes[input_.neighbours[place + kAhead].pair.a]);
        traversal::prefetch_node(nodes[input_.neighbours[place + kAhead].pair.b]);
      }
      if (listed.neighbours == NeighbourPair::kUnlisted)
        search_below<true>(listed.pair, true);
      else if (may_enter<true>(listed.pair))
        compare_listed(listed);
      else
        place = listed.end - 1;
      ++place;
      if (waiting_count_ >= kMaxWaiting) search_waiting();
    }
    search_waiting();
  }

  /// A pair of primitives whose boxes meet.
  void take_pair(Index i, Index j) {
    const Index first = triangle(input_.a, i), second = triangle(input_.b, j);
    bool shares = false;
    if (input_.one_surface)
      for (const Index v : input_.a.triangles[first])
        for (const Index w : input_.b.triangles[second]) shares |= v == w;
    ++result_.counters.box_pairs;
    result_.counters.adjacent_pairs += shares;
    add(first, second, shares);
  }

  void finish() {
    disjoint_.flush();
    by_vertex_.flush();
    by_edge_.flush();
  }

 private:
  /// Culling: the one place where a pair of nodes is left out although their boxes meet.
  template <bool kSelf>
  SELVAGE_INLINE bool may_enter(NodePair pair) {
    if (result_.stop != nullptr && result_.stop->load(std::memory_order_relaxed)) return false;
    if (kSelf && input_.culled.holds(input_.a.nodes.data(), pair)) return false;
    ++result_.counters.node_pairs;
    result_.counters.self_node_pairs += kSelf && pair.a == pair.b;
    return true;
  }

  SELVAGE_INLINE void compare_listed(const NeighbourPair& listed) {
    const NodePair pair = listed.pair;
    const BvhNode &a = input_.a.nodes[pair.a], &b = input_.a.nodes[pair.b];
    std::uint64_t nonadjacent = traversal::meeting_children(a, b) & ~listed.neighbours;
    if (pair.a == pair.b) nonadjacent &= traversal::kAboveDiagonal;
    const std::uint64_t primitives = traversal::primitive_pairs(a, b), neighbours = listed.neighbours & primitives;
    take({pair.a, pair.b, (nonadjacent & primitives) | neighbours}, neighbours);
    if ((nonadjacent & ~primitives) == 0) return;
    traversal::hand_on_children(
        a, b, pair, nonadjacent & ~primitives,
        [&](NodePair next) {
          traversal::prefetch_node(input_.a.nodes[next.a]);
          traversal::prefetch_node(input_.a.nodes[next.b]);
          waiting_[waiting_count_++] = next;
        },
        [](const PrimitivePairs&) {});
  }

  /// Searches below pairs of nonadjacent nodes, which by now are in the caches.
  void search_waiting() {
    for (int i = 0; i < waiting_count_; ++i) search_below<true>(waiting_[i], false);
    waiting_count_ = 0;
  }

  static Index triangle(const SurfaceView& surface, Index primitive) {
    return surface.triangle_of == nullptr ? primitive : surface.triangle_of[primitive];
  }

  SELVAGE_INLINE void take(const PrimitivePairs& pairs, std::uint64_t shared) {
    const BvhNode& a = input_.a.nodes[pairs.first];
    const BvhNode& b = input_.b.nodes[pairs.second];
    result_.counters.box_pairs += count_bits(pairs.bits);
    result_.counters.adjacent_pairs += count_bits(shared);
    const std::uint64_t nonadjacent = pairs.bits & ~shared;
    if (takes_all_)
      disjoint_.add_children(pairs.first, pairs.second, nonadjacent);
    else
      add_each(a, b, nonadjacent, false);
    if (input_.include_adjacent) add_each(a, b, shared, true);
  }

  void add_each(const BvhNode& a, const BvhNode& b, std::uint64_t bits, bool shares) {
    for (; bits != 0; bits &= bits - 1) {
      const int bit = lowest_bit(bits);
      add(triangle(input_.a, a.children[bit / BvhNode::kWidth]), triangle(input_.b, b.children[bit % BvhNode::kWidth]),
          shares);
    }
  }

  void add_adjacent(Index first, Index second) {
    VertexTuple<3> a = input_.a.triangles[first], b = input_.b.triangles[second];
    const int shared = bring_shared_first(a, b);
    if (shared == 1)
      by_vertex_.add(first, second, a, b);
    else if (shared == 2)
      by_edge_.add(first, second, a, b);
    else
      decide_pair(input_, first, second, result_);
  }

  void add(Index first, Index second, bool shares) {
    if (input_.in_subset != nullptr && (first == second || (input_.in_subset[second] != 0 && second < first))) return;
    if (!shares)
      disjoint_.add(first, second);
    else if (input_.include_adjacent)
      add_adjacent(first, second);
  }

  const DiscreteInput& input_;
  DiscreteResult& result_;
  bool takes_all_;  ///< nothing is filtered before the test
  PairBatch disjoint_;
  AdjacentBatch<1> by_vertex_;
  AdjacentBatch<2> by_edge_;
  static constexpr int kMaxWaiting = 16;
  int waiting_count_ = 0;
  NodePair waiting_[kMaxWaiting + BvhNode::kWidth * BvhNode::kWidth];
};

}  // namespace

void find_self_collisions(const DiscreteInput& input, std::span<const SelfPiece> pieces, DiscreteResult& result) {
  Search search(input, result);
  for (const SelfPiece& piece : pieces)
    if (piece.is_listed())
      search.search_listed(piece.first, piece.last);
    else
      search.search_below<true>(piece.pair, piece.may_share);
  search.finish();
}

void find_collisions(const DiscreteInput& input, std::span<const NodePair> pieces, DiscreteResult& result) {
  Search search(input, result);
  for (const NodePair& piece : pieces) search.search_below<false>(piece, input.one_surface);
  search.finish();
}

void test_listed_pairs(const DiscreteInput& input, std::span<const IndexPair> pairs, DiscreteResult& result) {
  Search search(input, result);
  for (const IndexPair& pair : pairs) search.take_pair(pair.first, pair.second);
  search.finish();
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
