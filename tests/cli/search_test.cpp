#include "cli/reports/path_search.h"

#include "cli/program.h"
#include "selvage/core/error.h"
#include "selvage/shapes/poses.h"
#include "selvage/shapes/shapes.h"

#include <pty.h>

#include <random>

namespace selvage::cli {
namespace {

/// Standard error is a terminal for as long as this lives.
class TerminalOnStandardError {
 public:
  TerminalOnStandardError() : saved_(dup(STDERR_FILENO)) {
    EXPECT_EQ(openpty(&other_end_, &terminal_, nullptr, nullptr, nullptr), 0);
    dup2(terminal_, STDERR_FILENO);
  }
  ~TerminalOnStandardError() {
    dup2(saved_, STDERR_FILENO);
    for (const int descriptor : {saved_, terminal_, other_end_}) close(descriptor);
  }

 private:
  int saved_, terminal_ = -1, other_end_ = -1;
};

class SearchTest : public testing::ProgramTest {
 protected:
  SearchResult search(const IndexedMesh& mesh, const SearchRequest& request) const {
    Stopwatch watch;
    return is_flat(mesh) ? search_paths<2>(mesh, request, watch) : search_paths<3>(mesh, request, watch);
  }

  SearchRequest ask(const std::string& points) const {
    testing::write_text(file("points.csv"), points);
    SearchRequest request;
    request.points_file = file("points.csv").string();
    return request;
  }

 private:
  static bool is_flat(const IndexedMesh& mesh) { return mesh.tetrahedra.empty(); }
};

IndexedMesh tangled_rod() {
  IndexedMesh rod = make_shape("rod");
  apply_pose(rod, "self-crossing");
  return rod;
}

TEST_F(SearchTest, CountersAreFilledOnRequestOnly) {
  const IndexedMesh rod = tangled_rod();
  SearchRequest request;
  const PathTotals plain = total_paths(search(rod, request).table);
  EXPECT_GT(plain.found, 0);
  EXPECT_EQ(plain.counters.traversals, 0);
  request.count = true;
  const PathTotals counted = total_paths(search(rod, request).table);
  EXPECT_GE(counted.counters.traversals, counted.found);
  EXPECT_EQ(counted.found, plain.found);
}

TEST_F(SearchTest, PhasesAreTimed) {
  Stopwatch watch;
  search_paths<3>(tangled_rod(), {}, watch);
  std::vector<std::string> phases;
  for (const auto& [phase, seconds] : watch.laps()) phases.push_back(phase);
  EXPECT_EQ(phases, (std::vector<std::string>{"topology", "hierarchy", "detect", "paths"}));
}

TEST_F(SearchTest, ProgressBarDoesNotChangeTheAnswers) {
  const IndexedMesh ball = make_shape("ball");
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  std::string points;
  for (int i = 0; i < 25000; ++i) {
    for (int k = 0; k < 3; ++k) points += std::to_string(coordinate(random)) + (k < 2 ? "," : "\n");
  }
  SearchRequest request = ask(points);
  request.count = true;
  const std::string alone = print_csv(search(ball, request).table);
  const TerminalOnStandardError terminal;
  EXPECT_EQ(print_csv(search(ball, request).table), alone);
}

TEST_F(SearchTest, RowsFollowTheFileWhateverIsKnownOfEachPoint) {
  const IndexedMesh box = make_box({1, 1, 1}, 0.5);
  const SearchResult result = search(box, ask("9,9,9\n0.5,0.5,0.5\n0.1,0.2,0.3,40\n0.11,0.23,0.37\n9,9,9\n"));
  std::vector<std::int64_t> numbers;
  for (const PathRow& row : result.table.rows) numbers.push_back(row.query);
  EXPECT_TRUE(std::is_sorted(numbers.begin(), numbers.end()));
  EXPECT_EQ(numbers.front(), 0);
  EXPECT_EQ(numbers.back(), 4);
  for (const PathRow& row : result.table.rows) {
    const bool outside = row.query == 0 || row.query == 4;
    EXPECT_EQ(row.element == kNone, outside);
    if (row.query == 2) {
      EXPECT_EQ(row.element, 40);
    } else {
      EXPECT_EQ(row.found(), !outside);
    }
  }
}

TEST_F(SearchTest, PointThatIsNotInItsElementSaysSo) {
  const IndexedMesh box = make_box({1, 1, 1}, 0.5);
  const Index last = static_cast<Index>(box.tetrahedra.size()) - 1;
  const SearchResult result = search(box, ask("0.01,0.02,0.03," + std::to_string(last) + "\n"));
  ASSERT_EQ(result.table.rows.size(), 1u);
  EXPECT_EQ(result.table.rows[0].status, PathStatus::kNotInElement);
  EXPECT_EQ(result.table.rows[0].element, last);
  EXPECT_EQ(total_paths(result.table).not_in_element, 1);
}

TEST_F(SearchTest, SurfaceAndOutlineAreTheBoundary) {
  const SearchResult solid = search(make_box({1, 1, 1}, 1), {});
  EXPECT_EQ(solid.surface.size(), 12u);
  EXPECT_TRUE(solid.outline.empty());
  EXPECT_FALSE(solid.table.planar);
  const SearchResult plane = search(make_cloth(1, 1, 1), {});
  EXPECT_EQ(plane.surface.size(), 2u);
  EXPECT_EQ(plane.outline.size(), 4u);
  EXPECT_TRUE(plane.table.planar);
  EXPECT_EQ(plane.element_count, 2);
}

TEST_F(SearchTest, PointsInThePlane) {
  const SearchResult result = search(make_cloth(1, 1, 0.25), ask("0.4,0.1,0\n"));
  ASSERT_GE(result.table.rows.size(), 1u);
  const PathRow& row = result.table.rows[0];
  EXPECT_TRUE(row.found());
  EXPECT_NEAR(row.distance, 0.1, 1e-15);
  EXPECT_EQ(row.normal, Vec3(0, -1, 0));
  EXPECT_EQ(row.closest[2], 0);
  EXPECT_EQ(row.face[2], kNone);
}

TEST_F(SearchTest, CullingIsPassedOn) {
  SearchRequest request;
  request.count = true;
  const PathTotals with = total_paths(search(tangled_rod(), request).table);
  request.options.cull_infeasible_regions = false;
  const PathTotals without = total_paths(search(tangled_rod(), request).table);
  EXPECT_EQ(without.counters.culled, 0);
  EXPECT_GT(without.counters.traversals, with.counters.traversals);
}

}  // namespace
}  // namespace selvage::cli
