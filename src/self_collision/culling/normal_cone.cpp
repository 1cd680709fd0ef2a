#include "self_collision/culling/normal_cone.h"

#include "self_collision/culling/surface_cones.h"

#include <numbers>

namespace selvage {

namespace {

/// True is certain. The cones tell where the test can pass; they decide nothing, because their rounding is not bounded.
template <int kSteps>
bool passes_normal_cone_test(const Bvh& bvh, const SurfaceCones<kSteps>& cones, const PlanarEmbeddingTest<kSteps>& test,
                             Index node, ContourTest contour,
                             typename PlanarEmbeddingTest<kSteps>::Workspace& workspace) {
  if (bvh.nodes()[node].children[0] >= 0) return false;
  if (!(cones.normals(node).angle < std::numbers::pi / 2)) return false;
  const ProjectionPlane plane = plane_across(cones.normals(node).axis);
  return test.do_triangles_face(node, plane) && test.is_contour_embedded(node, plane, workspace, contour);
}

}  // namespace

template <int kSteps>
CulledPairs cull_by_normal_cones(ContourTest contour, const Bvh& bvh, SurfacePieces& pieces,
                                 const typename PlanarEmbeddingTest<kSteps>::Poses& poses,
                                 PlanarEmbeddingTest<kSteps>& test) {
  using Workspace = typename PlanarEmbeddingTest<kSteps>::Workspace;
  const SurfaceCones<kSteps> cones(bvh, pieces, poses);
  test.place(pieces, poses);
  CulledPairs culled;
  cull_from_root<Workspace>(bvh, pieces, 1, culled, [&](Index node, Workspace& workspace) {
    return passes_normal_cone_test<kSteps>(bvh, cones, test, node, contour, workspace);
  });
  return culled;
}

template CulledPairs cull_by_normal_cones<1>(ContourTest, const Bvh&, SurfacePieces&,
                                             const PlanarEmbeddingTest<1>::Poses&, PlanarEmbeddingTest<1>&);
template CulledPairs cull_by_normal_cones<2>(ContourTest, const Bvh&, SurfacePieces&,
                                             const PlanarEmbeddingTest<2>::Poses&, PlanarEmbeddingTest<2>&);

}  // namespace selvage
