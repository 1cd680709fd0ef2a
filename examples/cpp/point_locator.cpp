// Which elements hold a point: a PointLocator names all of them, where a mesh overlaps itself.
#include <selvage/boundary_path/point_locator.h>

#include <cstdio>

using namespace selvage;

int main() {
  // Two triangles of a strip in the plane; the second is folded back over the first.
  const PlanarMesh strip(4, {{0, 1, 2}, {1, 3, 2}});
  const std::vector<Vec2> folded{{0, 0}, {1, 0}, {0, 1}, {0.25, 0.25}};
  const PointLocator<2> locator(strip, folded);

  const std::vector<Vec2> points{{0.4, 0.4}, {0.1, 0.1}, {0.5, 0.5}, {2, 2}};
  const LocatedPoints<2> located = locator.locate(points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::printf("(%.1f, %.1f) is in", points[i][0], points[i][1]);
    for (auto k = located.first[i]; k < located.first[i + 1]; ++k)
      std::printf(" element %d", located.queries[k].element);
    std::printf(located.first[i] == located.first[i + 1] ? " no element\n" : "\n");
  }
  std::printf("inverted: %d\n", static_cast<int>(locator.defects().inverted_elements));
}

// Prints:
// (0.4, 0.4) is in element 0 element 1
// (0.1, 0.1) is in element 0
// (0.5, 0.5) is in element 0 element 1
// (2.0, 2.0) is in no element
// inverted: 1
