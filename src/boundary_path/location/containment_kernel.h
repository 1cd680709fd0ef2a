#pragma once

#include "boundary_path/input/path_input.h"
#include "boundary_path/location/group_order.h"

namespace selvage {

/// A point, by its place in the order of a search, and an element that holds it.
struct PointInElement {
  Index point;
  Index element;
  friend bool operator==(PointInElement, PointInElement) = default;
};

/// A position from the input's box origin, each coordinate to the nearest float (the rest 0).
using RoundedPosition = std::array<float, 4>;

/// Mesh and pose as a containment search reads them.
template <int D>
struct ContainmentInput {
  const Vec<D>* positions;
  const VertexTuple<D + 1>* elements;
  const RoundedPosition* rounded;  ///< of the vertices
  float rounding;                  ///< bounds the error of each rounded coordinate inside the mesh's box
  std::span<const BvhNode> nodes;  ///< hierarchy over the elements
};

/// Which points of a group have the children of a node, where those are elements, as their own: these do not count as
/// holding the points.
struct OwnElements {
  Index node;
  std::uint16_t points[BvhNode::kWidth];  ///< a bit for each
};

/// Ends a list of OwnElements.
inline constexpr Index kBeyondAllNodes = std::numeric_limits<Index>::max();

/// Points to look for, in groups of neighbours: the k-th is number ids[k] of the points.
template <int D>
struct PointBatch {
  const Vec<D>* points;
  const RoundedPosition* rounded;
  std::span<const Index> ids;
  std::span<const OwnElements* const> own;  ///< for each group by ascending nodes, then kBeyondAllNodes
  /// Whether points are numbered as vertices, which their own elements do not hold, whether listed in `own` or not.
  bool are_vertices = false;
};

/// Grows the list; compiled once, for every x86-64.
void append_found(std::vector<PointInElement>& found, PointInElement pair);

#define SELVAGE_DECLARE_CONTAINMENT_KERNEL(isa)                                                         \
  namespace isa {                                                                                       \
  void find_containing(const ContainmentInput<2>&, const PointBatch<2>&, std::vector<PointInElement>&); \
  void find_containing(const ContainmentInput<3>&, const PointBatch<3>&, std::vector<PointInElement>&); \
  }

/// Appends every pair of a point (its place in `ids`) and an element that holds it (closed, decided exactly) and is not
/// its own: group after group, inside a group in no particular order.
SELVAGE_DECLARE_CONTAINMENT_KERNEL(baseline)
SELVAGE_DECLARE_CONTAINMENT_KERNEL(avx2)
SELVAGE_DECLARE_CONTAINMENT_KERNEL(avx512)

#undef SELVAGE_DECLARE_CONTAINMENT_KERNEL

}  // namespace selvage
