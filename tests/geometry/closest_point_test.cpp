#include "selvage/geometry/closest_point.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <vector>

#include "geometry/exact_oracle.h"
#include "selvage/geometry/predicates.h"
#include "test_scale.h"

namespace selvage {
namespace {

using test::RandomSource;
using test::Rational;
using test::RationalPoint;
using test::scaled;

constexpr double kEpsilon = 0x1p-52;

template <int D>
ClosestPoint<D, 2> closest_point(const Vec<D>& p, const std::array<Vec<D>, 2>& s) {
  return closest_point_on_segment<D>(p, s[0], s[1]);
}
ClosestPoint<3, 3> closest_point(const Vec3& p, const std::array<Vec3, 3>& s) {
  return closest_point_on_triangle(p, s[0], s[1], s[2]);
}
ClosestPoint<3, 4> closest_point(const Vec3& p, const std::array<Vec3, 4>& s) {
  return closest_point_on_tetrahedron(p, s[0], s[1], s[2], s[3]);
}

template <int D>
Rational dot(const RationalPoint<D>& u, const RationalPoint<D>& v) {
  Rational sum = 0;
  for (int k = 0; k < D; ++k) sum += u[k] * v[k];
  return sum;
}

template <int D>
RationalPoint<D> minus(const RationalPoint<D>& u, const RationalPoint<D>& v) {
  RationalPoint<D> result;
  for (int k = 0; k < D; ++k) result[k] = u[k] - v[k];
  return result;
}

struct ExactAnswer {
  Rational squared_distance = -1;
  unsigned vertex_mask = 0;    ///< of the last feature that holds the answer in its interior
  unsigned features_seen = 0;  ///< how many features hold it in their interior: more than 1 only when degenerate
  bool degenerate = false;     ///< some feature has no volume
};

/// Weights of the corners of a feature at the foot of the perpendicular from p, by Gauss elimination of the normal
/// equations; false when the feature has no volume of its own dimension.
template <int D>
bool project_on_feature(const RationalPoint<D>& p, const std::vector<RationalPoint<D>>& corners,
                        std::vector<Rational>& weights) {
  const std::size_t n = corners.size() - 1;
  std::vector<std::vector<Rational>> rows(n, std::vector<Rational>(n + 1));
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j)
      rows[i][j] = dot<D>(minus<D>(corners[i + 1], corners[0]), minus<D>(corners[j + 1], corners[0]));
    rows[i][n] = dot<D>(minus<D>(corners[i + 1], corners[0]), minus<D>(p, corners[0]));
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (rows[i][i] == 0) return false;  // the matrix is positive semidefinite: a zero pivot is a zero determinant
    for (std::size_t r = 0; r < n; ++r) {
      if (r == i) continue;
      const Rational factor = rows[r][i] / rows[i][i];
      for (std::size_t c = i; c <= n; ++c) rows[r][c] -= factor * rows[i][c];
    }
  }
  weights.assign(n + 1, Rational(1));
  for (std::size_t i = 0; i < n; ++i) {
    weights[i + 1] = rows[i][n] / rows[i][i];
    weights[0] -= weights[i + 1];
  }
  return true;
}

/// Every feature in rational arithmetic, by the definition.
template <int D, std::size_t N>
ExactAnswer search_all_features(const Vec<D>& p, const std::array<Vec<D>, N>& simplex) {
  ExactAnswer answer;
  const RationalPoint<D> exact_p = test::to_rational<D>(p);
  for (unsigned feature = 1; feature < 1u << N; ++feature) {
    std::vector<RationalPoint<D>> corners;
    for (std::size_t i = 0; i < N; ++i)
      if ((feature >> i & 1) != 0) corners.push_back(test::to_rational<D>(simplex[i]));
    std::vector<Rational> weights;
    if (!project_on_feature<D>(exact_p, corners, weights)) {
      answer.degenerate = true;
      continue;
    }
    if (std::any_of(weights.begin(), weights.end(), [](const Rational& w) { return w <= 0; })) continue;
    RationalPoint<D> offset = exact_p;
    for (std::size_t i = 0; i < corners.size(); ++i)
      for (int k = 0; k < D; ++k) offset[k] -= weights[i] * corners[i][k];
    const Rational squared = dot<D>(offset, offset);
    if (answer.features_seen > 0 && squared > answer.squared_distance) continue;
    answer.features_seen = squared == answer.squared_distance ? answer.features_seen + 1 : 1;
    answer.squared_distance = squared;
    answer.vertex_mask = feature;
  }
  return answer;
}

