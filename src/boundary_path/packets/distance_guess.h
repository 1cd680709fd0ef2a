#pragma once

#include "boundary_path/packets/packet_search.h"

/// How far a PacketSearch guesses the answers to be, before anything is known of them.
namespace selvage {
inline namespace SELVAGE_ISA {

/// Looks for near faces in single precision: from those to start with, then from what others of the group have found.
/// Nothing is said of whether paths lead there.
/// @return  lanes for which there is a guess
template <int D>
unsigned PacketSearch<D>::guess(unsigned lanes) {
  unsigned some = 0;
  for (unsigned rest = lanes; rest != 0; rest &= rest - 1) {
    const int lane = lowest_lane(rest);
    guesses_.face[lane] = searches_[lane].first_face();
    guesses_.nearest[lane] = kNone;
    guesses_.squared_distance[lane] = HUGE_VALF;
    if (guesses_.face[lane] != kNone) some |= 1u << lane;
  }
  approach(some);
  if (input_.options.use_hints) approach(start_from_others(some));
  for (unsigned rest = some; rest != 0; rest &= rest - 1)
    if (guesses_.nearest[lowest_lane(rest)] == kNone) some &= ~(rest & (0u - rest));
  return some;
}

/// Mostly there is no defect anywhere near the group, and no search needs to look for one itself.
template <int D>
void PacketSearch<D>::look_for_defects() {
  constexpr float kFarBeyond = 8;
  alignas(64) float squared_reach[kWidth];
  bool any = false;
  if (input_.defect_nodes.empty()) {
    Float16::broadcast(HUGE_VALF).store(squared_reach);
  } else if (present_ != 0) {
    (Float16::load(guesses_.squared_distance) * Float16::broadcast(kFarBeyond * kFarBeyond)).store(squared_reach);
    visit_overlaps(input_.defect_nodes, box_of_reach(squared_reach), [&](Index) {
      any = true;
      return false;
    });
  }
  for (unsigned rest = present_; rest != 0; rest &= rest - 1) {
    const int lane = lowest_lane(rest);
    searches_[lane].take_defects(squared_reach[lane], any);
  }
}

/// Goes on to neighbours as long as they come closer for more than a few.
template <int D>
void PacketSearch<D>::approach(unsigned lanes) {
  constexpr int kMaxSteps = 8;
  constexpr Index kLanes[kWidth] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
  if (lanes == 0) return;
  for (int lane = 0; lane < kWidth; ++lane)
    if ((lanes >> lane & 1) == 0) guesses_.face[lane] = guesses_.face[lowest_lane(lanes)];
  unsigned moving = lanes;
  for (int step = 0; step < kMaxSteps && (step == 0 || count_bits(moving) > kMaxLeftBehind); ++step) {
    const FaceFindings<D> found = look_at(view(guesses_.face, kLanes));
    alignas(64) float squared[kWidth], points[3][kWidth];
    dot(found.way, found.way).store(squared);
    for (int i = 0; i < 3; ++i) (Float16::load(query_point_[i]) + found.way[i]).store(points[i]);
    unsigned on = 0;
    for (const unsigned neighbours : found.closer) on |= neighbours;
    for (unsigned rest = moving; rest != 0; rest &= rest - 1) {
      const int lane = lowest_lane(rest);
      const unsigned bit = 1u << lane;
      if (!(squared[lane] < guesses_.squared_distance[lane]) || !searches_[lane].may_end_at(guesses_.face[lane])) {
        moving &= ~bit;
        continue;
      }
      guesses_.squared_distance[lane] = squared[lane];
      for (int i = 0; i < 3; ++i) guesses_.point[i][lane] = points[i][lane];
      guesses_.nearest[lane] = guesses_.face[lane];
      int k = 0;
      while (k < D - 1 && (found.closer[k] & bit) == 0) ++k;
      if ((on & bit) != 0) guesses_.face[lane] = input_.boundary_neighbours[guesses_.face[lane]][k];
    }
    moving &= on;
  }
}

/// Starts each lane from the nearest of the points that others have found, now or just before.
/// @return  lanes for which that is nearer than what they have
template <int D>
unsigned PacketSearch<D>::start_from_others(unsigned lanes) {
  const Float16 own = Float16::load(guesses_.squared_distance);
  Float16 least = own, from = Float16::broadcast(0);
  const Vector16 p = load_axes<Float16>(query_point_);
  Index faces[kWidth + kWidth];
  int count = 0;
  const auto compare = [&](const float(&rows)[3][kWidth], int i, Index face) {
    const Vector16 to_point = broadcast_axes<Float16>(rows, i) - p;
    const Float16 squared = dot(to_point, to_point);
    from = select_less(squared, least, Float16::broadcast(static_cast<float>(count)), from);
    least = min(squared, least);
    faces[count++] = face;
  };
  for (unsigned rest = lanes; rest != 0; rest &= rest - 1) {
    const int other = lowest_lane(rest);
    if (guesses_.nearest[other] == kNone) continue;
    compare(guesses_.point, other, guesses_.nearest[other]);
  }
  for (int i = 0; i < latest_.count; ++i) compare(latest_.point, i, latest_.face[i]);
  alignas(64) float others[kWidth];
  from.store(others);
  const unsigned nearer = ~less_equal(own * Float16::broadcast(0.99f), least) & lanes;
  for (unsigned rest = nearer; rest != 0; rest &= rest - 1) {
    const int lane = lowest_lane(rest);
    guesses_.face[lane] = faces[static_cast<int>(others[lane])];
  }
  return nearer;
}

/// Keeps answers for those that come next, which lie near.
template <int D>
void PacketSearch<D>::keep_answers(unsigned lanes) {
  latest_.count = 0;
  for (unsigned rest = lanes; rest != 0; rest &= rest - 1) {
    const LaneSearch<D>& search = searches_[lowest_lane(rest)];
    if (!search.has_answer()) continue;
    const Answer<D> answer = search.answer();
    for (int i = 0; i < 3; ++i)
      latest_.point[i][latest_.count] = i < D ? static_cast<float>(answer.point[i] - input_.box_origin.position[i]) : 0;
    latest_.face[latest_.count++] = answer.face;
  }
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
