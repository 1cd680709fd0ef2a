#pragma once

#include "self_collision/continuous/axis_separation.h"
#include "self_collision/continuous/continuous_kernel.h"
#include "self_collision/surface/eight_pairs.h"
#include "self_collision/surface/motion_filter.h"

namespace selvage {
inline namespace SELVAGE_ISA {

/// Pairs (a vertex and a face: kFirst = 1, two edges: kFirst = 2) that the test over the whole step leaves undecided,
/// tested over its halves, their halves and so on: eight parts of time at once, of any pairs. Pairs that the shortest
/// parts leave undecided are decided exactly.
template <int kFirst>
class PartBatch {
 public:
  PartBatch(const ContinuousInput& input, ContinuousResult& result) : input_(input), result_(result) {
    for (int i = 0; i < kMaxPairs; ++i) free_[i] = static_cast<std::uint8_t>(i);
  }

  SELVAGE_INLINE void add(const FeaturePair& pair) {
    while (free_count_ == 0) test_parts();
    const std::uint8_t place = free_[--free_count_];
    pairs_[place] = {pair, 0, false, false};
    push_halves({place, 0, 1});
    if (part_count_ >= EightPairs::kSize) test_parts();
  }

  void decide(const FeaturePair& pair, bool do_meet) {
    if constexpr (kFirst == 1)
      decide_vertex_face(input_, pair.first, pair.second, do_meet, result_);
    else
      decide_edge_edge(input_, pair.first, pair.second, do_meet, result_);
  }

  void flush() {
    while (part_count_ > 0) test_parts();
  }

 private:
  static constexpr int kHalvings = 6, kMaxPairs = 16;
  static constexpr float kShortest = 1.0f / (1 << kHalvings);

  struct OpenPair {
    FeaturePair pair;
    int waiting;  ///< parts to be tested
    bool do_meet, is_undecided;
  };
  struct Part {
    std::uint8_t pair;
    float from, to;
  };

  SELVAGE_INLINE void push_halves(const Part& part) {
    const float middle = 0.5f * (part.from + part.to);
    parts_[part_count_++] = {part.pair, middle, part.to};
    parts_[part_count_++] = {part.pair, part.from, middle};
    pairs_[part.pair].waiting += 2;
  }

  void test_parts() {
    constexpr int kSize = EightPairs::kSize;
    Part parts[kSize];
    int count = 0;
    while (part_count_ > 0 && count < kSize) {
      const Part& next = parts_[--part_count_];
      if (pairs_[next.pair].do_meet)
        finish_part(next.pair);
      else
        parts[count++] = next;
    }
    if (count == 0) return;
    Index vertices[4][kSize];
    float from[kSize], to[kSize];
    for (int i = 0; i < kSize; ++i) {
      const Part& part = parts[i < count ? i : 0];
      for (int k = 0; k < 4; ++k) vertices[k][i] = pairs_[part.pair].pair.vertices[k];
      from[i] = part.from;
      to[i] = part.to;
    }
    MovingSets<kFirst, 4 - kFirst> sets(input_, vertices);
    sets.shorten(Float8::load(from), Float8::load(to));
    const unsigned apart = sets.apart(), meet = sets.meet();
    for (int i = 0; i < count; ++i) {
      OpenPair& pair = pairs_[parts[i].pair];
      const bool is_apart = (apart >> i & 1) != 0;
      if ((meet >> i & 1) != 0)
        pair.do_meet = true;
      else if (!is_apart && parts[i].to - parts[i].from > kShortest)
        push_halves(parts[i]);
      else if (!is_apart)
        pair.is_undecided = true;
      finish_part(parts[i].pair);
    }
  }

  SELVAGE_INLINE void finish_part(std::uint8_t place) {
    OpenPair& open = pairs_[place];
    if (--open.waiting > 0) return;
    free_[free_count_++] = place;
    if (!open.do_meet && !open.is_undecided) return;
    decide(open.pair, open.do_meet);
  }

  const ContinuousInput& input_;
  ContinuousResult& result_;
  OpenPair pairs_[kMaxPairs];
  Part parts_[kMaxPairs << kHalvings];  // no two parts of a pair overlap
  std::uint8_t free_[kMaxPairs];
  int free_count_ = kMaxPairs, part_count_ = 0;
};

/// Pairs that boxes do not separate, tested eight at once over the whole step, then one by one along some axes, then
/// over the step's parts; what does not move has no parts.
template <int kFirst>
class FeatureBatch {
 public:
  FeatureBatch(const ContinuousInput& input, ContinuousResult& result)
      : input_(input), result_(result), open_(input, result) {}

  SELVAGE_INLINE void add(const FeaturePair& pair) {
    pairs_[count_] = pair;
    if (++count_ == EightPairs::kSize) test_whole_step();
  }

  void flush() {
    if (count_ > 0) test_whole_step();
    open_.flush();
  }

 private:
  SELVAGE_INLINE bool has_strayed(const FeaturePair& pair) const {
    if (input_.strayed == nullptr) return true;
    const auto& [a, b, c, d] = pair.vertices;
    return (input_.strayed[a] | input_.strayed[b] | input_.strayed[c] | input_.strayed[d]) != 0;
  }

  void list_near(unsigned apart) {
    for (unsigned rest = ~apart & ((1u << count_) - 1); rest != 0; rest &= rest - 1)
      if (const FeaturePair& pair = pairs_[lowest_lane(rest)]; has_strayed(pair)) append_near(result_, kFirst, pair);
    count_ = 0;
  }

  void test_whole_step() {
    Index vertices[4][EightPairs::kSize];
    for (int i = 0; i < EightPairs::kSize; ++i)
      for (int k = 0; k < 4; ++k) vertices[k][i] = pairs_[i < count_ ? i : 0].vertices[k];
    const unsigned apart = MovingSets<kFirst, 4 - kFirst>(input_, vertices).apart();
    if (input_.is_listing()) return list_near(apart);
    for (unsigned rest = ~apart & ((1u << count_) - 1); rest != 0; rest &= rest - 1) {
      const FeaturePair& pair = pairs_[lowest_lane(rest)];
      if (are_still(input_, pair.vertices))
        open_.decide(pair, false);
      else if (!stay_apart_by_axis(input_, pair.vertices, kFirst))
        open_.add(pair);
    }
    count_ = 0;
  }

  const ContinuousInput& input_;
  ContinuousResult& result_;
  PartBatch<kFirst> open_;
  FeaturePair pairs_[EightPairs::kSize];
  int count_ = 0;
};

}  // namespace SELVAGE_ISA
}  // namespace selvage
