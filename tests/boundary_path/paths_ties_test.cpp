// Of several faces that share the closest point, the one with the smallest index is named.
#include "boundary_path/compare.h"
#include "test_scale.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace selvage {
namespace {

/// Whether all vertices of which the answer's point is made belong to the face.
template <int D>
bool has_feature(const families::Subject<D>& subject, Index face, const BoundaryPath<D>& path) {
  const auto& named = subject.judge.faces()[path.face].vertices;
  const auto& other = subject.judge.faces()[face].vertices;
  for (int i = 0; i < D; ++i) {
    if (path.barycentric[i] != 0 && !std::count(other.begin(), other.end(), named[i])) return false;
  }
  return true;
}

template <int D>
bool is_excluded(const families::Subject<D>& subject, Index face, const PathQuery<D>& query) {
  const auto& vertices = subject.judge.faces()[face].vertices;
  return query.source[0] != kNone && std::all_of(query.source.begin(), query.source.end(), [&](Index v) {
           return v == kNone || std::count(vertices.begin(), vertices.end(), v) > 0;
         });
}

/// A smaller face that could have been named: it has the closest point and a valid path. kNone when there is none.
/// Where coordinates are small integers a face that has the feature has no point so near that rounding hides it.
template <int D>
Index smaller_face(const families::Subject<D>& subject, const PathQuery<D>& query, const BoundaryPath<D>& path,
                   oracle::Workspace& workspace) {
  for (Index face = 0; face < path.face; ++face) {
    if (is_excluded<D>(subject, face, query) || !has_feature<D>(subject, face, path)) continue;
    const bool is_closer = subject.judge.face_distance(query.point, face) < path.distance * (1 - 1e-9);
    if (!is_closer && subject.judge.is_valid(query.point, query.element, face, workspace)) return face;
  }
  return kNone;
}

template <int D>
void expect_smallest_faces() {
  std::int64_t shared = 0;
  for (std::size_t number = 0; number < families::all_families<D>().size(); ++number) {
    if (!families::all_families<D>()[number].is_exact) continue;
    const families::Subject<D> subject(families::all_families<D>()[number]);
    const BoundaryPathFinder<D> finder(subject.mesh, subject.judge.positions());
    const auto queries = families::to_library<D>(subject.maker.make_many(test::scaled(300), test::seed(500 + number)));
    const auto paths = finder.find_paths(queries);
    oracle::Workspace workspace;
    for (std::size_t i = 0; i < paths.size(); ++i) {
      if (paths[i].status != PathStatus::kFound || paths[i].feature == BoundaryFeature::kFace) continue;
      if (!subject.judge.is_clean(queries[i].element)) continue;
      ++shared;
      EXPECT_EQ(smaller_face<D>(subject, queries[i], paths[i], workspace), kNone)
          << subject.family.name << ", query " << i << " names face " << paths[i].face;
    }
  }
  EXPECT_GT(shared, test::scaled(300)) << "few answers lie on an edge or a vertex";
}

TEST(Ties, TheSmallestOfTheFacesThatShareThePointIsNamedInThePlane) {
  expect_smallest_faces<2>();
}

TEST(Ties, TheSmallestOfTheFacesThatShareThePointIsNamedInSpace) {
  expect_smallest_faces<3>();
}

TEST(Ties, TheMiddleOfACubeIsNearestToItsFirstFace) {
  const auto pieces = families::grid(2, 2, 2);
  const SimplexMesh<3> mesh(static_cast<Index>(pieces.positions.size()), pieces.elements);
  const BoundaryPathFinder<3> finder(mesh, pieces.positions);
  const Vec3 middle(1, 1, 1);
  for (const auto& path : finder.find_paths(finder.locate(std::span(&middle, 1)).queries)) {
    ASSERT_EQ(path.status, PathStatus::kFound);
    EXPECT_EQ(path.feature, BoundaryFeature::kVertex);
    Index first = mesh.boundary_face_count();
    for (Index face = mesh.boundary_face_count() - 1; face >= 0; --face) {
      const auto& vertices = mesh.boundary_faces()[face];
      const bool holds_a_middle = std::any_of(vertices.begin(), vertices.end(), [&](Index v) {
        return (pieces.positions[v] - middle).cwiseAbs().sum() == 1;
      });
      if (holds_a_middle) first = face;
    }
    EXPECT_EQ(path.face, first);
  }
}

/// Faces that are equally far, while a rounding puts an edge between them nearer than both.
TEST(PathTies, AreToldApartAlikeWithoutCulling) {
  const auto solid = families::moved<3>(families::grid(2, 2, 1),
                                        [](const Vec3& x) -> Vec3 { return (x + Vec3::Constant(1e6)) * 1e-5; });
  const TetMesh mesh(static_cast<Index>(solid.positions.size()), solid.elements);
  std::vector<PathQuery<3>> queries;
  constexpr int kParts = 10;
  for (Index e = 0; e < mesh.element_count(); ++e) {
    const auto& v = mesh.elements()[e];
    for (int a = 0; a <= kParts; ++a)
      for (int b = 0; a + b <= kParts; ++b)
        for (int c = 0; a + b + c <= kParts; ++c) {
          Vec3 point = Vec3::Zero();
          const std::array<int, 4> weights{a, b, c, kParts - a - b - c};
          for (int i = 0; i < 4; ++i) point += solid.positions[v[i]] * (weights[i] / double{kParts});
          queries.push_back({point, e});
        }
  }
  const auto culled = BoundaryPathFinder<3>(mesh, solid.positions).find_paths(queries);
  const auto all = BoundaryPathFinder<3>(mesh, solid.positions, {.cull_infeasible_regions = false}).find_paths(queries);
  for (std::size_t i = 0; i < queries.size(); ++i)
    ASSERT_TRUE(families::is_identical<3>(culled[i], all[i]))
        << i << ": faces " << culled[i].face << ", " << all[i].face;
}

}  // namespace
}  // namespace selvage
