#pragma once

#include "boundary_path/search/feasible_region.h"
#include "boundary_path/search/path_order.h"
#include "boundary_path/traversal/tet_traversal.h"

namespace selvage {
inline namespace SELVAGE_ISA {

/// Whether the segment from p to the candidate is a valid path: it runs inside the material (SPB, definition 3).
template <int D>
bool is_path(const PathInput<D>& input, const QueryPoint<D>& p, const Candidate<D>& candidate) {
  const TetTraversal<D> traversal(input, p.query(), p.is_strictly_inside(), nullptr);
  // p itself is the candidate: only a penetrating vertex or edge may end where it is.
  if (is_zero(candidate.offset)) return p.query().source[0] != kNone && traversal.is_on(candidate.face);
  if (p.follows_inverted_rules(candidate.squared_distance)) {
    bool is_valid = false;
    traversal.follow_backwards({&candidate, 1}, &is_valid);
    return is_valid;
  }
  return traversal.follow(candidate, false).valid;
}

/// ShortestPathToSurface (SPB supplement, algorithm 3): the shortest path of one query, from the exact parts alone.
///
/// Read this first. Boundary faces are visited from near to far. Each has a closest point to p, the candidate. It is
/// the answer so far if it is nearer than all before, if p is in its feasible region (algorithm 4), and if the
/// tetrahedral traversal from p arrives there (algorithm 1, which selects exit faces by algorithm 2). Faces farther
/// than the answer so far are never visited.
///
/// This is the slow twin of the packets, with which tests compare them query by query. Nothing is kept from one query
/// for the next, no face is estimated in single precision, and no bound is drawn from a path that is blocked.
template <int D>
PathResult<D> find_path_alone(const PathInput<D>& input, const PathQuery<D>& query) {
  constexpr float kAnywhere = std::numeric_limits<float>::infinity();
  QueryPoint<D> p(input, query);
  PathResult<D> none;
  if (!p.locate(false)) none.status = PathStatus::kNotInElement;
  if (!p.is_inside()) return none;
  p.find_defects(kAnywhere, true);
  const CandidateFactory<D> candidates(input, query.point);
  Candidate<D> best;
  best.squared_distance = std::numeric_limits<double>::infinity();
  const auto is_answer_so_far = [&](const Candidate<D>& candidate) {
    if (best.face != kNone && is_no_better(input, p, candidates, candidate, best)) return false;
    if (!is_zero(candidate.offset) && find_closer_neighbour(input, p, candidate) != kNone) return false;
    return is_path(input, p, candidate);
  };
  visit_nearest(input.face_nodes, input.box_origin.around_point(query.point), kAnywhere, [&](Index face, float) {
    if (p.may_end_at(face)) {
      const Candidate<D> candidate = candidates.make(face, candidates.estimate(face));
      if (is_answer_so_far(candidate)) best = candidate;
    }
    return round_up(best.squared_distance);
  });
  return best.face == kNone ? none : describe_path(best, smallest_face(input, p, candidates, best));
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
