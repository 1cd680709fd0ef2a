#include "self_collision/discrete/leaf_faces.h"

#include "self_collision/surface/deformed_surface.h"
#include "self_collision/surface/neighbour_pairs.h"
#include "self_collision/surfaces.h"
#include "selvage/geometry/triangle_triangle.h"
#include "test_scale.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

namespace selvage {
namespace {

using surfaces::Random;
using surfaces::Surface;
using test::scaled;

/// A surface in a hierarchy, as searches see it.
struct Posed {
  Surface surface;
  TriangleMesh mesh = surface.mesh();
  DeformedSurface pose;
  Bvh bvh;
  std::vector<LeafVertices> leaves;

  explicit Posed(Surface s) : surface(std::move(s)) {
    pose.place(mesh, surface.positions, {},
               box_units_around(check_positions<3>(surface.positions, mesh.vertex_count())));
    bvh = Bvh(pose.boxes(mesh));
    leaves = list_leaf_vertices(bvh, mesh.triangles());
  }

  std::array<Vec3, 3> corners(Index t) const {
    const auto& [a, b, c] = mesh.triangles()[t];
    return {surface.positions[a], surface.positions[b], surface.positions[c]};
  }
};

bool do_boxes_meet(const Box& a, const Box& b) {
  for (int axis = 0; axis < 3; ++axis)
    if (a.upper[axis] < b.lower[axis] || b.upper[axis] < a.lower[axis]) return false;
  return true;
}

/// Calls `visit(triangle, other, whether the other lies beside)` for all pairs whose boxes meet.
template <typename Visit>
void visit_told(const Posed& posed, Visit&& visit) {
  const auto nodes = posed.bvh.nodes();
  const auto faces = std::make_unique<FaceCache>(posed.pose.rounded().data(), posed.leaves.data());
  for (std::size_t a = 0; a < nodes.size(); ++a)
    for (std::size_t b = 0; b < nodes.size(); ++b)
      for (int i = 0; i < nodes[a].child_count; ++i) {
        if (nodes[a].children[i] < 0) continue;
        std::int32_t pairs[64];
        ASSERT_EQ(store_bit_numbers(std::uint64_t{0xff} << 8 * i, pairs), 8);
        const unsigned beside =
            beside_faces(faces->of(static_cast<Index>(a)), shift_right<3>(Int8::load(pairs)),
                         faces->of(static_cast<Index>(b), static_cast<Index>(a)), Int8::load(pairs));
        for (int k = 0; k < nodes[b].child_count; ++k)
          if (nodes[b].children[k] >= 0 && do_boxes_meet(nodes[a].box(i), nodes[b].box(k)))
            visit(nodes[a].children[i], nodes[b].children[k], (beside >> k & 1) != 0);
      }
}

TEST(LeafFaces, NeverTellApartWhatMeets) {
  Random random(1);
  for (const surfaces::Family& family : surfaces::families())
    for (std::int64_t n = 0; n < scaled(20); ++n) {
      const Surface made = family.make(random);
      Surface surface = n % 4 == 3 ? made : surfaces::snapped(made, n % 2 == 0 ? 8 : 2);
      // What is near the border of the box units is rounded most.
      if (n % 3 == 0)
        for (Vec3& x : surface.positions) x += Vec3(0.1, -1e6, 1e3);
      const Posed posed(surface);
      visit_told(posed, [&](Index t, Index other, bool beside) {
        if (beside) {
          ASSERT_EQ(classify_contact(posed.corners(t), posed.corners(other)), TriangleContact::kDisjoint)
              << family.name << " " << n << ": " << t << ", " << other;
        }
      });
    }
}

TEST(LeafFaces, TellApartNearlyAllThatPlanesDo) {
  Random random(2);
  const auto& families = surfaces::families();
  const auto loose = std::find_if(families.begin(), families.end(), [](const auto& f) { return f.name == "loose"; });
  const Posed posed(loose->make(random));
  int apart = 0, told = 0;
  visit_told(posed, [&](Index t, Index other, bool beside) {
    const auto lie_beside = [&](Index face, Index points) {
      const auto [a, b, c] = posed.corners(face);
      const Vec3 normal = (b - a).cross(c - a);
      int above = 0, below = 0;
      for (const Vec3& p : posed.corners(points)) {
        above += normal.dot(p - a) > 0;
        below += normal.dot(p - a) < 0;
      }
      return above == 3 || below == 3;
    };
    const auto &v = posed.mesh.triangles()[t], &w = posed.mesh.triangles()[other];
    const bool shares = std::any_of(v.begin(), v.end(), [&](Index i) { return std::count(w.begin(), w.end(), i) > 0; });
    if (shares || !(lie_beside(t, other) || lie_beside(other, t))) return;
    ++apart;
    told += beside;
  });
  EXPECT_GT(apart, 100);
  EXPECT_GT(told, 0.99 * apart);
}

}  // namespace
}  // namespace selvage
