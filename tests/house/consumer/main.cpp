#include <selvage/boundary_path/boundary_path.h>
#include <selvage/mesh/triangle_mesh.h>

#include <cmath>
#include <cstdio>

/// The way out of a corner tetrahedron that a neighbour enlarges, and the surface of both.
int main() {
  const selvage::TetMesh mesh(5, {{0, 1, 2, 3}, {1, 4, 2, 3}});
  const std::vector<selvage::Vec3> positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  const auto faces = mesh.boundary_faces();
  const selvage::TriangleMesh surface(mesh.vertex_count(), {faces.begin(), faces.end()});
  const selvage::BoundaryPathFinder<3> finder(mesh, positions);
  const selvage::PathQuery<3> query{{0.25, 0.25, 0.125}, 0};
  const auto path = finder.find_paths(std::span(&query, 1)).front();
  std::printf("%d boundary faces, %d edges, out after %g m\n", surface.triangle_count(), surface.edge_count(),
              path.distance);
  return path.status == selvage::PathStatus::kFound && std::abs(path.distance - 0.125) < 1e-12 ? 0 : 1;
}
