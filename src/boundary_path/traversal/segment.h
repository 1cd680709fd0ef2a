#pragma once

#include "boundary_path/input/path_input.h"
#include "boundary_path/traversal/exact_segment.h"

#include <algorithm>
#include <cmath>

#ifndef SELVAGE_ISA
#define SELVAGE_ISA baseline
#endif

namespace selvage {
inline namespace SELVAGE_ISA {

inline constexpr double kUnitRoundoff = 0x1p-53;
/// Results below this may have lost digits to underflow and are never trusted.
inline constexpr double kTrustAbove = 0x1p-900;

/// Whether an index is among others. Ours, not the standard library's: a copy of a standard template compiled for one
/// instruction set must not be linked into code for another. No branch for a few: it would be unpredictable.
template <std::size_t N>
SELVAGE_INLINE bool contains(const std::array<Index, N>& some, Index value) {
  bool found = false;
  for (std::size_t i = 0; i < N; ++i) found |= some[i] == value;
  return found;
}
template <typename Range>
inline bool contains(const Range& range, Index value) {
  for (const Index item : range)
    if (item == value) return true;
  return false;
}

/// Where an index is that is among a few others.
template <std::size_t N>
SELVAGE_INLINE int position_in(const std::array<Index, N>& some, Index value) {
  int position = 0;
  for (std::size_t i = 1; i < N; ++i) position += some[i] == value ? static_cast<int>(i) : 0;
  return position;
}

/// Heap memory for containers that belong to this instruction set alone.
template <typename T>
struct KernelAllocator {
  using value_type = T;
  KernelAllocator() = default;
  template <typename U>
  KernelAllocator(const KernelAllocator<U>&) {}
  T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T))); }
  void deallocate(T* p, std::size_t) { ::operator delete(p); }
  friend bool operator==(KernelAllocator, KernelAllocator) { return true; }
};
template <typename T>
using KernelVector = std::vector<T, KernelAllocator<T>>;

/// A candidate: the feature of a boundary face, its closest point, and bounds of the rounding errors.
template <int D>
struct Candidate {
  Index face = kNone;
  TargetSimplex<D> target;
  VertexTuple<D> ids;                   ///< of the target's vertices; ascending on an edge
  double offset[D];                     ///< s - p
  std::array<double, D> barycentric{};  ///< with respect to ids
  double squared_distance = 0;
  double direction[D];         ///< parallel to s - p, known better than it when the target is a triangle
  double direction_error = 0;  ///< absolute, per coordinate of `direction`
  double offset_error = 0;     ///< absolute, per coordinate of `offset`
  bool has_normal = false;     ///< the direction is the normal of a triangle, outward
};

/// Where several corners of the material meet in the target, each of their faces is a target of its own.
template <int D>
inline bool is_split(const PathInput<D>& input, const Candidate<D>& candidate) {
  if (candidate.target.count == D) return false;
  for (int i = 0; i < candidate.target.count; ++i)
    if (!input.is_split[candidate.ids[i]]) return false;
  return true;
}

/// The element on the other side of a face, if there is one; without a branch.
template <int D>
SELVAGE_INLINE void prefetch_across(const PathInput<D>& input, Index neighbour) {
  prefetch(input.elements + HalfFace{neighbour & ~(neighbour >> 31)}.element());
}

/// The segment from p to the closest point s of a candidate, seen along itself.
///
/// Vertices are sheared so that the line through p and s becomes the axis; then the side on which the line passes an
/// edge is the sign of a 2 x 2 determinant (Woop, Benthin, Wald 2013; SPB supplement 1.1.1). A bound of the rounding
/// error, relative to the distance of the vertices from p, tells when that sign is certain; otherwise it is decided in
/// exact arithmetic. So every decision is exact, and nearly every one costs a few multiplications.
template <int D>
class Segment {
 public:
  /// A vertex relative to the segment: `across` its coordinates off the axis, `along` the one on it.
  struct RaySpaceVertex {
    double across[D - 1];
    double along;
    double reach;  ///< largest absolute coordinate relative to p
    Index vertex;
  };

  Segment(const PathInput<D>& input, const Vec<D>& p, const Candidate<D>& candidate, std::int64_t* exact_decisions)
      : input_(input), p_(p), candidate_(candidate), exact_(p, candidate.target), exact_decisions_(exact_decisions) {
    for (int i = 1; i < D; ++i)
      if (std::abs(candidate.direction[i]) > std::abs(candidate.direction[axis_])) axis_ = i;
    const double main = candidate.direction[axis_];
    for (int k = 0; k < D - 1; ++k) {
      other_[k] = (axis_ + 1 + k) % D;
      shear_[k] = candidate.direction[other_[k]] / main;
    }
    const double relative_error = candidate.direction_error / std::abs(main);
    // First-order bound; where it is not small nothing is certain.
    shear_error_ = relative_error < 1e-3 ? 16 * relative_error + 96 * kUnitRoundoff : HUGE_VAL;
    end_ = candidate.offset[axis_];
    sign_ = (end_ < 0 ? -1.0 : 1.0) * (D == 2 && axis_ == 1 ? -1.0 : 1.0);
    forward_ = end_ < 0 ? -1.0 : 1.0;
    const double length = std::abs(end_), farthest = 3 * length;
    const double error = 4 * (candidate.offset_error + 4 * kUnitRoundoff * farthest) + kTrustAbove;
    backmost_ = error - length;
    foremost_ = farthest - error;
  }

