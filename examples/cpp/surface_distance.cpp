// How far points are from a surface, and on which side: a SurfaceDistance.
#include <selvage/mesh/triangle_mesh.h>
#include <selvage/surface_distance/surface_distance.h>

#include <cstdio>

using namespace selvage;

int main() {
  // A tetrahedron, its normals outward. It is closed, so that it has an inside.
  const TriangleMesh mesh(4, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}});
  const std::vector<Vec3> x{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const SurfaceDistance surface(mesh, x);

  const std::vector<Vec3> points{{0.1, 0.2, 0.3}, {-2, 0.1, 0.1}, {0.25, 0.25, 0}, {0, 0, 3}};
  for (const SignedDistance& answer : surface.find_signed_distances(points)) {
    const char* const side = answer.side.is_on_surface ? "on" : answer.side.winding_number != 0 ? "inside" : "outside";
    const char* const feature = answer.closest.feature == SurfaceFeature::kFace   ? "face"
                                : answer.closest.feature == SurfaceFeature::kEdge ? "edge"
                                                                                  : "vertex";
    std::printf("%.2f m, %s; closest is (%.2f, %.2f, %.2f) on %s %d\n", answer.distance, side, answer.closest.point[0],
                answer.closest.point[1], answer.closest.point[2], feature, answer.closest.feature_index);
  }
}

// Prints:
// -0.10 m, inside; closest is (0.00, 0.20, 0.30) on face 2
// 2.00 m, outside; closest is (0.00, 0.10, 0.10) on face 2
// 0.00 m, on; closest is (0.25, 0.25, 0.00) on face 0
// 2.00 m, outside; closest is (0.00, 0.00, 1.00) on vertex 3
