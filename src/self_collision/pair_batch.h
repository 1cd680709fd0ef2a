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

/// Triangles known by their numbers.
struct ByTriangle {
  SELVAGE_INLINE static Index vertex(const SurfaceView& surface, Index id, int corner) {
    return surface.triangles[id][corner];
  }
  SELVAGE_INLINE static Index triangle(const SurfaceView&, Index id) { return id; }
};

/// Triangles known by their places in the leaves, eight times the number of a node and that of the child: what is asked
/// of them soon after the node was is still near.
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
/// @tparam Known  by what they are known
template <typename Known>
struct WidePairs {
  WideCorner a[3], b[3];

  SELVAGE_INLINE WidePairs(const DiscreteScene& scene, const Index* first, const Index* second) {
    for (int k = 0; k < 3; ++k) {
      a[k] = gather_corner(scene.a.rounded, [&](int lane) { return Known::vertex(scene.a, first[lane], k); });
      b[k] = gather_corner(scene.b.rounded, [&](int lane) { return Known::vertex(scene.b, second[lane], k); });
    }
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

/// Pairs of children of two nodes that wait to be compared. Nothing is a branch: how many there are of two nodes is
/// never the same.
class ChildrenQueue {
 public:
  /// Adds pairs of children of two nodes. Returns whether there are many.
  SELVAGE_INLINE bool add(Index a, Index b, std::uint64_t pairs) {
    const int added = store_bit_numbers(pairs, numbers_ + count_);
    count_ += added;
    node_pairs_[node_count_] = {a, b, count_};
    node_count_ += added != 0;
    return count_ >= kMany;
  }

  /// Takes all out.
  ///
  /// @param test  `test(Index a, Index b, std::span<const std::int32_t> pairs)`, eight times the child of a and that of
  ///              b; seven more can be read
  template <typename Test>
  SELVAGE_INLINE void take_all(Test&& test) {
    int first = 0;
    for (int i = 0; i < node_count_; ++i) {
      const auto [a, b, end] = node_pairs_[i];
      test(a, b, std::span(numbers_ + first, numbers_ + end));
      first = end;
    }
    count_ = node_count_ = 0;
  }

 private:
  static constexpr int kMany = 192, kMostOfTwo = BvhNode::kWidth * BvhNode::kWidth;
  struct Nodes {
    Index a, b;
    int end;  ///< of their pairs
  };
  int count_ = 0, node_count_ = 0;
  Nodes node_pairs_[kMany + 1];
  std::int32_t numbers_[kMany + kMostOfTwo + 16] = {};
};

/// The mask of the first so many lanes of eight, or of all.
SELVAGE_INLINE unsigned first_lanes(std::size_t count) {
  return count < BvhNode::kWidth ? (1u << count) - 1 : 0xff;
}

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
  template <typename Known>
  auto crossing() {
    return
        [this](const Index* first, const Index* second, unsigned lanes) { test_crossing<Known>(first, second, lanes); };
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
    if (children_.add(a, b, bits)) test_faces();
  }

  void flush() {
    met_.take_all(planes());
    test_faces();
    close_.take_all(crossing<ByTriangle>());
    close_in_leaves_.take_all(crossing<ByLeaf>());
    unclear_.take_all(edges());
  }

 private:
  void test_faces() {
    children_.take_all([this](Index a, Index b, std::span<const std::int32_t> pairs) {
      const LeafFaces& of_a = faces_of_a_.of(a);
      const LeafFaces& of_b = is_self_ ? faces_of_a_.of(b, a) : faces_of_b_.of(b);
      const Int8 first_of_a = Int8::broadcast(a * BvhNode::kWidth), first_of_b = Int8::broadcast(b * BvhNode::kWidth);
      for (std::size_t i = 0; i < pairs.size(); i += BvhNode::kWidth) {
        const unsigned lanes = first_lanes(pairs.size() - i);
        const Int8 k = Int8::load(pairs.data() + i), row = shift_right<3>(k);
        const unsigned close = lanes & ~beside_faces(of_a, row, of_b, k);
        if (close_in_leaves_.add_lanes(first_of_a | row, first_of_b | (k & Int8::broadcast(7)), close))
          close_in_leaves_.take_groups(crossing<ByLeaf>());
      }
    });
  }

  void test_planes(const Index* first, const Index* second, unsigned lanes) {
    const WidePairs<ByTriangle> pairs(scene_, first, second);
    unsigned apart;
    if (has_thickness_) {
      const Float8 away = distance(first, second);
      apart = beside_plane(pairs.a, pairs.b, away) | beside_plane(pairs.b, pairs.a, away);
    } else {
      apart = beside_plane(pairs.a, pairs.b) | beside_plane(pairs.b, pairs.a);
    }
    if (close_.add_lanes(Int8::load(first), Int8::load(second), lanes & ~apart))
      close_.take_groups(crossing<ByTriangle>());
  }

  template <typename Known>
  void test_crossing(const Index* first, const Index* second, unsigned lanes) {
    const WidePairs<Known> pairs(scene_, first, second);
    const CertainLanes certain = tell_crossing(pairs.a, pairs.b);
    const auto visit = [&](unsigned rest, auto&& take) {
      for (; rest != 0; rest &= rest - 1) {
        const int lane = lowest_lane(rest);
        take(Known::triangle(scene_.a, first[lane]), Known::triangle(scene_.b, second[lane]));
      }
    };
    visit(lanes & certain.cross, [&](Index a, Index b) { take_crossing_pair(scene_, a, b, result_); });
    // What lies apart may be too near.
    visit(lanes & ~certain.cross & ~(has_thickness_ ? 0 : certain.apart), [&](Index a, Index b) {
      if (unclear_.add(a, b)) unclear_.take_groups(edges());
    });
  }

  void test_edges(const Index* first, const Index* second, unsigned lanes) {
    const WidePairs<ByTriangle> pairs(scene_, first, second);
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
  ChildrenQueue children_;
  PairQueue met_, close_, unclear_;
  PairQueue close_in_leaves_;  ///< known ByLeaf, all else ByTriangle
};

}  // namespace SELVAGE_ISA
}  // namespace selvage
