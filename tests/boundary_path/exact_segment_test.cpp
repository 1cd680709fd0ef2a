// Exact decisions about a segment and a face against rational arithmetic, on small integers: most cases are degenerate.
#include "boundary_path/traversal/exact_segment.h"

#include "boundary_path/families/families.h"
#include "boundary_path/oracle/rational.h"
#include "test_scale.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

template <int D>
Vec<D> lattice_point(test::Random& random) {
  Vec<D> x;
  for (int k = 0; k < D; ++k) x[k] = random.below(5) - 2.0;
  return x;
}

/// A face; one in three is flat, or a point.
template <int D>
FacePoints<D> lattice_face(test::Random& random) {
  FacePoints<D> face;
  for (auto& x : face) x = lattice_point<D>(random);
  if (random.below(3) == 0) face[D - 1] = D == 2 || random.below(4) == 0 ? face[0] : Vec<D>(2 * face[1] - face[0]);
  if (random.below(20) == 0) face.fill(face[0]);
  return face;
}

template <int D>
std::array<oracle::RationalVec<D>, D> seen_from(const Vec<D>& p, const FacePoints<D>& face) {
  std::array<oracle::RationalVec<D>, D> result;
  using oracle::operator-;
  for (int i = 0; i < D; ++i) result[i] = oracle::to_rational<D>(face[i]) - oracle::to_rational<D>(p);
  return result;
}

/// @param unit  of the lattice: 1, or a number whose multiples are rounded, so that little is degenerate but much
/// nearly
template <int D>
void compare_with_rationals(double unit) {
  test::Random random(test::seed(D));
  std::int64_t in_segment = 0, in_reach = 0, on_line = 0;
  const std::int64_t count = test::scaled(12000);
  for (std::int64_t i = 0; i < count; ++i) {
    const Vec<D> p = unit * lattice_point<D>(random);
    FacePoints<D> boundary = lattice_face<D>(random), face = lattice_face<D>(random);
    for (auto* some : {&boundary, &face})
      for (Vec<D>& x : *some) x *= unit;
    const auto direction = oracle::closest_to_origin<D>(seen_from<D>(p, boundary));
    if (oracle::dot(direction, direction) == 0) continue;
    TargetSimplex<D> target;
    const unsigned mask = exact_closest_mask(p, boundary);
    for (int k = 0; k < D; ++k)
      if (mask >> k & 1) target.vertices[target.count++] = boundary[k];

    const auto met = oracle::meet_line<D>(seen_from<D>(p, face), direction);
    const bool segment = met && met->first <= 1 && met->second >= 0;
    const bool reach = met && met->first <= 3 && met->second >= -1;
    in_segment += segment;
    in_reach += reach && !segment;
    on_line += met && !reach;
    const ExactSegment<D> exact(p, target);
    ASSERT_EQ(exact.touches(face), segment) << i;
    ASSERT_EQ(exact.touches_within_reach(face), reach) << i;
  }
  for (const auto seen : {in_segment, in_reach, on_line}) EXPECT_GT(seen, test::quota(count, 1.0 / 400));
}

TEST(ExactSegment, MeetsFacesAsRationalsDoInThePlane) {
  for (const double unit : {1.0, 0.1}) compare_with_rationals<2>(unit);
}

TEST(ExactSegment, MeetsFacesAsRationalsDoInSpace) {
  for (const double unit : {1.0, 0.1}) compare_with_rationals<3>(unit);
}

// Flat faces across the line, in the plane of two coordinates that a projection could lose.
TEST(ExactSegment, FlatFacesBesideTheLineAreNotMet) {
  const TargetSimplex<3> target{1, {Vec3(1, 0, 0)}};
  const ExactSegment<3> along_x(Vec3(0, 0, 0), target);
  for (const Vec3& across : {Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(0, 1, 1), Vec3(1, 0, 2)}) {
    const Vec3 at(0.5, 0, 0), beside = at + across;
    EXPECT_TRUE(along_x.touches({at, beside, at + 2 * across}));
    EXPECT_TRUE(along_x.touches({Vec3(at - across), beside, at}));
    EXPECT_FALSE(along_x.touches({beside, Vec3(at + 2 * across), Vec3(at + 3 * across)}));
    EXPECT_FALSE(along_x.touches({beside, beside, beside}));
  }
  EXPECT_TRUE(along_x.touches_within_reach({Vec3(3, 0, 0), Vec3(4, 0, 0), Vec3(5, 0, 0)}));
  EXPECT_FALSE(along_x.touches_within_reach({Vec3(3.5, 0, 0), Vec3(4, 0, 0), Vec3(5, 0, 0)}));
  EXPECT_TRUE(along_x.touches_within_reach({Vec3(-1, 0, 0), Vec3(-4, 1, 0), Vec3(-5, 0, 1)}));
  EXPECT_FALSE(along_x.touches_within_reach({Vec3(-1.5, 0, 0), Vec3(-4, 1, 0), Vec3(-5, 0, 0)}));
}