template <int D, int N>
void expect_consistent(const Vec<D>& p, const std::array<Vec<D>, N>& simplex, const ClosestPoint<D, N>& found) {
  double magnitude = p.cwiseAbs().maxCoeff(), sum = 0;
  Vec<D> combined = Vec<D>::Zero();
  for (int i = 0; i < N; ++i) {
    magnitude = std::max(magnitude, simplex[i].cwiseAbs().maxCoeff());
    combined += found.barycentric[i] * simplex[i];
    sum += found.barycentric[i];
    if ((found.vertex_mask >> i & 1) != 0)
      ASSERT_GT(found.barycentric[i], 0) << i;
    else
      ASSERT_EQ(found.barycentric[i], 0) << i;
  }
  ASSERT_NEAR(sum, 1, 4 * kEpsilon);
  ASSERT_LE((combined - found.point).cwiseAbs().maxCoeff(), 32 * kEpsilon * magnitude);
  ASSERT_EQ(found.squared_distance, (p - found.point).squaredNorm());
  if (std::has_single_bit(found.vertex_mask)) {
    ASSERT_EQ(found.point, simplex[std::countr_zero(found.vertex_mask)]);
  }
}

template <int D, std::size_t N>
void expect_closest(const Vec<D>& p, const std::array<Vec<D>, N>& simplex, bool same_feature) {
  const ClosestPoint<D, N> found = closest_point(p, simplex);
  expect_consistent<D, N>(p, simplex, found);
  const ExactAnswer exact = search_all_features<D, N>(p, simplex);
  double size = 0;
  for (const Vec<D>& vertex : simplex) size = std::max({size, vertex.cwiseAbs().maxCoeff(), p.cwiseAbs().maxCoeff()});
  ASSERT_NEAR(std::sqrt(found.squared_distance), std::sqrt(exact.squared_distance.template convert_to<double>()),
              16 * kEpsilon * size);
  if (same_feature && exact.features_seen == 1) {
    ASSERT_EQ(found.vertex_mask, exact.vertex_mask);
  }
}

enum class Shape { kAny, kThin, kFlat };

/// A point of the lattice; thin simplices have their last vertex beside the hull of the others, flat ones in it.
template <int D, std::size_t N>
std::array<Vec<D>, N> lattice_simplex(RandomSource& random, std::int64_t range, Shape shape) {
  std::array<Vec<D>, N> simplex;
  for (Vec<D>& vertex : simplex) vertex = test::to_point<D>(random.template lattice_point<D>(range));
  if (shape == Shape::kAny) return simplex;
  simplex[N - 1] = simplex[0];
  for (std::size_t i = 1; i + 1 < N; ++i)
    simplex[N - 1] += static_cast<double>(random.integer(-2, 2)) * (simplex[i] - simplex[0]);
  if (shape == Shape::kThin) simplex[N - 1][random.integer(0, D - 1)] += 1;
  std::swap(simplex[N - 1], simplex[random.integer(0, N - 1)]);
  return simplex;
}

