#pragma once

#include "self_collision/crossing_filter.h"
#include "self_collision/discrete_kernel.h"
#include "self_collision/eight_pairs.h"
#include "self_collision/leaf_faces.h"
#include "selvage/core/simd16.h"

namespace selvage {
inline namespace SELVAGE_ISA {

/// @param triangle  `const VertexTuple<3>& triangle(int lane)`
template <typename Triangle>
SELVAGE_INLINE void gather_triangles(const SurfaceView& surface, Triangle&& triangle, WideCorner (&corners)[3]) {
  for (int k = 0; k < 3; ++k) corners[k] = gather_corner(surface.rounded, [&](int lane) { return triangle(lane)[k]; });
}

/// The corners of eight pairs of triangles.
struct WidePairs {
  WideCorner a[3], b[3];

  SELVAGE_INLINE WidePairs(const DiscreteScene& scene, const Index* first, const Index* second) {
    const VertexTuple<3>* const of_a = scene.a.triangles;
    const VertexTuple<3>* const of_b = scene.b.triangles;
    gather_triangles(
        scene.a, [&](int lane) -> const VertexTuple<3>& { return of_a[first[lane]]; }, a);
    gather_triangles(
        scene.b, [&](int lane) -> const VertexTuple<3>& { return of_b[second[lane]]; }, b);
  }
};

/// Pairs of triangles that wait to be looked at in groups.
class PairQueue {
 public:
  /// Returns whether there are many.
  SELVAGE_INLINE bool add(Index first, Index second) {
    first_[count_] = first;
    second_[count_] = second;
    return ++count_ >= kMany;
  }

  /// Adds the lanes of a mask.
  SELVAGE_INLINE bool add_lanes(Int8 first, Int8 second, unsigned lanes) {
    store_packed(first, lanes, first_ + count_);
    store_packed(second, lanes, second_ + count_);
    count_ += count_lanes(lanes);
    return count_ >= kMany;
  }

  /// Takes out groups of eight pairs.
  ///
  /// @param test  `test(const Index* first, const Index* second, unsigned lanes)`: the lanes that count
  template <typename Test>
  SELVAGE_INLINE void take_groups(Test&& test) {
    int start = 0;
    for (; start + kGroup <= count_; start += kGroup) test(first_ + start, second_ + start, (1u << kGroup) - 1);
    for (int i = 0; start + i < count_; ++i) {
      first_[i] = first_[start + i];
      second_[i] = second_[start + i];
    }
    count_ -= start;
  }

  /// Takes out all pairs, the last ones in a group that the first of them fills.
  template <typename Test>
  SELVAGE_INLINE void take_all(Test&& test) {
    take_groups(test);
    if (count_ == 0) return;
    for (int i = count_; i < kGroup; ++i) {
      first_[i] = first_[0];
      second_[i] = second_[0];
    }
    test(first_, second_, (1u << count_) - 1);
    count_ = 0;
  }

 private:
  static constexpr int kGroup = 8, kMany = 64;
  int count_ = 0;
  Index first_[kMany + kGroup], second_[kMany + kGroup];
};

/// Triangles of a node that wait to be compared with some of another. Nothing is a branch: how many there are of two
/// nodes is never the same.
class RowQueue {
 public:
  /// Adds pairs of children of two nodes. Returns whether there are many.
  SELVAGE_INLINE bool add(Index a, Index b, std::uint64_t pairs) {
    alignas(32) static constexpr std::int32_t kRowNumbers[8] = {0, 0x100, 0x200, 0x300, 0x400, 0x500, 0x600, 0x700};
    nodes_[node_pairs_][0] = a;
    nodes_[node_pairs_][1] = b;
    const Int8 lanes = Int8::from_bytes(pairs);
    const unsigned rows = ~zero(lanes) & 0xffu;
    store_packed(lanes | Int8::load(kRowNumbers) | Int8::broadcast(node_pairs_ << 16), rows, rows_ + count_);
    count_ += count_lanes(rows);
    node_pairs_ += pairs != 0;
    return count_ >= kMany;
  }

  /// Takes all out.
  ///
  /// @param test  `test(Index a, Index b, int child of a, unsigned children of b)`
  template <typename Test>
  SELVAGE_INLINE void take_all(Test&& test) {
    for (int i = 0; i < count_; ++i) {
      const Index* const nodes = nodes_[rows_[i] >> 16];
      test(nodes[0], nodes[1], rows_[i] >> 8 & 0xff, static_cast<unsigned>(rows_[i] & 0xff));
    }
    count_ = node_pairs_ = 0;
  }

 private:
  static constexpr int kMany = 64, kRoom = kMany + BvhNode::kWidth;
  int count_ = 0, node_pairs_ = 0;
  Index nodes_[kRoom][2];
  std::int32_t rows_[kRoom];  ///< children of b, child of a << 8, number of the two nodes << 16
};

/// What decides pairs exactly, one by one.
inline void decide_all(const DiscreteScene& scene, const Index* first, const Index* second, unsigned lanes,
                       DiscreteResult& result) {
  for (; lanes != 0; lanes &= lanes - 1)
    decide_pair(scene, first[lowest_lane(lanes)], second[lowest_lane(lanes)], result);
}

/// Pairs of triangles without a common vertex whose boxes meet, looked at eight at once in single precision with a
/// bound of all rounding: the planes of both tell apart nearly all that do not meet; nearly all that cross certainly
/// do; the edges tell apart most of the rest. What is left is decided exactly.
class PairBatch {
  auto planes() {
    return [this](const Index* first, const Index* second, unsigned lanes) { test_planes(first, second, lanes); };
  }
  auto crossing() {
    return [this](const Index* first, const Index* second, unsigned lanes) { test_crossing(first, second, lanes); };
  }
  auto edges() {
    return [this](const Index* first, const Index* second, unsigned lanes) { test_edges(first, second, lanes); };
  }

 public:
  PairBatch(const DiscreteScene& scene, DiscreteResult& result)
      : scene_(scene),
        result_(result),
        is_self_(scene.a.leaves == scene.b.leaves),
        has_thickness_(scene.a.thickness != nullptr || scene.b.thickness != nullptr),
        faces_of_a_(scene.a.rounded, scene.a.leaves),
        faces_of_b_(scene.b.rounded, scene.b.leaves) {}

  SELVAGE_INLINE void add(Index first, Index second) {
    if (met_.add(first, second)) met_.take_groups(planes());
  }
  /// Adds those pairs of children of two nodes that are in the mask, told apart by the faces of both.
  SELVAGE_INLINE void add_children(Index a, Index b, std::uint64_t bits) {
    if (rows_.add(a, b, bits)) test_faces();
  }

  void flush() {
    met_.take_all(planes());
    test_faces();
    close_.take_all(crossing());
    unclear_.take_all(edges());
  }

 private:
  void test_faces() {
    rows_.take_all([this](Index a, Index b, int row, unsigned lanes) {
      const unsigned close =
          lanes & ~beside_faces(faces_of_a_.of(a), row, is_self_ ? faces_of_a_.of(b, a) : faces_of_b_.of(b));
      if (close_.add_lanes(Int8::broadcast(scene_.a.nodes[a].children[row]), Int8::load(scene_.b.nodes[b].children),
                           close))
        close_.take_groups(crossing());
    });
  }

  void test_planes(const Index* first, const Index* second, unsigned lanes) {
    const WidePairs pairs(scene_, first, second);
    unsigned apart;
    if (has_thickness_) {
      const Float8 away = distance(first, second);
      apart = beside_plane(pairs.a, pairs.b, away) | beside_plane(pairs.b, pairs.a, away);
    } else {
      apart = beside_plane(pairs.a, pairs.b) | beside_plane(pairs.b, pairs.a);
    }
    if (close_.add_lanes(Int8::load(first), Int8::load(second), lanes & ~apart)) close_.take_groups(crossing());
  }

  void test_crossing(const Index* first, const Index* second, unsigned lanes) {
    const WidePairs pairs(scene_, first, second);
    const CertainLanes certain = tell_crossing(pairs.a, pairs.b);
    for (unsigned rest = lanes & certain.cross; rest != 0; rest &= rest - 1)
      take_crossing_pair(scene_, first[lowest_lane(rest)], second[lowest_lane(rest)], result_);
    // What lies apart may be too near.
    const unsigned unclear = lanes & ~certain.cross & ~(has_thickness_ ? 0 : certain.apart);
    if (unclear_.add_lanes(Int8::load(first), Int8::load(second), unclear)) unclear_.take_groups(edges());
  }

  void test_edges(const Index* first, const Index* second, unsigned lanes) {
    const WidePairs pairs(scene_, first, second);
    const Float8 away = has_thickness_ ? distance(first, second) : Float8::broadcast(0);
    decide_all(scene_, first, second, lanes & ~apart_by_edges(pairs.a, pairs.b, away), result_);
  }

  /// How far apart is far enough.
  Float8 distance(const Index* first, const Index* second) const {
    float sums[EightPairs::kSize];
    for (int i = 0; i < EightPairs::kSize; ++i) {
      const float a = scene_.a.thickness != nullptr ? scene_.a.thickness[first[i]] : 0;
      const float b = scene_.b.thickness != nullptr ? scene_.b.thickness[second[i]] : 0;
      sums[i] = (a + b) * 1.000001f;
    }
    return Float8::load(sums);
  }

  const DiscreteScene& scene_;
  DiscreteResult& result_;
  bool is_self_, has_thickness_;
  FaceCache faces_of_a_, faces_of_b_;
  RowQueue rows_;
  PairQueue met_, close_, unclear_;
};

}  // namespace SELVAGE_ISA
}  // namespace selvage
