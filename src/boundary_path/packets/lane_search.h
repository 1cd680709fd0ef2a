#pragma once

#include "boundary_path/search/feasible_region.h"
#include "boundary_path/search/feature_set.h"
#include "boundary_path/search/path_order.h"
#include "boundary_path/traversal/tet_traversal.h"

#include <limits>

namespace selvage {
inline namespace SELVAGE_ISA {

/// State of the segment to a candidate, as far as a TetTraversalPacket has decided it.
enum class SegmentState : std::uint8_t { kUnknown, kPath, kBlocked };

/// Where the shortest path of a query ends.
template <int D>
struct Answer {
  Index face;
  Vec<D> point;
};

/// Search of one query in one lane of a packet (SPB supplement, algorithms 3 and 4). The same answer as that of
/// find_path_alone(), which is to be read first.
///
/// The packet hands it boundary faces in any order, until none that is left can be closer than the answer. So it can be
/// stopped wherever a segment may be followed side by side with others, and goes on when its state is known.
///
/// Two bounds shrink the search beside a valid candidate, both only where the theorems hold. A segment that leaves p's
/// own material shows a boundary point at that distance, which bounds the answer by theorem 1. A culled candidate leads
/// to the neighbouring face that is closer.
///
/// The course of the search is here; lane_search_faces.h considers one face.
template <int D>
class LaneSearch {
 public:
  LaneSearch(const PathInput<D>& input, const PathTask<D>& task, PathCounters* counters)
      : input_(input),
        task_(task),
        query_(task.query),
        point_(input, task.query),
        counters_(counters),
        candidates_(input, query_.point) {}

  /// False when the point does not lie in its element.
  /// @param is_inside  it certainly lies strictly inside
  bool locate(bool is_inside);

  /// The face to look for answers from: the one to try first, or near in the mesh.
  Index first_face() const {
    if (task_.warm_start != kNone || !input_.options.use_hints) return task_.warm_start;
    return input_.hints[query_.element];
  }

  /// Whether a face may be the answer, wherever it lies.
  bool may_end_at(Index face) const { return point_.may_end_at(face); }

  /// Learns how far p is from the nearest defect of its component, unless that is farther than this: then it is as if
  /// one were there. Without `look` none is nearer.
  void take_defects(float squared_reach, bool look) { point_.find_defects(squared_reach, look); }
  /// A reach that is beyond any likely answer.
  float squared_reach() const;

  /// Looks for answers no farther than this, whether or not there are any.
  void limit_to(double squared_distance);
  /// From now on also farther. False when there is no answer yet: then all faces must be considered anew.
  bool lift_limit();

  /// Considers a face. Where it may be the answer, and its segment may be followed in a TetTraversalPacket, it becomes
  /// the target and is not yet tested.
  /// @param known  the candidate, where it has been computed; else null
  void nominate(Index face, unsigned feature, const Candidate<D>* known);

  /// The same from a face on, over neighbours that come closer.
  void nominate_from(Index face);

  /// Candidate of nominate() or nominate_from() whose segment is to be followed in a TetTraversalPacket; null where
  /// there is none, or it has been tested.
  const Candidate<D>* target() const { return is_nominating_ ? &target_ : nullptr; }

  /// Tests the target, if there is one, as far as that is left to do.
  /// @param elements_visited  by the segment to the target, when its state is known
  void test_target(SegmentState state, int elements_visited);

  /// Goes on until there is a path: from the target's, from near in the mesh, and last anywhere. False when there is
  /// none.
  bool start();

  /// Tests a face unless it is known to be no answer.
  /// @param feature  vertices of the face (bits) that certainly span the feature of its closest point; 0: not known
  /// @param follow   whether to go on to neighbours that come closer
  /// @param known   the candidate, where it has been computed
  void consider(Index face, unsigned feature, bool follow = false, const Candidate<D>* known = nullptr);

  /// Tests what consider() has left to be tested together.
  void test_waiting();

  /// The answer, once all faces have been considered that may be it.
  PathResult<D> finish();

  /// Nothing farther is an answer.
  double squared_bound() const { return std::min(std::min(best_squared_, known_squared_), limit_squared_); }
  /// Whether faces may be passed over because a neighbour comes closer: see docs/how_it_works/boundary_path.md.
  bool may_cull() const { return input_.options.cull_infeasible_regions && reject_above_ < point_.safe_distance(); }
  /// See QueryPoint::may_cull_towards_source().
  bool may_cull_towards_source() const { return point_.may_cull_towards_source(); }
  bool has_answer() const { return best_squared_ < kInfinity; }
  Answer<D> answer() const { return {best_.face, query_.point + Vec<D>(best_.offset)}; }
  const PathQuery<D>& query() const { return query_; }
  /// Null when nothing is counted.
  PathCounters* counters() const { return counters_; }

 private:
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  /// Distances that only bound the search are widened by more than their rounding.
  static constexpr double kBoundSlack = 1 + 1e-9;
  /// Bounds the error of TraversalResult::left_at, amply.
  static constexpr double kLeftAtError = 1e-6;

  bool may_postpone(const Candidate<D>& candidate) const;
  double squared_distance_to_hint() const;
  void start_from(Index face);
  void start_anywhere();
  void test(const Candidate<D>& candidate);
  void wait(const Candidate<D>& candidate);
  void test_touching(const Candidate<D>& candidate);
  void accept(const Candidate<D>& candidate);
  void keep(const Candidate<D>& candidate);
  Candidate<D> move_to_closer_neighbours(Candidate<D> candidate) const;
  bool follows_inverted_rules(const Candidate<D>& candidate) const {
    return point_.follows_inverted_rules(candidate.squared_distance);
  }
  bool is_new(Index face);
  bool is_known(Index face, unsigned mask) const;
  bool was_dismissed(const VertexTuple<D>& ids) const;
  void dismiss(const Candidate<D>& candidate);
  static VertexTuple<D> name_of_face(const Candidate<D>& candidate);
  void block(const Candidate<D>& candidate);
  Index closer_neighbour(const Candidate<D>& candidate) const {
    return find_closer_neighbour(input_, point_, candidate);
  }
  Index smallest_face(const Candidate<D>& candidate) const {
    return selvage::smallest_face(input_, point_, candidates_, candidate);
  }
  bool is_worse(const Candidate<D>& candidate) const;

  const PathInput<D>& input_;
  const PathTask<D>& task_;
  const PathQuery<D>& query_;
  QueryPoint<D> point_;
  PathCounters* counters_;
  CandidateFactory<D> candidates_;
  bool is_nominating_ = false;
  Candidate<D> target_;

  Candidate<D> best_;
  double best_squared_ = kInfinity;
  double known_squared_ = kInfinity;  ///< some boundary point that p can reach is this close
  double limit_squared_ = kInfinity;  ///< the answer is looked for no farther than this
  Index left_through_ = kNone;        ///< where a segment was seen to leave the material
  double reject_above_ = kInfinity;   ///< distance of squared_bound(), widened for the rounding of squares

  static constexpr int kRemembered = 64, kDismissed = 8;
  Index seen_[kRemembered];
  VertexTuple<D> dismissed_[kDismissed];
  int dismissed_count_ = 0;

  // Where the rules for inverted elements hold, hundreds of candidates may be nearer than the answer, or none: more and
  // more are followed together.
  static constexpr std::size_t kFirstTogether = 1, kTogether = 32;
  std::size_t together_ = kFirstTogether;
  KernelVector<Candidate<D>> waiting_;  ///< to be followed together
  KernelVector<Candidate<D>> twins_;    ///< in the feature of one that waits, but on another face
  FeatureSet<D> blocked_;               ///< features, and faces, to which there are no paths
};

template <int D>
bool LaneSearch<D>::locate(bool is_inside) {
  if (!point_.locate(is_inside)) return false;
  for (Index& slot : seen_) slot = kNone;
  return true;
}

/// Goes on where a blocked segment leaves the material: the boundary there is near in the mesh, too.
template <int D>
void LaneSearch<D>::start_from(Index face) {
  constexpr int kMaxSteps = 4;
  for (int step = 0; step < kMaxSteps && face != kNone; ++step) {
    left_through_ = kNone;
    consider(face, 0, true);
    test_waiting();
    face = left_through_;
  }
}

template <int D>
void LaneSearch<D>::limit_to(double squared_distance) {
  limit_squared_ = squared_distance;
  reject_above_ = std::sqrt(squared_bound()) * kBoundSlack;
}

template <int D>
bool LaneSearch<D>::lift_limit() {
  test_waiting();
  limit_squared_ = kInfinity;
  if (best_squared_ < kInfinity) return true;
  for (Index& slot : seen_) slot = kNone;
  reject_above_ = std::sqrt(squared_bound()) * kBoundSlack;
  return false;
}

template <int D>
void LaneSearch<D>::nominate(Index face, unsigned feature, const Candidate<D>* known) {
  is_nominating_ = true;
  target_.face = kNone;
  consider(face, feature, false, known);
  is_nominating_ = target_.face != kNone;
}

template <int D>
void LaneSearch<D>::nominate_from(Index face) {
  target_.face = kNone;
  is_nominating_ = true;
  consider(face, 0, true);
  is_nominating_ = target_.face != kNone;
}

template <int D>
void LaneSearch<D>::test_target(SegmentState state, int elements_visited) {
  if (!is_nominating_) return;
  is_nominating_ = false;
  // Where a blocked segment ends is worth to know as long as there is no bound.
  if (state == SegmentState::kUnknown || (state == SegmentState::kBlocked && squared_bound() == kInfinity))
    return test(target_);
  if (counters_ != nullptr) {
    ++counters_->traversals;
    counters_->elements_visited += elements_visited;
  }
  if (state == SegmentState::kBlocked) return dismiss(target_);
  accept(target_);
}

template <int D>
bool LaneSearch<D>::start() {
  test_waiting();
  together_ = kFirstTogether;
  start_from(left_through_);
  if (squared_distance_to_hint() < squared_bound()) start_from(input_.hints[query_.element]);
  if (best_squared_ == kInfinity) start_anywhere();
  return best_squared_ < kInfinity;
}

/// Whether the candidate's segment may be followed in a TetTraversalPacket, with others.
template <int D>
bool LaneSearch<D>::may_postpone(const Candidate<D>& candidate) const {
  if (D == 2 || !input_.is_oriented || !point_.is_strictly_inside() ||
      point_.component_state() == ComponentState::kInverted)
    return false;
  return !is_split(input_, candidate) &&
         !TetTraversal<D>(input_, query_, point_.is_strictly_inside(), nullptr).starts_at(candidate);
}

/// Near to far, until some path is found.
template <int D>
void LaneSearch<D>::start_anywhere() {
  std::int64_t volumes = 0;
  visit_nearest(
      input_.face_nodes, input_.box_origin.around_point(query_.point), round_up(squared_bound()),
      [&](Index face, float) {
        consider(face, 0);
        return best_squared_ == kInfinity ? round_up(squared_bound()) : -1.0f;
      },
      volumes);
  test_waiting();
  if (counters_ != nullptr) counters_->volumes_visited += volumes;
}

template <int D>
PathResult<D> LaneSearch<D>::finish() {
  if (best_squared_ < kInfinity) return describe_path(best_, smallest_face(best_));
  PathResult<D> none;
  if (!point_.is_inside()) none.status = PathStatus::kNotInElement;
  return none;
}

/// To a vertex of the face that is near in the mesh.
template <int D>
double LaneSearch<D>::squared_distance_to_hint() const {
  double least = kInfinity;
  const Index hint = input_.options.use_hints ? input_.hints[query_.element] : kNone;
  if (hint != kNone)
    for (const Index v : input_.face_stars[hint].vertices)
      least = std::min(least, (input_.positions[v] - query_.point).squaredNorm());
  return least;
}

template <int D>
float LaneSearch<D>::squared_reach() const {
  constexpr double kFarBeyond = 8;
  return round_up(kFarBeyond * kFarBeyond * squared_distance_to_hint());
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
