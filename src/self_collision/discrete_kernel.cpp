#include "self_collision/discrete_kernel.h"

#include "self_collision/plane_filter.h"
#include "selvage/bvh/traverse_pairs.h"

namespace selvage {
inline namespace SELVAGE_ISA {

namespace {

/// Pairs of triangles whose boxes meet, waiting to be looked at eight at once: first in single precision, with a bound
/// of all rounding, which tells apart nearly all that do not meet; what is left is decided exactly.
template <bool kAdjacent>
class PairBatch {
 public:
  PairBatch(const DiscreteScene& scene, DiscreteResult& result) : scene_(scene), result_(result) {}

  void add(Index first, Index second) {
    first_[count_] = first;
    second_[count_] = second;
    if (++count_ == kSize) flush();
  }

  void flush() {
    if (count_ == 0) return;
    for (int i = count_; i < kSize; ++i) {
      first_[i] = first_[0];
      second_[i] = second_[0];
    }
    const unsigned apart = kAdjacent ? adjacent_apart() : apart_by_planes();
    for (unsigned rest = ~apart & ((1u << count_) - 1); rest != 0; rest &= rest - 1) {
      const int i = lowest_lane(rest);
      decide_pair(scene_, first_[i], second_[i], result_);
    }
    count_ = 0;
  }

 private:
  static constexpr int kSize = 8;

  static void gather(const SurfaceView& surface, const VertexTuple<3> (&vertices)[kSize], WideCorner (&corners)[3]) {
    for (int k = 0; k < 3; ++k) {
      Index lanes[kSize];
      for (int i = 0; i < kSize; ++i) lanes[i] = vertices[i][k];
      corners[k] = gather_corner(surface.rounded, lanes);
    }
  }

  Float8 distance() const {
    if (scene_.a.thickness == nullptr && scene_.b.thickness == nullptr) return Float8::broadcast(0);
    float sums[kSize];
    for (int i = 0; i < kSize; ++i) {
      const float a = scene_.a.thickness != nullptr ? scene_.a.thickness[first_[i]] : 0;
      const float b = scene_.b.thickness != nullptr ? scene_.b.thickness[second_[i]] : 0;
      sums[i] = (a + b) * 1.000001f;
    }
    return Float8::load(sums);
  }

  /// Pairs of which one triangle lies beside the plane of the other.
  unsigned apart_by_planes() const {
    VertexTuple<3> a[kSize], b[kSize];
    for (int i = 0; i < kSize; ++i) {
      a[i] = scene_.a.triangles[first_[i]];
      b[i] = scene_.b.triangles[second_[i]];
    }
    WideCorner corners_a[3], corners_b[3];
    gather(scene_.a, a, corners_a);
    gather(scene_.b, b, corners_b);
    const Float8 away = distance();
    return beside_plane(corners_a, corners_b, away) | beside_plane(corners_b, corners_a, away);
  }

  /// The same for triangles that share vertices: what counts is where the other vertices lie.
  unsigned adjacent_apart() const {
    VertexTuple<3> a[kSize], b[kSize], others_a[kSize], others_b[kSize];
    for (int i = 0; i < kSize; ++i) {
      a[i] = scene_.a.triangles[first_[i]];
      b[i] = scene_.b.triangles[second_[i]];
      others_a[i] = unshared(a[i], b[i]);
      others_b[i] = unshared(b[i], a[i]);
    }
    WideCorner corners_a[3], corners_b[3], rest_a[3], rest_b[3];
    gather(scene_.a, a, corners_a);
    gather(scene_.b, b, corners_b);
    gather(scene_.a, others_a, rest_a);
    gather(scene_.b, others_b, rest_b);
    const Float8 zero = Float8::broadcast(0);
    return beside_plane(corners_a, rest_b, zero) | beside_plane(corners_b, rest_a, zero);
  }

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
  Index first_[kSize];
  Index second_[kSize];
  int count_ = 0;
};

/// One piece of a search: the hierarchy decides which triangles are looked at.
template <bool kSelf>
class Search {
 public:
  Search(const DiscreteScene& scene, DiscreteResult& result)
      : scene_(scene), result_(result), disjoint_(scene, result), adjacent_(scene, result) {}

  void run(NodePair start) {
    NodePair stack[traversal::kPairStackSize];
    stack[0] = start;
    NodePair* top = stack + 1;
    while (top != stack && !is_stopped()) {
      const NodePair pair = *--top;
      ++result_.counters.node_pairs;
      traversal::compare_children<kSelf>(
          scene_.a.nodes, scene_.b.nodes, pair,
          [&](NodePair next) {
            if (is_worth_comparing(next)) *top++ = next;
          },
          [&](const PrimitiveRow& row) { take_row(row); });
    }
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
  bool is_stopped() const { return result_.stop != nullptr && result_.stop->load(std::memory_order_relaxed); }

  /// The one place where a pair of nodes is left out although their boxes meet. The hierarchy alone leaves out none.
  SELVAGE_INLINE static bool is_worth_comparing(NodePair) { return true; }

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
  PairBatch<false> disjoint_;
  PairBatch<true> adjacent_;
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
