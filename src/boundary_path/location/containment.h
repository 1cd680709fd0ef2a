#pragma once

#include "boundary_path/injectivity/deformed_mesh.h"
#include "boundary_path/location/containment_kernel.h"

namespace selvage {

/// Finds the elements that hold points: closed, decided exactly.
///
/// Points are sorted into groups of neighbours; a group descends the hierarchy over the elements together. Refers to
/// all that it is made of.
template <int D>
class ContainmentSearch {
 public:
  ContainmentSearch(const SimplexMesh<D>& mesh, const DeformedMesh<D>& pose, const Bvh& elements)
      : mesh_(mesh), pose_(pose), elements_(elements) {}

  /// To be called when the hierarchy has been built; a refit needs nothing.
  void rebuild();

  /// All pairs of a boundary vertex and an element that holds it and is not its own, in order.
  std::vector<PointInElement> find_boundary_vertices() const;

  /// The same of some vertices of any kind, in ascending order of the vertices.
  std::vector<PointInElement> find_vertices(std::span<const Index> vertices) const;

  /// All pairs of one of some points, scaled as the pose, and an element that holds it, in order.
  std::vector<PointInElement> find_points(std::span<const Vec<D>> points) const;

 private:
  void list_own_elements();
  std::vector<PointInElement> find(const PointBatch<D>& batch) const;

  const SimplexMesh<D>& mesh_;
  const DeformedMesh<D>& pose_;
  const Bvh& elements_;
  std::vector<Index> boundary_order_;                   ///< boundary vertices, in groups of neighbours
  std::vector<std::vector<OwnElements>> own_elements_;  ///< of the groups
  std::vector<const OwnElements*> own_of_groups_;
};

extern template class ContainmentSearch<2>;
extern template class ContainmentSearch<3>;

}  // namespace selvage