template <int D, std::size_t N>
void compare_with_all_features(std::uint64_t seed, std::int64_t count) {
  RandomSource random(seed);
  for (std::int64_t n = 0; n < count; ++n) {
    SCOPED_TRACE(n);
    const std::int64_t range = std::int64_t{1} << random.integer(1, 9);
    const auto shape = static_cast<Shape>(random.integer(0, 2));
    const auto simplex = lattice_simplex<D, N>(random, range, shape);
    Vec<D> p = test::to_point<D>(random.template lattice_point<D>(2 * range));
    if (random.integer(0, 2) == 0) {  // a point of the simplex, or near it
      p.setZero();
      for (const Vec<D>& vertex : simplex) p += vertex / 4;
      if constexpr (N == 3) p += simplex[random.integer(0, 2)] / 4;
      if constexpr (N == 2) p *= 2;
    }
    expect_closest<D, N>(p, simplex, true);
    if (testing::Test::HasFatalFailure()) return;
  }
}

TEST(ClosestPoint, SegmentInThePlaneEqualsSearchOfAllFeatures) {
  compare_with_all_features<2, 2>(1, scaled(10'000));
}
TEST(ClosestPoint, SegmentInSpaceEqualsSearchOfAllFeatures) {
  compare_with_all_features<3, 2>(2, scaled(10'000));
}
TEST(ClosestPoint, TriangleEqualsSearchOfAllFeatures) {
  compare_with_all_features<3, 3>(3, scaled(8'000));
}
TEST(ClosestPoint, TetrahedronEqualsSearchOfAllFeatures) {
  compare_with_all_features<3, 4>(4, scaled(2'000));
}

TEST(ClosestPoint, FootOnAnEdgeOfAThinTriangle) {
  // The weight of the second vertex is zero, as a difference 6e-17.
  expect_closest<3, 3>({0, -16, 13}, {Vec3(0, -4, -4), Vec3(1, 10, 18), Vec3(0, 3, 7)}, true);
}

/// Random doubles: from fat simplices to ones whose height is 1e-17 of their length, and points at all distances.
template <std::size_t N>
void compare_thin_with_all_features(std::uint64_t seed, std::int64_t count) {
  RandomSource random(seed);
  for (std::int64_t n = 0; n < count; ++n) {
    SCOPED_TRACE(n);
    std::array<Vec3, N> simplex;
    for (Vec3& vertex : simplex) vertex = random.point<3>();
    const double thinness = random.with_exponent(-56, 0), distance = random.with_exponent(-50, 3);
    Vec3 flat = simplex[0], p = simplex[0];
    for (std::size_t i = 1; i + 1 < N; ++i) {
      const double weight = random.uniform();
      flat += weight * (simplex[i] - simplex[0]);
      p += std::abs(random.uniform()) * (simplex[i] - simplex[0]);
    }
    if (random.integer(0, 1) == 0) simplex[N - 1] = flat + thinness * random.point<3>();
    std::swap(simplex[N - 1], simplex[random.integer(0, N - 1)]);
    p += distance * random.point<3>();
    expect_closest<3, N>(p, simplex, false);
    if (testing::Test::HasFatalFailure()) return;
  }
}

TEST(ClosestPoint, ThinTriangleEqualsSearchOfAllFeatures) {
  compare_thin_with_all_features<3>(5, scaled(4'000));
}
TEST(ClosestPoint, ThinTetrahedronEqualsSearchOfAllFeatures) {
  compare_thin_with_all_features<4>(6, scaled(600));
}

/// The point that lies off the middle of each feature, along its outward direction, in all orders of the vertices.
template <std::size_t N>
void expect_every_feature_in_every_order(const std::array<Vec3, N>& corners) {
  std::array<int, N> order;
  std::iota(order.begin(), order.end(), 0);
  const Vec3 center = std::accumulate(corners.begin(), corners.end(), Vec3(Vec3::Zero())) / static_cast<double>(N);
  do {
    std::array<Vec3, N> simplex;
    for (std::size_t i = 0; i < N; ++i) simplex[i] = corners[order[i]];
    for (unsigned feature = 1; feature < 1u << N; ++feature) {
      Vec3 middle = Vec3::Zero();
      for (std::size_t i = 0; i < N; ++i)
        if ((feature >> i & 1) != 0) middle += simplex[i] / std::popcount(feature);
      Vec3 p = middle + 0.75 * (middle - center);
      if (N == 3 && feature == 7) p += Vec3(1, 1, 1);
      const auto found = closest_point(p, simplex);
      ASSERT_EQ(found.vertex_mask, feature);
      ASSERT_LE((found.point - middle).norm(), 8 * kEpsilon);
      expect_consistent<3, N>(p, simplex, found);
    }
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST(ClosestPoint, EveryFeatureInEveryOrder) {
  // Regular simplices, where the way from the centre through the middle of a feature is normal to it.
  expect_every_feature_in_every_order<2>({Vec3{1, 2, 3}, Vec3{3, 2, 1}});
  expect_every_feature_in_every_order<3>({Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}});
  expect_every_feature_in_every_order<4>({Vec3{1, 1, 1}, Vec3{1, -1, -1}, Vec3{-1, 1, -1}, Vec3{-1, -1, 1}});
}

TEST(ClosestPoint, OrderOfVerticesDoesNotMatter) {
  RandomSource random(7);
  for (std::int64_t n = 0; n < scaled(20'000); ++n) {
    const auto shape = static_cast<Shape>(random.integer(0, 1));
    const auto corners = lattice_simplex<3, 4>(random, 100, shape);
    if (orientation(corners) == 0) continue;
    const Vec3 p = test::to_point<3>(random.lattice_point<3>(150));
    const auto first = closest_point(p, corners);
    std::array<int, 4> order{0, 1, 2, 3};
    while (std::next_permutation(order.begin(), order.end())) {
      std::array<Vec3, 4> simplex;
      for (int i = 0; i < 4; ++i) simplex[i] = corners[order[i]];
      const auto found = closest_point(p, simplex);
      unsigned mask = 0;
      for (int i = 0; i < 4; ++i) mask |= (found.vertex_mask >> i & 1u) << order[i];
      ASSERT_EQ(mask, first.vertex_mask) << "input " << n;
      ASSERT_LE((found.point - first.point).norm(), 1e-12);
    }
  }
}

TEST(ClosestPoint, BothFacesAtAnEdgeFindTheSameBits) {
  RandomSource random(8);
  std::int64_t on_edge = 0;
  for (std::int64_t n = 0; n < scaled(100'000); ++n) {
    const Vec3 a = random.point<3>(), b = random.point<3>(), c = random.point<3>(), d = random.point<3>();
    const Vec3 p = 2 * random.point<3>();
    const auto forth = closest_point_on_segment<3>(p, a, b), back = closest_point_on_segment<3>(p, b, a);
    ASSERT_EQ(forth.point, back.point);
    ASSERT_EQ(forth.squared_distance, back.squared_distance);
    ASSERT_EQ(forth.barycentric[0], back.barycentric[1]);
    const auto left = closest_point_on_triangle(p, a, b, c), right = closest_point_on_triangle(p, d, b, a);
    if (left.vertex_mask != 0b011 || right.vertex_mask != 0b110) continue;
    ++on_edge;
    ASSERT_EQ(left.point, right.point);
    ASSERT_EQ(left.squared_distance, right.squared_distance);
  }
  EXPECT_GT(on_edge, scaled(100'000) / 1000);
}

TEST(ClosestPoint, DegenerateSimplices) {
  const Vec3 a{0, 0, 0}, b{4, 0, 0}, c{1, 0, 0};
  const auto equal_ends = closest_point_on_segment<3>({5, 1, 0}, b, b);
  EXPECT_EQ(equal_ends.vertex_mask, 1u);
  EXPECT_EQ(equal_ends.squared_distance, 2);
  const auto flat = closest_point_on_triangle({3, 2, 0}, a, b, c);
  EXPECT_EQ(flat.point, Vec3(3, 0, 0));
  EXPECT_EQ(std::popcount(flat.vertex_mask), 2);
  const auto point = closest_point_on_triangle({1, 2, 2}, c, c, c);
  EXPECT_EQ(point.squared_distance, 8);
  EXPECT_EQ(std::popcount(point.vertex_mask), 1);
  // A line that is not parallel to an axis, and whose products round.
  const Vec3 d{0.1, 0.7, 0.3};
  const auto rounded = closest_point_on_triangle({1, 0, 0}, d, 2 * d, 4 * d);
  EXPECT_LE(std::popcount(rounded.vertex_mask), 2);
  const auto flat_tetrahedron = closest_point_on_tetrahedron({0.5, 0.25, 3}, a, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
  EXPECT_EQ(flat_tetrahedron.squared_distance, 9);
  EXPECT_EQ(std::popcount(flat_tetrahedron.vertex_mask), 3);
  const auto needle = closest_point_on_tetrahedron({2, 3, 4}, a, b, c, c);
  EXPECT_EQ(needle.squared_distance, 25);
  EXPECT_EQ(closest_point_on_tetrahedron(a, a, a, a, a).squared_distance, 0);
}

TEST(ClosestPoint, PointInsideATetrahedronIsItselfAndNamesItsFace) {
  const Vec3 a{0, 0, 0}, b{4, 0, 0}, c{0, 4, 0}, d{0, 0, 4};
  const auto inner = closest_point_on_tetrahedron({1, 1, 1}, a, b, c, d);
  EXPECT_EQ(inner.vertex_mask, 15u);
  EXPECT_EQ(inner.barycentric, (std::array<double, 4>{0.25, 0.25, 0.25, 0.25}));
  const auto on_face = closest_point_on_tetrahedron({1, 1, 0}, a, b, c, d);
  EXPECT_EQ(on_face.vertex_mask, 7u);
  EXPECT_EQ(on_face.barycentric, (std::array<double, 4>{0.5, 0.25, 0.25, 0}));
  EXPECT_EQ(on_face.squared_distance, 0);
  // So thin that the weights come from exact volumes.
  const double height = 0x1p-60;
  const auto thin = closest_point_on_tetrahedron({1, 1, height / 4}, a, b, c, {1, 1, height});
  EXPECT_EQ(thin.vertex_mask, 15u);
  EXPECT_EQ(thin.barycentric, (std::array<double, 4>{0.375, 0.1875, 0.1875, 0.25}));
}

template <std::size_t N>
void expect_scale_does_not_matter(const Vec3& p, const std::array<Vec3, N>& simplex) {
  const auto unit = closest_point(p, simplex);
  for (int exponent : {-1000, -490, -300, -101, 101, 300, 490, 1000}) {
    const double scale = std::ldexp(1.0, exponent);
    std::array<Vec3, N> scaled_simplex;
    for (std::size_t i = 0; i < N; ++i) scaled_simplex[i] = scale * simplex[i];
    const auto found = closest_point(Vec3(scale * p), scaled_simplex);
    ASSERT_EQ(found.vertex_mask, unit.vertex_mask) << exponent;
    ASSERT_LE((found.point / scale - unit.point).cwiseAbs().maxCoeff(), 300 * kEpsilon) << exponent;
    for (std::size_t i = 0; i < N; ++i) ASSERT_NEAR(found.barycentric[i], unit.barycentric[i], 4 * kEpsilon);
    if (std::abs(exponent) < 500 && unit.squared_distance > 0) {
      ASSERT_NEAR(found.squared_distance / scale / scale / unit.squared_distance, 1, 4 * kEpsilon);
    }
  }
}

TEST(ClosestPoint, AnyMagnitude) {
  RandomSource random(9);
  for (std::int64_t n = 0; n < scaled(3'000) && !HasFatalFailure(); ++n) {
    const auto shape = static_cast<Shape>(random.integer(0, 1));
    const Vec3 p = test::to_point<3>(random.lattice_point<3>(120));
    expect_scale_does_not_matter<2>(p, lattice_simplex<3, 2>(random, 100, shape));
    expect_scale_does_not_matter<3>(p, lattice_simplex<3, 3>(random, 100, shape));
    expect_scale_does_not_matter<4>(p, lattice_simplex<3, 4>(random, 100, shape));
  }
}

}  // namespace
}  // namespace selvage