// Points that lie on the line, or on a plane through it, but for rounding; and edges through p.
TEST(ExactSegment, SidesAreThoseOfRationals) {
  test::Random random(test::seed(9));
  const std::int64_t count = test::scaled(6000);
  const auto rational = [](const Vec3& x) { return oracle::to_rational<3>(x); };
  for (std::int64_t i = 0; i < count; ++i) {
    const double scale = std::ldexp(1.0, random.below(10) == 0 ? random.below(240) - 120 : 0);
    TargetSimplex<3> target;
    target.count = 1 + random.below(3);
    for (Vec3& x : target.vertices) x = scale * random.vector(1);
    Vec3 p = scale * random.vector(1);
    if (random.below(3) == 0) p = target.vertices[0] + std::pow(10.0, -random.within(0, 18)) * scale * random.vector(1);
    using oracle::operator-;
    const auto v = rational(target.vertices[0]) - rational(p),
               e = rational(target.vertices[1]) - rational(target.vertices[0]);
    const auto n = oracle::cross(e, rational(target.vertices[2]) - rational(target.vertices[0]));
    auto direction = v;
    for (int k = 0; k < 3; ++k) {
      if (target.count == 2) direction[k] = v[k] * oracle::dot(e, e) - e[k] * oracle::dot(v, e);
      if (target.count == 3) direction[k] = n[k] * oracle::dot(n, v);
    }
    if (oracle::dot(direction, direction) == 0) continue;
    Vec3 along;
    for (int k = 0; k < 3; ++k) along[k] = static_cast<double>(direction[k] / oracle::dot(direction, direction));
    along *= scale / along.cwiseAbs().maxCoeff();
    Vec3 a = p + random.within(-2, 2) * along, b = p + scale * random.vector(1);
    if (random.below(2) == 0) a = p - random.unit() * (b - p);  // an edge through p, but for rounding
    const oracle::Rational side = oracle::determinant(direction, rational(a) - rational(p), rational(b) - rational(p));
    ASSERT_EQ((ExactSegment<3>(p, target).side({a, b})), side.sign()) << i;
  }
}

/// s - p and the weights of s, for the foot of the perpendicular from p on a triangle's plane or an edge's line.
struct RationalOffset {
  oracle::RationalVec<3> offset;
  std::array<oracle::Rational, 3> weights;
};
RationalOffset project(const Vec3& p, const TargetSimplex<3>& target) {
  using oracle::operator-;
  std::array<oracle::RationalVec<3>, 3> v;
  for (int i = 0; i < target.count; ++i)
    for (int k = 0; k < 3; ++k) v[i][k] = oracle::Rational(target.vertices[i][k]) - oracle::Rational(p[k]);
  const auto e = v[1] - v[0];
  RationalOffset result;
  if (target.count == 2) {
    result.weights[1] = -oracle::dot(v[0], e) / oracle::dot(e, e);
    result.weights[0] = 1 - result.weights[1];
    for (int k = 0; k < 3; ++k) result.offset[k] = v[0][k] + result.weights[1] * e[k];
    return result;
  }
  const auto n = oracle::cross(e, v[2] - v[0]);
  const oracle::Rational squared = oracle::dot(n, n), height = oracle::dot(n, v[0]);
  for (int k = 0; k < 3; ++k) {
    result.offset[k] = n[k] * height / squared;
    result.weights[k] = oracle::dot(oracle::cross(v[(k + 1) % 3], v[(k + 2) % 3]), n) / squared;
  }
  return result;
}

// p from far away to as close as a rounding, on slivers and on tiny and huge triangles: most by double-double
// arithmetic, the rest by integers.
TEST(PreciseOffset, IsThatOfRationals) {
  test::Random random(test::seed(7));
  const std::int64_t count = test::scaled(4000);
  for (std::int64_t i = 0; i < count; ++i) {
    const double scale = std::ldexp(1.0, random.below(10) == 0 ? random.below(240) - 120 : 0);
    TargetSimplex<3> target;
    target.count = 2 + random.below(2);
    for (Vec3& x : target.vertices) x = scale * random.vector(1);
    if (random.below(4) == 0)
      target.vertices[1] = target.vertices[0] + std::pow(10.0, -random.within(0, 18)) * scale * random.vector(1);
    const double t = random.unit(), u = target.count == 3 ? (1 - t) * random.unit() : 0;
    const Vec3 foot = (1 - t - u) * target.vertices[0] + t * target.vertices[1] + u * target.vertices[2];
    const Vec3 p = foot + std::pow(10.0, 2 - random.within(0, 20)) * scale * random.vector(1);
    if (target.vertices[0] == target.vertices[1]) continue;
    const RationalOffset exact = project(p, target);
    const PreciseOffset<3> precise = precise_offset(p, target);
    oracle::Rational largest = 0;
    for (const auto& x : exact.offset) largest = std::max(largest, oracle::Rational(abs(x)));
    for (int k = 0; k < 3; ++k)
      ASSERT_LE(abs(oracle::Rational(precise.offset[k]) - exact.offset[k]), oracle::Rational(0x1p-52) * largest) << i;
    for (int k = 0; k < target.count; ++k)
      ASSERT_LE(abs(oracle::Rational(precise.barycentric[k]) - exact.weights[k]),
                oracle::Rational(0x1p-52) * abs(exact.weights[k]))
          << i;
  }
}

}  // namespace
}  // namespace selvage
