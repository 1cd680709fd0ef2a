#pragma once

#include "selvage/core/types.h"

#include <cstddef>

namespace selvage {

/// Axis-aligned box in single precision that contains what it bounds: rounded outward.
struct Box {
  std::array<float, 3> lower;
  std::array<float, 3> upper;

  /// A box that contains nothing and grows by merging.
  static Box empty();
  void merge(const Box& other);
  /// Half of the surface area.
  float half_area() const;
};

/// Smallest box of floats that contains all points; the z of a planar point is 0.
template <int D>
Box bounding_box(std::span<const Vec<D>> points);

/// A node of eight children. Child i is a primitive when children[i] >= 0, node ~children[i] when it is negative, and
/// absent when i >= child_count; absent children have empty boxes (lower > upper), which no test passes.
struct alignas(64) BvhNode {
  static constexpr int kWidth = 8;
  float lower[3][kWidth];
  float upper[3][kWidth];
  Index children[kWidth];
  Index parent;       ///< kNone for the root
  Index child_count;
  Index reserved[6];  ///< room for what later floors hang on a node
};
static_assert(sizeof(BvhNode) == 256);

/// Bounding-volume hierarchy over boxes of primitives: eight-wide nodes, one primitive a leaf slot.
///
/// Nodes are stored level by level, the root first, so that children come after their parents and a refit is one linear
/// pass from the back. Dimension-free: planar primitives have flat boxes.
/// Built with a binned surface-area heuristic, in parallel; the same tree for any number of threads.
class Bvh {
 public:
  Bvh() = default;

  /// @param boxes  one box per primitive
  explicit Bvh(std::span<const Box> boxes);

  /// Takes new boxes for the same primitives: one linear pass, parallel within each level. O(n).
  void refit(std::span<const Box> boxes);

  /// Expected cost of a query against the cost right after building: 1 then, larger when a refit has loosened the tree.
  /// Above 2 (see kRebuildAbove) a rebuild pays. O(1): measured while refitting.
  double quality_loss() const { return cost_ / built_cost_; }
  static constexpr double kRebuildAbove = 2.0;

  Index primitive_count() const { return primitive_count_; }
  std::span<const BvhNode> nodes() const { return nodes_; }

  /// (n_levels + 1) first node of each level.
  std::span<const Index> levels() const { return levels_; }

  /// Primitives in the order of the leaves, which keeps neighbours in space together.
  std::vector<Index> leaf_order() const;

 private:
  Index primitive_count_ = 0;
  std::vector<BvhNode> nodes_;
  std::vector<Index> levels_;
  double cost_ = 1;
  double built_cost_ = 1;
};

}  // namespace selvage
