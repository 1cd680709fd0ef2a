#include "untangling/solids/posed_rest.h"

#include "mesh/find_inverted.h"
#include "selvage/core/error.h"
#include "threads.h"
#include "untangling/resolved.h"

#include <gtest/gtest.h>

#include <cmath>

namespace selvage {
namespace {

/// A straight bar, and the same bent into a ring whose ends overlap.
struct Ring {
  IndexedMesh straight = make_box({12, 0.6, 0.6}, 0.2);
  IndexedMesh bent = straight;
  Ring() { apply_pose(bent, "bend", {.axis = 0, .turns = 1.08}); }

  TetMesh topology() const { return {static_cast<Index>(straight.positions.size()), straight.tetrahedra}; }
  /// Turns elements near the bar's start inside out.
  void shake() {
    for (std::size_t v = 0; v < bent.positions.size(); ++v)
      if (straight.positions[v][0] < 1 && v % 4 == 0)
        bent.positions[v] +=
            0.3 * Vec3(std::sin(7.0 * static_cast<double>(v)), std::cos(5.0 * static_cast<double>(v)), 0);
  }
  /// Vertices in the middle of the bar, far from the overlap.
  bool is_far(std::size_t v) const { return std::abs(straight.positions[v][0] - 6) < 2; }
};

TEST(PosedRest, IsThePoseWhereNothingIsTangled) {
  Ring ring;
  ring.bent = ring.straight;
  apply_pose(ring.bent, "bend", {.axis = 0, .turns = 0.5});
  EXPECT_EQ(find_posed_rest(ring.topology(), ring.straight.positions, ring.bent.positions, {}), ring.bent.positions);
}

TEST(PosedRest, IsPositiveAndKeepsWhatIsFar) {
  Ring ring;
  ring.shake();
  const TetMesh mesh = ring.topology();
  ASSERT_GT(find_inverted(mesh, ring.bent.positions).size(), 10u);
  const std::vector<Vec3> rest = find_posed_rest(mesh, ring.straight.positions, ring.bent.positions, {});
  EXPECT_TRUE(find_inverted(mesh, rest).empty());
  for (std::size_t v = 0; v < rest.size(); ++v) EXPECT_TRUE(!ring.is_far(v) || rest[v] == ring.bent.positions[v]) << v;
}

TEST(PosedRest, RefusesARestThatIsNone) {
  Ring ring;
  std::vector<Vec3> flat = ring.straight.positions;
  for (Vec3& p : flat) p[2] = 0;
  EXPECT_THROW(find_posed_rest(ring.topology(), flat, ring.bent.positions, {}), Error);
  EXPECT_THROW(find_posed_rest(ring.topology(), std::span(flat).first(3), ring.bent.positions, {}), Error);
}

/// Folded in the middle until its halves cross near their ends, one of which is crumpled on request.
TEST(PosedRest, LetsAFoldedBarStayFolded) {
  for (const bool is_crumpled : {false, true}) {
    IndexedMesh mesh = make_box({8, 0.5, 0.5}, 0.25);
    ResolveOptions options;
    options.rest_positions = mesh.positions;
    apply_pose(mesh, "fold", {.axis = 0, .angle = 3.3});
    for (std::size_t v = 0; v < mesh.positions.size() && is_crumpled; v += 3) {
      const auto number = static_cast<double>(v);
      if (options.rest_positions[v][0] < 1.3)
        mesh.positions[v] += 0.4 * Vec3(std::sin(7 * number), std::cos(5 * number), std::sin(3 * number));
    }
    const Resolved stood_up = resolve(mesh, options);
    options.keep_pose = true;
    const Resolved stayed = resolve(mesh, options);
    expect_resolved(stood_up);
    expect_resolved(stayed);
    EXPECT_GT(stood_up.report.iterations.front().triangle_pairs, 50);
    EXPECT_EQ(stood_up.report.iterations.front().inverted_elements > 10, is_crumpled);
    EXPECT_LT(stayed.report.mean_displacement, 0.3 * stood_up.report.mean_displacement) << is_crumpled;
    EXPECT_NEAR(stayed.report.volume_at_rest, 2, 1e-9);
    EXPECT_NEAR(stayed.report.volume_after, 2, 0.06);
  }
}

TEST(PosedRest, GivesTheSameBitsForAnyNumberOfThreads) {
  Ring ring;
  ring.shake();
  const TetMesh mesh = ring.topology();
  test::same_for_any_threads([&] { return find_posed_rest(mesh, ring.straight.positions, ring.bent.positions, {}); });
}

}  // namespace
}  // namespace selvage
