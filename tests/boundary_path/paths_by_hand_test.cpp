// Answers worked out by hand: the figures of the paper, normals, defects of a pose, errors in the input.
#include "boundary_path/families/figures.h"
#include "selvage/boundary_path/boundary_path.h"
#include "selvage/core/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace selvage {
namespace {

using families::Pieces;

template <int D>
SimplexMesh<D> mesh_of(const Pieces<D>& pieces) {
  return SimplexMesh<D>(static_cast<Index>(pieces.positions.size()), pieces.elements);
}

// The path of a point in the first element that holds it.
template <int D>
BoundaryPath<D> path_of(const Pieces<D>& pieces, const Vec<D>& point) {
  const auto mesh = mesh_of(pieces);
  const BoundaryPathFinder<D> finder(mesh, pieces.positions);
  const auto located = finder.locate(std::span(&point, 1));
  return finder.find_paths(std::span(located.queries).first(1)).front();
}

template <int D>
MeshDefects defects_of(const Pieces<D>& pieces) {
  const auto mesh = mesh_of(pieces);
  return BoundaryPathFinder<D>(mesh, pieces.positions).defects();
}

void expect_close(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  EXPECT_LT((a - b).norm(), 1e-14) << a.transpose() << " is not " << b.transpose();
}

TEST(PathsByHand, FiguresOfThePaper) {
  for (const auto& figure : families::paper_figures()) {
    const auto mesh = mesh_of(figure.mesh);
    const BoundaryPathFinder<2> finder(mesh, figure.mesh.positions);
    const PathQuery<2> query{figure.query.point, figure.query.element, figure.query.source};
    const auto path = finder.find_paths(std::span(&query, 1)).front();
    ASSERT_EQ(path.status, PathStatus::kFound) << figure.name;
    EXPECT_EQ(path.distance, figure.distance) << figure.name;
    EXPECT_EQ(path.point, figure.closest) << figure.name;
  }
}

TEST(PathsByHand, TheHooksTipPenetratesTheBar) {
  const auto pieces = families::hook(0.375);
  const auto mesh = mesh_of(pieces);
  const BoundaryPathFinder<2> finder(mesh, pieces.positions);
  const auto queries = finder.find_penetrating_vertices();
  std::vector<double> heights;
  for (const auto& query : queries) {
    if (query.point[1] == 0.375) heights.push_back(query.point[0]);
  }
  EXPECT_EQ(heights.front(), std::min(heights.front(), heights.back()));
  EXPECT_GE(heights.size(), 2u) << "both corners of the tip, each in the bar";
  for (const auto& path : finder.find_paths(queries)) EXPECT_EQ(path.status, PathStatus::kFound);
}

// An inverted boundary triangle holds no penetrating vertex for DCD (figure 7).
TEST(PathsByHand, InvertedBoundaryElementsAreSkippedByDcd) {
  // The second object's tip lies in the first, which is a single triangle listed clockwise.
  const Pieces<2> pieces{{{0, 0}, {4, 0}, {0, 4}, {1, 1}, {5, 1}, {5, 3}}, {{0, 2, 1}, {3, 4, 5}}};
  const auto mesh = mesh_of(pieces);
  EXPECT_TRUE(BoundaryPathFinder<2>(mesh, pieces.positions).find_penetrating_vertices().empty());
  const Pieces<2> positive{pieces.positions, {{0, 1, 2}, {3, 4, 5}}};
  const auto positive_mesh = mesh_of(positive);
  EXPECT_EQ(BoundaryPathFinder<2>(positive_mesh, positive.positions).find_penetrating_vertices().size(), 1u);
}

TEST(PathsByHand, FeaturesAndNormalsInThePlane) {
  const auto corner = families::squares({"##", "#."});
  const auto side = path_of<2>(corner, {0.25, 0.5});
  EXPECT_EQ(side.feature, BoundaryFeature::kFace);
  EXPECT_EQ(side.distance, 0.25);
  expect_close(side.normal, Vec2(-1, 0));
  expect_close(side.barycentric, Vec2(0.5, 0.5));
  const auto reflex = path_of<2>(corner, {0.75, 0.75});
  EXPECT_EQ(reflex.feature, BoundaryFeature::kVertex);
  EXPECT_EQ(reflex.point, Vec2(1, 1));
  EXPECT_EQ(reflex.distance, std::sqrt(0.125));
  expect_close(reflex.normal, Vec2(1, 1).normalized());
}

TEST(PathsByHand, FeaturesAndNormalsInSpace) {
  const auto notched = families::cubes({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}});
  const auto face = path_of<3>(notched, {0.25, 0.5, 0.625});
  EXPECT_EQ(face.feature, BoundaryFeature::kFace);
  EXPECT_EQ(face.distance, 0.25);
  expect_close(face.normal, Vec3(-1, 0, 0));
  const auto edge = path_of<3>(notched, {1.25, 0.875, 0.875});
  EXPECT_EQ(edge.feature, BoundaryFeature::kEdge);
  EXPECT_EQ(edge.point, Vec3(1.25, 1, 1));
  EXPECT_EQ(edge.distance, std::sqrt(0.03125));
  expect_close(edge.normal, Vec3(0, 1, 1).normalized());
  const auto vertex = path_of<3>(notched, {0.75, 0.75, 0.75});
  EXPECT_EQ(vertex.feature, BoundaryFeature::kVertex);
  EXPECT_EQ(vertex.point, Vec3(1, 1, 1));
  expect_close(vertex.normal, Vec3(1, 1, 1).normalized());
}

