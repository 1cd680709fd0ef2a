#pragma once

#include "bvh/box.h"
#include "core/unset_vector.h"
#include "selvage/core/types.h"

#include <cstddef>
#include <functional>

namespace selvage {

/// A node of eight children. Child i is a primitive when children[i] >= 0, node ~children[i] when it is negative, and
/// absent when i >= child_count; absent children have empty boxes (lower > upper). Children that are nodes come before
/// those that are primitives, and are neighbours in the order of nodes: children[i] == ~(~children[0] + i).
struct alignas(64) BvhNode {
  static constexpr int kWidth = 8;
  float lower[3][kWidth];
  float upper[3][kWidth];
  Index children[kWidth];
  Index parent;  ///< kNone for the root
  Index child_count;
  Index reserved[6];  ///< padding to 256 bytes; free for callers

  /// The mask of all children.
  SELVAGE_INLINE unsigned present() const { return (1u << child_count) - 1u; }
  SELVAGE_INLINE Box box(int child) const {
    return {{lower[0][child], lower[1][child], lower[2][child]}, {upper[0][child], upper[1][child], upper[2][child]}};
  }
};
static_assert(sizeof(BvhNode) == 256);

/// The purpose of a hierarchy. Queries give the same answers either way.
enum class BuildQuality : std::uint8_t {
  kBest,  ///< to be searched or refitted many times
  kFast,  ///< to be searched once: built in less time than the search then takes longer
};

/// Bounding-volume hierarchy over boxes of primitives: eight-wide nodes, one primitive a leaf slot.
///
/// Nodes are stored level by level, the root first, so that children come after their parents and a refit is one linear
/// pass from the back. Dimension-free: planar primitives have flat boxes. Without primitives there is no node, and
/// every query finds nothing. A box may be infinite; one that is empty is found only by queries without bound.
///
/// Built with a binned surface-area heuristic, in parallel; the same tree for any number of threads. A sort along a
/// Morton curve would build faster, but gives trees that take up to three times longer to search, and here a tree is
/// searched and refitted far more often than it is built. Where it is not, `BuildQuality::kFast` looks at fewer
/// primitives of large ranges, and halves small ones. Spatial splits would store a primitive twice, which a refit
/// and a self-overlap cannot use.
class Bvh {
 public:
  /// No tree has more levels, so that a traversal needs no more than a stack of fixed size.
  static constexpr int kMaxLevels = 64;

  Bvh() = default;

  /// @param boxes  one box per primitive
  /// @throws Error when there are more than 2^31 - 1
  explicit Bvh(std::span<const Box> boxes, BuildQuality quality = BuildQuality::kBest);

  /// Takes new boxes for the same primitives: one linear pass, parallel within each level. O(n).
  /// @throws Error when the number of boxes is not primitive_count()
  void refit(std::span<const Box> boxes);

  /// Sets the boxes of those children of the nodes [first, last) that are primitives, and empty boxes for all other
  /// children. May write to the nodes nothing else.
  using BoxFiller = std::function<void(BvhNode* nodes, Index first, Index last)>;

  /// The same for a caller that can compute boxes in place. `fill` is called for pieces of the tree, in parallel within
  /// a level, children before their parents.
  void refit_from(const BoxFiller& fill);

  /// Expected cost of a query against the cost right after building: 1 then, larger when a refit has loosened the tree.
  /// Above 2 (see kRebuildAbove) a rebuild pays. O(1): measured while refitting.
  ///
  /// The cost is the surface area of all nodes (in a flat tree: their half perimeter) over that of all primitives: it
  /// does not change with the scale, nor when whole objects move apart.
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
  UnsetVector<BvhNode> nodes_;
  std::vector<Index> levels_ = {0};
  bool flat_ = false;        ///< the boxes that it was built over lie in a plane across an axis
  float measure_scale_ = 1;  ///< 1 / largest extent when built
  double cost_ = 1;
  double built_cost_ = 1;
};

}  // namespace selvage
