// Pairs that meet during a step, and how far the step may go: a ContinuousCollisionFinder.
#include <selvage/self_collision/continuous_collision.h>

#include <cstdio>

using namespace selvage;

int main() {
  // A triangle that lies in the plane z = 0, and one above it, on its tip.
  const TriangleMesh mesh(6, {{0, 1, 2}, {3, 4, 5}});
  const std::vector<Vec3> start{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 1}, {1, 1, 2}, {2, 1, 2}};
  std::vector<Vec3> end = start;
  for (int v = 3; v < 6; ++v) end[v] -= Vec3(0, 0, 2);  // it falls by 2 m: its tip through the other, its edge onto it

  const ContinuousCollisionFinder finder(mesh, start, end);
  const ContinuousPairs pairs = finder.find_pairs();
  for (const VertexFacePair& pair : pairs.vertex_face) std::printf("vertex %d meets face %d\n", pair.vertex, pair.face);
  std::printf("pairs of edges that meet: %zu\n", pairs.edge_edge.size());
  std::printf("free until %.3f of the step\n", finder.find_free_step(pairs));

  // With a thickness of 0.1 m at each vertex, pairs shall stay 0.2 m apart.
  SelfCollisionOptions options;
  options.thickness.assign(6, 0.1);
  const ContinuousCollisionFinder thick(mesh, start, end, options);
  std::printf("0.2 m apart until %.3f of the step\n", thick.find_separated_step());
}

// Prints:
// vertex 3 meets face 0
// vertex 4 meets face 0
// vertex 5 meets face 0
// pairs of edges that meet: 0
// free until 0.500 of the step
// 0.2 m apart until 0.400 of the step
