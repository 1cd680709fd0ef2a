#pragma once

#include "boundary_path/path_scene.h"

namespace selvage {

/// A point and an element that holds it.
struct PointInElement {
  Index point;
  Index element;
  friend bool operator==(PointInElement, PointInElement) = default;
};

/// What a containment search reads.
template <int D>
struct ContainmentScene {
  const Vec<D>* positions;
  const VertexTuple<D + 1>* elements;
  std::span<const BvhNode> element_nodes;
  BoxFrame<D> frame;
  const std::array<float, 4>* rounded;  ///< per vertex: its position in the frame, to the nearest floats
  float rounding;                       ///< bounds the error of each of them
};

/// Points to look for, best in an order that keeps neighbours together: `points[i]` has the number `ids[i]`. With
/// `skip_own` the numbers are vertices, and elements that have the vertex are left out.
template <int D>
struct PointBatch {
  const Vec<D>* points;
  const Index* ids;
  Index count;
  bool skip_own;
};

/// Grows the list; compiled once, for every x86-64.
void append_found(std::vector<PointInElement>& found, PointInElement pair);

#define SELVAGE_DECLARE_CONTAINMENT_KERNEL(isa)                                                         \
  namespace isa {                                                                                       \
  void find_containing(const ContainmentScene<2>&, const PointBatch<2>&, std::vector<PointInElement>&); \
  void find_containing(const ContainmentScene<3>&, const PointBatch<3>&, std::vector<PointInElement>&); \
  }

/// Appends every pair of a point and an element that holds it (closed, decided exactly), in no particular order.
SELVAGE_DECLARE_CONTAINMENT_KERNEL(baseline)
SELVAGE_DECLARE_CONTAINMENT_KERNEL(avx2)
SELVAGE_DECLARE_CONTAINMENT_KERNEL(avx512)

#undef SELVAGE_DECLARE_CONTAINMENT_KERNEL

}  // namespace selvage
