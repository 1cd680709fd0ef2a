#include <selvage/mesh/simplex_mesh.h>
#include <selvage/mesh/triangle_mesh.h>

#include <cstdio>

/// Two tetrahedra that share a face, and the surface they have.
int main() {
  const selvage::TetMesh mesh(5, {{0, 1, 2, 3}, {1, 4, 2, 3}});
  const auto faces = mesh.boundary_faces();
  const selvage::TriangleMesh surface(mesh.vertex_count(), {faces.begin(), faces.end()});
  std::printf("%d tetrahedra, %d boundary faces, %d edges\n", mesh.element_count(), surface.triangle_count(),
              surface.edge_count());
  return surface.triangle_count() == 6 && surface.edge_count() == 9 ? 0 : 1;
}
