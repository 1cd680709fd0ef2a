// Where a surface meets itself, exactly: a SelfCollisionFinder.
#include <selvage/self_collision/self_collision.h>

#include <cstdio>

using namespace selvage;

int main() {
  // A strip of cloth, 8 x 1 squares in the plane z = 0. Any (n x 3) positions and (m x 3) vertex numbers do.
  std::vector<Vec3> x;
  std::vector<VertexTuple<3>> triangles;
  for (Index i = 0; i <= 8; ++i)
    for (Index k = 0; k <= 1; ++k) x.push_back(Vec3(i, k, 0));
  for (Index i = 0; i < 8; ++i) {
    triangles.push_back({2 * i, 2 * i + 2, 2 * i + 1});
    triangles.push_back({2 * i + 1, 2 * i + 2, 2 * i + 3});
  }
  const TriangleMesh mesh(static_cast<Index>(x.size()), triangles);
  SelfCollisionFinder finder(mesh, x);
  std::printf("flat: %s\n", finder.has_pairs() ? "collides" : "free");

  // Its end led back through its middle. A new pose costs a refit.
  for (Vec3& p : x)
    if (p[0] > 4) p = Vec3(8 - p[0], p[1] + 0.25, 2 * (p[0] - 4) * (6.5 - p[0]));
  finder.update(x);
  const std::vector<TrianglePair> pairs = finder.find_pairs();
  std::printf("led through itself: %zu pairs\n", pairs.size());

  // The points that the first two triangles have in common: a segment.
  const CommonSegment segment = finder.find_segments(pairs).front();
  if (segment)
    std::printf("triangles %d and %d meet along %.3f m\n", pairs[0].first, pairs[0].second,
                ((*segment)[1] - (*segment)[0]).norm());
}

// Prints:
// flat: free
// led through itself: 3 pairs
// triangles 2 and 12 meet along 0.150 m
