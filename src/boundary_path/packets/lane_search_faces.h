#pragma once

#include "boundary_path/packets/lane_search.h"

/// LaneSearch considers one boundary face: whether it is a candidate, whether a neighbour comes closer, and where its
/// segment leads.
namespace selvage {
inline namespace SELVAGE_ISA {

template <int D>
bool LaneSearch<D>::is_new(Index face) {
  Index& slot = seen_[face % kRemembered];
  if (slot == face) return false;
  slot = face;
  return true;
}

template <int D>
void LaneSearch<D>::consider(Index face, unsigned feature, bool follow, const Candidate<D>* known) {
  while (face != kNone && is_new(face)) {
    if (!may_end_at(face)) return;
    if (counters_ != nullptr) ++counters_->faces_visited;
    using Estimate = typename CandidateFactory<D>::Estimate;
    const Estimate estimate = feature != 0 ? Estimate{0, 0, feature, false} : candidates_.estimate(face);
    const double limit = reject_above_ + estimate.error;
    if (estimate.squared_distance > limit * limit) return;
    if (!estimate.ambiguous && is_known(face, estimate.mask)) return;
    Candidate<D> made;
    if (known == nullptr) made = candidates_.make(face, estimate);
    const Candidate<D>& candidate = known != nullptr ? *known : made;
    if (is_worse(candidate) || was_dismissed(candidate.ids)) return;
    if (is_zero(candidate.offset)) return test_touching(candidate);
    const Index closer = input_.options.cull_infeasible_regions ? closer_neighbour(candidate) : kNone;
    if (closer == kNone) return test(candidate);
    if (counters_ != nullptr) ++counters_->culled;
    dismiss(candidate);
    face = follow ? closer : kNone;
    feature = 0;
    known = nullptr;
  }
}

/// Farther than the answer. Of candidates that are equally far in double precision the one inside the larger feature is
/// taken, which is a rounding away from the other (and which culling would leave), then the one on the smaller face.
template <int D>
bool LaneSearch<D>::is_worse(const Candidate<D>& candidate) const {
  if (candidate.squared_distance != squared_bound()) return candidate.squared_distance > squared_bound();
  if (candidate.squared_distance != best_squared_) return false;
  if (candidate.target.count != best_.target.count) return candidate.target.count < best_.target.count;
  if (candidate.ids == best_.ids && !follows_inverted_rules(candidate) && !is_split(input_, candidate)) return true;
  return smallest_face(candidate) >= smallest_face(best_);
}

/// Whether the feature is that of the answer so far, or known not to be that of any.
template <int D>
bool LaneSearch<D>::is_known(Index face, unsigned mask) const {
  VertexTuple<D> ids;
  ids.fill(kNone);
  int count = 0;
  for (int k = 0; k < D; ++k)
    if ((mask >> k & 1) != 0) ids[count++] = input_.face_stars[face].vertices[k];
  if (count == D) return false;
  if (count == 2 && ids[0] > ids[1]) std::swap(ids[0], ids[1]);
  return (best_.face != kNone && ids == best_.ids && !follows_inverted_rules(best_) && !is_split(input_, best_)) ||
         was_dismissed(ids);
}

template <int D>
bool LaneSearch<D>::was_dismissed(const VertexTuple<D>& ids) const {
  for (int i = 0; i < std::min(dismissed_count_, kDismissed); ++i)
    if (is_same<D>(dismissed_[i], ids)) return true;
  return blocked_.contains(ids);
}

/// The feature is not that of the answer, through whatever face it is found: also by the rules for inverted elements,
/// where the owners of all its faces hang together through faces that the line meets in it.
template <int D>
void LaneSearch<D>::dismiss(const Candidate<D>& candidate) {
  if (candidate.target.count < D && !is_split(input_, candidate))
    dismissed_[dismissed_count_++ % kDismissed] = candidate.ids;
}

/// p itself lies on the face. It is a candidate only for a penetrating vertex or edge that touches it.
template <int D>
void LaneSearch<D>::test_touching(const Candidate<D>& candidate) {
  if (query_.source[0] == kNone) return;
  if (TetTraversal<D>(input_, query_, point_.is_strictly_inside(), counters_).is_on(candidate.face)) accept(candidate);
}

template <int D>
void LaneSearch<D>::test(const Candidate<D>& candidate) {
  if (is_nominating_ && may_postpone(candidate)) {
    target_ = candidate;
    return;
  }
  if (follows_inverted_rules(candidate)) return wait(candidate);
  const TetTraversal<D> traversal(input_, query_, point_.is_strictly_inside(), counters_);
  const double distance = std::sqrt(candidate.squared_distance);
  const TraversalResult result = traversal.follow(
      candidate, point_.component_state() == ComponentState::kImmersed && squared_bound() == kInfinity);
  if (result.valid) return accept(candidate);
  dismiss(candidate);
  const double length = distance * (result.left_at + kLeftAtError) * kBoundSlack;
  if (result.left_through == kNone || point_.is_excluded(result.left_through) || !(length < point_.safe_distance()))
    return;
  left_through_ = result.left_through;
  known_squared_ = std::min(known_squared_, length * length);
  reject_above_ = std::sqrt(squared_bound()) * kBoundSlack;
}

/// Leaves a candidate to be tested by the rules for inverted elements.
template <int D>
void LaneSearch<D>::wait(const Candidate<D>& candidate) {
  if (blocked_.contains(name_of_face(candidate))) return;
  if (candidate.target.count < D && !is_split(input_, candidate)) {
    for (const Candidate<D>& other : waiting_)
      if (is_same<D>(other.ids, candidate.ids)) return twins_.push_back(candidate);
  }
  prefetch(input_.elements + input_.boundary_owners[candidate.face].element());
  waiting_.push_back(candidate);
  if (waiting_.size() >= together_) test_waiting();
}

template <int D>
void LaneSearch<D>::test_waiting() {
  const TetTraversal<D> traversal(input_, query_, point_.is_strictly_inside(), counters_);
  bool are_valid[kTogether];
  while (!waiting_.empty()) {
    traversal.follow_backwards({waiting_.data(), waiting_.size()}, are_valid);
    for (std::size_t i = 0; i < waiting_.size(); ++i) {
      if (!are_valid[i])
        block(waiting_[i]);
      else if (!is_worse(waiting_[i]))
        accept(waiting_[i]);
    }
    waiting_.clear();
    together_ = std::min(2 * together_, kTogether);
    // What is blocked from one face is so from all: see dismiss(). Otherwise each face needs a path of its own.
    for (; !twins_.empty() && waiting_.size() < kTogether; twins_.pop_back())
      if (!was_dismissed(twins_.back().ids) && !is_worse(twins_.back())) waiting_.push_back(twins_.back());
  }
}

/// The face as a name in blocked_: no feature has it.
template <int D>
VertexTuple<D> LaneSearch<D>::name_of_face(const Candidate<D>& candidate) {
  VertexTuple<D> name;
  name.fill(kNone);
  name[D - 1] = candidate.face;
  return name;
}

template <int D>
void LaneSearch<D>::block(const Candidate<D>& candidate) {
  blocked_.insert(candidate.target.count == D || is_split(input_, candidate) ? name_of_face(candidate) : candidate.ids);
}

template <int D>
void LaneSearch<D>::accept(const Candidate<D>& candidate) {
  if (input_.options.cull_infeasible_regions) return keep(candidate);
  const Candidate<D> moved = move_to_closer_neighbours(candidate);
  if (moved.face == candidate.face || !is_worse(moved)) keep(moved);
}

template <int D>
void LaneSearch<D>::keep(const Candidate<D>& candidate) {
  best_ = candidate;
  best_squared_ = candidate.squared_distance;
  reject_above_ = std::sqrt(squared_bound()) * kBoundSlack;
}

/// Without culling a rounding may make an infeasible candidate win over the closer one beside it, to which culling
/// would have led: that one, if its path is valid.
template <int D>
Candidate<D> LaneSearch<D>::move_to_closer_neighbours(Candidate<D> candidate) const {
  constexpr int kMaxSteps = 16;
  for (int step = 0; step < kMaxSteps; ++step) {
    const Index closer = closer_neighbour(candidate);
    if (closer == kNone || point_.is_excluded(closer) || is_zero(candidate.offset)) break;
    const Candidate<D> next = candidates_.make(closer, candidates_.estimate(closer));
    const double longer = std::max(next.squared_distance, candidate.squared_distance);
    if (longer > std::min(next.squared_distance, candidate.squared_distance) * kBoundSlack) break;
    if (!TetTraversal<D>(input_, query_, point_.is_strictly_inside(), nullptr).follow(next, false).valid) break;
    candidate = next;
  }
  return candidate;
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
