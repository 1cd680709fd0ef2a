#pragma once

#include "selvage/bvh/bvh.h"
#include "selvage/bvh/traverse.h"
#include "selvage/mesh/simplex_mesh.h"

#include <cmath>

namespace selvage {

/// An interval on each axis.
struct Range {
  Vec3 lower = Vec3::Constant(HUGE_VAL);
  Vec3 upper = Vec3::Constant(-HUGE_VAL);

  void add(const Vec3& x) {
    lower = lower.cwiseMin(x);
    upper = upper.cwiseMax(x);
  }
  bool meets(const Range& other) const {
    return (lower.array() <= other.upper.array()).all() && (other.lower.array() <= upper.array()).all();
  }
  Range grown(double by) const { return {lower.array() - by, upper.array() + by}; }
  Box box() const { return enclosing_box<3>(lower, upper); }
};

/// The largest coordinates of the differences between what lies in one range and in another.
inline Vec3 largest_difference(const Range& a, const Range& b) {
  return (a.upper - b.lower).cwiseAbs().cwiseMax((b.upper - a.lower).cwiseAbs());
}

/// The elements of a mesh in blocks of neighbours, with the boxes that they had in a reference pose.
///
/// A new pose only tells where each block is and by how much its vertices have moved: a pass over vertices, none over
/// elements. Where an element is now, it is not known to more than that: see visit_elements().
class ElementBlocks {
 public:
  static constexpr Index kSize = 64;

  /// Cuts the blocks and takes the pose for reference.
  ElementBlocks(const TetMesh& mesh, std::span<const Vec3> positions);

  Index count() const { return static_cast<Index>(extents_.size()); }
  Index block_of(Index element) const { return block_of_[element]; }

  /// The pose is a new reference. O(n), parallel.
  void take_reference(std::span<const Vec3> positions);

  /// A new pose.
  void place(std::span<const Vec3> positions);

  /// (n_vertices) the reference pose.
  std::span<const Vec3> reference() const { return reference_; }

  /// Where a block's vertices are, and by how much they have moved since the reference.
  const Range& extent(Index block) const { return extents_[block]; }
  const Range& motion(Index block) const { return motions_[block]; }

  /// More than the rounding of a sum of a few coordinates. [m]
  double slack() const { return slack_; }

  /// Visits all blocks whose extent meets a range.
  template <typename Visit>
  void visit_near(const Range& range, Visit&& visit) const {
    visit_overlaps(hierarchy_.nodes(), range.box(), visit);
  }

  /// Visits all elements of a block whose boxes in the reference pose meet a range.
  ///
  /// What lies in an element now is a weighted mean of its vertices; it lay, with the same weights, in the box of the
  /// element in the reference pose, and has since moved by the mean of what the vertices have: by something in
  /// motion(block). So all elements that meet a range now are found where that range was: at its lower end less the
  /// upper one of the motion, to its upper end less the lower.
  template <typename Visit>
  void visit_elements(Index block, const Range& range, Visit&& visit) const;

  /// A range of now, as it may have been for a block in the reference pose.
  Range in_reference(Index block, const Range& now) const {
    return Range{now.lower - motions_[block].upper, now.upper - motions_[block].lower}.grown(slack_);
  }

 private:
  /// Eight of its boxes at a time; absent ones are empty.
  struct Boxes {
    float lower[3][kSize];
    float upper[3][kSize];
  };

  void list_vertices();

  const TetMesh& mesh_;
  std::vector<Index> order_;     ///< elements, block after block
  std::vector<Index> block_of_;  ///< per element
  std::vector<Index> vertices_, vertices_first_;
  std::vector<Vec3> reference_;
  std::vector<Boxes> boxes_;
  std::vector<Range> extents_, motions_;
  Bvh hierarchy_;
  double slack_ = 0;
};

template <typename Visit>
void ElementBlocks::visit_elements(Index block, const Range& range, Visit&& visit) const {
  const Boxes& boxes = boxes_[block];
  const traversal::WideBox query(range.box());
  for (Index first = 0; first < kSize; first += 8) {
    unsigned meeting = 0xff;
    for (int axis = 0; axis < 3; ++axis) {
      meeting &= less_equal(Float8::load(boxes.lower[axis] + first), query.upper[axis]);
      meeting &= less_equal(query.lower[axis], Float8::load(boxes.upper[axis] + first));
    }
    for (; meeting != 0; meeting &= meeting - 1) visit(order_[block * kSize + first + lowest_lane(meeting)]);
  }
}

}  // namespace selvage
