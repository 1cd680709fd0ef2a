#pragma once

#include "boundary_path/traversal/segment.h"
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

/// Elements that were visited: the first ones in place, more in a growing list as a fail-safe (SPB supplement 1.2).
class VisitedElements {
 public:
  bool contains(Index element) const {
    for (int i = 0; i < count_; ++i)
      if (first_[i] == element) return true;
    return SELVAGE_ISA::contains(more_, element);
  }

  /// Whether the element is new; it is visited from now on.
  bool insert(Index element) {
    if (contains(element)) return false;
    if (count_ < kInPlace)
      first_[count_++] = element;
    else
      more_.push_back(element);
    return true;
  }

 private:
  static constexpr int kInPlace = 32;
  Index first_[kInPlace];
  int count_ = 0;
  KernelVector<Index> more_;
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
  /// not stop at p, gives up past twice the distance.
  bool follow_backwards(const Candidate<D>& candidate) const;

  /// Whether p, as a point of its element, lies on the boundary face, where the face contains p.
  bool is_on(Index face) const;

 private:
  using RaySpaceVertex = typename Segment<D>::RaySpaceVertex;

  /// A face of an element that the line passes through properly, listed so that its normal points along the line.
  struct ExitFace {
    Index element;
    int face;  ///< opposite to which vertex of the element
    RaySpaceVertex corners[D];
  };

