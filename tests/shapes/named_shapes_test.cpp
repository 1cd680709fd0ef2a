#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <ostream>
#include <string>

#include "mesh/mesh_checks.h"
#include "selvage/core/error.h"
#include "selvage/shapes/poses.h"
#include "selvage/shapes/shapes.h"

namespace selvage {

void PrintTo(const TangledExample& example, std::ostream* out) {
  *out << example.shape << " " << example.pose;
}

namespace {

std::int64_t element_count(const IndexedMesh& mesh) {
  return static_cast<std::int64_t>(mesh.tetrahedra.size() + mesh.triangles.size());
}

std::string refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "not refused";
}

class NamedShapes : public testing::TestWithParam<std::string_view> {};

TEST_P(NamedShapes, AreSoundByDefault) {
  const IndexedMesh mesh = make_shape(GetParam());
  EXPECT_GT(element_count(mesh), 500);
  EXPECT_LT(element_count(mesh), 400000);
  EXPECT_EQ(test::count_not_positive(mesh), 0);
  EXPECT_EQ(test::count_orphans(mesh), 0);
  EXPECT_EQ(test::count_components(mesh), 1);
  EXPECT_EQ(test::count_buried_vertices(mesh, 1), 0);
  EXPECT_EQ(test::count_surface(mesh).bad_facets, 0);
}

TEST_P(NamedShapes, ComeInTheNumberAskedFor) {
  ShapeOptions options;
  if (GetParam() == "squishy-ball") options.tentacles = 20;
  for (const std::int64_t target : {30000, 80000}) {
    options.elements = target;
    const double count = static_cast<double>(element_count(make_shape(GetParam(), options)));
    // A swept disc has one ring more or less: a jump of (n + 1)^2 / n^2, at most 4, of which the nearer end is taken.
    const bool swept = GetParam() == "rod" || GetParam() == "trefoil" || GetParam().ends_with("knot") ||
                       GetParam().ends_with("overhand") || GetParam() == "noodle" || GetParam() == "torus" ||
                       GetParam() == "tube";
    const double ratio = count / static_cast<double>(target), slack = swept ? 2.01 : 1.15;
    EXPECT_LT(ratio, slack);
    EXPECT_GT(ratio, 1 / slack);
  }
}

INSTANTIATE_TEST_SUITE_P(All, NamedShapes, testing::ValuesIn(shape_names().begin(), shape_names().end()),
                         [](const auto& param) {
                           std::string name(param.param);
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST(NamedShapesRefuse, WhatTheyDoNotHave) {
  EXPECT_NE(refusal([] { make_shape("cube"); }).find("no shape 'cube'"), std::string::npos);
  EXPECT_NE(refusal([] { make_shape("cube"); }).find("octopus"), std::string::npos);
  EXPECT_NE(refusal([] { make_shape("ball", {.length = 1}); }).find("'ball' has no length"), std::string::npos);
  EXPECT_NE(refusal([] { make_shape("box", {.seed = 1}); }).find("no seed"), std::string::npos);
  EXPECT_NE(refusal([] { make_shape("box", {.cell = 1, .elements = 10}); }).find("one of them"), std::string::npos);
  EXPECT_NE(refusal([] { make_shape("box", {.elements = 0}); }).find("at least 1"), std::string::npos);
  EXPECT_NE(refusal([] { make_shape("box", {.elements = 1LL << 40}); }).find("2^29"), std::string::npos);
  EXPECT_NE(refusal([] { make_shape("octopus", {.elements = 100}); }).find("too few"), std::string::npos);
  EXPECT_NE(refusal([] { make_shape("ball", {.elements = 100, .radius = -1}); }).find("length"), std::string::npos);
  // Radii that leave nothing, before a cell is sought for so many elements.
  for (const char* name : {"tube", "torus", "gear"})
    EXPECT_NE(refusal([&] { make_shape(name, {.elements = 5000, .radius = 0.1}); }).find("radius"), std::string::npos);
  EXPECT_NE(refusal([] { make_shape("gear", {.elements = 50000, .teeth = 3}); }).find("teeth"), std::string::npos);
  EXPECT_NE(refusal([] { make_shape("squishy-ball", {.tentacles = 0}); }).find("tentacles"), std::string::npos);
}

TEST(NamedShapes, SlendernessThinsTheArms) {
  for (const char* name : {"octopus", "squishy-ball"}) {
    ShapeOptions options{.slenderness = 2};
    if (std::string_view(name) == "squishy-ball") options.tentacles = 20;
    const IndexedMesh slender = make_shape(name, options);
    options.slenderness = 1;
    const IndexedMesh stout = make_shape(name, options);
    options.slenderness.reset();
    EXPECT_EQ(make_shape(name, options).positions, stout.positions) << name;
    EXPECT_EQ(test::count_not_positive(slender), 0) << name;
    EXPECT_EQ(test::count_components(slender), 1) << name;
    EXPECT_EQ(test::count_buried_vertices(slender), 0) << name;
    // Thin arms have few inner vertices: fewer elements for each vertex.
    const auto ratio = [](const IndexedMesh& mesh) {
      return static_cast<double>(mesh.tetrahedra.size()) / static_cast<double>(mesh.positions.size());
    };
    EXPECT_LT(ratio(slender), 0.95 * ratio(stout)) << name;
    options.slenderness = 0.5;
    EXPECT_NE(refusal([&] { make_shape(name, options); }).find("slenderness"), std::string::npos);
    options.slenderness = 11;
    EXPECT_NE(refusal([&] { make_shape(name, options); }).find("slenderness"), std::string::npos);
  }
  EXPECT_NE(refusal([] { make_shape("ball", {.slenderness = 2}); }).find("no slenderness"), std::string::npos);
}

TEST(NamedShapes, SphereIsABall) {
  EXPECT_EQ(make_shape("sphere").positions, make_shape("ball").positions);
}

class TangledExamples : public testing::TestWithParam<TangledExample> {};

TEST_P(TangledExamples, RunIntoThemselvesWithoutInverting) {
  IndexedMesh mesh = make_shape(GetParam().shape);
  apply_pose(mesh, GetParam().pose);
  EXPECT_EQ(test::count_not_positive(mesh), 0);
  if (mesh.tetrahedra.empty()) {
    EXPECT_EQ(test::count_triangle_crossings(make_shape(GetParam().shape), 1), 0);
    EXPECT_GE(test::count_triangle_crossings(mesh, 10), 10);
  } else {
    EXPECT_GE(test::count_buried_vertices(mesh, 20), 20);
  }
}

INSTANTIATE_TEST_SUITE_P(All, TangledExamples, testing::ValuesIn(tangled_examples().begin(), tangled_examples().end()),
                         [](const auto& param) {
                           std::string name = std::string(param.param.shape) + "_" + std::string(param.param.pose);
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST(NamedPosesRefuse, WhatTheyDoNotHave) {
  IndexedMesh mesh = make_shape("beam");
  EXPECT_NE(refusal([&] { apply_pose(mesh, "knit"); }).find("no pose 'knit'"), std::string::npos);
  EXPECT_NE(refusal([&] { apply_pose(mesh, "bend", {.angle = 1}); }).find("'bend' has no angle"), std::string::npos);
  EXPECT_NE(refusal([&] { apply_pose(mesh, "overlap", {.axis = 1}); }).find("no axis"), std::string::npos);
  EXPECT_NE(refusal([&] { apply_pose(mesh, "bend", {.axis = 5}); }).find("no axis 5"), std::string::npos);
  EXPECT_NE(refusal([&] { apply_pose(mesh, "bend", {.turns = 9}); }).find("inside out"), std::string::npos);
  EXPECT_EQ(mesh.positions, make_shape("beam").positions) << "a refused pose moves nothing";
}

TEST(NamedPosesRefuse, ElementsTooLargeForABend) {
  const auto twist = [](IndexedMesh& mesh) { apply_pose(mesh, "twist", {.turns = 4}); };
  IndexedMesh coarse = make_shape("noodle", {.elements = 2000}), fine = make_shape("noodle", {.elements = 20000});
  const std::vector<Vec3> before = coarse.positions;
  EXPECT_NE(refusal([&] { twist(coarse); }).find("inside out, the first of them element"), std::string::npos);
  EXPECT_EQ(coarse.positions, before) << "a refused pose moves nothing";
  twist(fine);
  EXPECT_EQ(test::count_not_positive(fine), 0);
}

// A loop needs a mesh that is long; to be turned needs nothing.
TEST(NamedPoses, TwistThrowsAsManyLoopsAsItIsToldAndNoneOfACube) {
  const IndexedMesh cube = make_shape("box", {.cell = 0.1});
  IndexedMesh twisted = cube, wanted = cube;
  EXPECT_NE(refusal([&] { apply_pose(twisted, "twist", {.axis = 2, .turns = 0.2}); }).find("inside out"),
            std::string::npos);
  apply_pose(twisted, "twist", {.axis = 2, .turns = 0.2, .crossings = 0});
  pose_twist(wanted.positions, 2, 0.2);
  EXPECT_EQ(twisted.positions, wanted.positions);
  EXPECT_NE(refusal([&] { apply_pose(twisted, "twist", {.crossings = -1}); }).find("out of range"), std::string::npos);

  const IndexedMesh rod = make_shape("rod", {.cell = 0.1, .length = 12});
  IndexedMesh looped = rod;
  wanted = rod;
  apply_pose(looped, "twist", {.turns = 1, .crossings = 2});
  pose_twist(wanted.positions, 0, 1);
  pose_self_crossing(wanted.positions, 0, 2);
  EXPECT_EQ(looped.positions, wanted.positions);
}

TEST(Demonstration, AnOctopusOfThirtyThousandAndANoodleTangle) {
  IndexedMesh octopus = make_shape("octopus", {.elements = 30000});
  EXPECT_NEAR(static_cast<double>(octopus.tetrahedra.size()), 30000, 3000);
  EXPECT_EQ(test::count_buried_vertices(octopus), 0);
  apply_pose(octopus, "swirl", {.turns = 0.2});
  EXPECT_EQ(test::count_not_positive(octopus), 0);
  EXPECT_GT(test::count_buried_vertices(octopus), 200);

  IndexedMesh noodle = make_shape("rod", {.elements = 30000, .length = 20, .radius = 0.15});
  apply_pose(noodle, "self-crossing", {.crossings = 6});
  EXPECT_EQ(test::count_not_positive(noodle), 0);
  EXPECT_GT(test::count_buried_vertices(noodle), 200);
}

TEST(NamedShapes, ThinBoxesAreOfFewElementsWhereNothingSaysHowMany) {
  for (const Vec3& size : {Vec3(2, 0.02, 1.5), Vec3(100, 100, 0.001), Vec3(50, 0.1, 0.1), Vec3(1, 1, 1)}) {
    const IndexedMesh box = make_shape("box", {.size = size});
    EXPECT_LE(box.tetrahedra.size(), 100'000u);
    EXPECT_GE(box.tetrahedra.size(), 2'000u);
  }
}

}  // namespace
}  // namespace selvage
