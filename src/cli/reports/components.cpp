#include "cli/reports/components.h"

#include <algorithm>
#include <numeric>

namespace selvage::cli {

namespace {

/// Sets of indices that have been joined.
class JoinedSets {
 public:
  explicit JoinedSets(Index count) : parent_(count), count_(count) { std::iota(parent_.begin(), parent_.end(), 0); }

  void join(Index a, Index b) {
    a = root(a);
    b = root(b);
    if (a == b) return;
    parent_[std::max(a, b)] = std::min(a, b);
    --count_;
  }
  std::int64_t count() const { return count_; }

 private:
  Index root(Index i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  std::vector<Index> parent_;
  std::int64_t count_;
};

}  // namespace

template <int D>
std::int64_t count_components(const SimplexMesh<D>& mesh) {
  const auto component = mesh.element_components();
  return component.empty() ? 0 : 1 + *std::max_element(component.begin(), component.end());
}

template <int D>
std::int64_t count_boundary_components(const SimplexMesh<D>& mesh) {
  JoinedSets sets(mesh.boundary_face_count());
  const auto neighbours = mesh.boundary_neighbours();
  for (Index face = 0; face < mesh.boundary_face_count(); ++face) {
    for (const Index other : neighbours[face]) sets.join(face, other);
  }
  return sets.count();
}

std::int64_t count_components(const TriangleMesh& mesh) {
  JoinedSets sets(mesh.triangle_count());
  for (Index e = 0; e < mesh.edge_count(); ++e) {
    for (const Index triangle : mesh.edge_triangles(e)) sets.join(mesh.edge_triangles(e)[0], triangle);
  }
  return sets.count();
}

template std::int64_t count_components<2>(const PlanarMesh&);
template std::int64_t count_components<3>(const TetMesh&);
template std::int64_t count_boundary_components<2>(const PlanarMesh&);
template std::int64_t count_boundary_components<3>(const TetMesh&);

}  // namespace selvage::cli
