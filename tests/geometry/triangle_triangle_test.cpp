#include "selvage/geometry/triangle_triangle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "geometry/contact_oracle.h"
#include "test_scale.h"

namespace selvage {
namespace {

using test::ExactTriangle;
using test::quota;
using test::RandomSource;
using test::scaled;

using Triangle = std::array<Vec3, 3>;
using enum TriangleContact;

constexpr int kContacts = 4;
using Counts = std::array<std::int64_t, kContacts>;

struct LatticePair {
  ExactTriangle<std::int64_t> a, b;
};

Triangle to_triangle(const ExactTriangle<std::int64_t>& lattice, double scale) {
  return {test::to_point<3>(lattice[0], scale), test::to_point<3>(lattice[1], scale),
          test::to_point<3>(lattice[2], scale)};
}

ExactTriangle<std::int64_t> random_lattice_triangle(RandomSource& random, std::int64_t range) {
  return {random.lattice_point<3>(range), random.lattice_point<3>(range), random.lattice_point<3>(range)};
}

/// An integer combination of the vertices with weights that sum to 1: a point of the triangle's plane, all multiples of
/// 12 when the vertices are, so that halves, thirds and quarters are on the lattice.
test::ExactVec<std::int64_t> point_of_plane(const ExactTriangle<std::int64_t>& t, RandomSource& random) {
  const std::int64_t i = random.integer(-2, 8), j = random.integer(-2, 8);
  test::ExactVec<std::int64_t> p;
  for (int k = 0; k < 3; ++k) p[k] = t[0][k] + i * ((t[1][k] - t[0][k]) / 6) + j * ((t[2][k] - t[0][k]) / 6);
  return p;
}

/// Two triangles of a coarse lattice; some vertices of b in the plane of a, at its vertices or on its edges.
LatticePair random_pair(RandomSource& random, std::int64_t range) {
  LatticePair pair{random_lattice_triangle(random, range), random_lattice_triangle(random, range)};
  for (auto* triangle : {&pair.a, &pair.b})
    for (auto& vertex : *triangle)
      for (auto& x : vertex) x *= 6;
  for (auto& vertex : pair.b) {
    if (random.integer(0, 2) != 0) continue;
    vertex = point_of_plane(pair.a, random);
    if (random.integer(0, 3) == 0) vertex[random.integer(0, 2)] += random.integer(-1, 1);
  }
  return pair;
}

/// Compares with the definition on lattices scaled by powers of two, both ways round.
void compare_contacts_on_lattice(std::uint64_t seed, std::int64_t count, int low_exponent, int high_exponent) {
  RandomSource random(seed);
  std::int64_t wrong = 0;
  Counts seen{};
  for (std::int64_t n = 0; n < count; ++n) {
    const LatticePair lattice = random_pair(random, random.integer(1, 5));
    const double scale = std::ldexp(1.0, static_cast<int>(random.integer(low_exponent, high_exponent)));
    const Triangle a = to_triangle(lattice.a, scale), b = to_triangle(lattice.b, scale);
    const TriangleContact expected = test::contact_by_definition(lattice.a, lattice.b);
    ++seen[static_cast<int>(expected)];
    wrong += classify_contact(a, b) != expected || classify_contact(b, a) != expected;
    wrong += triangles_meet(a, b) != (expected != kDisjoint) || triangles_meet(b, a) != (expected != kDisjoint);
  }
  EXPECT_EQ(wrong, 0) << "of " << count;
  for (std::int64_t number : seen) EXPECT_GT(number, quota(count, 1.0 / 50)) << "every contact must be met often";
}

TEST(TriangleContact, EqualsTheDefinitionOnCoarseLattices) {
  compare_contacts_on_lattice(1, scaled(300'000), -60, 60);
}
TEST(TriangleContact, EqualsTheDefinitionAtAnyMagnitude) {
  compare_contacts_on_lattice(2, scaled(50'000), -1074, 1015);
}

/// Coordinates in {0, 1} or {0, 1, 2}: mostly degenerate, coplanar or with equal vertices.
TEST(TriangleContact, EqualsTheDefinitionOnTheSmallestLattices) {
  RandomSource random(3);
  std::int64_t wrong = 0;
  for (std::int64_t n = 0; n < scaled(300'000); ++n) {
    const std::int64_t size = random.integer(1, 2);
    LatticePair lattice{};
    for (auto* triangle : {&lattice.a, &lattice.b})
      for (auto& vertex : *triangle)
        for (auto& x : vertex) x = random.integer(0, size);
    const TriangleContact expected = test::contact_by_definition(lattice.a, lattice.b);
    wrong += classify_contact(to_triangle(lattice.a, 0.1), to_triangle(lattice.b, 0.1)) != expected && size == 1;
    wrong += classify_contact(to_triangle(lattice.a, 1), to_triangle(lattice.b, 1)) != expected;
  }
  EXPECT_EQ(wrong, 0);
}

/// Doubles of one kind a call, with vertices of b close to or on features of a.
std::array<Vec3, 6> points_of_kind(int kind, RandomSource& random) {
  std::array<Vec3, 6> points;
  for (Vec3& point : points) {
    point = random.point<3>();
    for (int k = 0; k < 3; ++k) {
      if (kind == 1) point[k] = std::ldexp(point[k], -1060);  // denormal
      if (kind == 2) point[k] *= 1e150;
      if (kind == 3) point[k] *= 1e-150;
      if (kind == 4) point[k] = random.any_finite();
      if (kind == 5) point[k] *= random.integer(0, 1) == 0 ? 1e150 : 1e-150;
    }
  }
  if (kind == 4 || kind == 5) return points;
  for (int i = 3; i < 6; ++i) {
    if (random.integer(0, 1) == 0) continue;
    const double s = random.integer(0, 2) == 0 ? 0 : random.uniform(), t = random.uniform();
    points[i] = points[0] + s * (points[1] - points[0]) + t * (points[2] - points[0]);
    for (int k = 0; k < 3; ++k) points[i][k] = random.nudge(points[i][k]);
  }
  if (random.integer(0, 7) == 0) points[random.integer(0, 5)] = points[random.integer(0, 5)];
  if (random.integer(0, 7) == 0)
    for (Vec3& point : points) point[2] = points[0][2];
  return points;
}

template <class T>
void compare_doubles(const std::vector<int>& kinds, std::uint64_t seed, std::int64_t count) {
  RandomSource random(seed);
  Counts seen{};
  for (std::int64_t n = 0; n < count; ++n) {
    const int kind = kinds[n % kinds.size()];
    const std::array<Vec3, 6> points = points_of_kind(kind, random);
    const auto exact = test::to_exact<T>(points);
    const ExactTriangle<T> exact_a{exact[0], exact[1], exact[2]}, exact_b{exact[3], exact[4], exact[5]};
    const Triangle a{points[0], points[1], points[2]}, b{points[3], points[4], points[5]};
    const TriangleContact expected = test::contact_by_definition(exact_a, exact_b);
    ++seen[static_cast<int>(expected)];
    ASSERT_EQ(classify_contact(a, b), expected) << "kind " << kind << ", input " << n;
    ASSERT_EQ(triangles_meet(b, a), expected != kDisjoint) << "kind " << kind << ", input " << n;
  }
  for (int contact : {0, 2, 3}) EXPECT_GT(seen[contact], quota(count, 1.0 / 100));
}

TEST(TriangleContact, EqualsTheDefinitionOnNearlyDegenerateDoubles) {
  compare_doubles<test::Wide>({0, 1, 2, 3}, 4, scaled(20'000));
}
TEST(TriangleContact, EqualsTheDefinitionOnMixedMagnitudes) {
  compare_doubles<test::Unlimited>({4, 5}, 5, scaled(200));
}

TEST(TriangleContact, IsTheSameForEveryOrderOfVertices) {
  RandomSource random(6);
  std::int64_t different = 0;
  for (std::int64_t n = 0; n < scaled(5'000); ++n) {
    const LatticePair lattice = random_pair(random, 2);
    Triangle a = to_triangle(lattice.a, 0x1p-4), b = to_triangle(lattice.b, 0x1p-4);
    if (n % 2 == 0) {
      const std::array<Vec3, 6> points = points_of_kind(0, random);
      a = {points[0], points[1], points[2]};
      b = {points[3], points[4], points[5]};
    }
    const TriangleContact expected = classify_contact(a, b);
    std::array<int, 3> p{0, 1, 2}, q{0, 1, 2};
    do {
      do {
        const Triangle c{a[p[0]], a[p[1]], a[p[2]]}, d{b[q[0]], b[q[1]], b[q[2]]};
        different += classify_contact(c, d) != expected || classify_contact(d, c) != expected;
        different += triangles_meet(c, d) != (expected != kDisjoint);
      } while (std::next_permutation(q.begin(), q.end()));
    } while (std::next_permutation(p.begin(), p.end()));
  }
  EXPECT_EQ(different, 0);
}

/// A pair with shared vertices, moved onto each other from an independent pair.
template <int Shared>
LatticePair random_adjacent_pair(RandomSource& random) {
  LatticePair pair = random_pair(random, random.integer(1, 4));
  for (int i = 0; i < Shared; ++i) pair.b[i] = pair.a[i];
  return pair;
}

TEST(MeetBeyondVertex, EqualsTheDefinition) {
  RandomSource random(7);
  std::int64_t wrong = 0, met = 0;
  const std::int64_t count = scaled(500'000);
  for (std::int64_t n = 0; n < count; ++n) {
    const LatticePair lattice = random_adjacent_pair<1>(random);
    const double scale = std::ldexp(1.0, static_cast<int>(n % 32 == 0 ? random.integer(-1074, 1015) : 0));
    Triangle a = to_triangle(lattice.a, scale), b = to_triangle(lattice.b, scale);
    const bool expected = test::meet_beyond_vertex_by_definition(lattice.a, lattice.b);
    met += expected;
    wrong += meet_beyond_vertex(a, b) != expected || meet_beyond_vertex(b, a) != expected;
    std::swap(a[1], a[2]);
    wrong += meet_beyond_vertex(a, b) != expected;
    if (expected) wrong += classify_contact(a, b) == kDisjoint;
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(met, quota(count, 1.0 / 10));
}

TEST(MeetBeyondVertex, EqualsTheDefinitionOnDoubles) {
  RandomSource random(8);
  std::int64_t met = 0;
  const std::int64_t count = scaled(30'000);
  for (std::int64_t n = 0; n < count; ++n) {
    std::array<Vec3, 6> points = points_of_kind(static_cast<int>(n % 4), random);
    points[3] = points[0];
    const auto exact = test::to_exact<test::Wide>(points);
    const bool expected = test::meet_beyond_vertex_by_definition<test::Wide>({exact[0], exact[1], exact[2]},
                                                                             {exact[3], exact[4], exact[5]});
    met += expected;
    ASSERT_EQ(meet_beyond_vertex({points[0], points[1], points[2]}, {points[3], points[4], points[5]}), expected) << n;
  }
  EXPECT_GT(met, quota(count, 1.0 / 20));
}

TEST(MeetBeyondEdge, EqualsTheDefinition) {
  RandomSource random(9);
  std::int64_t wrong = 0, met = 0;
  const std::int64_t count = scaled(500'000);
  for (std::int64_t n = 0; n < count; ++n) {
    const LatticePair lattice = random_adjacent_pair<2>(random);
    const double scale = std::ldexp(1.0, static_cast<int>(n % 32 == 0 ? random.integer(-1074, 1015) : 0));
    Triangle a = to_triangle(lattice.a, scale), b = to_triangle(lattice.b, scale);
    const bool expected = test::meet_beyond_edge_by_definition(lattice.a, lattice.b);
    met += expected;
    wrong += meet_beyond_edge(a, b) != expected || meet_beyond_edge(b, a) != expected;
    std::swap(a[0], a[1]);
    std::swap(b[0], b[1]);
    wrong += meet_beyond_edge(a, b) != expected;
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(met, quota(count, 1.0 / 20));
}

TEST(MeetBeyondEdge, EqualsTheDefinitionOnDoubles) {
  RandomSource random(10);
  for (std::int64_t n = 0; n < scaled(100'000); ++n) {
    std::array<Vec3, 6> points = points_of_kind(static_cast<int>(n % 4), random);
    points[3] = points[0];
    points[4] = points[1];
    const auto exact = test::to_exact<test::Wide>(points);
    ASSERT_EQ(meet_beyond_edge({points[0], points[1], points[2]}, {points[3], points[4], points[5]}),
              test::meet_beyond_edge_by_definition<test::Wide>({exact[0], exact[1], exact[2]},
                                                               {exact[3], exact[4], exact[5]}))
        << n;
  }
}

using test::Rational;
using test::operator-;
using RationalVec = test::ExactVec<Rational>;
using RationalTriangle = ExactTriangle<Rational>;

/// x is a vertex, between two, or inside.
bool contains(const RationalTriangle& t, const RationalVec& x) {
  const RationalTriangle d{t[0] - x, t[1] - x, t[2] - x};
  const RationalTriangle crosses{test::cross(d[0], d[1]), test::cross(d[1], d[2]), test::cross(d[2], d[0])};
  bool same_turn = true, any_turn = false;
  for (int i = 0; i < 3; ++i) {
    if (test::is_zero(crosses[i]) && test::dot(d[i], d[(i + 1) % 3]) <= 0) return true;
    any_turn |= !test::is_zero(crosses[i]);
    same_turn &= test::dot(crosses[i], crosses[(i + 1) % 3]) >= 0;
  }
  return test::dot(crosses[0], d[2]) == 0 && any_turn && same_turn;
}

/// Slow twin of `intersection_segment`: of all vertices and all points where an edge crosses the other's plane, those
/// common to both triangles; the ends are the first and the last of them.
std::vector<RationalVec> common_points_by_definition(const RationalTriangle& a, const RationalTriangle& b) {
  std::vector<RationalVec> candidates;
  for (const auto* pair : {&a, &b}) {
    const RationalTriangle &edges = *pair, &plane = pair == &a ? b : a;
    const RationalVec normal = test::cross(plane[1] - plane[0], plane[2] - plane[0]);
    for (int i = 0; i < 3; ++i) {
      const RationalVec &p = edges[i], &q = edges[(i + 1) % 3];
      candidates.push_back(p);
      const Rational p_height = test::dot(normal, p - plane[0]), q_height = test::dot(normal, q - plane[0]);
      if (p_height * q_height >= 0) continue;
      RationalVec x;
      for (int k = 0; k < 3; ++k) x[k] = p[k] + (q[k] - p[k]) * p_height / (p_height - q_height);
      candidates.push_back(x);
    }
  }
  std::vector<RationalVec> common;
  for (const RationalVec& x : candidates)
    if (contains(a, x) && contains(b, x)) common.push_back(x);
  std::sort(common.begin(), common.end());
  return common;
}

double distance(const Vec3& p, const RationalVec& q) {
  double largest = 0;
  for (int k = 0; k < 3; ++k) largest = std::max(largest, std::abs((Rational(p[k]) - q[k]).convert_to<double>()));
  return largest;
}

RationalTriangle to_rational(const Triangle& t) {
  return {test::to_rational<3>(t[0]), test::to_rational<3>(t[1]), test::to_rational<3>(t[2])};
}

TEST(IntersectionSegment, EqualsTheDefinition) {
  RandomSource random(11);
  std::int64_t points = 0, segments = 0, thin = 0;
  const std::int64_t count = scaled(5'000);
  for (std::int64_t n = 0; n < count; ++n) {
    const LatticePair lattice = random_pair(random, random.integer(1, 3));
    Triangle a = to_triangle(lattice.a, 1), b = to_triangle(lattice.b, 1);
    if (n % 4 == 0) {  // planes a hair apart
      b[random.integer(0, 2)] = a[0] + random.uniform() * (a[1] - a[0]) + random.uniform() * (a[2] - a[0]);
      ++thin;
    }
    const TriangleContact contact = classify_contact(a, b);
    const auto found = intersection_segment(a, b);
    ASSERT_EQ(found.has_value(), contact == kTouching || contact == kCrossing) << n;
    if (!found) continue;
    const auto expected = common_points_by_definition(to_rational(a), to_rational(b));
    ASSERT_FALSE(expected.empty()) << n;
    const double forward = std::max(distance((*found)[0], expected.front()), distance((*found)[1], expected.back()));
    const double backward = std::max(distance((*found)[1], expected.front()), distance((*found)[0], expected.back()));
    ASSERT_LT(std::min(forward, backward), 1e-10) << n;
    const bool is_point = expected.front() == expected.back();
    if (is_point) {
      ASSERT_EQ((*found)[0], (*found)[1]) << n;
    }
    ++(is_point ? points : segments);
  }
  EXPECT_GT(points, quota(count, 1.0 / 50));
  EXPECT_GT(segments, quota(count, 1.0 / 20));
}

TEST(IntersectionSegment, AtAnyMagnitude) {
  for (double scale : {0x1p-1074, 1e-300, 1e-150, 1.0, 1e150, 1e307}) {
    const auto scaled_by = [scale](Triangle t) {
      for (Vec3& p : t) p *= scale;
      return t;
    };
    const Triangle a = scaled_by({Vec3{0, 0, 0}, Vec3{8, 0, 0}, Vec3{0, 8, 0}});
    const Triangle b = scaled_by({Vec3{2, 2, -2}, Vec3{2, 2, 2}, Vec3{2, 6, -2}});
    const auto found = intersection_segment(a, b);
    ASSERT_TRUE(found.has_value());
    const Vec3 p = scale * Vec3{2, 2, 0}, q = scale * Vec3{2, 4, 0};
    EXPECT_TRUE(((*found)[0] == p && (*found)[1] == q) || ((*found)[0] == q && (*found)[1] == p)) << scale;
  }
}

}  // namespace
}  // namespace selvage