TEST(Defects, NoneInPlainMeshes) {
  for (const auto& d : {defects_of(families::grid(5, 4)), defects_of(families::walk("EEENNNWWWSSSEEE")),
                        defects_of(families::fan(7, 1, true)), defects_of(families::fan(6, 0.9, false))}) {
    EXPECT_EQ(d.inverted_elements + d.degenerate_elements + d.overwound_boundary_ridges + d.overwound_interior_ridges,
              0);
  }
  for (const auto& d :
       {defects_of(families::grid(3, 3, 2)), defects_of(families::extrude(families::fan(7, 1, true), 3, 1)),
        defects_of(families::cube_walk("EENNWWSSEE"))}) {
    EXPECT_EQ(d.inverted_elements + d.degenerate_elements + d.overwound_boundary_ridges + d.overwound_interior_ridges,
              0);
  }
}

TEST(Defects, OverwoundRidgesAreCounted) {
  EXPECT_EQ(defects_of(families::fan(9, 2, true)).overwound_interior_ridges, 1);
  EXPECT_EQ(defects_of(families::fan(14, 3, true, 2)).overwound_interior_ridges, 1);
  EXPECT_EQ(defects_of(families::fan(12, 1.6, false)).overwound_boundary_ridges, 1);
  EXPECT_EQ(defects_of(families::extrude(families::fan(9, 2, true), 3, 1)).overwound_interior_ridges, 3);
  EXPECT_EQ(defects_of(families::extrude(families::fan(12, 1.6, false, 2), 4, 1)).overwound_boundary_ridges, 4);
  EXPECT_EQ(defects_of(families::extrude(families::fan(12, 1.6, false, 2), 4, 1)).overwound_interior_ridges, 0);
  EXPECT_EQ(defects_of(families::walk("ENW")).overwound_boundary_ridges, 0) << "2 pi exactly is not more than 2 pi";
  EXPECT_EQ(defects_of(families::walk("ENWS")).overwound_boundary_ridges, 1);
  EXPECT_EQ(defects_of(families::cube_walk("ENWS")).overwound_boundary_ridges, 1);
}

template <int D>
void expect_signs_counted() {
  for (const auto& family : families::all_families<D>()) {
    const oracle::Oracle<D> judge(family.mesh.positions, family.mesh.elements);
    const auto defects = defects_of(family.mesh);
    const auto& signs = judge.orientations();
    EXPECT_EQ(defects.inverted_elements, std::count(signs.begin(), signs.end(), -1)) << family.name;
    EXPECT_EQ(defects.degenerate_elements, std::count(signs.begin(), signs.end(), 0)) << family.name;
  }
}

TEST(Defects, InvertedAndFlatElementsAreCounted) {
  expect_signs_counted<2>();
  expect_signs_counted<3>();
}

/// Paths end on the boundary, which has to be where the elements are.
TEST(Errors, FinderOnALocatorInAnotherPoseIsNotAsked) {
  const auto pieces = families::grid(2, 2);
  const auto mesh = mesh_of(pieces);
  PointLocator<2> locator(mesh, pieces.positions);
  BoundaryPathFinder<2> finder(locator);
  const std::vector<PathQuery<2>> query{{{0.75, 0.25}, 0}};
  const std::vector<std::array<Vec2, 2>> box{{Vec2(0, 0), Vec2(1, 1)}};
  EXPECT_NO_THROW(finder.find_paths(query));
  locator.update(pieces.positions);
  EXPECT_THROW(finder.find_paths(query), Error);
  EXPECT_THROW(finder.find_faces_near(box), Error);
  EXPECT_FALSE(locator.find_elements_near(box).found.empty());
  EXPECT_NO_THROW(finder.locate(std::vector<Vec2>{{0.75, 0.25}}));
  finder.update();
  EXPECT_NO_THROW(finder.find_paths(query));
  EXPECT_FALSE(finder.find_faces_near(box).found.empty());
}

