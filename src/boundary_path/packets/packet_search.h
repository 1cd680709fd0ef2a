#pragma once

#include "boundary_path/packets/face_view.h"
#include "boundary_path/packets/lane_search_faces.h"
#include "boundary_path/packets/traversal_packet.h"
#include "boundary_path/packets/triangle_projections.h"

namespace selvage {
inline namespace SELVAGE_ISA {

/// In the plane segments are followed one by one.
struct NoTraversalPacket {
  explicit NoTraversalPacket(const PathInput<2>&) {}
  int elements_visited(int) const { return 0; }
  unsigned blocked() const { return 0; }
};

/// The searches of up to sixteen queries that lie near each other.
///
/// How far the answers are is guessed: from faces that are near in the mesh, and from each other's. Then all descend
/// the hierarchy over the boundary faces, level by level, so that a node has arrived in the cache when its turn comes,
/// and together where many come to the same. What is left are pairs of a query and a face:
/// sixteen at a time are looked at in single precision, and the few that may be answers are considered near to far, the
/// first of each query side by side. Where a path is found the guess was right, as nothing nearer can have been missed;
/// the others look for a first path one by one, whose length is a bound, and then do the same again.
template <int D>
class PacketSearch {
 public:
  explicit PacketSearch(const PathInput<D>& input) : input_(input), traversals_(input), nodes_(kRoom), faces_(kRoom) {}

  /// Forgets what groups before have found.
  void forget() {
    latest_.count = 0;
    is_cautious_ = false;
    near_faces_ = faces_culled_by_cone_ = 0;
  }

  /// One result a task and, unless the pointer is null, one set of counters a task.
  void run(std::span<const PathTask<D>> tasks, PathResult<D>* results, PathCounters* counters);

 private:
  static constexpr int kWidth = kPacketSize, kVanguard = 4;
  static constexpr std::size_t kAhead = 6, kRoom = 256;
  /// At most kSmallGroup lanes visit a node one by one. Guesses are improved no further where at most kMaxLeftBehind
  /// lanes would be.
#ifdef SELVAGE_SIMD_AVX512
  static constexpr int kSmallGroup = 4, kMaxLeftBehind = 0;
#else
  static constexpr int kSmallGroup = 6, kMaxLeftBehind = 2;  // sixteen lanes take two operations or more
#endif

  /// Pairs of some lanes (bits) and a node, or of a lane and a face.
  struct Pairs {
    explicit Pairs(std::size_t size) : items(size), lanes(size) {}

    KernelVector<Index> items, lanes;
    std::size_t count = 0;

    /// Makes room for some more, and for what is written beyond them.
    SELVAGE_INLINE void reserve(std::size_t more) {
      if (items.size() >= count + more + BvhNode::kWidth) return;
      items.resize(2 * items.size());
      lanes.resize(2 * lanes.size());
    }
    SELVAGE_INLINE void add(const Index* children, unsigned wanted, Index lane) {
      store_packed(Int8::load(children), wanted, items.data() + count);
      Int8::broadcast(lane).store(lanes.data() + count);
      count += static_cast<std::size_t>(count_lanes(wanted));
    }
  };

  /// Faces that may answer a lane's query.
  struct Waiting {
    static constexpr int kMax = 64;
    int count = 0;
    float squared_distance[kMax];  ///< at least
    Index face[kMax];
    std::uint8_t feature[kMax];  ///< vertices of the face that span the closest point's feature; 0: not known
  };

  struct WaitingFace {
    Index face;
    unsigned feature;
  };

  /// Near boundary points, to which there may be no paths.
  struct Guesses {
    Index face[kWidth];     ///< to be looked at next
    Index nearest[kWidth];  ///< the face of the nearest point so far, or kNone
    alignas(64) float squared_distance[kWidth];
    alignas(64) float point[3][kWidth];
  };

  /// From which others start that lie near.
  struct Answers {
    int count = 0;
    Index face[kWidth];
    alignas(64) float point[3][kWidth];
  };

  void prefetch_ends(std::span<const PathTask<D>> tasks) const;
  void place(int lane);
  unsigned find_inside(std::span<const PathTask<D>> tasks) const;
  void take_sources(int lane);
  unsigned search_near_guesses(unsigned lanes, int& bad_guesses);
  unsigned guess(unsigned lanes);
  void approach(unsigned lanes);
  unsigned start_from_others(unsigned lanes);
  void keep_answers(unsigned lanes);
  void search_from_paths(unsigned lanes);
  void follow_targets();
  void take_bound(int lane);
  void collect_faces();
  void descend();
  void look_for_defects();
  Box box_of_reach(const float (&squared_reach)[kWidth]) const;
  void visit_together(Index place, unsigned lanes, const traversal::WideBox& reach);
  void visit(Index place, Index lane);

  void compare_cones();
  void count_faces_culled_by_cone(unsigned near, unsigned culled);
  unsigned excluded_from(const LeafNode<D>& leaf, int child) const;
  unsigned excluded_faces(const LeafNode<D>& leaf, Index lane) const;
  FaceView<D> view(const Index* faces, const Index* lanes) const;
  void repeat_last_face();
  void leave_out_far_faces();
  void look_at_faces(std::size_t first);
  void count_faces(std::size_t first, unsigned seen, unsigned culled);
  WaitingFace take_nearest(int lane);
  void nominate_nearest();
  void decide(int lane);

  const PathInput<D>& input_;
  KernelVector<LaneSearch<D>> searches_;
  std::conditional_t<D == 3, TetTraversalPacket, NoTraversalPacket> traversals_;
  unsigned present_ = 0;                                   ///< lanes that look for something
  unsigned culling_ = 0;                                   ///< lanes that may pass over faces because of a neighbour
  alignas(64) float culling_signs_[kWidth] = {};           ///< the same, as signs
  alignas(64) float query_point_[3][kWidth] = {};          ///< points from the box origin, to the nearest float
  alignas(64) float lower_[3][kWidth], upper_[3][kWidth];  ///< boxes around them
  alignas(64) float limit_[kWidth];                        ///< upper bound of a computed squared distance
  alignas(64) float sources_[2][kWidth] = {};              ///< vertices on which p lies, or none; as bits
  alignas(64) float barring_sources_[2][kWidth] = {};      ///< the same where their faces prove nothing
  int most_sources_ = 0;                                   ///< vertices on which some p lies
  bool any_barring_ = false;
  Pairs nodes_, faces_;
  bool compares_cones_ = true;                     ///< of faces
  int left_to_compare_ = 0;                        ///< faces before that is decided
  std::size_t compare_again_at_ = 0;               ///< how many faces are listed when it is decided anew
  int near_faces_ = 0, faces_culled_by_cone_ = 0;  ///< of those compared before, since forget()
  Waiting waiting_[kWidth];
  TriangleProjections projections_;
  Guesses guesses_;
  Answers latest_;
  bool is_cautious_ = false;  ///< many guesses were bad in the group before
};

template <int D>
void PacketSearch<D>::run(std::span<const PathTask<D>> tasks, PathResult<D>* results, PathCounters* counters) {
  const int count = static_cast<int>(tasks.size());
  prefetch_ends(tasks);
  searches_.clear();
  searches_.reserve(kWidth);
  for (int i = 0; i < count; ++i) {
    searches_.emplace_back(input_, tasks[i], counters != nullptr ? counters + i : nullptr);
    place(i);
  }
  const unsigned inside = find_inside(tasks);
  unsigned present = 0;
  for (int i = 0; i < count; ++i)
    if (searches_[i].locate((inside >> i & 1) != 0)) present |= 1u << i;
  most_sources_ = 0;
  any_barring_ = false;
  for (unsigned rest = present; rest != 0; rest &= rest - 1) take_sources(lowest_lane(rest));
  // Where many guesses were bad just now, a few lanes find answers from which the others start.
  int wanted = is_cautious_ ? kVanguard : kWidth;
  int bad_guesses = 0;
  while (present != 0) {
    unsigned lanes = 0;
    for (; wanted > 0 && present != 0; --wanted, present &= present - 1) lanes |= present & (0u - present);
    const unsigned unanswered = lanes & ~search_near_guesses(lanes, bad_guesses);
    keep_answers(lanes);
    if (unanswered != 0) search_from_paths(unanswered);
    wanted = kWidth;
  }
  is_cautious_ = bad_guesses > kVanguard;
  for (int i = 0; i < count; ++i) results[i] = searches_[i].finish();
}

/// Searches no farther than the guessed points are, and a little more.
/// @return  lanes that have an answer
template <int D>
unsigned PacketSearch<D>::search_near_guesses(unsigned lanes, int& bad_guesses) {
  constexpr float kSlack = 1 + 1e-4f, kBad = 1.5f;
  present_ = guess(lanes);
  look_for_defects();
  for (unsigned rest = present_; rest != 0; rest &= rest - 1) {
    const int lane = lowest_lane(rest);
    searches_[lane].limit_to(double(kSlack * guesses_.squared_distance[lane]) + 1e-30);
    take_bound(lane);
  }
  collect_faces();
  nominate_nearest();
  follow_targets();
  unsigned answered = 0;
  for (unsigned rest = present_; rest != 0; rest &= rest - 1) {
    const int lane = lowest_lane(rest);
    take_bound(lane);
    decide(lane);
    const bool found = searches_[lane].lift_limit();
    if (found) answered |= 1u << lane;
    bad_guesses +=
        !found || guesses_.squared_distance[lane] > kBad * static_cast<float>(searches_[lane].squared_bound());
  }
  return answered;
}

/// Finds a first path of each lane, and searches no farther than it is long.
template <int D>
void PacketSearch<D>::search_from_paths(unsigned lanes) {
  for (unsigned rest = lanes; rest != 0; rest &= rest - 1) {
    const int lane = lowest_lane(rest);
    guesses_.face[lane] = searches_[lane].first_face();
    guesses_.nearest[lane] = kNone;
    guesses_.squared_distance[lane] = HUGE_VALF;
    searches_[lane].take_defects(searches_[lane].squared_reach(), true);
  }
  if (input_.options.use_hints) start_from_others(lanes);
  present_ = lanes;
  for (unsigned rest = lanes; rest != 0; rest &= rest - 1) {
    const int lane = lowest_lane(rest);
    searches_[lane].nominate_from(guesses_.face[lane]);
  }
  follow_targets();
  for (unsigned rest = lanes; rest != 0; rest &= rest - 1) {
    const int lane = lowest_lane(rest);
    if (searches_[lane].start())
      take_bound(lane);
    else
      present_ &= ~(1u << lane);
  }
  collect_faces();
  for (unsigned rest = present_; rest != 0; rest &= rest - 1) decide(lowest_lane(rest));
}

/// Tests the targets of the searches: side by side where that may be.
template <int D>
void PacketSearch<D>::follow_targets() {
  unsigned paths = 0;
  if constexpr (D == 3) {
    traversals_.clear();
    for (unsigned rest = present_; rest != 0; rest &= rest - 1) {
      const int lane = lowest_lane(rest);
      if (const Candidate<3>* target = searches_[lane].target())
        traversals_.add(lane, searches_[lane].query().element, *target);
    }
    paths = traversals_.follow(query_point_);
  }
  for (unsigned rest = present_; rest != 0; rest &= rest - 1) {
    const int lane = lowest_lane(rest);
    const bool is_path = (paths >> lane & 1) != 0, is_blocked = (traversals_.blocked() >> lane & 1) != 0;
    searches_[lane].test_target(is_path      ? SegmentState::kPath
                                : is_blocked ? SegmentState::kBlocked
                                             : SegmentState::kUnknown,
                                traversals_.elements_visited(lane));
  }
}

template <int D>
void PacketSearch<D>::take_bound(int lane) {
  limit_[lane] = traversal::widen_bound(round_up(searches_[lane].squared_bound()));
  const unsigned bit = 1u << lane;
  const bool may_cull = searches_[lane].may_cull();
  culling_ = may_cull ? culling_ | bit : culling_ & ~bit;
  culling_signs_[lane] = may_cull ? -0.0f : 0.0f;
}

/// The nearest face that waits, or kNone when none is near enough any more.
template <int D>
typename PacketSearch<D>::WaitingFace PacketSearch<D>::take_nearest(int lane) {
  Waiting& waiting = waiting_[lane];
  if (waiting.count == 0) return {kNone, 0};
  int nearest = 0;
  float least = waiting.squared_distance[0];
  for (int k = 1; k < waiting.count; ++k) {  // without a branch
    const float other = waiting.squared_distance[k];
    nearest = other < least ? k : nearest;
    least = other < least ? other : least;
  }
  if (!(least <= limit_[lane])) {
    waiting.count = 0;
    return {kNone, 0};
  }
  const WaitingFace face = {waiting.face[nearest], waiting.feature[nearest]};
  --waiting.count;
  waiting.squared_distance[nearest] = waiting.squared_distance[waiting.count];
  waiting.face[nearest] = waiting.face[waiting.count];
  waiting.feature[nearest] = waiting.feature[waiting.count];
  return face;
}

/// Considers the faces that wait, near to far, until there is a target or an answer. The first ones that are triangles
/// have their candidates computed side by side.
template <int D>
void PacketSearch<D>::nominate_nearest() {
  WaitingFace first[kWidth];
  Candidate<D> made[kWidth];
  unsigned are_made = 0;
  for (unsigned rest = present_; rest != 0; rest &= rest - 1)
    first[lowest_lane(rest)] = take_nearest(lowest_lane(rest));
  if constexpr (D == 3) {
    constexpr unsigned kTriangle = 0b111;
    for (unsigned rest = present_; rest != 0; rest &= rest - 1) {
      const int lane = lowest_lane(rest);
      if (first[lane].face == kNone || first[lane].feature != kTriangle) continue;
      const auto& [a, b, c] = input_.face_stars[first[lane].face].vertices;
      const Vec<3>* const x = input_.positions;
      projections_.set(lane, searches_[lane].query().point, x[a], x[b], x[c]);
      are_made |= 1u << lane;
    }
    projections_.project();
    for (unsigned rest = are_made; rest != 0; rest &= rest - 1) {
      const int lane = lowest_lane(rest);
      projections_.get(lane, made[lane]);
      if (!CandidateFactory<3>::complete(input_, first[lane].face, made[lane])) are_made &= ~(rest & (0u - rest));
    }
  }
  for (unsigned rest = present_; rest != 0; rest &= rest - 1) {
    const int lane = lowest_lane(rest);
    LaneSearch<D>& search = searches_[lane];
    const Candidate<D>* known = (are_made >> lane & 1) != 0 ? made + lane : nullptr;
    for (WaitingFace next = first[lane]; next.face != kNone; next = take_nearest(lane)) {
      search.nominate(next.face, next.feature, known);
      if (search.target() != nullptr || search.has_answer()) break;
      known = nullptr;
    }
  }
}

/// Considers all faces that wait, near to far.
template <int D>
void PacketSearch<D>::decide(int lane) {
  for (WaitingFace next = take_nearest(lane); next.face != kNone; next = take_nearest(lane)) {
    searches_[lane].consider(next.face, next.feature);
    take_bound(lane);
  }
  searches_[lane].test_waiting();
  take_bound(lane);
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
