// The oracle against answers found by hand: what is trusted to judge the library must itself be seen to be right.
#include "boundary_path/oracle/oracle.h"

#include "boundary_path/families/families.h"
#include "boundary_path/families/figures.h"
#include "boundary_path/oracle/exact_integers.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

using families::Pieces;
using oracle::Oracle;
using oracle::OracleAnswer;
using oracle::Rational;
using oracle::RationalVec;

constexpr std::array<Index, 2> kNoSource{kNone, kNone};

// Both routes must say the same; the answer of the fast one.
template <int D>
OracleAnswer ask(const Pieces<D>& mesh, const Vec<D>& p, Index element,
                 const std::array<Index, 2>& source = kNoSource) {
  const Oracle<D> oracle(mesh.positions, mesh.elements);
  oracle::Workspace workspace;
  const auto fast = oracle.shortest_path(p, element, source, workspace);
  const auto slow = oracle.shortest_path_rational(p, element, source);
  EXPECT_EQ(fast.in_element, slow.in_element);
  EXPECT_EQ(fast.found, slow.found);
  EXPECT_DOUBLE_EQ(fast.distance, slow.distance);
  return fast;
}

TEST(Rationals, ClosestPointOfATriangleOnEachFeature) {
  const RationalVec<3> a{0, 0, 0}, b{4, 0, 0}, c{0, 4, 0};
  auto closest = [&](int x, int y, int z) {
    using oracle::operator-;
    const RationalVec<3> p{x, y, z};
    RationalVec<3> s = oracle::closest_to_origin<3>({a - p, b - p, c - p});
    for (int k = 0; k < 3; ++k) s[k] += p[k];
    return s;
  };
  EXPECT_EQ(closest(1, 1, 7), (RationalVec<3>{1, 1, 0}));
  EXPECT_EQ(closest(2, -3, 1), (RationalVec<3>{2, 0, 0}));
  EXPECT_EQ(closest(4, 4, 1), (RationalVec<3>{2, 2, 0}));
  EXPECT_EQ(closest(-1, -2, 3), a);
  EXPECT_EQ(closest(9, 1, 0), b);
  EXPECT_EQ(closest(-1, 5, 0), c);
}

TEST(Rationals, LineMeetsATriangleInAPointAPieceOrNothing) {
  const std::array<RationalVec<3>, 3> face{{{2, 0, 0}, {2, 4, 0}, {2, 0, 4}}};
  auto meet = [&](const RationalVec<3>& d) { return oracle::meet_line<3>(face, d); };
  EXPECT_EQ(meet({1, Rational(1, 2), Rational(1, 2)})->first, 2);  // inside
  EXPECT_EQ(meet({2, 0, 0})->first, 1);                            // a vertex
  EXPECT_EQ(meet({-4, -4, 0})->first, Rational(-1, 2));            // an edge, backwards
  EXPECT_FALSE(meet({1, -1, 1}));
  EXPECT_FALSE(meet({0, 1, 1}));  // parallel
  const std::array<RationalVec<3>, 3> around{{{-1, -1, 0}, {3, -1, 0}, {-1, 3, 0}}};
  const auto piece = oracle::meet_line<3>(around, {1, 0, 0});
  EXPECT_EQ(piece->first, -1);
  EXPECT_EQ(piece->second, 2);
  const std::array<RationalVec<3>, 3> segment{{{1, -1, 0}, {1, 1, 0}, {1, 3, 0}}};
  EXPECT_EQ(oracle::meet_line<3>(segment, {2, 0, 0})->first, Rational(1, 2));
  EXPECT_FALSE(oracle::meet_line<3>(segment, {2, 0, 1}));
  EXPECT_EQ(oracle::meet_line<2>({{{1, 1}, {3, 3}}}, {2, 2})->second, Rational(3, 2));
  EXPECT_FALSE(oracle::meet_line<2>({{{1, 2}, {3, 4}}}, {1, 1}));
}

