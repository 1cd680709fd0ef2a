#include <selvage/selvage.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>

using namespace selvage;

namespace {

/// FNV-1a over the bits of numbers, so that one line shows whether any of them differs.
class Bits {
 public:
  void add(double x) {
    std::uint64_t bits;
    std::memcpy(&bits, &x, sizeof bits);
    for (int i = 0; i < 8; ++i) hash_ = (hash_ ^ (bits >> (8 * i) & 0xff)) * 0x100000001b3u;
  }
  void add(const Vec3& x) {
    for (int i = 0; i < 3; ++i) add(x[i]);
  }
  unsigned long long value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325u;
};

void print_path() {
  const TetMesh mesh(5, {{0, 1, 2, 3}, {1, 4, 2, 3}});
  const std::vector<Vec3> positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  const TriangleMesh surface = boundary_surface(mesh);
  const BoundaryPathFinder<3> finder(mesh, positions);
  const BoundaryPath<3> path = finder.find_path(PathQuery<3>::at({0.3, 0.2, 0.1}, 0));
  std::printf("%d boundary faces, %d edges, out after %a m\n", surface.triangle_count(), surface.edge_count(),
              path.distance);
}

/// Everything that a finder says of a ring that is bent until it passes through itself.
void print_tangle() {
  IndexedMesh rod = make_rod(RodCurve::kStraight, 8, 0.25, 0.2);
  apply_pose(rod, "self-crossing");
  const TetMesh mesh(static_cast<Index>(rod.positions.size()), rod.tetrahedra);
  const BoundaryPathFinder<3> finder(mesh, rod.positions);
  const auto queries = finder.find_penetrating_vertices();
  Bits bits;
  for (const auto& path : finder.find_paths(queries)) {
    bits.add(path.distance);
    bits.add(path.point);
    bits.add(path.normal);
  }
  std::printf("%zu penetrating vertices, paths %016llx\n", queries.size(), bits.value());
  const TriangleMesh surface = boundary_surface(mesh);
  const auto pairs = SelfCollisionFinder(surface, rod.positions).find_pairs();
  for (const TrianglePair& pair : pairs) {
    bits.add(pair.first);
    bits.add(pair.second);
  }
  std::printf("%zu pairs of triangles, %016llx\n", pairs.size(), bits.value());
}

/// Functions of a few points, decided exactly. Nothing is computed here: an application's own arithmetic may be
/// contracted or reordered by its flags.
void print_geometry() {
  const Vec3 a(0.1, 0.2, 0.3), b(1.1, 0.2, 0.4), c(0.4, 1.3, 0.2), p(0.7, 0.6, 1.7);
  const ClosestPoint<3, 3> closest = closest_point_on_triangle(p, a, b, c);
  std::printf("closest point %a %a %a\n", closest.point[0], closest.point[1], closest.point[2]);
  // Products of these differ in their last bits alone.
  const Vec3 o(0, 0, 0), u(0x1.0000000000001p0, 1, 0), v(1, 0x1.fffffffffffffp-1, 0), w(0.3, 0.3, 0x1p-52);
  std::printf("sides %d %d %d\n", orient3d(o, u, v, w), orient3d(o, v, u, w), orient3d(o, u, u, w));
}

}  // namespace

int main() {
  std::printf("selvage %s\n", version());
  if (std::strcmp(version(), SELVAGE_VERSION) != 0) return 1;
  print_path();
  print_tangle();
  print_geometry();
}
