// Pins, limits and the report of resolve_collisions().
#include "selvage/core/error.h"
#include "threads.h"
#include "untangling/resolved.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace selvage {
namespace {

TEST(Resolve, KeepsPinnedVertices) {
  const IndexedMesh mesh = boxes({0.83, 0.13, 0.07});
  ResolveOptions options;
  for (Index v = 0; v < std::ssize(mesh.positions) / 2; ++v) options.pinned.push_back(v);
  const Resolved r = resolve(mesh, options);
  expect_resolved(r);
  for (const Index v : options.pinned) ASSERT_EQ(r.after[v], r.before[v]) << v;
}

// Where elements turn over that are held by some of their vertices.
TEST(Resolve, KeepsPinnedVerticesInATangle) {
  const IndexedMesh mesh = posed("octopus", 15000, "swirl");
  ResolveOptions options;
  for (Index v = 0; v < std::ssize(mesh.positions); v += 9) options.pinned.push_back(v);
  options.max_iterations = 20;
  const Resolved r = resolve(mesh, options);
  EXPECT_GT(r.report.moved_vertices, 100);
  for (const Index v : options.pinned) ASSERT_EQ(r.after[v], r.before[v]) << v;
}

TEST(Resolve, NamesTheElementsThatStayTangled) {
  ResolveOptions options;
  options.max_displacement = 1e-6;
  options.patience = 7;
  options.pinned = {0, 1, 2};
  for (Index v = 0; v < 216; v += 2) options.pinned.push_back(v);
  const Resolved r = resolve(boxes({0.83, 0.13, 0.07}), options);
  EXPECT_EQ(r.report.outcome, ResolveOutcome::kStuck);
  EXPECT_GE(r.report.iterations.size(), 8u);
  const std::vector<Index>& holding = r.report.holding_vertices;
  ASSERT_FALSE(holding.empty());
  EXPECT_EQ(std::adjacent_find(holding.begin(), holding.end(), std::greater_equal<>()), holding.end());
  for (const Index v : holding) {
    EXPECT_EQ(v % 2, 0);
    EXPECT_GT(r.after[v][0], 0.7) << v;
  }
  // Those of either box that reach into the other.
  ASSERT_FALSE(r.report.tangled_elements.empty());
  EXPECT_TRUE(std::is_sorted(r.report.tangled_elements.begin(), r.report.tangled_elements.end()));
  for (const Index e : r.report.tangled_elements) {
    double nearest = std::numeric_limits<double>::infinity(), farthest = -nearest;
    for (const Index v : r.mesh.elements()[e]) {
      nearest = std::min(nearest, r.after[v][0]);
      farthest = std::max(farthest, r.after[v][0]);
    }
    EXPECT_TRUE(nearest < 1 + 1e-5 && farthest > 0.83 - 1e-5) << e;
  }
}

TEST(Resolve, NamesAtOnceTheElementsThatPinnedVerticesHold) {
  ResolveOptions options;
  for (Index v = 0; v < 432; ++v) options.pinned.push_back(v);
  const Resolved r = resolve(boxes({0.83, 0.13, 0.07}), options);
  EXPECT_EQ(r.report.outcome, ResolveOutcome::kHeld);
  EXPECT_EQ(r.report.iterations.size(), 1u);
  EXPECT_EQ(r.after, r.before);
  std::set<Index> corners;
  for (const Index e : r.report.tangled_elements)
    corners.insert(r.mesh.elements()[e].begin(), r.mesh.elements()[e].end());
  EXPECT_FALSE(corners.empty());
  EXPECT_EQ(r.report.holding_vertices, std::vector<Index>(corners.begin(), corners.end()));
}

// Pins that hold nothing that meets are no reason to refuse.
TEST(Resolve, MovesFreeVerticesOutOfPinnedElements) {
  ResolveOptions options;
  const IndexedMesh mesh = boxes({0.83, 0.13, 0.07});
  for (Index v = 0; v < 432; ++v)
    if (v < 216 || mesh.positions[v][0] > 1.7) options.pinned.push_back(v);
  const Resolved r = resolve(mesh, options);
  expect_resolved(r);
  EXPECT_TRUE(r.report.holding_vertices.empty());
}

TEST(Resolve, MovesNoVertexFartherThanTheLargestDisplacement) {
  ResolveOptions options;
  options.max_displacement = 0.02;
  options.patience = 20;
  const Resolved capped = resolve(boxes({0.83, 0.13, 0.07}), options);
  EXPECT_EQ(capped.report.outcome, ResolveOutcome::kStuck);
  EXPECT_GT(capped.report.max_displacement, 0.019);
  for (std::size_t v = 0; v < capped.after.size(); ++v) ASSERT_LE(displacement(capped, v), 0.02) << v;
  options.max_displacement = 0.15;
  options.patience = 60;
  const Resolved enough = resolve(boxes({0.83, 0.13, 0.07}), options);
  expect_resolved(enough);
  EXPECT_LE(enough.report.max_displacement, 0.15);
}

TEST(Resolve, GivesUpAfterTheLargestNumberOfIterations) {
  ResolveOptions options;
  options.max_iterations = 1;
  const Resolved r = resolve(boxes({0.83, 0.13, 0.07}), options);
  EXPECT_EQ(r.report.outcome, ResolveOutcome::kGaveUp);
  EXPECT_EQ(r.report.iterations.size(), 2u);
}

TEST(Resolve, ReportsEachIteration) {
  ResolveOptions options;
  std::vector<int> seen;
  options.on_iteration = [&](const ResolveIteration& row) { seen.push_back(row.iteration); };
  const Resolved r = resolve(boxes({0.83, 0.13, 0.07}), options);
  ASSERT_EQ(seen.size(), r.report.iterations.size());
  for (std::size_t i = 0; i < seen.size(); ++i) EXPECT_EQ(seen[i], static_cast<int>(i));
}

TEST(Resolve, GivesTheSameBitsForAnyNumberOfThreads) {
  const IndexedMesh mesh = posed("torus", 1500, "overlap");
  test::same_for_any_threads([&] { return resolve(mesh).after; });
}

TEST(Resolve, ResolvesAlikeInAnyUnit) {
  IndexedMesh mesh = boxes({0.83, 0.13, 0.07});
  const Resolved metres = resolve(mesh);
  for (Vec3& p : mesh.positions) p *= 1024;
  const Resolved others = resolve(mesh);
  EXPECT_EQ(others.report.iterations.size(), metres.report.iterations.size());
  for (std::size_t v = 0; v < others.after.size(); ++v)
    EXPECT_LT((others.after[v] - 1024 * metres.after[v]).norm(), 1e-6 * 1024) << v;
}

TEST(Resolve, RefusesImpossibleOptions) {
  const IndexedMesh mesh = boxes({0.83, 0.13, 0.07});
  const auto refuses = [&](auto&& change) {
    ResolveOptions options;
    change(options);
    EXPECT_THROW(resolve(mesh, options), Error);
  };
  refuses([](auto& o) { o.max_displacement = 0; });
  refuses([](auto& o) { o.max_displacement = std::nan(""); });
  refuses([](auto& o) { o.clearance = 0; });
  refuses([](auto& o) { o.max_iterations = 0; });
  refuses([](auto& o) { o.patience = 0; });
  refuses([](auto& o) { o.pinned = {-1}; });
  refuses([](auto& o) { o.pinned = {100000}; });
  refuses([](auto& o) { o.rest_positions.resize(3); });
  IndexedMesh inverted = mesh;
  std::swap(inverted.tetrahedra[5][0], inverted.tetrahedra[5][1]);
  EXPECT_THROW(resolve(inverted), Error);
}

}  // namespace
}  // namespace selvage