TEST(Rationals, RootsAndBits) {
  using oracle::Integer;
  EXPECT_EQ(oracle::root_of_fraction(9, 4, 0), 1.5);
  EXPECT_EQ(oracle::root_of_fraction(9, 4, 3), 1.5 / 8);
  EXPECT_EQ(oracle::root_of_fraction(2, 1, 0), std::sqrt(2.0));
  EXPECT_EQ(oracle::root_of_fraction(Integer(1) << 1500, 1, 750), 1);
  EXPECT_EQ(oracle::root_of_fraction(0, 7, 0), 0);
  EXPECT_EQ(oracle::fraction_bits(0.375), 3);
  EXPECT_EQ(oracle::fraction_bits(-6.0), -1);
  EXPECT_EQ(oracle::to_integer(-0.375, 5), -12);
  EXPECT_EQ(oracle::to_integer(6.0, -1), 3);
}

TEST(OracleByHand, SingleTriangle) {
  const Pieces<2> mesh{{{0, 0}, {8, 0}, {0, 8}}, {{0, 1, 2}}};
  EXPECT_EQ(ask<2>(mesh, {1, 2}, 0).distance, 1);
  EXPECT_EQ(ask<2>(mesh, {3, 3}, 0).distance, std::sqrt(2.0));
  EXPECT_FALSE(ask<2>(mesh, {5, 5}, 0).in_element);
  EXPECT_TRUE(ask<2>(mesh, {4, 4}, 0).in_element);
  EXPECT_EQ(ask<2>(mesh, {4, 4}, 0).distance, 4) << "the edge that holds the point is no candidate";
  EXPECT_EQ(ask<2>(mesh, {0, 0}, 0).distance, std::sqrt(32.0)) << "nor are the two at a vertex";
}

TEST(OracleByHand, SingleTetrahedron) {
  const Pieces<3> mesh{{{0, 0, 0}, {8, 0, 0}, {0, 8, 0}, {0, 0, 8}}, {{0, 1, 2, 3}}};
  EXPECT_EQ(ask<3>(mesh, {1, 2, 3}, 0).distance, 1);
  EXPECT_EQ(ask<3>(mesh, {0, 2, 2}, 0).distance, 2);
  EXPECT_EQ(ask<3>(mesh, {0, 0, 2}, 0).distance, 2);
  EXPECT_EQ(ask<3>(mesh, {0, 0, 0}, 0).distance, std::sqrt(64.0 / 3));
}

TEST(OracleByHand, PointsOnTheBoundaryOfAGrid) {
  const auto mesh = families::grid(4, 4);
  int in_middle = 0;
  for (Index e = 0; e < 32; ++e) {
    const auto middle = ask<2>(mesh, {2, 2}, e);
    if (middle.in_element) {
      EXPECT_EQ(middle.distance, 2);
    }
    in_middle += middle.in_element;
    const auto side = ask<2>(mesh, {0, 2}, e);  // along the boundary to the next edge
    if (side.in_element) {
      EXPECT_EQ(side.distance, 1);
    }
    const auto other = ask<2>(mesh, {0, 2}, e, {24, kNone});  // the far corner's edges alone are excluded
    if (other.in_element) {
      EXPECT_EQ(other.distance, 0);
    }
  }
  EXPECT_EQ(in_middle, 6);
}

TEST(OracleByHand, OtherSheetsAndOtherObjectsAreNoWayOut) {
  auto small = families::grid(1, 1);
  for (auto& x : small.positions) x = {2.25 + x[0] * 0.5, 2.25 + x[1] * 0.5};
  const auto mesh = families::together(families::grid(5, 5), small);
  for (Index e = 0; e < 50; ++e) {
    const auto in_large = ask<2>(mesh, {2.375, 2.5}, e);
    if (in_large.in_element) {
      EXPECT_EQ(in_large.distance, 2.375);
    }
  }
  for (Index e = 50; e < 52; ++e) {
    const auto in_small = ask<2>(mesh, {2.375, 2.5}, e);
    if (in_small.in_element) {
      EXPECT_EQ(in_small.distance, 0.125);
    }
  }
}

