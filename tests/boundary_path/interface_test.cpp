// The public face of the room: queries by name, one query alone, what a finder may be made of.
#include "boundary_path/families/families.h"
#include "selvage/boundary_path/boundary_path.h"
#include "selvage/core/error.h"

#include <gtest/gtest.h>

#include <type_traits>

namespace selvage {
namespace {

// A mesh that would be gone before the first query is refused.
template <int D>
using Positions = std::span<const Vec<D>>;
static_assert(std::is_constructible_v<PointLocator<3>, const TetMesh&, Positions<3>>);
static_assert(std::is_constructible_v<BoundaryPathFinder<3>, const TetMesh&, Positions<3>>);
static_assert(std::is_constructible_v<BoundaryPathFinder<3>, PointLocator<3>&>);
static_assert(!std::is_constructible_v<PointLocator<3>, TetMesh, Positions<3>>);
static_assert(!std::is_constructible_v<PointLocator<2>, const PlanarMesh, Positions<2>>);
static_assert(!std::is_constructible_v<BoundaryPathFinder<3>, TetMesh, Positions<3>>);
static_assert(!std::is_constructible_v<BoundaryPathFinder<2>, PlanarMesh, Positions<2>, PathOptions>);

TEST(PathQueries, AreMadeByName) {
  const Vec3 p(1, 2, 3);
  const auto inner = PathQuery<3>::at(p, 7), vertex = PathQuery<3>::of_vertex(5, p, 7);
  const auto edge = PathQuery<3>::of_edge({4, 2}, p, 7);
  for (const auto& query : {inner, vertex, edge}) {
    EXPECT_EQ(query.point, p);
    EXPECT_EQ(query.element, 7);
  }
  EXPECT_EQ(inner.source, (std::array<Index, 2>{kNone, kNone}));
  EXPECT_EQ(vertex.source, (std::array<Index, 2>{5, kNone}));
  EXPECT_EQ(edge.source, (std::array<Index, 2>{4, 2}));
}

// The bits of a path do not depend on what else is asked, nor on how.
template <int D>
void expect_same_path_alone() {
  std::int64_t found = 0;
  for (const auto& family : families::all_families<D>()) {
    const families::Subject<D> subject(family);
    const BoundaryPathFinder<D> finder(subject.mesh, subject.judge.positions());
    const auto queries = finder.find_penetrating_vertices();
    const auto together = finder.find_paths(queries);
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const BoundaryPath<D> alone = finder.find_path(queries[i]);
      const BoundaryPath<D> warm = finder.find_path(queries[i], 0);
      ASSERT_EQ(alone.status, together[i].status) << family.name << ' ' << i;
      if (alone.status != PathStatus::kFound) continue;
      ++found;
      for (const auto& path : {alone, warm}) {
        EXPECT_EQ(path.face, together[i].face) << family.name << ' ' << i;
        EXPECT_EQ(path.point, together[i].point) << family.name << ' ' << i;
        EXPECT_EQ(path.distance, together[i].distance) << family.name << ' ' << i;
        EXPECT_EQ(path.normal, together[i].normal) << family.name << ' ' << i;
      }
    }
  }
  EXPECT_GT(found, 20);
}

TEST(OneQuery, HasTheSamePathAloneAndTogether) {
  expect_same_path_alone<2>();
  expect_same_path_alone<3>();
}

TEST(OneQuery, IsCheckedAsMany) {
  const TetMesh mesh(4, {{0, 1, 2, 3}});
  const std::vector<Vec3> positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const BoundaryPathFinder<3> finder(mesh, positions);
  EXPECT_EQ(finder.find_path(PathQuery<3>::at({0.125, 0.25, 0.25}, 0)).distance, 0.125);
  EXPECT_EQ(finder.find_path(PathQuery<3>::at({2, 2, 2}, 0)).status, PathStatus::kNotInElement);
  EXPECT_THROW(finder.find_path(PathQuery<3>::at({0.125, 0.25, 0.25}, 1)), Error);
  EXPECT_THROW(finder.find_path(PathQuery<3>::at({0.125, 0.25, 0.25}, 0), 4), Error);
}

}  // namespace
}  // namespace selvage
