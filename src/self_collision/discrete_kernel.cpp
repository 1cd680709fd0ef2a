#include "self_collision/discrete_kernel.h"

#include "self_collision/eight_pairs.h"
#include "self_collision/plane_filter.h"
#include "selvage/bvh/traverse_pairs.h"

namespace selvage {
inline namespace SELVAGE_ISA {

namespace {

using EightTriangles = VertexTuple<3>[EightPairs::kSize];

void gather_triangles(const SurfaceView& surface, const EightTriangles& triangles, WideCorner (&corners)[3]) {
  for (int k = 0; k < 3; ++k) {
    Index lanes[EightPairs::kSize];
    for (int i = 0; i < EightPairs::kSize; ++i) lanes[i] = triangles[i][k];
    corners[k] = gather_corner(surface.rounded, lanes);
  }
}

void gather_pairs(const DiscreteScene& scene, const EightPairs& pairs, WideCorner (&a)[3], WideCorner (&b)[3]) {
  EightTriangles of_a, of_b;
  for (int i = 0; i < EightPairs::kSize; ++i) {
    of_a[i] = scene.a.triangles[pairs.first[i]];
    of_b[i] = scene.b.triangles[pairs.second[i]];
  }
  gather_triangles(scene.a, of_a, a);
  gather_triangles(scene.b, of_b, b);
}

/// What decides pairs exactly, one by one.
void decide_all(const DiscreteScene& scene, const EightPairs& pairs, unsigned lanes, DiscreteResult& result) {
  for (; lanes != 0; lanes &= lanes - 1)
    decide_pair(scene, pairs.first[lowest_lane(lanes)], pairs.second[lowest_lane(lanes)], result);
}

/// Pairs of triangles without a common vertex whose boxes meet, looked at eight at once: first the planes of both tell
/// apart nearly all that do not meet, then their edges most of the rest, in single precision with a bound of all
/// rounding; what is left is decided exactly.
class PairBatch {
 public:
  PairBatch(const DiscreteScene& scene, DiscreteResult& result) : scene_(scene), result_(result) {}

  SELVAGE_INLINE void add(Index first, Index second) {
    if (pairs_.add(first, second)) test_planes();
  }

  void flush() {
    if (pairs_.count > 0) test_planes();
    if (close_.count > 0) test_edges();
  }

 private:
  void test_planes() {
    const unsigned lanes = pairs_.fill();
    WideCorner a[3], b[3];
    gather_pairs(scene_, pairs_, a, b);
    const Float8 away = distance(pairs_);
    const unsigned apart = beside_plane(a, b, away) | beside_plane(b, a, away);
    for (unsigned rest = lanes & ~apart; rest != 0; rest &= rest - 1) {
      const int i = lowest_lane(rest);
      if (close_.add(pairs_.first[i], pairs_.second[i])) test_edges();
    }
    pairs_.count = 0;
  }

  void test_edges() {
    const unsigned lanes = close_.fill();
    WideCorner a[3], b[3];
    gather_pairs(scene_, close_, a, b);
    decide_all(scene_, close_, lanes & ~apart_by_edges(a, b, distance(close_)), result_);
    close_.count = 0;
  }

  /// How far apart is far enough.
  Float8 distance(const EightPairs& pairs) const {
    if (scene_.a.thickness == nullptr && scene_.b.thickness == nullptr) return Float8::broadcast(0);
    float sums[EightPairs::kSize];
    for (int i = 0; i < EightPairs::kSize; ++i) {
      const float a = scene_.a.thickness != nullptr ? scene_.a.thickness[pairs.first[i]] : 0;
      const float b = scene_.b.thickness != nullptr ? scene_.b.thickness[pairs.second[i]] : 0;
      sums[i] = (a + b) * 1.000001f;
    }
    return Float8::load(sums);
  }

  const DiscreteScene& scene_;
  DiscreteResult& result_;
  EightPairs pairs_, close_;
};

/// Pairs of triangles that share kShared vertices: what counts is where the other vertices lie.
template <int kShared>
class AdjacentBatch {
 public:
  AdjacentBatch(const DiscreteScene& scene, DiscreteResult& result) : scene_(scene), result_(result) {}

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
    WideCorner a[3], b[3];
    gather_triangles(scene_.a, a_, a);
    gather_triangles(scene_.b, b_, b);
    const WideCorner rest_a[3] = {a[kShared], a[2], a[2]}, rest_b[3] = {b[kShared], b[2], b[2]};
    const Float8 zero = Float8::broadcast(0);
    unsigned apart = beside_plane(a, rest_b, zero) | beside_plane(b, rest_a, zero);
    // What lies flat beside its neighbour is not beside its plane.
    if constexpr (kShared == 1)
      apart |= apart_but_for_vertex({a[1] - a[0], a[2] - a[0]}, {b[1] - a[0], b[2] - a[0]});
    else
      apart |= apart_but_for_edge(a[1] - a[0], a[2] - a[0], b[2] - a[0]);
    decide_all(scene_, pairs_, lanes & ~apart, result_);
    pairs_.count = 0;
  }

 private:
  const DiscreteScene& scene_;
  DiscreteResult& result_;
  EightPairs pairs_;
  EightTriangles a_, b_;
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

/// One piece of a search: the hierarchy decides which triangles are looked at.
template <bool kSelf>
class Search {
 public:
  Search(const DiscreteScene& scene, DiscreteResult& result)
      : scene_(scene), result_(result), disjoint_(scene, result), by_vertex_(scene, result), by_edge_(scene, result) {}

  void run(NodePair start) {
    traversal::visit_meeting<kSelf>(
        scene_.a.nodes, scene_.b.nodes, start, [&](NodePair pair) { return enter(pair); },
        [&](const PrimitivePairs& pairs) { take(pairs); });
    finish();
  }

  /// A pair of primitives whose boxes meet.
  void take_pair(Index i, Index j) {
    const Index first = triangle(scene_.a, i), second = triangle(scene_.b, j);
    bool shares = false;
    if (scene_.one_surface)
      for (const Index v : scene_.a.triangles[first])
        for (const Index w : scene_.b.triangles[second]) shares |= v == w;
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
  /// The one place where a pair of nodes is left out although their boxes meet.
  SELVAGE_INLINE bool enter(NodePair pair) {
    if (result_.stop != nullptr && result_.stop->load(std::memory_order_relaxed)) return false;
    if (kSelf && scene_.spared.do_hold(scene_.a.nodes.data(), pair)) return false;
    for (const LeafVertices* leaves : {scene_.a.leaves + pair.a, scene_.b.leaves + pair.b}) {
      prefetch(leaves);
      prefetch(leaves->corners[2]);
    }
    ++result_.counters.node_pairs;
    result_.counters.self_node_pairs += kSelf && pair.a == pair.b;
    return true;
  }

  static Index triangle(const SurfaceView& surface, Index primitive) {
    return surface.triangle_of == nullptr ? primitive : surface.triangle_of[primitive];
  }

  SELVAGE_INLINE void take(const PrimitivePairs& pairs) {
    const BvhNode& a = scene_.a.nodes[pairs.first];
    const BvhNode& b = scene_.b.nodes[pairs.second];
    const std::uint64_t shared =
        scene_.one_surface ? pairs.bits & sharing_pairs(scene_.a.leaves[pairs.first], scene_.b.leaves[pairs.second])
                           : 0;
    result_.counters.box_pairs += count_bits(pairs.bits);
    result_.counters.adjacent_pairs += count_bits(shared);
    const std::uint64_t wanted = scene_.include_adjacent ? pairs.bits : pairs.bits & ~shared;
    for (std::uint64_t rest = wanted; rest != 0; rest &= rest - 1) {
      const int bit = lowest_bit(rest);
      add(triangle(scene_.a, a.children[bit / BvhNode::kWidth]), triangle(scene_.b, b.children[bit % BvhNode::kWidth]),
          (shared >> bit & 1) != 0);
    }
  }

  /// Children of two nodes that have a vertex in common, as bits of pairs.
  SELVAGE_INLINE static std::uint64_t sharing_pairs(const LeafVertices& a, const LeafVertices& b) {
    const auto corners = [](const LeafVertices& leaves, int l) {
      return Float8::load(reinterpret_cast<const float*>(leaves.corners[l]));
    };
    const Float8 of_b[3] = {corners(b, 0), corners(b, 1), corners(b, 2)};
    std::uint64_t bits = 0;
    for (int i = 0; i < BvhNode::kWidth; ++i) {
      Float8 lanes = Float8::broadcast(0);
      for (int k = 0; k < 3; ++k) {
        const Float8 corner = Float8::broadcast(std::bit_cast<float>(a.corners[k][i]));
        for (int l = 0; l < 3; ++l) lanes = or_bits(lanes, equal_lanes(corner, of_b[l]));
      }
      bits |= std::uint64_t{sign_bits(lanes)} << BvhNode::kWidth * i;
    }
    return bits;
  }

  void add_adjacent(Index first, Index second) {
    VertexTuple<3> a = scene_.a.triangles[first], b = scene_.b.triangles[second];
    const int shared = bring_shared_first(a, b);
    if (shared == 1)
      by_vertex_.add(first, second, a, b);
    else if (shared == 2)
      by_edge_.add(first, second, a, b);
    else
      decide_pair(scene_, first, second, result_);
  }

  void add(Index first, Index second, bool shares) {
    if (scene_.in_subset != nullptr && (first == second || (scene_.in_subset[second] != 0 && second < first))) return;
    if (!shares)
      disjoint_.add(first, second);
    else if (scene_.include_adjacent)
      add_adjacent(first, second);
  }

  const DiscreteScene& scene_;
  DiscreteResult& result_;
  PairBatch disjoint_;
  AdjacentBatch<1> by_vertex_;
  AdjacentBatch<2> by_edge_;
};

}  // namespace

void find_self_collisions(const DiscreteScene& scene, NodePair start, DiscreteResult& result) {
  Search<true>(scene, result).run(start);
}

void find_collisions(const DiscreteScene& scene, NodePair start, DiscreteResult& result) {
  Search<false>(scene, result).run(start);
}

void test_listed_pairs(const DiscreteScene& scene, std::span<const IndexPair> pairs, DiscreteResult& result) {
  Search<false> search(scene, result);
  for (const IndexPair& pair : pairs) search.take_pair(pair.first, pair.second);
  search.finish();
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