TEST(OracleByHand, DiamondWoundTwiceAroundItsCentre) {
  Pieces<2> mesh{{{0, 0}}, {}};
  for (int turn = 0; turn < 2; ++turn) {
    for (const auto& x : {Vec2(2, 0), Vec2(0, 2), Vec2(-2, 0), Vec2(0, -2)}) mesh.positions.push_back(x);
  }
  for (Index i = 0; i < 8; ++i) mesh.elements.push_back({0, 1 + i, 1 + (i + 1) % 8});
  for (Index e = 0; e < 8; ++e) EXPECT_EQ(ask<2>(mesh, {0, 0}, e).distance, std::sqrt(2.0));
  EXPECT_EQ(ask<2>(mesh, {0.5, 1}, 0).distance, std::sqrt(0.125));
  EXPECT_EQ(ask<2>(mesh, {0.5, 1}, 4).distance, std::sqrt(0.125));
  EXPECT_FALSE(ask<2>(mesh, {0.5, 1}, 1).in_element);
}

TEST(OracleByHand, PointsOnAnotherSheetsBoundaryWithASource) {
  // The tip of one triangle touches the long side of another: the way out has length 0.
  const Pieces<2> mesh{{{0, 0}, {4, 0}, {0, 4}, {2, 2}, {5, 5}, {4, 6}}, {{0, 1, 2}, {3, 4, 5}}};
  const auto touching = ask<2>(mesh, {2, 2}, 0, {3, kNone});
  EXPECT_TRUE(touching.found);
  EXPECT_EQ(touching.distance, 0);
  EXPECT_EQ(ask<2>(mesh, {2, 2}, 0).distance, 2);
}

TEST(OracleByHand, PenetratingVertices) {
  const Pieces<2> mesh{{{0, 0}, {4, 0}, {0, 4}, {1, 1}, {5, 1}, {5, 3}}, {{0, 1, 2}, {3, 4, 5}}};
  const auto pairs = Oracle<2>(mesh.positions, mesh.elements).penetrating_vertices();
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0], (oracle::OraclePair{3, 0}));
}

TEST(OracleByHand, FiguresOfThePaper) {
  for (const auto& figure : families::paper_figures()) {
    ASSERT_NE(figure.query.element, kNone) << figure.name;
    const auto answer = ask<2>(figure.mesh, figure.query.point, figure.query.element, figure.query.source);
    EXPECT_TRUE(answer.found) << figure.name;
    EXPECT_EQ(answer.distance, figure.distance) << figure.name;
  }
}

// The closest point lies 5e-10 from a vertex: by their squared lengths doubles cannot tell the two apart, and the line
// to the vertex misses the way.
TEST(OracleByHand, ClosestPointBesideAVertex) {
  for (const auto& family : families::solid_families()) {
    if (family.name != "many_inverted_exact") continue;
    const auto answer = ask<3>(family.mesh, {0.999999999620699, 1.000000000438554, 2.4697771971842286}, 177);
    EXPECT_EQ(answer.face, 102);
    return;
  }
  FAIL() << "no such family";
}

TEST(OracleByHand, FacesAreListedByOwnerAndNumber) {
  const Oracle<3> oracle({{0, 0, 0}, {4, 0, 0}, {1, 3, 0}, {1, 1, 4}, {4, 4, 4}}, {{0, 1, 2, 3}, {1, 4, 2, 3}});
  ASSERT_EQ(oracle.faces().size(), 6u);
  EXPECT_EQ(oracle.faces()[0].vertices, (VertexTuple<3>{0, 3, 2}));
  EXPECT_EQ(oracle.faces()[5].owner, 1);
  EXPECT_EQ(oracle.neighbour(0, 0), 1);
  EXPECT_EQ(oracle.neighbour(1, 1), 0);
}

}  // namespace
}  // namespace selvage
