// A rod that runs through itself becomes one that does not, by resolve_collisions().
#include <selvage/self_collision/self_collision.h>
#include <selvage/shapes/poses.h>
#include <selvage/shapes/shapes.h>
#include <selvage/untangling/resolve.h>

#include <cmath>
#include <cstdio>

using namespace selvage;

int main() {
  IndexedMesh rod = make_rod(RodCurve::kStraight, 6, 0.25, 0.15);
  const TetMesh mesh(static_cast<Index>(rod.positions.size()), rod.tetrahedra);
  PoseOptions pose;
  pose.crossings = 1;
  apply_pose(rod, "self-crossing", pose);

  const ResolveReport report = resolve_collisions(mesh, rod.positions);
  const ResolveIteration &before = report.iterations.front(), &after = report.iterations.back();
  std::printf("resolved: %s\n", report.outcome == ResolveOutcome::kResolved ? "yes" : "no");
  std::printf("triangles meet before: %s, after: %s\n", before.triangle_pairs > 0 ? "yes" : "no",
              after.triangle_pairs > 0 ? "yes" : "no");
  std::printf("volume kept to 2%%: %s\n",
              std::abs(report.volume_after / report.volume_before - 1) < 0.02 ? "yes" : "no");
}

// Prints:
// resolved: yes
// triangles meet before: yes, after: no
// volume kept to 2%: yes
