#pragma once

#include "boundary_path/search/query_point.h"

namespace selvage {
inline namespace SELVAGE_ISA {

/// FeasibleRegionCheck (SPB section 3.6; supplement, algorithm 4): a boundary face next to the candidate's vertex or
/// edge that comes closer to p. Where there is one, p lies outside the feasible region of the candidate, which is then
/// not the answer, and need not be traversed to.
///
/// @return  kNone when p is in the feasible region, when rounding leaves a doubt, or when the argument does not hold
///          there: beyond the nearest defect, and at vertices whose surroundings are not proven to be injective
template <int D>
Index find_closer_neighbour(const PathInput<D>& input, const QueryPoint<D>& p, const Candidate<D>& candidate) {
  if (candidate.target.count == D) return kNone;
  if (!(std::sqrt(candidate.squared_distance) < p.safe_distance())) return kNone;
  const auto comes_closer = [&](Index from, Index to) {
    const Vec<D>&a = input.positions[from], &b = input.positions[to];
    double slope = 0, bound = 0;
    for (int i = 0; i < D; ++i) {
      const double step = b[i] - a[i];
      slope += candidate.offset[i] * step;
      bound += (8 * kUnitRoundoff * std::abs(candidate.offset[i]) + candidate.offset_error) * std::abs(step);
    }
    return slope < -2 * bound - kTrustAbove;
  };
  const FaceStar<D>& star = input.face_stars[candidate.face];
  const auto proves_nothing = [&](Index face) { return !p.may_cull_towards_source() && p.is_excluded(face); };
  const auto neighbour = [&](int k, Index from) {
    const Index other = input.boundary_neighbours[candidate.face][k];
    return proves_nothing(other) || !comes_closer(from, star.apexes[k]) ? kNone : other;
  };
  if (candidate.target.count == 2) {
    const Index a = candidate.ids[0], b = candidate.ids[1];
    if (!input.cullable[a] && !input.cullable[b]) return kNone;
    int k = 0;
    while (star.vertices[k] == a || star.vertices[k] == b) ++k;
    return neighbour(k, a);
  }
  const Index v = candidate.ids[0];
  if (!input.cullable[v]) return kNone;
  for (int k = 0; k < D; ++k) {
    const Index closer = star.vertices[k] == v ? kNone : neighbour(k, v);
    if (closer != kNone) return closer;
  }
  for (Index face : input.mesh->vertex_boundary_faces(v)) {
    if (proves_nothing(face)) continue;
    for (Index w : input.face_stars[face].vertices)
      if (w != v && comes_closer(v, w)) return face;
  }
  return kNone;
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
