#pragma once

#include "boundary_path/traversal/exit_face.h"

namespace selvage {
inline namespace SELVAGE_ISA {

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

/// The search of TetTraversal::follow_backwards() for one candidate.
///
/// Reached are all elements that the line meets, joined to the candidate's face through faces that it meets. Through
/// most of these it passes properly, and then leaves each element by one other face. Where it meets an edge or a vertex
/// the search stops, and looks at all faces of the element.
template <int D>
class BackwardSearch {
 public:
  /// A part of the line that is followed from face to face.
  struct Line {
    Index start;  ///< the element that it began in
    ExitFace<D> exit_face;
  };

  /// @param goals  the search ends in any of these elements
  BackwardSearch(const PathInput<D>& input, const Vec<D>& p, const Candidate<D>& candidate,
                 const KernelVector<Index>& goals, PathCounters* counters)
      : input_(input),
        segment_(input, p, candidate, counters != nullptr ? &counters->exact_decisions : nullptr),
        goals_(goals),
        counters_(counters),
        stops_{input.boundary_owners[candidate.face]} {
    if (counters_ != nullptr) ++counters_->traversals;
  }

  /// Begins with the next line, looking around from stop to stop until there is one. False when the search is over.
  bool find_line();

  /// Follows the line into the next element, or goes on with another one. False when the search is over.
  SELVAGE_INLINE bool advance();

  bool has_arrived() const { return has_arrived_; }

  // For a LinePacket, which follows the line itself.
  const Segment<D>& segment() const { return segment_; }
  const Line& line() const { return line_; }
  Line& line() { return line_; }
  /// Whether the line passes through its exit face within its reach.
  bool is_within_reach() const {
    const auto& corners = line_.exit_face.corners;
    return segment_.is_clearly_within_reach(corners) || segment_.within_reach(segment_.crossing(corners), corners);
  }

 private:
  enum class Passing : std::uint8_t { kNot, kTouching, kProper };
  Passing passing(Index element, int face, ExitFace<D>& exit_face) const;
  void look_around(HalfFace entry);
  bool arrives_in(Index element) {
    has_arrived_ |= contains(goals_, element);
    return has_arrived_;
  }
  void count_element() const {
    if (counters_ != nullptr) ++counters_->elements_visited;
  }

  const PathInput<D>& input_;
  Segment<D> segment_;
  const KernelVector<Index>& goals_;
  PathCounters* counters_;
  bool has_arrived_ = false;
  Line line_;
  KernelVector<Line> lines_;      ///< that are left to follow
  KernelVector<HalfFace> stops_;  ///< that are left to look around from, each as the face by which it is entered
  VisitedElements visited_;
};

/// How the whole line through p and s, no farther from s than its reach, meets a face. Where it passes through
/// properly, `exit_face` is that face.
template <int D>
typename BackwardSearch<D>::Passing BackwardSearch<D>::passing(Index element, int face, ExitFace<D>& exit_face) const {
  const auto ids = SimplexMesh<D>::face_of(input_.elements[element].vertices, face);
  if (segment_.ends_on_edge_of(ids)) return Passing::kTouching;
  auto& corners = exit_face.corners;
  for (int i = 0; i < D; ++i) corners[i] = segment_.to_ray_space(ids[i]);
  int positive = 0, negative = 0;
  const auto is_beside = [&] { return D == 3 ? positive > 0 && negative > 0 : positive == D || negative == D; };
  for (const bool exactly : {false, true}) {
    positive = negative = 0;
    for (int i = 0; i < D; ++i) {
      int side;
      if constexpr (D == 3)
        side = exactly ? segment_.side(corners[i], corners[(i + 1) % D])
                       : segment_.clear_side(corners[i], corners[(i + 1) % D]);
      else
        side = exactly ? segment_.side(corners[i]) : segment_.clear_side(corners[i]);
      positive += side > 0;
      negative += side < 0;
    }
    if (is_beside()) return Passing::kNot;
    if (positive + negative == D) break;
  }
  if (positive + negative == 0) {  // the line lies in the plane of the face
    segment_.count_exact();
    return segment_.exact().touches_within_reach(face_points(input_, element, face)) ? Passing::kTouching
                                                                                     : Passing::kNot;
  }
  if (!segment_.is_clearly_within_reach(corners) && !segment_.within_reach(segment_.crossing(corners), corners))
    return Passing::kNot;
  if (positive + negative < D) return Passing::kTouching;
  bool is_turned = negative > 0;  // listed so that its normal points along the line
  if constexpr (D == 2) is_turned = segment_.side(corners[0]) > 0;
  if (is_turned) std::swap(corners[0], corners[1]);
  return Passing::kProper;
}

template <int D>
SELVAGE_INLINE bool BackwardSearch<D>::advance() {
  ExitFace<D>& exit_face = line_.exit_face;
  const HalfFace next = exit_face.next;
  if (!next.exists() || next.element() == line_.start) return find_line();
  count_element();
  if (arrives_in(next.element())) return false;
  if (!select_exit_face(input_, segment_, exit_face)) {
    stops_.push_back(next);
    return find_line();
  }
  prefetch_across(input_, exit_face.next.code);
  return is_within_reach() || find_line();
}

template <int D>
bool BackwardSearch<D>::find_line() {
  while (lines_.empty()) {
    if (stops_.empty()) return false;
    const HalfFace stop = stops_.back();
    stops_.pop_back();
    if (!visited_.insert(stop.element())) continue;
    count_element();
    if (arrives_in(stop.element())) return false;
    look_around(stop);
  }
  line_ = lines_.back();
  lines_.pop_back();
  return true;
}

/// Adds what the line meets beyond an element.
template <int D>
void BackwardSearch<D>::look_around(HalfFace entry) {
  Line line;
  line.start = entry.element();
  for (int i = 0; i <= D; ++i) {
    const HalfFace next{input_.elements[entry.element()].neighbours[i]};
    if (i == entry.face() || !next.exists()) continue;
    const Passing how = passing(entry.element(), i, line.exit_face);
    if (how == Passing::kTouching) stops_.push_back(next);
    if (how != Passing::kProper) continue;
    line.exit_face.next = next;
    lines_.push_back(line);
  }
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
