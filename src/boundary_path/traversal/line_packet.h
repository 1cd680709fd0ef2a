#pragma once

#include "boundary_path/traversal/backward_search.h"
#include "core/simd/simd_double.h"
#include "core/simd/vec3.h"

namespace selvage {
inline namespace SELVAGE_ISA {

/// Backward searches of one query whose lines are followed side by side, sixteen at a time: an element waits for the
/// one before it on its line, but not for those on others.
///
/// Each step is that of BackwardSearch::advance(), by the same operations in double precision, where these leave no
/// doubt. Where they do, or a line ends, the search takes the step itself.
class LinePacket {
 public:
  LinePacket(const PathInput<3>& input, const Vec<3>& p, const KernelVector<Index>& goals)
      : input_(input), p_(p), goals_(goals) {}

  /// Runs the searches to their ends.
  /// @return  elements visited that the searches have not counted
  std::int64_t run(KernelVector<BackwardSearch<3>>& searches);

 private:
  static constexpr int kLanes = 16;
  using Row = double[kLanes];
  using Vector = LaneVec3<WideDouble>;

  bool start_next(int lane);
  void take(int lane);
  void give_back(int lane);
  bool go_on(int lane, bool goes_on);
  void enter_elements();
  void select_exit_faces(int lane);
  void leave_elements();

  const PathInput<3>& input_;
  const Vec<3>& p_;
  const KernelVector<Index>& goals_;
  BackwardSearch<3>* next_search_ = nullptr;
  BackwardSearch<3>* last_search_ = nullptr;
  BackwardSearch<3>* searches_[kLanes];
  unsigned active_ = 0;
  std::int64_t elements_visited_ = 0;
  HalfFace next_[kLanes];
  Index start_[kLanes], vertices_[3][kLanes];
  // What the segments see vertices by.
  alignas(64) Row across_[2][3] = {}, along_[3] = {};
  alignas(64) Row sign_ = {}, forward_ = {}, shear_error_ = {}, backmost_ = {}, foremost_ = {};
  alignas(64) Row corners_[3][4] = {};  ///< of the exit faces: two across, one along, reach
  alignas(64) Row apexes_[3] = {};      ///< positions of the vertices behind the exit faces
  /// Which corner the next exit face does not have any more, and 4 where it is clearly within reach; -1: not clear.
  alignas(64) Row found_ = {};
};

inline std::int64_t LinePacket::run(KernelVector<BackwardSearch<3>>& searches) {
  next_search_ = searches.data();
  last_search_ = searches.data() + searches.size();
  for (int lane = 0; lane < kLanes; ++lane)
    if (start_next(lane)) active_ |= 1u << lane;
  for (enter_elements(); active_ != 0; enter_elements()) {
    for (int lane = 0; lane < kLanes; lane += WideDouble::kLanes)
      if ((active_ >> lane & ((1u << WideDouble::kLanes) - 1)) != 0) select_exit_faces(lane);
    leave_elements();
  }
  return elements_visited_;
}

/// False when no search is left that has a line to follow.
inline bool LinePacket::start_next(int lane) {
  while (next_search_ != last_search_) {
    searches_[lane] = next_search_++;
    if (!searches_[lane]->find_line()) continue;
    take(lane);
    return true;
  }
  return false;
}

inline void LinePacket::take(int lane) {
  const BackwardSearch<3>& search = *searches_[lane];
  start_[lane] = search.line().start;
  next_[lane] = search.line().exit_face.next;
  for (int k = 0; k < 3; ++k) {
    const auto& corner = search.line().exit_face.corners[k];
    corners_[k][0][lane] = corner.across[0];
    corners_[k][1][lane] = corner.across[1];
    corners_[k][2][lane] = corner.along;
    corners_[k][3][lane] = corner.reach;
    vertices_[k][lane] = corner.vertex;
  }
  const Segment<3>::RaySpace space = search.segment().ray_space();
  for (int i = 0; i < 3; ++i) {
    along_[i][lane] = space.along[i];
    for (int k = 0; k < 2; ++k) across_[k][i][lane] = space.across[k][i];
  }
  sign_[lane] = space.sign;
  forward_[lane] = space.forward;
  shear_error_[lane] = space.shear_error;
  backmost_[lane] = space.backmost;
  foremost_[lane] = space.foremost;
}

/// Tells the search how far its line has been followed.
inline void LinePacket::give_back(int lane) {
  ExitFace<3>& exit_face = searches_[lane]->line().exit_face;
  exit_face.next = next_[lane];
  for (int k = 0; k < 3; ++k) {
    auto& corner = exit_face.corners[k];
    corner.across[0] = corners_[k][0][lane];
    corner.across[1] = corners_[k][1][lane];
    corner.along = corners_[k][2][lane];
    corner.reach = corners_[k][3][lane];
    corner.vertex = vertices_[k][lane];
  }
}

/// Goes on with a search that has a line to follow, or else with the next one.
inline bool LinePacket::go_on(int lane, bool goes_on) {
  if (goes_on)
    take(lane);
  else if (!start_next(lane))
    active_ &= ~(1u << lane);
  return (active_ >> lane & 1) != 0;
}

/// Learns the vertices behind the exit faces. Lines that end there are gone on with by their searches.
inline void LinePacket::enter_elements() {
  for (unsigned rest = active_; rest != 0; rest &= rest - 1) {
    const int lane = lowest_lane(rest);
    const auto ends = [&] {
      const HalfFace next = next_[lane];
      return !next.exists() || next.element() == start_[lane] || contains(goals_, next.element());
    };
    bool is_active = true;
    while (is_active && ends()) {
      give_back(lane);
      is_active = go_on(lane, searches_[lane]->advance());
    }
    if (!is_active) continue;
    const HalfFace next = next_[lane];
    const Vec<3>& apex = input_.positions[input_.elements[next.element()].vertices[next.face()]];
    for (int i = 0; i < 3; ++i) apexes_[i][lane] = apex[i];
  }
}

/// The same as selvage::select_exit_face(): products with 0 and 1 are exact, so that a dot product along or across a
/// segment rounds as Segment::to_ray_space() does.
SELVAGE_INLINE void LinePacket::select_exit_faces(int lane) {
  const WideDouble zero = WideDouble::broadcast(0), one = WideDouble::broadcast(1);
  const auto load = [&](const Row& row) { return WideDouble::load(row + lane); };
  const auto load_vector = [&](const Row(&rows)[3]) -> Vector {
    return {{load(rows[0]), load(rows[1]), load(rows[2])}};
  };
  const auto is_less = [&](WideDouble a, WideDouble b) { return select_less(a, b, one, zero); };
  const Vector p = {{WideDouble::broadcast(p_[0]), WideDouble::broadcast(p_[1]), WideDouble::broadcast(p_[2])}};
  const Vector relative = load_vector(apexes_) - p;
  const WideDouble apex[4] = {dot(load_vector(across_[0]), relative), dot(load_vector(across_[1]), relative),
                              dot(load_vector(along_), relative), abs_max(relative)};
  WideDouble positive[3], negative[3];
  for (int k = 0; k < 3; ++k) {
    const WideDouble value = load(sign_) * (load(corners_[k][0]) * apex[1] - load(corners_[k][1]) * apex[0]);
    const WideDouble error = load(shear_error_) * load(corners_[k][3]) * apex[3] + WideDouble::broadcast(kTrustAbove);
    positive[k] = is_less(error, value);
    negative[k] = is_less(value, zero - error);
  }
  const WideDouble is_behind[3] = {negative[1] * positive[2], negative[2] * positive[0], negative[0] * positive[1]};
  WideDouble within = one;
  for (int k = 0; k < 3; ++k) {
    for (int i = 0; i < 4; ++i)
      select_less(zero, is_behind[k], apex[i], load(corners_[k][i])).store(corners_[k][i] + lane);
    const WideDouble along = load(forward_) * load(corners_[k][2]);
    within = within * is_less(load(backmost_), along) * is_less(along, load(foremost_));
  }
  const WideDouble is_clear = is_behind[0] + is_behind[1] + is_behind[2];
  const WideDouble corner = is_behind[1] + is_behind[2] + is_behind[2];
  select_less(zero, is_clear, corner + WideDouble::broadcast(4) * within, zero - one).store(found_ + lane);
}

/// Takes the lines through their new exit faces.
inline void LinePacket::leave_elements() {
  for (unsigned rest = active_; rest != 0; rest &= rest - 1) {
    const int lane = lowest_lane(rest);
    const int found = static_cast<int>(found_[lane]);
    if (found < 0) {
      give_back(lane);
      go_on(lane, searches_[lane]->advance());
      continue;
    }
    const HalfFace next = next_[lane];
    const auto& [vertices, neighbours] = input_.elements[next.element()];
    Index& behind = vertices_[found & 3][lane];
    next_[lane] = {neighbours[position_in(vertices, behind)]};
    behind = vertices[next.face()];
    prefetch_across(input_, next_[lane].code);
    ++elements_visited_;
    if (found >= 4) continue;
    give_back(lane);
    if (!searches_[lane]->is_within_reach()) go_on(lane, searches_[lane]->find_line());
  }
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
