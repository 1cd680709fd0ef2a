#pragma once

#include "boundary_path/packets/face_view.h"
#include "boundary_path/traversal/segment.h"

namespace selvage {
inline namespace SELVAGE_ISA {

/// Tetrahedral traversal of up to sixteen segments from points p to candidates s, side by side in single precision,
/// each as long as everything about it is certain. A segment that is found to be a valid path is one, and one that is
/// found to be blocked is none; the others are left to TetTraversal.
///
/// As there, an element is left through the face that the line passes through. All elements are positive and
/// all neighbours lie on both sides of their face, so that the line runs forward from face to face. The element with
/// the target is convex and holds s, so that the line comes into it no later than to s. A line that leaves the material
/// before, or comes to a face that lies beyond s, is blocked.
class TetTraversalPacket {
 public:
  explicit TetTraversalPacket(const PathInput<3>& input) : input_(input) {}

  void clear() { active_ = blocked_ = 0; }

  /// p lies strictly inside its element, which does not have the target; no corners of the material meet there.
  void add(int lane, Index element, const Candidate<3>& candidate);

  /// Lanes with segments that are valid paths.
  /// @param query_point  p of each lane from the box origin, each coordinate to the nearest float
  unsigned follow(const float (&query_point)[3][kPacketSize]);

  /// Lanes with segments that are no valid paths, among those followed last.
  unsigned blocked() const { return blocked_; }

  /// Of a valid path, or a blocked one.
  int elements_visited(int lane) const { return visited_[lane]; }

 private:
  static constexpr int kLanes = kPacketSize, kMaxSteps = 64;

  /// Vertices as seen along the segments: across them, and relative to p the largest coordinate and the one along which
  /// the segment is longest.
  struct RaySpaceVertices {
    Float16 x, y, reach, along;
  };
  struct Sides {
    unsigned positive, negative;
  };

  RaySpaceVertices to_ray_space(const Index* vertices) const;
  Sides sides(const RaySpaceVertices& a, const RaySpaceVertices& b) const;
  void select_first_exit_faces();
  unsigned arrive();
  void select_exit_faces();
  void stop_beyond_ends();
  void set_corner(int k, int lane, Index vertex, const float (&in_ray_space)[4][kLanes]) {
    vertices_[k][lane] = vertex;
    for (int i = 0; i < 4; ++i) corners_[k][i][lane] = in_ray_space[i][lane];
  }
  SELVAGE_INLINE RaySpaceVertices corner(int k) const {
    const auto& rows = corners_[k];
    return {Float16::load(rows[0]), Float16::load(rows[1]), Float16::load(rows[2]), Float16::load(rows[3])};
  }
  static void store(const RaySpaceVertices& s, float (&rows)[4][kLanes]) {
    s.x.store(rows[0]);
    s.y.store(rows[1]);
    s.reach.store(rows[2]);
    s.along.store(rows[3]);
  }

  const PathInput<3>& input_;
  unsigned active_ = 0, blocked_ = 0;
  int visited_[kLanes];
  Index element_[kLanes];                          ///< that the segment leaves through its exit face
  Index next_[kLanes];                             ///< the element behind the exit face
  Index goal_[kLanes], goal_vertices_[2][kLanes];  ///< the owner of the target, or what an element there must have
  Vector16 query_point_, across_[2], along_;       ///< directions across the segments, and an axis along them
  alignas(64) float across_rows_[2][3][kLanes] = {}, along_rows_[3][kLanes] = {};
  alignas(64) float ends_[kLanes] = {};           ///< `along` of s, or a little more
  alignas(64) float corners_[3][4][kLanes] = {};  ///< of the exit faces, each as a RaySpaceVertices
  Index vertices_[3][kLanes];                     ///< of the exit faces
  alignas(64) Index apexes_[4][kLanes] = {};
};

inline void TetTraversalPacket::add(int lane, Index element, const Candidate<3>& candidate) {
  const double* d = candidate.direction;
  int axis = 0;
  for (int i = 1; i < 3; ++i)
    if (std::abs(d[i]) > std::abs(d[axis])) axis = i;
  if (!(candidate.direction_error < 0x1p-24 * std::abs(d[axis]))) return;
  const double sign = candidate.offset[axis] < 0 ? -1 : 1;
  const int other[2] = {(axis + 1) % 3, (axis + 2) % 3};
  for (int k = 0; k < 2; ++k) {
    const double turn = k == 0 ? sign : 1;
    across_rows_[k][other[k]][lane] = static_cast<float>(turn);
    across_rows_[k][other[1 - k]][lane] = 0;
    across_rows_[k][axis][lane] = static_cast<float>(-turn * (d[other[k]] / d[axis]));
  }
  along_rows_[axis][lane] = static_cast<float>(sign);
  for (const int i : other) along_rows_[i][lane] = 0;
  ends_[lane] = static_cast<float>(std::abs(candidate.offset[axis])) * (1 + 0x1p-20f) + 1e-30f;
  element_[lane] = element;
  visited_[lane] = 1;
  const bool is_face = candidate.target.count == 3;
  goal_[lane] = is_face ? input_.boundary_owners[candidate.face].element() : kNone;
  goal_vertices_[0][lane] = is_face ? kNone : candidate.ids[0];
  goal_vertices_[1][lane] = is_face ? kNone : candidate.ids[candidate.target.count - 1];
  active_ |= 1u << lane;
}

inline unsigned TetTraversalPacket::follow(const float (&query_point)[3][kPacketSize]) {
  if (active_ == 0) return 0;
  for (int i = 0; i < 3; ++i) {
    query_point_[i] = Float16::load(query_point[i]);
    for (int k = 0; k < 2; ++k) across_[k][i] = Float16::load(across_rows_[k][i]);
    along_[i] = Float16::load(along_rows_[i]);
  }
  select_first_exit_faces();
  unsigned arrived = 0;
  for (int step = 0; step < kMaxSteps && active_ != 0; ++step) {
    stop_beyond_ends();
    arrived |= arrive();
    select_exit_faces();
  }
  active_ = 0;
  return arrived;
}

SELVAGE_INLINE TetTraversalPacket::RaySpaceVertices TetTraversalPacket::to_ray_space(const Index* vertices) const {
  const Vector16 x = gather(input_.rounded, [&](int lane) { return vertices[lane]; }) - query_point_;
  return {dot(across_[0], x), dot(across_[1], x), abs_max(x), dot(along_, x)};
}

/// Signs of det(s - p, a - p, b - p), where they are certain.
///
/// Let r bound the error of a rounded coordinate, R be the larger reach. A coordinate relative to p is off by 2 r +
/// 2^-24 R. Of each direction across, one coordinate is 0, one 1 or -1 and one, at most 1, is known to 8 units of
/// 2^-24. So a vertex is off by E = 4 r + 13 units R across the segment, where it lies within 2 R, and the determinant
/// by 8 E R
/// + 2 E^2 + 16 units R^2. Terms that underflow are far below the last term.
SELVAGE_INLINE TetTraversalPacket::Sides TetTraversalPacket::sides(const RaySpaceVertices& a,
                                                                   const RaySpaceVertices& b) const {
  const Float16 value = a.x * b.y - a.y * b.x, reach = max(a.reach, b.reach);
  const Float16 bound = reach * (Float16::broadcast(64 * input_.rounding) + Float16::broadcast(0x1p-16f) * reach) +
                        Float16::broadcast(1e-30f);
  return {less_equal(bound, value), less_equal(value, Float16::broadcast(0) - bound)};
}

inline void TetTraversalPacket::select_first_exit_faces() {
  for (unsigned rest = active_; rest != 0; rest &= rest - 1) {
    const int lane = lowest_lane(rest);
    for (int k = 0; k < 4; ++k) apexes_[k][lane] = input_.elements[element_[lane]].vertices[k];
  }
  RaySpaceVertices in_ray_space[4];
  alignas(64) float rows[4][4][kLanes];
  for (int k = 0; k < 4; ++k) {
    in_ray_space[k] = to_ray_space(apexes_[k]);
    store(in_ray_space[k], rows[k]);
  }
  Sides side[4][4];
  for (int i = 0; i < 4; ++i) {
    for (int j = i + 1; j < 4; ++j) {
      side[i][j] = sides(in_ray_space[i], in_ray_space[j]);
      side[j][i] = {side[i][j].negative, side[i][j].positive};
    }
  }
  const unsigned starting = active_;
  active_ = 0;
  constexpr int kFaces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  for (int face = 0; face < 4; ++face) {
    const auto& [a, b, c] = kFaces[face];
    const unsigned through = starting & side[a][b].positive & side[b][c].positive & side[c][a].positive;
    for (unsigned rest = through; rest != 0; rest &= rest - 1) {
      const int lane = lowest_lane(rest);
      for (int k = 0; k < 3; ++k) set_corner(k, lane, apexes_[kFaces[face][k]][lane], rows[kFaces[face][k]]);
      next_[lane] = input_.elements[element_[lane]].neighbours[face];
    }
    active_ |= through;
  }
}

/// Steps into the next elements. Lanes that have come to their target, or to the boundary, are done.
inline unsigned TetTraversalPacket::arrive() {
  unsigned arrived = 0;
  for (unsigned rest = active_; rest != 0; rest &= rest - 1) {
    const int lane = lowest_lane(rest);
    const HalfFace next{next_[lane]};
    const unsigned bit = 1u << lane;
    if (!next.exists()) {
      blocked_ |= bit;
      active_ &= ~bit;
      continue;
    }
    ++visited_[lane];
    element_[lane] = next.element();
    const auto& [vertices, neighbours] = input_.elements[next.element()];
    for (const Index neighbour : neighbours) prefetch_across(input_, neighbour);
    apexes_[0][lane] = vertices[next.face()];
    if (next.element() == goal_[lane] ||
        (contains(vertices, goal_vertices_[0][lane]) && contains(vertices, goal_vertices_[1][lane]))) {
      arrived |= bit;
      active_ &= ~bit;
    }
  }
  return arrived;
}

/// Where all corners of an exit face certainly lie beyond s, as seen on a coordinate, so does where the line passes
/// through. A coordinate relative to p is off by 2 r + 2^-24 of the reach: see sides().
inline void TetTraversalPacket::stop_beyond_ends() {
  Float16 nearest;
  for (int k = 0; k < 3; ++k) {
    const Float16 error =
        Float16::load(corners_[k][2]) * Float16::broadcast(0x1p-22f) + Float16::broadcast(4 * input_.rounding);
    const Float16 along = Float16::load(corners_[k][3]) - error;
    nearest = k == 0 ? along : min(nearest, along);
  }
  const unsigned beyond = less_equal(Float16::load(ends_), nearest, active_);
  blocked_ |= beyond;
  active_ &= ~beyond;
}

/// Turns the exit faces into those through which the segments leave the elements.
inline void TetTraversalPacket::select_exit_faces() {
  const RaySpaceVertices apex = to_ray_space(apexes_[0]);
  Sides side[3];
  for (int k = 0; k < 3; ++k) side[k] = sides(corner(k), apex);
  alignas(64) float rows[4][kLanes];
  store(apex, rows);
  const unsigned last = side[0].negative & side[1].positive, first = side[1].negative & side[2].positive;
  active_ &= last | first | (side[2].negative & side[0].positive);
  for (unsigned rest = active_; rest != 0; rest &= rest - 1) {
    const int lane = lowest_lane(rest);
    const int behind = static_cast<int>(1 + (last >> lane & 1) - (first >> lane & 1));
    const PathElement<3>& element = input_.elements[element_[lane]];
    next_[lane] = element.neighbours[position_in(element.vertices, vertices_[behind][lane])];
    set_corner(behind, lane, apexes_[0][lane], rows);
  }
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
