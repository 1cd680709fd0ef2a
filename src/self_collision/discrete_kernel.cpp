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

/// Pairs of triangles that share vertices: what counts is where the other vertices lie.
class AdjacentBatch {
 public:
  AdjacentBatch(const DiscreteScene& scene, DiscreteResult& result) : scene_(scene), result_(result) {}

  void add(Index first, Index second) {
    if (pairs_.add(first, second)) flush();
  }

  void flush() {
    if (pairs_.count == 0) return;
    const unsigned lanes = pairs_.fill();
    EightTriangles others_a, others_b;
    for (int i = 0; i < EightPairs::kSize; ++i) {
      const VertexTuple<3>& of_a = scene_.a.triangles[pairs_.first[i]];
      const VertexTuple<3>& of_b = scene_.b.triangles[pairs_.second[i]];
      others_a[i] = unshared(of_a, of_b);
      others_b[i] = unshared(of_b, of_a);
    }
    WideCorner a[3], b[3], rest_a[3], rest_b[3];
    gather_pairs(scene_, pairs_, a, b);
    gather_triangles(scene_.a, others_a, rest_a);
    gather_triangles(scene_.b, others_b, rest_b);
    const Float8 zero = Float8::broadcast(0);
    const unsigned apart = beside_plane(a, rest_b, zero) | beside_plane(b, rest_a, zero);
    decide_all(scene_, pairs_, lanes & ~apart, result_);
    pairs_.count = 0;
  }

 private:
  /// The vertices of t that are none of u, some twice to make three; t where there is none.
  static VertexTuple<3> unshared(const VertexTuple<3>& t, const VertexTuple<3>& u) {
    VertexTuple<3> others = t;
    int count = 0;
    for (int i = 0; i < 3; ++i)
      if (t[i] != u[0] && t[i] != u[1] && t[i] != u[2]) others[count++] = t[i];
    for (int i = count; i > 0 && i < 3; ++i) others[i] = others[0];
    return others;
  }

  const DiscreteScene& scene_;
  DiscreteResult& result_;
  EightPairs pairs_;
};

/// One piece of a search: the hierarchy decides which triangles are looked at.
template <bool kSelf>
class Search {
 public:
  Search(const DiscreteScene& scene, DiscreteResult& result)
      : scene_(scene), result_(result), disjoint_(scene, result), adjacent_(scene, result) {}

  void run(NodePair start) {
    traversal::visit_rows<kSelf>(
        scene_.a.nodes, scene_.b.nodes, start, [&](NodePair pair) { return enter(pair); },
        [&](const PrimitiveRow& row) { take_row(row); });
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
    adjacent_.flush();
  }

 private:
  /// The one place where a pair of nodes is left out although their boxes meet.
  SELVAGE_INLINE bool enter(NodePair pair) {
    if (result_.stop != nullptr && result_.stop->load(std::memory_order_relaxed)) return false;
    if (kSelf && scene_.spared.do_hold(scene_.a.nodes.data(), pair)) return false;
    ++result_.counters.node_pairs;
    return true;
  }

  static Index triangle(const SurfaceView& surface, Index primitive) {
    return surface.triangle_of == nullptr ? primitive : surface.triangle_of[primitive];
  }

  SELVAGE_INLINE void take_row(const PrimitiveRow& row) {
    const SurfaceView& own = row.swapped ? scene_.b : scene_.a;
    const SurfaceView& other = row.swapped ? scene_.a : scene_.b;
    const Index t = triangle(own, row.primitive);
    const unsigned shared = scene_.one_surface ? sharing_lanes(own.triangles[t], other.leaves[row.node]) : 0;
    result_.counters.box_pairs += count_lanes(row.lanes);
    result_.counters.adjacent_pairs += count_lanes(row.lanes & shared);
    const BvhNode& node = other.nodes[row.node];
    const unsigned wanted = scene_.include_adjacent ? row.lanes : row.lanes & ~shared;
    for (unsigned rest = wanted; rest != 0; rest &= rest - 1) {
      const int lane = lowest_lane(rest);
      const Index u = triangle(other, node.children[lane]);
      const bool shares = (shared >> lane & 1) != 0;
      row.swapped ? add(u, t, shares) : add(t, u, shares);
    }
  }

  /// Children of a node that have a vertex of the triangle.
  SELVAGE_INLINE static unsigned sharing_lanes(const VertexTuple<3>& vertices, const LeafVertices& leaves) {
    unsigned lanes = 0;
    for (int l = 0; l < 3; ++l) {
      const Float8 corner = Float8::load(reinterpret_cast<const float*>(leaves.corners[l]));
      for (int k = 0; k < 3; ++k) lanes |= equal_bits(corner, Float8::broadcast(std::bit_cast<float>(vertices[k])));
    }
    return lanes;
  }

  void add(Index first, Index second, bool shares) {
    if (scene_.in_subset != nullptr && (first == second || (scene_.in_subset[second] != 0 && second < first))) return;
    if (!shares)
      disjoint_.add(first, second);
    else if (scene_.include_adjacent)
      adjacent_.add(first, second);
  }

  const DiscreteScene& scene_;
  DiscreteResult& result_;
  PairBatch disjoint_;
  AdjacentBatch adjacent_;
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