TEST(Errors, AreRaisedAtTheDoors) {
  const auto pieces = families::grid(2, 2);
  const auto mesh = mesh_of(pieces);
  auto positions = pieces.positions;
  EXPECT_THROW(BoundaryPathFinder<2>(mesh, std::span(positions).first(8)), Error);
  const PlanarMesh none;
  EXPECT_THROW(BoundaryPathFinder<2>(none, {}), Error);
  BoundaryPathFinder<2> finder(mesh, positions);
  EXPECT_THROW(finder.update(std::span(positions).first(3)), Error);
  EXPECT_THROW(finder.rebuild(std::span(positions).first(3)), Error);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    positions[4][1] = bad;
    EXPECT_THROW(BoundaryPathFinder<2>(mesh, positions), Error);
    EXPECT_THROW(finder.update(positions), Error);
    EXPECT_THROW(finder.rebuild(positions), Error);
    const std::vector<PathQuery<2>> query{{{bad, 0.5}, 0}};
    EXPECT_THROW(finder.find_paths(query), Error);
    EXPECT_THROW(finder.locate(std::vector<Vec2>{{0.5, bad}}), Error);
  }
  const std::vector<PathQuery<2>> good{{{0.75, 0.25}, 0}}, below{{{0.75, 0.25}, -1}}, above{{{0.75, 0.25}, 8}};
  EXPECT_THROW(finder.find_paths(below), Error);
  EXPECT_THROW(finder.find_paths(above), Error);
  EXPECT_THROW(finder.find_paths(good, std::vector<Index>{0, 0}), Error);
  std::vector<PathCounters> counters(3);
  EXPECT_THROW(finder.find_paths(good, {}, counters), Error);
  // None of this has changed what the finder holds.
  const auto path = finder.find_paths(good).front();
  EXPECT_EQ(path.status, PathStatus::kFound);
  EXPECT_EQ(path.distance, 0.25);
}

template <int D>
std::string error_of(const BoundaryPathFinder<D>& finder, const std::vector<PathQuery<D>>& queries,
                     const std::vector<Index>& warm_start) {
  try {
    finder.find_paths(queries, warm_start);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST(Errors, SourcesAndWarmStartsOutOfRangeAreNamed) {
  const auto pieces = families::grid(1, 1, 1);  // 8 vertices, 6 elements, 12 boundary faces
  const auto mesh = mesh_of(pieces);
  const BoundaryPathFinder<3> finder(mesh, pieces.positions);
  const PathQuery<3> good{{0.5, 0.5, 0.5}, 0};
  for (const Index bad : {Index{-2}, Index{8}, std::numeric_limits<Index>::max(), std::numeric_limits<Index>::min()}) {
    for (const int place : {0, 1}) {
      PathQuery<3> query = good;
      query.source = {0, 1};
      query.source[place] = bad;
      EXPECT_EQ(error_of<3>(finder, {good, query}, {}),
                "query 1: there is no source vertex " + std::to_string(bad) + "; vertices lie in [0, 8)");
    }
  }
  for (const Index bad : {Index{-2}, Index{12}, std::numeric_limits<Index>::max(), std::numeric_limits<Index>::min()}) {
    EXPECT_EQ(
        error_of<3>(finder, {good, good, good}, {kNone, 11, bad}),
        "query 2: there is no boundary face " + std::to_string(bad) + " to start from; boundary faces lie in [0, 12)");
  }
  EXPECT_EQ(error_of<3>(finder, {good}, {kNone, kNone}),
            "warm_start: 2 faces for 1 queries; give one face per query, or none at all");
  EXPECT_EQ(error_of<3>(finder, {good, good}, {0, 11}), "");
}

TEST(Errors, NoQueriesNoAnswers) {
  const auto pieces = families::grid(1, 1, 1);
  const auto mesh = mesh_of(pieces);
  const BoundaryPathFinder<3> finder(mesh, pieces.positions);
  EXPECT_TRUE(finder.find_paths({}).empty());
  EXPECT_TRUE(finder.find_penetrating_vertices().empty());
  EXPECT_EQ(finder.locate({}).first, std::vector<std::int64_t>{0});
}

}  // namespace
}  // namespace selvage
