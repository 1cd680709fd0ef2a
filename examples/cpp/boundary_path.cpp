// How deep a mesh is in itself, and the shortest way out: a BoundaryPathFinder.
#include <selvage/boundary_path/boundary_path.h>
#include <selvage/shapes/shapes.h>

#include <algorithm>
#include <cstdio>

using namespace selvage;

int main() {
  // Two bars in one mesh, the second pushed 0.1 m into the top of the first.
  IndexedMesh bars = make_box(Vec3(3, 1, 1), 0.25);
  bars = concatenate(std::vector<IndexedMesh>{bars, bars});
  const std::size_t half = bars.positions.size() / 2;
  for (std::size_t v = half; v < bars.positions.size(); ++v) bars.positions[v] += Vec3(0.3, 0.2, 0.9);

  const TetMesh mesh(static_cast<Index>(bars.positions.size()), bars.tetrahedra);
  BoundaryPathFinder<3> finder(mesh, bars.positions);

  // A query is a point and the element it is taken to be in; these are all boundary vertices that have penetrated.
  const std::vector<PathQuery<3>> queries = finder.find_penetrating_vertices();
  double deepest = 0;
  for (const BoundaryPath<3>& path : finder.find_paths(queries))
    if (path.status == PathStatus::kFound) deepest = std::max(deepest, path.distance);
  std::printf("deepest: %.3f m\n", deepest);

  // One query alone, by name: the middle of the first bar.
  const auto holders = finder.locator().locate(std::vector<Vec3>{Vec3(1.4, 0.45, 0.4)});
  const BoundaryPath<3> path = finder.find_path(holders.queries.front());
  std::printf("out along (%.0f, %.0f, %.0f) after %.2f m\n", path.normal[0], path.normal[1], path.normal[2],
              path.distance);

  // A new pose costs a refit: the second bar lifted off again.
  for (std::size_t v = half; v < bars.positions.size(); ++v) bars.positions[v] += Vec3(0, 0, 0.2);
  finder.update(bars.positions);
  std::printf("penetrating after the lift: %zu\n", finder.find_penetrating_vertices().size());
}

// Prints:
// deepest: 0.100 m
// out along (0, 0, -1) after 0.40 m
// penetrating after the lift: 0
