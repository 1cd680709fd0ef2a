#pragma once

#include "boundary_path/boundary_corner.h"
#include "boundary_path/candidate.h"
#include "boundary_path/walk.h"
#include "selvage/bvh/traverse.h"

#include <limits>

namespace selvage {
inline namespace SELVAGE_ISA {

/// The search for one query's shortest path (SPB supplement, algorithms 3 and 4): boundary faces near to far, until
/// none can be closer than the answer.
///
/// What shrinks the search beside a valid candidate: a segment that leaves p's own material shows a boundary point at
/// that distance, which theorem 1 makes a bound of the answer; and a culled candidate leads to the neighbouring face
/// that is closer. Both only where the theorems hold.
template <int D>
class Search {
 public:
  Search(const PathScene<D>& scene, const PathTask<D>& task, PathCounters* counters)
      : scene_(scene), task_(task), query_(task.query), counters_(counters), candidates_(scene, query_.point) {}

  PathResult<D> run();

 private:
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  /// Distances that only bound the search are widened by more than their rounding.
  static constexpr double kBoundSlack = 1 + 1e-9;
  /// Bounds the error of WalkResult::left_at, with room to spare.
  static constexpr double kLeftAtError = 1e-6;

  void set_safe_distance(bool own);
  unsigned keep(const BvhNode& node, Index place, unsigned children) const;
  void start_from_hints();
  void consider(Index face);
  void test(const Candidate<D>& candidate);
  void test_touching(const Candidate<D>& candidate);
  void accept(const Candidate<D>& candidate);
  void settle();
  /// Whether the candidate is so far that its path may meet inverted elements.
  bool follows_inverted_rules(const Candidate<D>& candidate) const {
    return state_ == ComponentState::kInverted && !(std::sqrt(candidate.squared_distance) < defect_distance_);
  }
  bool is_excluded(Index face) const;
  bool is_new(Index face);
  bool was_blocked(const Candidate<D>& candidate) const;
  Index closer_neighbour(const Candidate<D>& candidate) const;
  Index smallest_face(const Candidate<D>& candidate) const;
  bool is_worse(const Candidate<D>& candidate) const;
  static bool is_zero(const double (&offset)[D]) {
    for (double x : offset)
      if (x != 0) return false;
    return true;
  }
  double squared_bound() const { return std::min(best_squared_, known_squared_); }

  const PathScene<D>& scene_;
  const PathTask<D>& task_;
  const PathQuery<D>& query_;
  PathCounters* counters_;
  CandidateFactory<D> candidates_;
  bool strictly_inside_ = false;
  Index component_ = 0;
  ComponentState state_ = ComponentState::kImmersed;
  /// No path up to this long can meet a defect: theorems 1 and 2 hold for it. 0 where they never do.
  double safe_distance_ = 0;
  double defect_distance_ = 0;  ///< the same, but for p's own position on the boundary

  Float8 eye_[3];  ///< p in the frame
  Candidate<D> best_;
  double best_squared_ = kInfinity;
  double known_squared_ = kInfinity;  ///< some boundary point that p can reach is this close
  double reject_above_ = kInfinity;   ///< distance of squared_bound(), widened for the rounding of squares

  static constexpr int kRemembered = 64, kBlocked = 8;
  Index seen_[kRemembered];
  VertexTuple<D> blocked_[kBlocked];
  int blocked_count_ = 0;
};

template <int D>
PathResult<D> Search<D>::run() {
  PathResult<D> result;
  std::array<Vec<D>, D + 1> corners;
  for (int i = 0; i <= D; ++i) corners[i] = scene_.positions[scene_.elements[query_.element][i]];
  const Containment at = locate_in_simplex<D>(corners, query_.point);
  if (!at.inside) {
    result.status = PathStatus::kNotInElement;
    return result;
  }
  strictly_inside_ = at.zero_mask == 0;
  component_ = scene_.component_of[query_.element];
  state_ = scene_.component_state[component_];
  // Faces that contain p materially are no candidates, which the theorems do not know: rely on them only where p is
  // known to be off the boundary, or is a vertex that came from elsewhere.
  const auto& vertices = scene_.elements[query_.element];
  const bool own = query_.source[0] == kNone
                       ? !strictly_inside_
                       : contains(vertices, query_.source[0]) || contains(vertices, query_.source[1]);
  set_safe_distance(own);
  for (Index& slot : seen_) slot = kNone;

  start_from_hints();
  const Box box = scene_.frame.around_point(query_.point);
  for (int i = 0; i < 3; ++i) eye_[i] = Float8::broadcast((box.lower[i] + box.upper[i]) * 0.5f);
  std::int64_t volumes = 0;
  visit_nearest(
      scene_.face_nodes, box, round_up(squared_bound()),
      [&](Index face, float) {
        consider(face);
        return round_up(squared_bound());
      },
      volumes, [&](const BvhNode& node, Index place, unsigned children) { return keep(node, place, children); });
  if (counters_ != nullptr) counters_->volumes_visited += volumes;

  if (best_squared_ == kInfinity) return result;
  settle();
  result.status = PathStatus::kFound;
  result.face = smallest_face(best_);
  result.target_count = best_.target.count;
  result.target_vertices = best_.ids;
  result.barycentric = best_.barycentric;
  for (int i = 0; i < D; ++i) result.offset[i] = best_.offset[i];
  return result;
}

/// How far p is from the nearest defect of its component. The rules for inverted elements look along the line up to
/// twice a candidate's distance beyond it: three times that distance from p.
template <int D>
void Search<D>::set_safe_distance(bool own) {
  const Box box = scene_.frame.around_point(query_.point);
  float nearest = std::numeric_limits<float>::infinity();
  visit_nearest(scene_.defect_nodes, box, nearest, [&](Index defect, float squared_distance) {
    if (scene_.defects[defect].component == component_ && squared_distance < nearest) nearest = squared_distance;
    return nearest;
  });
  defect_distance_ = std::sqrt(double(nearest)) * (state_ == ComponentState::kInverted ? 0.333 : 1.0);
  safe_distance_ = own ? 0 : defect_distance_;
}

/// Children below which the answer may lie: see ConeNode.
template <int D>
inline unsigned Search<D>::keep(const BvhNode& node, Index place, unsigned children) const {
  if (!scene_.options.cull_infeasible_regions || !(reject_above_ < safe_distance_)) return children;
  const ConeNode& cones = scene_.face_cones[place];
  const Float8 zero = Float8::broadcast(0), half = Float8::broadcast(0.5f);
  Float8 along = zero, squared_length = zero, squared_radius = zero, length_bound = zero;
  for (int i = 0; i < 3; ++i) {
    const Float8 lower = Float8::load(node.lower[i]), upper = Float8::load(node.upper[i]);
    const Float8 from_middle = eye_[i] - (lower + upper) * half, extent = (upper - lower) * half;
    along = along + from_middle * Float8::load(cones.axis[i]);
    squared_length = squared_length + from_middle * from_middle;
    squared_radius = squared_radius + extent * extent;
    length_bound = length_bound + max(from_middle, zero - from_middle);
  }
  // How far p is outside the cone of directions around the axis' opposite, opened at each point of the child's sphere.
  // Slack for the rounding of positions in the frame, which is a few units across, and for the root of a small
  // difference, which loses half its digits.
  const Float8 across = sqrt(max(squared_length - along * along, zero)) * Float8::load(cones.cosine);
  const Float8 lift = along * Float8::load(cones.sine);
  const Float8 radius = sqrt(squared_radius) * Float8::broadcast(1.001f) + length_bound * Float8::broadcast(1e-3f) +
                        Float8::broadcast(1e-6f);
  const unsigned not_below = less_equal(radius, across + lift);
  const unsigned not_above = less_equal(radius, across - lift);
  return children & ~(not_below & (not_above | ~cones.two_sided));
}

template <int D>
void Search<D>::start_from_hints() {
  if (task_.warm_start != kNone) consider(task_.warm_start);
  if (scene_.options.use_hints && scene_.hints[query_.element] != kNone) consider(scene_.hints[query_.element]);
}

/// Boundary faces that have all the vertices on which p lies.
template <int D>
bool Search<D>::is_excluded(Index face) const {
  if (query_.source[0] == kNone) return false;
  const auto& ids = scene_.boundary_faces[face];
  return contains(ids, query_.source[0]) && (query_.source[1] == kNone || contains(ids, query_.source[1]));
}

template <int D>
bool Search<D>::is_new(Index face) {
  Index& slot = seen_[face % kRemembered];
  if (slot == face) return false;
  slot = face;
  return true;
}

template <int D>
void Search<D>::consider(Index face) {
  while (face != kNone && is_new(face)) {
    if (scene_.component_of[scene_.boundary_owners[face].element()] != component_ || is_excluded(face)) return;
    if (scene_.inverted_owner[face]) return;
    if (counters_ != nullptr) ++counters_->faces_visited;
    const auto estimate = candidates_.estimate(face);
    const double limit = reject_above_ + estimate.error;
    if (estimate.squared_distance > limit * limit) return;
    const Candidate<D> candidate = candidates_.make(face, estimate);
    if (is_worse(candidate) || was_blocked(candidate)) return;
    if (is_zero(candidate.offset)) return test_touching(candidate);
    const Index closer = scene_.options.cull_infeasible_regions ? closer_neighbour(candidate) : kNone;
    if (closer == kNone) return test(candidate);
    if (counters_ != nullptr) ++counters_->culled;
    face = closer;
  }
}

/// Farther than the answer. Of candidates that are equally far in double precision the one inside the larger feature is
/// taken, which is a rounding away from the other (and which culling would leave), then the one on the smaller face.
template <int D>
bool Search<D>::is_worse(const Candidate<D>& candidate) const {
  if (candidate.squared_distance != squared_bound()) return candidate.squared_distance > squared_bound();
  if (candidate.squared_distance != best_squared_) return false;
  if (candidate.target.count != best_.target.count) return candidate.target.count < best_.target.count;
  return smallest_face(candidate) >= smallest_face(best_);
}

template <int D>
bool Search<D>::was_blocked(const Candidate<D>& candidate) const {
  if (candidate.target.count == D || follows_inverted_rules(candidate)) return false;
  for (int i = 0; i < std::min(blocked_count_, kBlocked); ++i)
    if (blocked_[i] == candidate.ids) return true;
  return false;
}

/// A face next to the candidate's vertex or edge that comes closer to p: then the candidate is not the answer (SPB
/// section 3.6). kNone when there is none, when rounding leaves a doubt, or when the argument does not hold there.
template <int D>
Index Search<D>::closer_neighbour(const Candidate<D>& candidate) const {
  if (candidate.target.count == D) return kNone;
  if (!(std::sqrt(candidate.squared_distance) < safe_distance_)) return kNone;
  const auto comes_closer = [&](Index from, Index to) {
    const Vec<D>&a = scene_.positions[from], &b = scene_.positions[to];
    double slope = 0, bound = 0;
    for (int i = 0; i < D; ++i) {
      const double step = b[i] - a[i];
      slope += candidate.offset[i] * step;
      bound += (8 * kUnitRoundoff * std::abs(candidate.offset[i]) + candidate.offset_error) * std::abs(step);
    }
    return slope < -2 * bound - kTrustAbove;
  };
  if (candidate.target.count == 1) {
    const Index v = candidate.ids[0];
    if (!scene_.cullable[v]) return kNone;
    for (Index face : scene_.mesh->vertex_boundary_faces(v)) {
      if (is_excluded(face)) continue;
      for (Index w : scene_.boundary_faces[face])
        if (w != v && comes_closer(v, w)) return face;
    }
    return kNone;
  }
  const Index a = candidate.ids[0], b = candidate.ids[1];
  if (!scene_.cullable[a] && !scene_.cullable[b]) return kNone;
  const auto apex = [&](Index face) {
    int k = 0;
    while (scene_.boundary_faces[face][k] == a || scene_.boundary_faces[face][k] == b) ++k;
    return k;
  };
  const Index other = scene_.boundary_neighbours[candidate.face][apex(candidate.face)];
  if (is_excluded(other) || !comes_closer(a, scene_.boundary_faces[other][apex(other)])) return kNone;
  return other;
}

/// p itself lies on the face. It is a candidate only for a penetrating vertex or edge that touches it.
template <int D>
void Search<D>::test_touching(const Candidate<D>& candidate) {
  if (query_.source[0] == kNone) return;
  if (Walk<D>(scene_, query_, strictly_inside_, counters_).is_on(candidate.face)) accept(candidate);
}

template <int D>
void Search<D>::test(const Candidate<D>& candidate) {
  const Walk<D> walk(scene_, query_, strictly_inside_, counters_);
  const double distance = std::sqrt(candidate.squared_distance);
  WalkResult result;
  if (follows_inverted_rules(candidate))
    result.valid = walk.follow_backwards(candidate);
  else
    result = walk.follow(candidate, state_ == ComponentState::kImmersed && squared_bound() == kInfinity);
  if (result.valid) return accept(candidate);
  if (candidate.target.count < D && !walk.is_split(candidate)) blocked_[blocked_count_++ % kBlocked] = candidate.ids;
  const double length = distance * (result.left_at + kLeftAtError) * kBoundSlack;
  if (result.left_through == kNone || is_excluded(result.left_through) || !(length < safe_distance_)) return;
  known_squared_ = std::min(known_squared_, length * length);
  reject_above_ = std::sqrt(squared_bound()) * kBoundSlack;
}

template <int D>
void Search<D>::accept(const Candidate<D>& candidate) {
  best_ = candidate;
  best_squared_ = candidate.squared_distance;
  reject_above_ = std::sqrt(squared_bound()) * kBoundSlack;
}

/// A rounding may have made an infeasible candidate win over the closer one beside it. Culling would have led to that
/// one.
template <int D>
void Search<D>::settle() {
  constexpr int kMostSteps = 16;
  for (int step = 0; step < kMostSteps; ++step) {
    const Index closer = closer_neighbour(best_);
    if (closer == kNone || is_zero(best_.offset)) return;
    const Candidate<D> candidate = candidates_.make(closer, candidates_.estimate(closer));
    if (candidate.squared_distance > best_squared_ * kBoundSlack) return;
    best_ = candidate;
  }
}

/// The smallest boundary face at the same corner of the material that has the same closest point: none that is left out
/// or that comes closer behind the corner.
template <int D>
Index Search<D>::smallest_face(const Candidate<D>& candidate) const {
  Index smallest = candidate.face;
  if (follows_inverted_rules(candidate)) return smallest;  // each face has a path of its own
  visit_feature<D>(scene_.boundary_faces, scene_.boundary_neighbours, candidate.face, candidate.ids,
                   candidate.target.count, [&](Index face) {
                     if (face >= smallest || is_excluded(face) || scene_.inverted_owner[face]) return;
                     if (candidates_.make(face, candidates_.estimate(face)).ids == candidate.ids) smallest = face;
                   });
  return smallest;
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
