#include "self_collision/culling/normal_cone.h"

#include <numbers>

namespace selvage {

template <int kSteps>
bool passes_normal_cone_test(const Bvh& bvh, const SurfaceCones<kSteps>& cones, const PlanarEmbeddingTest<kSteps>& test,
                             Index node, ContourTest contour,
                             typename PlanarEmbeddingTest<kSteps>::Workspace& workspace) {
  if (bvh.nodes()[node].children[0] >= 0) return false;
  if (!(cones.normals(node).angle < std::numbers::pi / 2)) return false;
  const ProjectionPlane plane = plane_across(cones.normals(node).axis);
  return test.do_triangles_face(node, plane) && test.is_contour_embedded(node, plane, workspace, contour);
}

template <int kSteps>
CulledPairs cull_by_normal_cones(const Bvh& bvh, SurfacePieces& pieces,
                                 const typename PlanarEmbeddingTest<kSteps>::Poses& poses,
                                 PlanarEmbeddingTest<kSteps>& test) {
  using Workspace = typename PlanarEmbeddingTest<kSteps>::Workspace;
  const SurfaceCones<kSteps> cones(bvh, pieces, poses);
  test.place(pieces, poses);
  CulledPairs culled;
  cull_from_root<Workspace>(bvh, pieces, 1, culled, [&](Index node, Workspace& workspace) {
    return passes_normal_cone_test<kSteps>(bvh, cones, test, node, ContourTest::kAllEdges, workspace);
  });
  return culled;
}

template bool passes_normal_cone_test<1>(const Bvh&, const SurfaceCones<1>&, const PlanarEmbeddingTest<1>&, Index,
                                         ContourTest, PlanarEmbeddingTest<1>::Workspace&);
template bool passes_normal_cone_test<2>(const Bvh&, const SurfaceCones<2>&, const PlanarEmbeddingTest<2>&, Index,
                                         ContourTest, PlanarEmbeddingTest<2>::Workspace&);
template CulledPairs cull_by_normal_cones<1>(const Bvh&, SurfacePieces&, const PlanarEmbeddingTest<1>::Poses&,
                                             PlanarEmbeddingTest<1>&);
template CulledPairs cull_by_normal_cones<2>(const Bvh&, SurfacePieces&, const PlanarEmbeddingTest<2>::Poses&,
                                             PlanarEmbeddingTest<2>&);

}  // namespace selvage
