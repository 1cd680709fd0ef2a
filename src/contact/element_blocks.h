#pragma once

#include "selvage/bvh/bvh.h"
#include "selvage/bvh/traverse.h"
#include "selvage/mesh/simplex_mesh.h"

#include <Eigen/LU>

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
  Vec3 middle() const { return (lower + upper) / 2; }
  Vec3 half() const { return (upper - lower) / 2; }
  Range grown(double by) const { return {lower.array() - by, upper.array() + by}; }
  Box box() const { return enclosing_box<3>(lower, upper); }
  static Range everything() { return {Vec3::Constant(-HUGE_VAL), Vec3::Constant(HUGE_VAL)}; }
};

/// Boxes to be compared eight at a time.
template <Index N>
struct Boxes {
  float lower[3][N];
  float upper[3][N];

  void set(Index i, const Box& box) {
    for (int axis = 0; axis < 3; ++axis) {
      lower[axis][i] = box.lower[axis];
      upper[axis][i] = box.upper[axis];
    }
  }
  /// Those of eight boxes that meet a query.
  unsigned meeting(Index first, const traversal::WideBox& query) const {
    unsigned mask = 0xff;
    for (int axis = 0; axis < 3; ++axis) {
      mask &= less_equal(Float8::load(lower[axis] + first), query.upper[axis]);
      mask &= less_equal(query.lower[axis], Float8::load(upper[axis] + first));
    }
    return mask;
  }
};

using Matrix3 = Eigen::Matrix<double, 3, 3, Eigen::DontAlign>;

/// How the vertices of a block have moved since the reference pose: all alike by an affine map, and each by the rest.
struct BlockMotion {
  Matrix3 forward = Matrix3::Identity();   ///< from the reference pose to now, about the anchors
  Matrix3 backward = Matrix3::Identity();  ///< its inverse or so: nothing depends on that
  Vec3 anchor = Vec3::Zero();              ///< a vertex of the block now
  Vec3 reference_anchor = Vec3::Zero();
  Range rest;           ///< of a vertex now less where `forward` takes it
  Range backward_rest;  ///< of where `backward` takes a vertex less where it was
  double size = 2;      ///< how rounding grows: 1 + norm of both maps

  /// Where a point of now would have been in the reference pose, had it moved as the block has.
  Vec3 to_reference(const Vec3& x) const { return reference_anchor + backward * (x - anchor); }
};

/// The elements of a mesh in blocks of neighbours, with the boxes that they had in a reference pose.
///
/// A new pose only tells where each block is and how its vertices have moved: a pass over vertices, none over elements.
/// Where an element is now is not known beyond that; see in_reference().
class ElementBlocks {
 public:
  static constexpr Index kPart = 16;
  static constexpr Index kParts = 8;
  static constexpr Index kSize = kPart * kParts;

  /// Cuts the blocks and takes the pose for reference.
  ElementBlocks(const TetMesh& mesh, std::span<const Vec3> positions);

  Index count() const { return static_cast<Index>(extents_.size()); }
  Index block_of(Index element) const { return block_of_[element]; }

  /// The pose is a new reference. O(n), parallel.
  void take_reference(std::span<const Vec3> positions);

  /// A new pose. O(n), parallel.
  void place(std::span<const Vec3> positions);

  /// (n_vertices) the reference pose.
  std::span<const Vec3> reference() const { return reference_; }

  /// Where a block's vertices are, and how they have moved.
  const Range& extent(Index block) const { return extents_[block]; }
  const BlockMotion& motion(Index block) const { return motions_[block]; }

  /// More than what rounding adds to a length in the reference pose that was found by a block's motion. [m]
  double slack(Index block) const { return rounding_ * motions_[block].size; }

  /// Visits all blocks whose extent meets a range.
  template <typename Visit>
  void visit_near(const Range& range, Visit&& visit) const {
    visit_overlaps(hierarchy_.nodes(), range.box(), visit);
  }

  /// Visits all elements of a block whose boxes in the reference pose meet a range.
  template <typename Visit>
  void visit_elements(Index block, const Range& range, Visit&& visit) const;

  /// The range in which, in the reference pose, all elements of a block lay that have a point in common now with the
  /// segment between two points.
  ///
  /// A common point is a weighted mean of the element's vertices, and so is where `backward` takes it, of where that
  /// takes them: of where they were in the reference pose, in the element's box, and of `backward_rest`.
  Range in_reference(Index block, const std::array<Vec3, 2>& segment) const;

  /// An upper bound of how differently the vertices of one block have moved from those of another, as seen from the
  /// reference pose of the other. [m]
  double difference_bound(Index block, Index other) const;

  /// The same for the two ends of a segment and a block.
  double difference_bound(const std::array<Index, 2>& ends, std::span<const Vec3> positions, Index other) const;

 private:
  void list_vertices();
  std::span<const Index> vertices_of(Index block) const;
  void refer(Index block);
  void move(Index block, std::span<const Vec3> positions, std::vector<float>& scratch);
  void fit_hierarchy();

  const TetMesh& mesh_;
  std::vector<Index> order_;                      ///< elements, block after block
  std::vector<Index> block_of_;                   ///< per element
  std::vector<Index> vertices_, vertices_first_;  ///< of blocks; in eights, the first one again where one is missing
  std::vector<Vec3> reference_;
  std::vector<Boxes<kSize>> boxes_;
  std::vector<Boxes<kParts>> part_boxes_;
  std::vector<float> arms_;  ///< of each block six rows: vertices about the anchor, and their weights in the fit
  std::vector<Range> arm_ranges_;
  std::vector<Range> extents_;
  std::vector<BlockMotion> motions_;
  Bvh hierarchy_;
  double rounding_ = 0;
};

template <typename Visit>
void ElementBlocks::visit_elements(Index block, const Range& range, Visit&& visit) const {
  const traversal::WideBox query(range.box());
  const Index begin = block * kSize, end = static_cast<Index>(order_.size());
  for (unsigned parts = part_boxes_[block].meeting(0, query); parts != 0; parts &= parts - 1) {
    const Index part = lowest_lane(parts) * kPart;
    for (Index first = part; first < part + kPart && begin + first < end; first += 8)
      for (unsigned rest = boxes_[block].meeting(first, query); rest != 0; rest &= rest - 1)
        if (const Index place = begin + first + lowest_lane(rest); place < end) visit(order_[place]);
  }
}

}  // namespace selvage
