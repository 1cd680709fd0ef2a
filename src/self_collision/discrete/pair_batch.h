#pragma once

#include "core/simd/simd16.h"
#include "self_collision/discrete/crossing_filter.h"
#include "self_collision/discrete/discrete_kernel.h"
#include "self_collision/discrete/leaf_faces.h"
#include "self_collision/surface/eight_pairs.h"

#include <tuple>

namespace selvage {
inline namespace SELVAGE_ISA {

/// @param triangle  `const VertexTuple<3>& triangle(int lane)`
template <typename Triangle>
SELVAGE_INLINE void gather_triangles(const SurfaceView& surface, Triangle&& triangle, WideVec3 (&corners)[3]) {
  for (int k = 0; k < 3; ++k) corners[k] = gather_corner(surface.rounded, [&](int lane) { return triangle(lane)[k]; });
}

/// Triangles named by their indices.
struct ByTriangle {
  SELVAGE_INLINE static Index vertex(const SurfaceView& surface, Index id, int corner) {
    return surface.triangles[id][corner];
  }
  SELVAGE_INLINE static Index triangle(const SurfaceView&, Index id) { return id; }
};

/// Triangles named by their places in the leaves: eight times the number of the node, plus that of the child. Their
/// vertices are in the cache while the search is at the node.
struct ByLeaf {
  SELVAGE_INLINE static Index vertex(const SurfaceView& surface, Index id, int corner) {
    return surface.leaves[node(id)].corners[corner][child(id)];
  }
  SELVAGE_INLINE static Index triangle(const SurfaceView& surface, Index id) {
    const Index primitive = surface.nodes[node(id)].children[child(id)];
    return surface.triangle_of == nullptr ? primitive : surface.triangle_of[primitive];
  }

 private:
  SELVAGE_INLINE static std::uint32_t node(Index id) { return static_cast<std::uint32_t>(id) / BvhNode::kWidth; }
  SELVAGE_INLINE static std::uint32_t child(Index id) { return static_cast<std::uint32_t>(id) % BvhNode::kWidth; }
};

/// The corners of eight pairs of triangles.
///
/// @tparam Naming  ByTriangle or ByLeaf
template <typename Naming>
struct WidePairs {
  WideVec3 a[3], b[3];

  SELVAGE_INLINE WidePairs(const DiscreteInput& input, const Index* first, const Index* second) {
    for (int k = 0; k < 3; ++k) {
      a[k] = gather_corner(input.a.rounded, [&](int lane) { return Naming::vertex(input.a, first[lane], k); });
      b[k] = gather_corner(input.b.rounded, [&](int lane) { return Naming::vertex(input.b, second[lane], k); });
    }
  }
};

/// Pairs of triangles that wait to be tested in groups.
class PairQueue {
 public:
  /// Returns whether it is time to take groups out.
  SELVAGE_INLINE bool add(Index first, Index second) {
    first_[count_] = first;
    second_[count_] = second;
    return ++count_ >= kFlushAt;
  }

  /// Adds the lanes of a mask.
  SELVAGE_INLINE bool add_lanes(Int8 first, Int8 second, unsigned lanes) {
    store_packed(first, lanes, first_ + count_);
    store_packed(second, lanes, second_ + count_);
    count_ += count_lanes(lanes);
    return count_ >= kFlushAt;
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

  /// Takes out all pairs.
  ///
  /// @param take  `take(Index* first, Index* second, int count)`, which may change them
  template <typename Take>
  SELVAGE_INLINE void take_at_once(Take&& take) {
    take(first_, second_, count_);
    count_ = 0;
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
  static constexpr int kGroup = 8, kFlushAt = 64;
  int count_ = 0;
  Index first_[kFlushAt + kGroup], second_[kFlushAt + kGroup];
};

/// Pairs of children of two nodes that wait to be compared.
class ChildrenQueue {
 public:
  /// Adds pairs of children of two nodes. Returns whether it is time to take all out. Most nodes have no such
  /// pair, and which ones do is hard to predict for a branch.
  SELVAGE_INLINE bool add(Index a, Index b, std::uint64_t pairs) {
    waiting_[count_] = {a, b, pairs};
    count_ += pairs != 0;
    return count_ == kFlushAt;
  }

  /// Takes all out.
  ///
  /// @param test  `test(Index a, Index b, const std::int32_t* pairs, int count)`, each eight times the child of a and
  ///              that of b; up to seven more can be read
  template <typename Test>
  SELVAGE_INLINE void take_all(Test&& test) {
    int ends[kFlushAt];
    for (int i = 0, end = 0; i < count_; ++i) ends[i] = end += store_bit_numbers(waiting_[i].pairs, numbers_ + end);
    for (int i = 0, begin = 0; i < count_; begin = ends[i++])
      test(waiting_[i].a, waiting_[i].b, numbers_ + begin, ends[i] - begin);
    count_ = 0;
  }

 private:
  static constexpr int kFlushAt = 32, kMaxOfTwo = BvhNode::kWidth * BvhNode::kWidth;
  struct Children {
    Index a, b;
    std::uint64_t pairs;
  };
  int count_ = 0;
  Children waiting_[kFlushAt];
  std::int32_t numbers_[kFlushAt * kMaxOfTwo + 16] = {};
};

/// The mask of the first so many lanes of eight, or of all.
SELVAGE_INLINE unsigned first_lanes(int count) {
  return count < BvhNode::kWidth ? (1u << count) - 1 : 0xff;
}

/// Decides pairs exactly, one by one.
inline void decide_all(const DiscreteInput& input, const Index* first, const Index* second, unsigned lanes,
                       DiscreteResult& result) {
  for (; lanes != 0; lanes &= lanes - 1)
    decide_pair(input, first[lowest_lane(lanes)], second[lowest_lane(lanes)], result);
}

/// Pairs of triangles without a common vertex whose boxes meet, tested eight at once in single precision with a bound
/// of all rounding. The planes of both separate nearly all pairs that do not meet. Nearly all pairs that cross are
/// recognised as such. Directions of edges separate most of the rest. Pairs that remain are decided exactly.
class PairBatch {
  /// Pairs that are close, and those of them that cross.
  template <typename Naming>
  struct Close {
    PairQueue close, crossing;
  };

  auto planes() {
    return [this](const Index* first, const Index* second, unsigned lanes) { test_planes(first, second, lanes); };
  }
  template <typename Naming>
  auto crossing() {
    return [this](const Index* first, const Index* second, unsigned lanes) {
      test_crossing<Naming>(first, second, lanes);
    };
  }
  auto edges() {
    return [this](const Index* first, const Index* second, unsigned lanes) { test_edges(first, second, lanes); };
  }

 public:
  PairBatch(const DiscreteInput& input, DiscreteResult& result)
      : input_(input),
        result_(result),
        is_self_(input.a.leaves == input.b.leaves),
        has_thickness_(input.a.thickness != nullptr || input.b.thickness != nullptr),
        faces_of_a_(input.a.rounded, input.a.leaves),
        faces_of_b_(input.b.rounded, input.b.leaves) {}

  SELVAGE_INLINE void add(Index first, Index second) {
    if (met_.add(first, second)) met_.take_groups(planes());
  }
  /// Adds those pairs of children of two nodes that are in the mask.
  SELVAGE_INLINE void add_children(Index a, Index b, std::uint64_t bits) {
    if (children_.add(a, b, bits)) test_faces();
  }

  void flush() {
    met_.take_all(planes());
    test_faces();
    flush_close<ByTriangle>();
    flush_close<ByLeaf>();
    undecided_.take_all(edges());
  }

 private:
  void test_faces() {
    children_.take_all([this](Index a, Index b, const std::int32_t* pairs, int count) {
      const LeafFaces& of_a = faces_of_a_.of(a);
      const LeafFaces& of_b = is_self_ ? faces_of_a_.of(b, a) : faces_of_b_.of(b);
      const Int8 first_of_a = Int8::broadcast(a * BvhNode::kWidth), first_of_b = Int8::broadcast(b * BvhNode::kWidth);
      for (int i = 0; i < count; i += BvhNode::kWidth) {
        const Int8 k = Int8::load(pairs + i), row = shift_right<3>(k);
        const unsigned close = first_lanes(count - i) & ~beside_faces(of_a, row, of_b, k);
        add_close<ByLeaf>(first_of_a | row, first_of_b | (k & Int8::broadcast(7)), close);
      }
    });
  }

  void test_planes(const Index* first, const Index* second, unsigned lanes) {
    const WidePairs<ByTriangle> pairs(input_, first, second);
    unsigned apart;
    if (has_thickness_) {
      const Float8 away = distance(first, second);
      apart = beside_plane(pairs.a, pairs.b, away) | beside_plane(pairs.b, pairs.a, away);
    } else {
      apart = beside_plane(pairs.a, pairs.b) | beside_plane(pairs.b, pairs.a);
    }
    add_close<ByTriangle>(Int8::load(first), Int8::load(second), lanes & ~apart);
  }

  template <typename Naming>
  SELVAGE_INLINE void add_close(Int8 first, Int8 second, unsigned lanes) {
    PairQueue& close = std::get<Close<Naming>>(close_).close;
    if (close.add_lanes(first, second, lanes)) close.take_groups(crossing<Naming>());
  }

  template <typename Naming>
  void flush_close() {
    std::get<Close<Naming>>(close_).close.take_all(crossing<Naming>());
    take_crossing<Naming>();
  }

  template <typename Naming>
  void test_crossing(const Index* first, const Index* second, unsigned lanes) {
    const WidePairs<Naming> pairs(input_, first, second);
    const CertainLanes certain = tell_crossing(pairs.a, pairs.b);
    PairQueue& crossing = std::get<Close<Naming>>(close_).crossing;
    if (crossing.add_lanes(Int8::load(first), Int8::load(second), lanes & certain.cross) || result_.stop != nullptr)
      take_crossing<Naming>();
    // With a thickness, pairs that lie apart may be too near.
    for (unsigned rest = lanes & ~certain.cross & ~(has_thickness_ ? 0 : certain.apart); rest != 0; rest &= rest - 1) {
      const int lane = lowest_lane(rest);
      if (undecided_.add(Naming::triangle(input_.a, first[lane]), Naming::triangle(input_.b, second[lane])))
        undecided_.take_groups(edges());
    }
  }

  template <typename Naming>
  void take_crossing() {
    std::get<Close<Naming>>(close_).crossing.take_at_once([&](Index* first, Index* second, int count) {
      for (int i = 0; i < count; ++i) {
        first[i] = Naming::triangle(input_.a, first[i]);
        second[i] = Naming::triangle(input_.b, second[i]);
      }
      take_crossing_pairs(input_, first, second, count, result_);
    });
  }

  void test_edges(const Index* first, const Index* second, unsigned lanes) {
    const WidePairs<ByTriangle> pairs(input_, first, second);
    const Float8 away = has_thickness_ ? distance(first, second) : Float8::broadcast(0);
    decide_all(input_, first, second, lanes & ~apart_by_edges(pairs.a, pairs.b, away), result_);
  }

  /// The sum of the thickness of both, rounded up.
  Float8 distance(const Index* first, const Index* second) const {
    float sums[EightPairs::kSize];
    for (int i = 0; i < EightPairs::kSize; ++i) {
      const float a = input_.a.thickness != nullptr ? input_.a.thickness[first[i]] : 0;
      const float b = input_.b.thickness != nullptr ? input_.b.thickness[second[i]] : 0;
      sums[i] = (a + b) * 1.000001f;
    }
    return Float8::load(sums);
  }

  const DiscreteInput& input_;
  DiscreteResult& result_;
  bool is_self_, has_thickness_;
  FaceCache faces_of_a_, faces_of_b_;
  ChildrenQueue children_;
  PairQueue met_, undecided_;
  std::tuple<Close<ByTriangle>, Close<ByLeaf>> close_;
};

}  // namespace SELVAGE_ISA
}  // namespace selvage
