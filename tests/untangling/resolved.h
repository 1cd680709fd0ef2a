#pragma once

#include "elasticity/deformation_gradient.h"
#include "selvage/boundary_path/boundary_path.h"
#include "selvage/self_collision/self_collision.h"
#include "selvage/shapes/poses.h"
#include "selvage/shapes/shapes.h"
#include "selvage/untangling/resolve.h"

#include <gtest/gtest.h>

namespace selvage {

inline IndexedMesh boxes(const Vec3& offset, double second_size = 1) {
  IndexedMesh second = make_box(Vec3::Constant(second_size), 0.2);
  for (Vec3& p : second.positions) p += offset;
  return concatenate(std::array{make_box(Vec3::Ones(), 0.2), second});
}

inline IndexedMesh posed(std::string_view shape, std::int64_t elements, std::string_view pose,
                         const PoseOptions& options = {}) {
  ShapeOptions measures;
  measures.elements = elements;
  IndexedMesh mesh = make_shape(shape, measures);
  if (!pose.empty()) apply_pose(mesh, pose, options);
  return mesh;
}

struct Resolved {
  TetMesh mesh;
  std::vector<Vec3> before, after;
  ResolveReport report;
};

inline Resolved resolve(const IndexedMesh& file, const ResolveOptions& options = {}) {
  Resolved result{
      TetMesh(static_cast<Index>(file.positions.size()), file.tetrahedra), file.positions, file.positions, {}};
  result.report = resolve_collisions(result.mesh, result.after, options);
  return result;
}

inline std::size_t pairs_of(const Resolved& r, const std::vector<Vec3>& positions) {
  const TriangleMesh surface = boundary_surface(r.mesh);
  return SelfCollisionFinder(surface, positions).find_pairs().size();
}

inline double displacement(const Resolved& r, std::size_t v) {
  return (r.after[v] - r.before[v]).norm();
}

/// Asks others than the solver whether anything is left, and holds the report against the positions.
inline void expect_resolved(const Resolved& r) {
  ASSERT_EQ(r.report.outcome, ResolveOutcome::kResolved);
  EXPECT_EQ(pairs_of(r, r.after), 0u);
  EXPECT_TRUE(BoundaryPathFinder<3>(r.mesh, r.after).find_penetrating_vertices().empty());
  EXPECT_TRUE(r.report.tangled_elements.empty());
  EXPECT_TRUE(r.report.iterations.back().is_clean());
  EXPECT_EQ(r.report.iterations.front().triangle_pairs, static_cast<std::int64_t>(pairs_of(r, r.before)));
  double furthest = 0, volume = 0;
  std::int64_t moved = 0;
  for (std::size_t v = 0; v < r.after.size(); ++v) {
    furthest = std::max(furthest, displacement(r, v));
    moved += r.after[v] != r.before[v];
  }
  for (const auto& e : r.mesh.elements()) {
    EXPECT_GT(element_volume(e, r.after), 0);
    volume += element_volume(e, r.after);
  }
  EXPECT_EQ(r.report.max_displacement, furthest);
  EXPECT_EQ(r.report.moved_vertices, moved);
  EXPECT_EQ(r.report.volume_after, volume);
}

}  // namespace selvage