  KernelVector<Index> elements_at_point() const;
  bool face_holds_point(Index element, int face) const;
  enum class Passing : std::uint8_t { kNot, kTouching, kProper };
  Passing line_passes(const Segment<D>& segment, Index element, int face, ExitFace& exit_face) const;
  bool follow_line(const Segment<D>& segment, const KernelVector<Index>& goals, ExitFace exit_face,
                   KernelVector<HalfFace>& pending) const;
  bool is_at_corner(Index element, const Candidate<D>& candidate) const;
  bool contains_target(Index element, const Candidate<D>& candidate) const;
  bool select_first_exit_face(const Segment<D>& segment, ExitFace& exit_face) const;
  bool select_exit_face(const Segment<D>& segment, Index next, ExitFace& exit_face) const;
  bool connects_exactly(const Segment<D>& segment, const Candidate<D>& candidate) const;
  bool segment_clearly_misses(const Segment<D>& segment, Index element, int face) const;
  FacePoints<D> face_points(Index element, int face) const {
    const auto ids = SimplexMesh<D>::face_of(input_.elements[element].vertices, face);
    FacePoints<D> points;
    for (int i = 0; i < D; ++i) points[i] = input_.positions[ids[i]];
    return points;
  }
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
bool TetTraversal<D>::select_first_exit_face(const Segment<D>& segment, ExitFace& exit_face) const {
  exit_face.element = query_.element;
  const auto& vertices = input_.elements[query_.element].vertices;
  RaySpaceVertex in_ray_space[D + 1];
  for (int i = 0; i <= D; ++i) in_ray_space[i] = segment.to_ray_space(vertices[i]);
  if constexpr (D == 3) {
    int side[4][4];
    const auto find_face = [&] {
      constexpr int kFaces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
      for (exit_face.face = 0; exit_face.face < 4; ++exit_face.face) {
        const auto& [a, b, c] = kFaces[exit_face.face];
        if (side[a][b] <= 0 || side[b][c] <= 0 || side[c][a] <= 0) continue;
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
    for (exit_face.face = 0; exit_face.face < 3; ++exit_face.face) {
      const int a = kFaces[exit_face.face][0], b = kFaces[exit_face.face][1];
      if (side[a] > 0 || side[b] < 0) continue;
      exit_face.corners[0] = in_ray_space[a];
      exit_face.corners[1] = in_ray_space[b];
      return true;
    }
  }
  return false;
}

/// Steps into the next element and turns the exit face into the one through which the segment leaves it. False when it
/// runs exactly through an edge or a vertex there.
template <int D>
bool TetTraversal<D>::select_exit_face(const Segment<D>& segment, Index next, ExitFace& exit_face) const {
  const Index element = HalfFace{next}.element();
  const auto& vertices = input_.elements[element].vertices;
  const RaySpaceVertex apex = segment.to_ray_space(vertices[HalfFace{next}.face()]);
  int behind;  // the corner that does not see the line any more
  if constexpr (D == 3) {
    int a = segment.clear_side(exit_face.corners[0], apex), b = segment.clear_side(exit_face.corners[1], apex),
        c = segment.clear_side(exit_face.corners[2], apex);
    const auto is_clear = [&] { return (((a < 0) & (b > 0)) | ((b < 0) & (c > 0)) | ((c < 0) & (a > 0))) != 0; };
    if (!is_clear()) {  // two that are on different sides are enough
      a = segment.side(exit_face.corners[0], apex);
      b = segment.side(exit_face.corners[1], apex);
      c = segment.side(exit_face.corners[2], apex);
      if (!is_clear()) return false;
    }
    behind = 1 + ((a < 0) & (b > 0)) - ((b < 0) & (c > 0));  // without a branch: it would be unpredictable
  } else {
    const int side = segment.side(apex);
    if (side == 0) return false;
    behind = side > 0 ? 1 : 0;
  }
  exit_face.element = element;
  exit_face.face = position_in(vertices, exit_face.corners[behind].vertex);
  exit_face.corners[behind] = apex;
  return true;
}

template <int D>
TraversalResult TetTraversal<D>::follow(const Candidate<D>& candidate, bool go_on) const {
  if (counters_ != nullptr) ++counters_->traversals;
  count_element();
  if (starts_at(candidate)) return {true};
  const Segment<D> segment(input_, query_.point, candidate,
                           counters_ != nullptr ? &counters_->exact_decisions : nullptr);
  ExitFace exit_face;
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
    const Index next = input_.elements[exit_face.element].neighbours[exit_face.face];
    if (next < 0) {
      const auto crossing = segment.crossing(exit_face.corners);
      return {false, segment.sees_well(crossing, exit_face.corners) ? ~next : kNone,
              segment.parameter(crossing, exit_face.corners)};
    }
    count_element();
    prefetch_beyond(HalfFace{next}.element());
    if (!passed && contains_target(HalfFace{next}.element(), candidate))
      return {is_at_corner(HalfFace{next}.element(), candidate)};
    if (!select_exit_face(segment, next, exit_face)) return {passed ? false : connects_exactly(segment, candidate)};
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
      if (!segment.exact().touches(face_points(element, i))) continue;
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
  const FacePoints<D> points = face_points(element, face);
  const unsigned mask = exact_closest_mask(query_.point, points);
  TargetSimplex<D> target;
  for (int i = 0; i < D; ++i)
    if (mask >> i & 1) target.vertices[target.count++] = points[i];
  const Vec<D> offset = precise_offset<D>(query_.point, target).offset;
  for (int i = 0; i < D; ++i)
    if (offset[i] != 0) return false;
  return true;
}

/// How the whole line through p and s, no farther from s than its reach, meets a face. Where it passes through
/// properly, `exit_face` is that face.
template <int D>
typename TetTraversal<D>::Passing TetTraversal<D>::line_passes(const Segment<D>& segment, Index element, int face,
                                                               ExitFace& exit_face) const {
  const auto ids = SimplexMesh<D>::face_of(input_.elements[element].vertices, face);
  RaySpaceVertex(&corners)[D] = exit_face.corners;
  for (int i = 0; i < D; ++i) corners[i] = segment.to_ray_space(ids[i]);
  int positive = 0, negative = 0;
  const auto is_beside = [&] { return D == 3 ? positive > 0 && negative > 0 : positive == D || negative == D; };
  for (const bool exactly : {false, true}) {
    positive = negative = 0;
    for (int i = 0; i < D; ++i) {
      int side;
      if constexpr (D == 3)
        side = exactly ? segment.side(corners[i], corners[(i + 1) % D])
                       : segment.clear_side(corners[i], corners[(i + 1) % D]);
      else
        side = exactly ? segment.side(corners[i]) : segment.clear_side(corners[i]);
      positive += side > 0;
      negative += side < 0;
    }
    if (is_beside()) return Passing::kNot;
    if (positive + negative == D) break;
  }
  if (positive + negative == 0) {  // the line lies in the plane of the face
    segment.count_exact();
    return segment.exact().touches_within_reach(face_points(element, face)) ? Passing::kTouching : Passing::kNot;
  }
  if (!segment.within_reach(segment.crossing(corners), corners)) return Passing::kNot;
  if (positive + negative < D) return Passing::kTouching;
  bool is_turned = negative > 0;  // listed so that its normal points along the line
  if constexpr (D == 2) is_turned = segment.side(corners[0]) > 0;
  if (is_turned) std::swap(corners[0], corners[1]);
  exit_face.element = element;
  exit_face.face = face;
  return Passing::kProper;
}

/// Follows the line from a face that it passes through properly to the next one, which there is only one of, and so on.
/// True when it comes to an element in `goals`. Where it meets an edge or a vertex the rest is left to the search.
template <int D>
bool TetTraversal<D>::follow_line(const Segment<D>& segment, const KernelVector<Index>& goals, ExitFace exit_face,
                                  KernelVector<HalfFace>& pending) const {
  const Index start = exit_face.element;
  for (;;) {
    const Index next = input_.elements[exit_face.element].neighbours[exit_face.face];
    if (next < 0 || HalfFace{next}.element() == start) return false;
    if (contains(goals, HalfFace{next}.element())) {
      count_element();
      return true;
    }
    prefetch_beyond(HalfFace{next}.element());
    if (!select_exit_face(segment, next, exit_face)) {
      pending.push_back(HalfFace{next});
      return false;
    }
    count_element();
    if (!segment.is_clearly_within_reach(exit_face.corners) &&
        !segment.within_reach(segment.crossing(exit_face.corners), exit_face.corners))
      return false;
  }
}

template <int D>
bool TetTraversal<D>::follow_backwards(const Candidate<D>& candidate) const {
  if (counters_ != nullptr) ++counters_->traversals;
  const Segment<D> segment(input_, query_.point, candidate,
                           counters_ != nullptr ? &counters_->exact_decisions : nullptr);
  const KernelVector<Index> goals = elements_at_point();
  VisitedElements visited;
  KernelVector<HalfFace> pending{input_.boundary_owners[candidate.face]};
  ExitFace exit_face;
  while (!pending.empty()) {
    const HalfFace entry = pending.back();
    pending.pop_back();
    if (!visited.insert(entry.element())) continue;
    count_element();
    if (contains(goals, entry.element())) return true;
    for (int i = 0; i <= D; ++i) {
      const Index next = input_.elements[entry.element()].neighbours[i];
      if (i == entry.face() || next < 0) continue;
      const Passing passing = line_passes(segment, entry.element(), i, exit_face);
      if (passing == Passing::kTouching) pending.push_back(HalfFace{next});
      if (passing == Passing::kProper && follow_line(segment, goals, exit_face, pending)) return true;
    }
  }
  return false;
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
