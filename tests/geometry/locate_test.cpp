#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "geometry/exact_oracle.h"
#include "selvage/geometry/predicates.h"
#include "test_scale.h"

namespace selvage {
namespace {

using test::LatticePoint;
using test::quota;
using test::RandomSource;
using test::scaled;

/// Slow twin: barycentric coordinates by the definition, with exact orientations of any kind of point.
template <int D, class Simplex, class Point, class Orientation>
Containment locate_slowly(const Simplex& simplex, const Point& p, Orientation&& exact_orientation) {
  const int whole = exact_orientation(simplex);
  Containment result;
  if (whole == 0) return result;
  for (int i = 0; i <= D; ++i) {
    Simplex replaced = simplex;
    replaced[i] = p;
    const int coordinate = exact_orientation(replaced) * whole;
    if (coordinate < 0) return {};
    if (coordinate == 0) result.zero_mask |= 1u << i;
  }
  result.inside = true;
  return result;
}

/// A lattice simplex, now and then flat or with equal vertices, and a point on one of its features or beside it. All
/// simplex coordinates are multiples of 12, so that midpoints and centroids of up to 4 vertices are lattice points.
template <int D>
void locate_on_lattice(std::uint64_t seed, std::int64_t count, int low_exponent, int high_exponent) {
  RandomSource random(seed);
  std::int64_t wrong = 0, inside = 0, on_feature = 0, flat = 0;
  for (std::int64_t n = 0; n < count; ++n) {
    const std::int64_t range = random.integer(1, 40);
    std::array<LatticePoint<D>, D + 1> lattice;
    for (auto& vertex : lattice) {
      vertex = random.template lattice_point<D>(range);
      for (std::int64_t& x : vertex) x *= 12;
    }
    const auto feature = static_cast<unsigned>(random.integer(1, (1 << (D + 1)) - 1));
    LatticePoint<D> p{};
    for (int i = 0; i <= D; ++i)
      for (int k = 0; k < D; ++k)
        if ((feature >> i & 1) != 0) p[k] += lattice[i][k] / std::popcount(feature);
    if (random.integer(0, 2) == 0) p[random.integer(0, D - 1)] += random.integer(-1, 1);
    const double scale = std::ldexp(1.0, static_cast<int>(random.integer(low_exponent, high_exponent)));
    std::array<Vec<D>, D + 1> simplex;
    for (int i = 0; i <= D; ++i) simplex[i] = test::to_point<D>(lattice[i], scale);
    const Containment expected = locate_slowly<D>(lattice, p, test::lattice_orientation<D>);
    const Containment found = locate_in_simplex<D>(simplex, test::to_point<D>(p, scale));
    wrong += found.inside != expected.inside || found.zero_mask != expected.zero_mask;
    inside += expected.inside;
    on_feature += expected.zero_mask != 0;
    flat += test::lattice_orientation<D>(lattice) == 0;
  }
  EXPECT_EQ(wrong, 0) << "of " << count;
  EXPECT_GT(inside, quota(count, 1.0 / 2));
  EXPECT_LT(inside, count);
  EXPECT_GT(on_feature, quota(count, 1.0 / 4));
  EXPECT_GT(flat, quota(count, 1.0 / 1000));
}

TEST(LocateInSimplex, TrianglesEqualIntegersOnLattice) {
  locate_on_lattice<2>(1, scaled(3'000'000), -60, 60);
}
TEST(LocateInSimplex, TetrahedraEqualIntegersOnLattice) {
  locate_on_lattice<3>(2, scaled(3'000'000), -60, 60);
}
TEST(LocateInSimplex, TrianglesAtAnyMagnitude) {
  locate_on_lattice<2>(3, scaled(200'000), -1074, 1010);
}
TEST(LocateInSimplex, TetrahedraAtAnyMagnitude) {
  locate_on_lattice<3>(4, scaled(200'000), -1074, 1010);
}

template <int D>
void locate_by_rationals(std::uint64_t seed, std::int64_t count) {
  RandomSource random(seed);
  std::int64_t inside = 0;
  for (std::int64_t n = 0; n < count; ++n) {
    std::array<Vec<D>, D + 1> simplex;
    for (Vec<D>& vertex : simplex) vertex = random.template point<D>();
    // A rounded point of a random feature, which is on it, just inside or just outside.
    const auto feature = static_cast<unsigned>(random.integer(1, (1 << (D + 1)) - 1));
    Vec<D> p = Vec<D>::Zero();
    double total = 0;
    for (int i = 0; i <= D; ++i) {
      if ((feature >> i & 1) == 0) continue;
      const double weight = 1.0 + random.uniform();
      p += weight * simplex[i];
      total += weight;
    }
    p /= total;
    if (random.integer(0, 1) == 0)
      for (int k = 0; k < D; ++k) p[k] = random.nudge(p[k]);
    const Containment expected = locate_slowly<D>(simplex, p, test::fixed_point_orientation<D>);
    const Containment found = locate_in_simplex<D>(simplex, p);
    ASSERT_EQ(found.inside, expected.inside) << "input " << n;
    ASSERT_EQ(found.zero_mask, expected.zero_mask) << "input " << n;
    inside += expected.inside;
  }
  EXPECT_GT(inside, quota(count, 1.0 / 20));
  EXPECT_GT(count - inside, quota(count, 1.0 / 20));
}

TEST(LocateInSimplex, TrianglesEqualRationals) {
  locate_by_rationals<2>(5, scaled(50'000));
}
TEST(LocateInSimplex, TetrahedraEqualRationals) {
  locate_by_rationals<3>(6, scaled(50'000));
}

TEST(LocateInSimplex, EveryFeatureOfATetrahedronInEveryOrder) {
  const std::array<Vec3, 4> corners{Vec3{0, 0, 0}, Vec3{12, 0, 0}, Vec3{0, 12, 0}, Vec3{0, 0, 12}};
  std::array<int, 4> order{0, 1, 2, 3};
  do {
    std::array<Vec3, 4> simplex;
    for (int i = 0; i < 4; ++i) simplex[i] = corners[order[i]];
    for (unsigned feature = 1; feature < 16; ++feature) {
      Vec3 p = Vec3::Zero();
      for (int i = 0; i < 4; ++i)
        if ((feature >> i & 1) != 0) p += simplex[i] / std::popcount(feature);
      const Containment found = locate_in_simplex<3>(simplex, p);
      EXPECT_TRUE(found.inside);
      EXPECT_EQ(found.zero_mask, 15u & ~feature);
    }
    for (const Vec3& outside : {Vec3{-1e-300, 1, 1}, Vec3{4, 4, std::nextafter(4.0, 5.0)}, Vec3{13, 0, 0}}) {
      EXPECT_FALSE(locate_in_simplex<3>(simplex, outside).inside);
      EXPECT_EQ(locate_in_simplex<3>(simplex, outside).zero_mask, 0u);
    }
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST(LocateInSimplex, FlatSimplicesContainNothing) {
  const std::array<Vec3, 4> square{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{1, 1, 0}, Vec3{0, 1, 0}};
  for (const Vec3& p : {Vec3{0.5, 0.5, 0}, Vec3{0, 0, 0}, Vec3{0.5, 0.5, 1}})
    EXPECT_FALSE(locate_in_simplex<3>(square, p).inside);
  const std::array<Vec3, 4> point{Vec3{1, 2, 3}, Vec3{1, 2, 3}, Vec3{1, 2, 3}, Vec3{1, 2, 3}};
  EXPECT_FALSE(locate_in_simplex<3>(point, {1, 2, 3}).inside);
  const std::array<Vec2, 3> segment{Vec2{0, 0}, Vec2{1, 1}, Vec2{3, 3}};
  EXPECT_FALSE(locate_in_simplex<2>(segment, {1, 1}).inside);
  EXPECT_FALSE(locate_in_simplex<2>(segment, {1, 0}).inside);
}

}  // namespace
}  // namespace selvage
