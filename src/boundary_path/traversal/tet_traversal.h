#pragma once

#include "boundary_path/traversal/line_packet.h"
#include "selvage/geometry/predicates.h"

namespace selvage {
inline namespace SELVAGE_ISA {

/// Result of following a segment through the mesh.
struct TraversalResult {
  bool valid = false;
  /// Where the segment is known to leave the mesh through a boundary face, or kNone, and the parameter of the crossing,
  /// to within 1e-7: 0 at p, 1 at s.
  Index left_through = kNone;
  double left_at = 0;
};

/// Decides whether the segment from p to a candidate is a valid path (SPB definition 1): the image of a path from p in
/// its element to the candidate inside the undeformed mesh.
///
/// Source: SPB section 3.3 and supplement, algorithms 1 and 2; but exact, and followed from p, so that it starts
/// in one known element wherever s lies, knows the feature that it must reach by its vertices, and finds where p's own
/// material ends when the segment is blocked.
template <int D>
class TetTraversal {
 public:
  TetTraversal(const PathInput<D>& input, const PathQuery<D>& query, bool strictly_inside, PathCounters* counters)
      : input_(input), query_(query), strictly_inside_(strictly_inside), counters_(counters) {}

  /// For components without inverted elements. With `go_on`, a traversal that has passed s without reaching it goes on
  /// until it leaves the mesh, to learn where.
  TraversalResult follow(const Candidate<D>& candidate, bool go_on) const;

  /// Whether p's own element has the candidate: then there is nothing to follow.
  bool starts_at(const Candidate<D>& candidate) const {
    return contains_target(query_.element, candidate) && is_at_corner(query_.element, candidate);
  }

  /// For components with inverted or flat elements: the rules of SPB section 3.5. Starts at s, may run backwards, does
  /// not stop at p, gives up past twice the distance. In space several candidates are followed side by side.
  /// @param are_valid  one per candidate
  void follow_backwards(std::span<const Candidate<D>> candidates, bool* are_valid) const;

  /// Whether p, as a point of its element, lies on the boundary face, where the face contains p.
  bool is_on(Index face) const;

 private:
  using RaySpaceVertex = typename Segment<D>::RaySpaceVertex;

  KernelVector<Index> elements_at_point() const;
  bool face_holds_point(Index element, int face) const;
  bool is_at_corner(Index element, const Candidate<D>& candidate) const;
  bool contains_target(Index element, const Candidate<D>& candidate) const;
  bool select_first_exit_face(const Segment<D>& segment, ExitFace<D>& exit_face) const;
  bool connects_exactly(const Segment<D>& segment, const Candidate<D>& candidate) const;
  bool segment_clearly_misses(const Segment<D>& segment, Index element, int face) const;
  void prefetch_beyond(Index element) const {
    for (const Index next : input_.elements[element].neighbours)
      if (next >= 0) prefetch(input_.elements + HalfFace{next}.element());
  }
  void count_element() const {
    if (counters_ != nullptr) ++counters_->elements_visited;
  }

  const PathInput<D>& input_;
  const PathQuery<D>& query_;
  bool strictly_inside_;  ///< p lies on no face of its element
  PathCounters* counters_;
};

/// Whether the element has all vertices of the candidate's feature; of a whole face, whether it is the owner.
template <int D>
bool TetTraversal<D>::contains_target(Index element, const Candidate<D>& candidate) const {
  if (candidate.target.count == D) return element == input_.boundary_owners[candidate.face].element();
  for (int i = 0; i < candidate.target.count; ++i)
    if (!contains(input_.elements[element].vertices, candidate.ids[i])) return false;
  return true;
}

/// Whether an element that has the candidate's feature belongs to the same corner of the material as the face's owner:
/// they hang together across faces that have the feature.
template <int D>
bool TetTraversal<D>::is_at_corner(Index element, const Candidate<D>& candidate) const {
  const Index owner = input_.boundary_owners[candidate.face].element();
  if (element == owner || !is_split(input_, candidate)) return true;
  KernelVector<Index> reached{element};
  for (std::size_t k = 0; k < reached.size(); ++k) {
    for (int i = 0; i <= D; ++i) {
      const Index next = input_.elements[reached[k]].neighbours[i];
      if (next < 0 || contains(candidate.ids, input_.elements[reached[k]].vertices[i])) continue;
      if (HalfFace{next}.element() == owner) return true;
      if (!contains(reached, HalfFace{next}.element())) reached.push_back(HalfFace{next}.element());
    }
  }
  return false;
}

/// Finds the face through which the segment leaves p's element. False when it runs exactly through an edge or a vertex.
template <int D>
bool TetTraversal<D>::select_first_exit_face(const Segment<D>& segment, ExitFace<D>& exit_face) const {
  const auto& vertices = input_.elements[query_.element].vertices;
  const auto& neighbours = input_.elements[query_.element].neighbours;
  RaySpaceVertex in_ray_space[D + 1];
  for (int i = 0; i <= D; ++i) in_ray_space[i] = segment.to_ray_space(vertices[i]);
  if constexpr (D == 3) {
    int side[4][4];
    const auto find_face = [&] {
      constexpr int kFaces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
      for (int face = 0; face < 4; ++face) {
        const auto& [a, b, c] = kFaces[face];
        if (side[a][b] <= 0 || side[b][c] <= 0 || side[c][a] <= 0) continue;
        exit_face.next = {neighbours[face]};
        exit_face.corners[0] = in_ray_space[a];
        exit_face.corners[1] = in_ray_space[b];
        exit_face.corners[2] = in_ray_space[c];
        return true;
      }
      return false;
    };
    // Often the line comes exactly out of a vertex behind p, which does not matter.
    for (int i = 0; i < 4; ++i)
      for (int j = i + 1; j < 4; ++j) side[j][i] = -(side[i][j] = segment.clear_side(in_ray_space[i], in_ray_space[j]));
    if (find_face()) return true;
    for (int i = 0; i < 4; ++i)
      for (int j = i + 1; j < 4; ++j)
        if (side[i][j] == 0) side[j][i] = -(side[i][j] = segment.side(in_ray_space[i], in_ray_space[j]));
    return find_face();
  } else {
    int side[3];
    for (int i = 0; i < 3; ++i)
      if ((side[i] = segment.side(in_ray_space[i])) == 0) return false;
    constexpr int kFaces[3][2] = {{1, 2}, {2, 0}, {0, 1}};
    for (int face = 0; face < 3; ++face) {
      const int a = kFaces[face][0], b = kFaces[face][1];
      if (side[a] > 0 || side[b] < 0) continue;
      exit_face.next = {neighbours[face]};
      exit_face.corners[0] = in_ray_space[a];
      exit_face.corners[1] = in_ray_space[b];
      return true;
    }
  }
  return false;
}

template <int D>
TraversalResult TetTraversal<D>::follow(const Candidate<D>& candidate, bool go_on) const {
  if (counters_ != nullptr) ++counters_->traversals;
  count_element();
  if (starts_at(candidate)) return {true};
  const Segment<D> segment(input_, query_.point, candidate,
                           counters_ != nullptr ? &counters_->exact_decisions : nullptr);
  ExitFace<D> exit_face;
  // A line that comes to a fold has both elements there on one side, where no exit face leads.
  if (!strictly_inside_ || !input_.is_oriented || !select_first_exit_face(segment, exit_face))
    return {connects_exactly(segment, candidate)};
  bool passed = false;
  for (;;) {
    if (!passed && !segment.is_before_end(exit_face.corners)) {
      const int before = segment.end_before(segment.crossing(exit_face.corners), exit_face.corners);
      if (before == 0) return {connects_exactly(segment, candidate)};
      passed = before > 0;
      if (passed && !go_on) return {false};
    }
    const HalfFace next = exit_face.next;
    if (!next.exists()) {
      const auto crossing = segment.crossing(exit_face.corners);
      return {false, segment.sees_well(crossing, exit_face.corners) ? next.boundary_face() : kNone,
              segment.parameter(crossing, exit_face.corners)};
    }
    count_element();
    prefetch_beyond(next.element());
    if (!passed && contains_target(next.element(), candidate)) return {is_at_corner(next.element(), candidate)};
    if (!select_exit_face(input_, segment, exit_face)) return {passed ? false : connects_exactly(segment, candidate)};
  }
}

/// The same by search: elements that the closed segment meets, joined through the faces that it meets.
template <int D>
bool TetTraversal<D>::connects_exactly(const Segment<D>& segment, const Candidate<D>& candidate) const {
  VisitedElements visited;
  KernelVector<Index> pending{query_.element};
  visited.insert(query_.element);
  while (!pending.empty()) {
    const Index element = pending.back();
    pending.pop_back();
    if (contains_target(element, candidate) && is_at_corner(element, candidate)) return true;
    for (int i = 0; i <= D; ++i) {
      const Index next = input_.elements[element].neighbours[i];
      if (next < 0 || visited.contains(HalfFace{next}.element()) || segment_clearly_misses(segment, element, i))
        continue;
      segment.count_exact();
      if (!segment.exact().touches(face_points(input_, element, i))) continue;
      visited.insert(HalfFace{next}.element());
      count_element();
      pending.push_back(HalfFace{next}.element());
    }
  }
  return false;
}

/// Whether the closed segment has no point of the closed face, as far as that is certain at a glance: the line passes
/// beside the face, or the face lies behind p.
template <int D>
bool TetTraversal<D>::segment_clearly_misses(const Segment<D>& segment, Index element, int face) const {
  const auto ids = SimplexMesh<D>::face_of(input_.elements[element].vertices, face);
  RaySpaceVertex corners[D];
  bool ahead = false;
  for (int i = 0; i < D; ++i) {
    corners[i] = segment.to_ray_space(ids[i]);
    ahead |= !segment.is_behind_start(corners[i]);
  }
  int positive = 0, negative = 0;
  for (int i = 0; i < D; ++i) {
    int side;
    if constexpr (D == 3)
      side = segment.clear_side(corners[i], corners[(i + 1) % D]);
    else
      side = segment.clear_side(corners[i]);
    positive += side > 0;
    negative += side < 0;
  }
  return !ahead || (D == 3 ? positive > 0 && negative > 0 : positive == D || negative == D);
}

template <int D>
bool TetTraversal<D>::is_on(Index face) const {
  for (Index element : elements_at_point())
    if (element == input_.boundary_owners[face].element()) return true;
  return false;
}

/// The query's element and, where p lies on faces of it, those that share p with it.
template <int D>
KernelVector<Index> TetTraversal<D>::elements_at_point() const {
  KernelVector<Index> elements{query_.element};
  if (strictly_inside_) return elements;
  for (std::size_t k = 0; k < elements.size(); ++k) {
    std::array<Vec<D>, D + 1> corners;
    for (int i = 0; i <= D; ++i) corners[i] = input_.positions[input_.elements[elements[k]].vertices[i]];
    const bool is_flat = orientation(corners) == 0;
    const unsigned on_faces = is_flat ? 0 : locate_in_simplex<D>(corners, query_.point).zero_mask;
    for (int i = 0; i <= D; ++i) {
      const Index next = input_.elements[elements[k]].neighbours[i];
      if (next < 0 || contains(elements, HalfFace{next}.element())) continue;
      if (is_flat ? face_holds_point(elements[k], i) : (on_faces >> i & 1) != 0)
        elements.push_back(HalfFace{next}.element());
    }
  }
  return elements;
}

/// Whether p lies exactly on a face, which may be one of a flat element.
template <int D>
bool TetTraversal<D>::face_holds_point(Index element, int face) const {
  const FacePoints<D> points = face_points(input_, element, face);
  const unsigned mask = exact_closest_mask(query_.point, points);
  TargetSimplex<D> target;
  for (int i = 0; i < D; ++i)
    if (mask >> i & 1) target.vertices[target.count++] = points[i];
  const Vec<D> offset = precise_offset<D>(query_.point, target).offset;
  for (int i = 0; i < D; ++i)
    if (offset[i] != 0) return false;
  return true;
}

template <int D>
void TetTraversal<D>::follow_backwards(std::span<const Candidate<D>> candidates, bool* are_valid) const {
  const KernelVector<Index> goals = elements_at_point();
  KernelVector<BackwardSearch<D>> searches;
  searches.reserve(candidates.size());
  for (const Candidate<D>& candidate : candidates) {
    prefetch_beyond(input_.boundary_owners[candidate.face].element());
    searches.emplace_back(input_, query_.point, candidate, goals, counters_);
  }
  if constexpr (D == 3) {
    const std::int64_t visited = LinePacket(input_, query_.point, goals).run(searches);
    if (counters_ != nullptr) counters_->elements_visited += visited;
  } else {
    for (BackwardSearch<D>& search : searches) {
      bool goes_on = search.find_line();
      while (goes_on) goes_on = search.advance();
    }
  }
  for (std::size_t i = 0; i < searches.size(); ++i) are_valid[i] = searches[i].has_arrived();
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
