#include "boundary_path/containment_kernel.h"

#include "boundary_path/segment.h"
#include "selvage/bvh/traverse.h"
#include "selvage/geometry/predicates.h"

namespace selvage {
inline namespace SELVAGE_ISA {

namespace {

template <int D>
void find_all(const ContainmentScene<D>& scene, const PointBatch<D>& batch, std::vector<PointInElement>& found) {
  for (Index i = 0; i < batch.count; ++i) {
    const Vec<D>& p = batch.points[i];
    const Index id = batch.ids != nullptr ? batch.ids[i] : i;
    visit_overlaps(scene.element_nodes, scene.frame.around_point(p), [&](Index element) {
      const auto& vertices = scene.elements[element];
      if (batch.skip_own && contains(vertices, id)) return;
      std::array<Vec<D>, D + 1> corners;
      for (int k = 0; k <= D; ++k) corners[k] = scene.positions[vertices[k]];
      if (locate_in_simplex<D>(corners, p).inside) append_found(found, {id, element});
    });
  }
}

}  // namespace

void find_containing(const ContainmentScene<2>& scene, const PointBatch<2>& batch, std::vector<PointInElement>& found) {
  find_all(scene, batch, found);
}

void find_containing(const ContainmentScene<3>& scene, const PointBatch<3>& batch, std::vector<PointInElement>& found) {
  find_all(scene, batch, found);
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
