#include "simulation/crossings/body_crossings.h"

#include "random.h"
#include "selvage/geometry/triangle_triangle.h"
#include "simulation/bodies.h"
#include "test_scale.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

namespace selvage {
namespace {

IndexedMesh cube_at(const Vec3& offset, double cell = 0.25) {
  return bodies::moved(make_box(Vec3::Ones(), cell), offset);
}

BodyCrossings measure(const Model& model) {
  const BoundaryPathFinder<3> finder(model.mesh, model.rest_positions);
  return BodyCrossingFinder(model, model.rest_positions).measure(finder, model.rest_positions);
}

Model model_of(std::vector<IndexedMesh> meshes) {
  return bodies::make(meshes, bodies::neo_hookean(1e5));
}

TEST(BodyCrossings, AreNoneOfBodiesApartOrTouching) {
  for (const double gap : {0.5, 0.0}) {
    const BodyCrossings found = measure(model_of({cube_at(Vec3::Zero()), cube_at(Vec3(1 + gap, 0, 0))}));
    EXPECT_TRUE(found.pairs.empty());
    EXPECT_EQ(found.total.edges, 0);
    EXPECT_EQ(found.total.deepest_edge, 0);
  }
}

TEST(BodyCrossings, AreListedForEachPairOfBodies) {
  // The second stands 0.1 in the first, the fourth 0.2 in the third.
  const BodyCrossings found = measure(model_of({cube_at(Vec3(0, 0, 0)), cube_at(Vec3(0.9, 0.07, 0.03)),
                                                cube_at(Vec3(0, 5, 0)), cube_at(Vec3(0.03, 5.07, 0.8))}));
  ASSERT_EQ(found.pairs.size(), 2u);
  EXPECT_EQ(found.pairs[0].first, 0);
  EXPECT_EQ(found.pairs[0].second, 1);
  EXPECT_EQ(found.pairs[1].first, 2);
  EXPECT_EQ(found.pairs[1].second, 3);
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(found.pairs[i].deepest_vertex, 0.1 * (i + 1), 1e-12);
    EXPECT_NEAR(found.pairs[i].deepest_edge, 0.1 * (i + 1), 1e-12);
    EXPECT_EQ(found.pairs[i].vertices, 2 * 16);  // of each, 4 x 4 of the 5 x 5 of its side
    EXPECT_GT(found.pairs[i].triangle_pairs, 0);
    EXPECT_GT(found.pairs[i].edges, found.pairs[i].vertices);
  }
  EXPECT_EQ(found.total.vertices, 64);
  EXPECT_EQ(found.total.triangle_pairs, found.pairs[0].triangle_pairs + found.pairs[1].triangle_pairs);
  EXPECT_NEAR(found.total.deepest_edge, 0.2, 1e-12);
}

/// Two bars laid crosswise meet by edges alone.
TEST(BodyCrossings, OfEdgesAreSeenWhereNoVertexIsInside) {
  const IndexedMesh bar = make_box(Vec3(1, 0.2, 0.2), 1);
  IndexedMesh other = make_box(Vec3(0.2, 1, 0.2), 1);
  other = bodies::moved(other, Vec3(0.4, -0.4, 0.17));
  const BodyCrossings found = measure(model_of({bar, other}));
  ASSERT_EQ(found.pairs.size(), 1u);
  EXPECT_EQ(found.total.vertices, 0);
  EXPECT_EQ(found.total.deepest_vertex, 0);
  EXPECT_GT(found.total.triangle_pairs, 0);
  EXPECT_GT(found.total.edges, 0);
  EXPECT_NEAR(found.total.deepest_edge, 0.03, 1e-12);
}

TEST(BodyCrossings, OfABodyWithItselfAreAPair) {
  // One body of two cubes.
  const IndexedMesh both = concatenate(std::vector{cube_at(Vec3::Zero()), cube_at(Vec3(0.9, 0.07, 0.03))});
  const BodyCrossings found = measure(model_of({both}));
  ASSERT_EQ(found.pairs.size(), 1u);
  EXPECT_EQ(found.pairs[0].first, 0);
  EXPECT_EQ(found.pairs[0].second, 0);
  EXPECT_EQ(found.pairs[0].vertices, 32);
}

/// A vertex in two bodies is one vertex, and counts for both pairs.
TEST(BodyCrossings, OfAVertexInTwoBodiesCountOnceInTheTotal) {
  const BodyCrossings found = measure(
      model_of({cube_at(Vec3::Zero(), 1), cube_at(Vec3(0.05, 0.06, 0.07), 1), cube_at(Vec3(0.9, 0.91, 0.92), 1)}));
  std::int64_t sum = 0;
  for (const auto& pair : found.pairs) sum += pair.vertices;
  ASSERT_EQ(found.pairs.size(), 3u);
  EXPECT_EQ(found.pairs[0].vertices, 2);  // a corner of each in the other
  // The third's corner is in both others, the far corners of which are in it.
  EXPECT_EQ(found.pairs[1].vertices, 2);
  EXPECT_EQ(found.pairs[2].vertices, 2);
  EXPECT_EQ(sum, 6);
  EXPECT_EQ(found.total.vertices, 4);
}

/// Random boxes: the pairs are those that every triangle against every other gives.
TEST(BodyCrossings, OfTrianglesAgreeWithEveryPair) {
  test::Random random(3);
  for (int round = 0; round < test::scaled(20); ++round) {
    std::vector<IndexedMesh> meshes;
    for (int i = 0; i < 4; ++i) meshes.push_back(cube_at(random.vector(0.6), 0.5));
    const Model model = model_of(meshes);
    const auto faces = model.mesh.boundary_faces();
    const auto triangle = [&](std::size_t f) {
      return std::array{model.rest_positions[faces[f][0]], model.rest_positions[faces[f][1]],
                        model.rest_positions[faces[f][2]]};
    };
    const auto body = [&](std::size_t f) { return faces[f][0] / model.bodies[0].vertex_count; };
    std::map<std::pair<Index, Index>, std::int64_t> expected;
    for (std::size_t f = 0; f < faces.size(); ++f)
      for (std::size_t g = 0; g < f; ++g)
        if (body(f) != body(g) && classify_contact(triangle(f), triangle(g)) == TriangleContact::kCrossing)
          ++expected[std::minmax(body(f), body(g))];
    const BodyCrossings found = measure(model);
    for (const auto& pair : found.pairs) {
      EXPECT_EQ(pair.triangle_pairs, expected[std::pair(pair.first, pair.second)]);
      EXPECT_GE(pair.deepest_edge, 0.8 * pair.deepest_vertex);
    }
  }
}

}  // namespace
}  // namespace selvage
