// The surface of a solid: a TetMesh knows its boundary, and boundary_surface() makes a TriangleMesh of it.
#include <selvage/mesh/triangle_mesh.h>
#include <selvage/shapes/shapes.h>

#include <cstdio>

using namespace selvage;

int main() {
  // Any (n x 3) positions and (m x 4) vertex numbers do: here, a ball made by formula.
  const IndexedMesh ball = make_ball(1.0, 0.2);
  const std::vector<Vec3>& x = ball.positions;
  const TetMesh mesh(static_cast<Index>(x.size()), ball.tetrahedra);
  const TriangleMesh surface = boundary_surface(mesh);

  // Triangles face outward, and name the vertices as the solid does: positions serve both.
  double volume = 0;
  for (const auto& [a, b, c] : surface.triangles()) volume += x[a].cross(x[b]).dot(x[c]) / 6;
  const bool is_closed = 2 * surface.edge_count() == 3 * surface.triangle_count();
  std::printf("volume %.2f m^3, %s\n", volume, is_closed ? "closed" : "open");
  std::printf("more edges inside than on the surface: %s\n",
              std::ssize(mesh.edges()) > 2 * surface.edge_count() ? "yes" : "no");
}

// Prints:
// volume 4.15 m^3, closed
// more edges inside than on the surface: yes
