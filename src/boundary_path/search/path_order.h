#pragma once

#include "boundary_path/search/boundary_corner.h"
#include "boundary_path/search/candidate.h"
#include "boundary_path/search/query_point.h"

namespace selvage {
inline namespace SELVAGE_ISA {

/// The smallest boundary face at the same corner of the material that has the same closest point as the candidate: none
/// that is excluded or that comes closer behind the corner.
template <int D>
Index smallest_face(const PathInput<D>& input, const QueryPoint<D>& p, const CandidateFactory<D>& candidates,
                    const Candidate<D>& candidate) {
  Index smallest = candidate.face;
  // By the rules for inverted elements each face has a path of its own.
  if (candidate.target.count == D || p.follows_inverted_rules(candidate.squared_distance)) return smallest;
  visit_feature<D>(input.boundary_faces, input.boundary_neighbours, candidate.face, candidate.ids,
                   candidate.target.count, [&](Index face) {
                     if (face >= smallest || p.is_excluded(face) || input.inverted_owner[face]) return;
                     if (candidates.make(face, candidates.estimate(face)).ids == candidate.ids) smallest = face;
                   });
  return smallest;
}

/// Whether a candidate is no better than another, to which there is a path: it is farther, or, equally far in double
/// precision, inside a smaller feature (culling would leave the smaller one, which is a rounding away from the other),
/// or, in features alike, on a larger face.
template <int D>
bool is_no_better(const PathInput<D>& input, const QueryPoint<D>& p, const CandidateFactory<D>& candidates,
                  const Candidate<D>& candidate, const Candidate<D>& best) {
  if (candidate.squared_distance != best.squared_distance) return candidate.squared_distance > best.squared_distance;
  if (candidate.target.count != best.target.count) return candidate.target.count < best.target.count;
  return smallest_face(input, p, candidates, candidate) >= smallest_face(input, p, candidates, best);
}

template <int D>
bool is_zero(const double (&offset)[D]) {
  for (double x : offset)
    if (x != 0) return false;
  return true;
}

/// The answer that ends at a candidate.
template <int D>
PathResult<D> describe_path(const Candidate<D>& best, Index face) {
  PathResult<D> result;
  result.status = PathStatus::kFound;
  result.face = face;
  result.target_count = best.target.count;
  result.target_vertices = best.ids;
  result.barycentric = best.barycentric;
  result.has_normal = D == 3 && best.target.count == 3 && best.has_normal;
  for (int i = 0; i < D; ++i) {
    result.offset[i] = best.offset[i];
    if (result.has_normal) result.normal[i] = best.direction[i];
  }
  return result;
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
