// Pairs that are near, how near, and where: a ProximityFinder, for barriers, repulsions and thick cloth.
#include <selvage/self_collision/proximity.h>

#include <cstdio>

using namespace selvage;

int main() {
  // Two triangles, the second 0.25 m above the first.
  const TriangleMesh mesh(6, {{0, 1, 2}, {3, 4, 5}});
  const std::vector<Vec3> x{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 0.25}, {-1, 1, 2}, {-1, 2, 0.5}};

  const ProximityFinder finder(mesh, x, 0.5);
  const NearPairs near = finder.find_pairs();
  for (const NearVertexFace& pair : near.vertex_face)
    std::printf("vertex %d is %.2f m from face %d, nearest to (%.2f, %.2f, %.2f)\n", pair.vertex, pair.distance,
                pair.face, pair.nearest[1][0], pair.nearest[1][1], pair.nearest[1][2]);
  for (const NearEdges& pair : near.edge_edge)
    std::printf("edges %d and %d are %.2f m apart\n", pair.first, pair.second, pair.distance);
}

// Prints:
// vertex 3 is 0.25 m from face 0, nearest to (1.00, 1.00, 0.00)
// edges 1 and 4 are 0.37 m apart
