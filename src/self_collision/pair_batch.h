#pragma once

#include "self_collision/crossing_filter.h"
#include "self_collision/discrete_kernel.h"
#include "self_collision/eight_pairs.h"

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

  /// Adds those pairs of children that are in the mask.
  SELVAGE_INLINE bool add_all(const BvhNode& a, const BvhNode& b, std::uint64_t bits) {
    int count = count_;
    for (; bits != 0; bits &= bits - 1, ++count) {
      const int bit = lowest_bit(bits);
      first_[count] = a.children[bit / BvhNode::kWidth];
      second_[count] = b.children[bit % BvhNode::kWidth];
    }
    count_ = count;
    return count >= kMany;
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
  static constexpr int kRoom = kMany + BvhNode::kWidth * BvhNode::kWidth;
  int count_ = 0;
  Index first_[kRoom], second_[kRoom];
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
      : scene_(scene), result_(result), has_thickness_(scene.a.thickness != nullptr || scene.b.thickness != nullptr) {}

  SELVAGE_INLINE void add(Index first, Index second) {
    if (met_.add(first, second)) met_.take_groups(planes());
  }
  SELVAGE_INLINE void add_all(const BvhNode& a, const BvhNode& b, std::uint64_t bits) {
    if (met_.add_all(a, b, bits)) met_.take_groups(planes());
  }

  void flush() {
    met_.take_all(planes());
    close_.take_all(crossing());
    unclear_.take_all(edges());
  }

 private:
  void test_planes(const Index* first, const Index* second, unsigned lanes) {
    const WidePairs pairs(scene_, first, second);
    unsigned apart;
    if (has_thickness_) {
      const Float8 away = distance(first, second);
      apart = beside_plane(pairs.a, pairs.b, away) | beside_plane(pairs.b, pairs.a, away);
    } else {
      apart = beside_plane(pairs.a, pairs.b) | beside_plane(pairs.b, pairs.a);
    }
    for (unsigned rest = lanes & ~apart; rest != 0; rest &= rest - 1) {
      const int i = lowest_lane(rest);
      if (close_.add(first[i], second[i])) close_.take_groups(crossing());
    }
  }

  void test_crossing(const Index* first, const Index* second, unsigned lanes) {
    const WidePairs pairs(scene_, first, second);
    const unsigned sure = certainly_cross(pairs.a, pairs.b);
    for (unsigned rest = lanes; rest != 0; rest &= rest - 1) {
      const int i = lowest_lane(rest);
      if ((sure >> i & 1) != 0)
        take_crossing_pair(scene_, first[i], second[i], result_);
      else if (unclear_.add(first[i], second[i]))
        unclear_.take_groups(edges());
    }
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
  bool has_thickness_;
  PairQueue met_, close_, unclear_;
};

}  // namespace SELVAGE_ISA
}  // namespace selvage