  /// What to_ray_space() and the tests below go by, for those who do the same for several segments at once.
  struct RaySpace {
    double across[D - 1][D] = {}, along[D] = {};  ///< a vertex relative to p is multiplied by these
    double sign, forward, shear_error, backmost, foremost;
  };
  RaySpace ray_space() const {
    RaySpace space;
    space.along[axis_] = 1;
    for (int k = 0; k < D - 1; ++k) {
      space.across[k][other_[k]] = 1;
      space.across[k][axis_] = -shear_[k];
    }
    space.sign = sign_;
    space.forward = forward_;
    space.shear_error = shear_error_;
    space.backmost = backmost_;
    space.foremost = foremost_;
    return space;
  }

  RaySpaceVertex to_ray_space(Index vertex) const {
    const Vec<D>& x = input_.positions[vertex];
    RaySpaceVertex s;
    s.along = x[axis_] - p_[axis_];
    s.reach = std::abs(s.along);
    for (int k = 0; k < D - 1; ++k) {
      const double relative = x[other_[k]] - p_[other_[k]];
      s.reach = std::max(s.reach, std::abs(relative));
      s.across[k] = relative - shear_[k] * s.along;
    }
    s.vertex = vertex;
    return s;
  }

  /// Twice the area that the line sees between two vertices (3D), the offset of a vertex from the line (2D); positive
  /// when they turn counter-clockwise about the direction from p to s. Only the sign from side() is certain.
  static double area(const RaySpaceVertex& a, const RaySpaceVertex& b) requires(D == 3) {
    return a.across[0] * b.across[1] - a.across[1] * b.across[0];
  }

  /// The sign of a value where it is certain, else 0. Without a branch: it would be unpredictable.
  static int clear_sign(double value, double error) { return int{value > error} - int{value < -error}; }

  /// The sign of det(s - p, a - p, b - p) where it is certain at a glance, else 0.
  int clear_side(const RaySpaceVertex& a, const RaySpaceVertex& b) const requires(D == 3) {
    return clear_sign(sign_ * area(a, b), shear_error_ * a.reach * b.reach + kTrustAbove);
  }

  /// Exact sign of det(s - p, a - p, b - p).
  int side(const RaySpaceVertex& a, const RaySpaceVertex& b) const requires(D == 3) {
    if (const int clear = clear_side(a, b)) return clear;
    if (a.reach == 0 || b.reach == 0 || meets_by_construction(a.vertex, b.vertex)) return 0;
    count_exact();
    return exact_.side({input_.positions[a.vertex], input_.positions[b.vertex]});
  }

  /// The same of det(s - p, a - p).
  int clear_side(const RaySpaceVertex& a) const requires(D == 2) {
    return clear_sign(sign_ * a.across[0], shear_error_ * a.reach + kTrustAbove);
  }

  /// Exact sign of det(s - p, a - p).
  int side(const RaySpaceVertex& a) const requires(D == 2) {
    if (const int clear = clear_side(a)) return clear;
    if (a.reach == 0 || (candidate_.target.count == 1 && a.vertex == candidate_.ids[0])) return 0;
    count_exact();
    return exact_.side({input_.positions[a.vertex]});
  }

  /// Where the line crosses a face that it passes through properly: weights of its vertices, and the parameter of the
  /// crossing (0 at p, 1 at s).
  struct Crossing {
    double weights[D];
    double total;
  };
  Crossing crossing(const RaySpaceVertex (&face)[D]) const {
    Crossing c;
    if constexpr (D == 3) {
      c.weights[0] = sign_ * area(face[1], face[2]);
      c.weights[1] = sign_ * area(face[2], face[0]);
      c.weights[2] = sign_ * area(face[0], face[1]);
      c.total = c.weights[0] + c.weights[1] + c.weights[2];
    } else {
      c.weights[0] = sign_ * face[1].across[0];
      c.weights[1] = -sign_ * face[0].across[0];
      c.total = c.weights[0] + c.weights[1];
    }
    return c;
  }

  /// Whether parameter() is good to 1e-7: false where the line grazes the face.
  bool sees_well(const Crossing& c, const RaySpaceVertex (&face)[D]) const {
    double reach = std::abs(end_);
    for (int i = 0; i < D; ++i) reach = std::max(reach, face[i].reach);
    const double area_bound = D == 3 ? reach * reach : reach;
    return c.total * std::abs(end_) > 1e8 * (shear_error_ * reach + candidate_.offset_error) * area_bound;
  }

  double parameter(const Crossing& c, const RaySpaceVertex (&face)[D]) const {
    double sum = 0;
    for (int i = 0; i < D; ++i) sum += c.weights[i] * face[i].along;
    return sum / (c.total * end_);
  }

  /// Whether the vertex lies behind p, along the axis on which the segment is longest: exactly.
  bool is_behind_start(const RaySpaceVertex& a) const { return forward_ * a.along < 0; }

  /// Whether the line certainly crosses the face before it comes to s, wherever it passes through: exactly, since that
  /// is seen on the coordinates of the face's vertices.
  bool is_before_end(const RaySpaceVertex (&face)[D]) const {
    double last = forward_ * face[0].along, reach = std::abs(end_);
    for (int i = 0; i < D; ++i) {
      last = std::max(last, forward_ * face[i].along);
      reach = std::max(reach, std::abs(face[i].along));
    }
    return last < forward_ * end_ - (candidate_.offset_error + 4 * kUnitRoundoff * reach) - kTrustAbove;
  }

  /// The same as within_reach() where it is certain on the coordinates of the face's vertices.
  bool is_clearly_within_reach(const RaySpaceVertex (&face)[D]) const {
    bool within = true;
    for (int i = 0; i < D; ++i)
      within &= (backmost_ < forward_ * face[i].along) & (forward_ * face[i].along < foremost_);
    return within;
  }

  /// Whether the line crosses the face, which it passes through properly, no farther than 2 |p - s| from s. Exact.
  bool within_reach(const Crossing& c, const RaySpaceVertex (&face)[D]) const {
    double reach = std::abs(end_);
    for (int i = 0; i < D; ++i) reach = std::max(reach, face[i].reach);
    const double area_bound = D == 3 ? reach * reach : reach;
    const double beyond = std::abs(parameter(c, face) - 1) - 2;
    const double error = 64 * (shear_error_ * reach + candidate_.offset_error) * area_bound;
    if (std::abs(beyond) * std::abs(c.total * end_) > error * (1 + std::abs(beyond)) + kTrustAbove) return beyond < 0;
    count_exact();
    FacePoints<D> points;
    for (int i = 0; i < D; ++i) points[i] = input_.positions[face[i].vertex];
    return exact_.crosses_within_reach(points);
  }

  /// Exact: 1 when s lies strictly before the crossing of the face, -1 strictly behind it, 0 on the face's plane. The
  /// line passes properly through the face, which is listed so that its normal points along the line.
  int end_before(const Crossing& c, const RaySpaceVertex (&face)[D]) const {
    double value = 0, reach = std::abs(end_);
    for (int i = 0; i < D; ++i) {
      value += c.weights[i] * (forward_ * (face[i].along - end_));
      reach = std::max(reach, face[i].reach);
    }
    const double area_bound = D == 3 ? reach * reach : reach;
    const double bound =
        2 * D * area_bound * (2 * shear_error_ * reach + 8 * (4 * kUnitRoundoff * reach + candidate_.offset_error));
    if (std::abs(value) > bound + kTrustAbove) return value > 0 ? 1 : -1;
    count_exact();
    FacePoints<D> points;
    for (int i = 0; i < D; ++i) points[i] = input_.positions[face[i].vertex];
    // Beyond the face is its positive side in space, and its negative one in the plane.
    return D == 3 ? -exact_.side_of_end(points) : exact_.side_of_end(points);
  }

  /// Whether s lies in a vertex or an edge of a face by construction.
  bool ends_on_edge_of(const VertexTuple<D>& face) const {
    for (int i = 0; i < candidate_.target.count; ++i)
      if (!contains(face, candidate_.ids[i])) return false;
    return candidate_.target.count < D;
  }

  const ExactSegment<D>& exact() const { return exact_; }
  double length() const { return std::sqrt(candidate_.squared_distance); }
  void count_exact() const {
    if (exact_decisions_ != nullptr) ++*exact_decisions_;
  }

 private:
  /// Whether the line meets the edge (a, b) by construction: the target is the edge, or one of its ends.
  bool meets_by_construction(Index a, Index b) const {
    const auto& ids = candidate_.ids;
    if (candidate_.target.count == 1) return a == ids[0] || b == ids[0];
    return candidate_.target.count == 2 && ((a == ids[0] && b == ids[1]) || (a == ids[1] && b == ids[0]));
  }

  const PathInput<D>& input_;
  const Vec<D>& p_;
  const Candidate<D>& candidate_;
  ExactSegment<D> exact_;
  std::int64_t* exact_decisions_;
  int axis_ = 0, other_[D - 1];
  double shear_[D - 1];
  double shear_error_;  ///< bounds the error of area() (3D) or `across` (2D) relative to the reaches
  double end_;          ///< `along` of s
  double sign_;         ///< turns the sign of a sheared determinant into that of the true one
  double forward_;
  double backmost_, foremost_;  ///< bound `forward_ * along` of what is clearly within reach
};

}  // namespace SELVAGE_ISA
}  // namespace selvage
