#include "selvage/geometry/moving_distance.h"

#include "selvage/geometry/closest_point.h"
#include "selvage/geometry/distance.h"
#include "test_scale.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

namespace selvage {
namespace {

using test::scaled;

struct Random {
  std::mt19937_64 engine{7};
  double within(double low, double high) { return low + (high - low) * static_cast<double>(engine() >> 11) * 0x1p-53; }
  Vec3 point(double size) { return {within(-size, size), within(-size, size), within(-size, size)}; }
};

double distance_at(const MovingPoints& points, bool edges, double t) {
  std::array<Vec3, 4> x;
  for (int i = 0; i < 4; ++i) x[i] = (1 - t) * points.t0[i] + t * points.t1[i];
  return std::sqrt(edges ? squared_distance(std::array{x[0], x[1]}, std::array{x[2], x[3]})
                         : closest_point_on_triangle(x[0], x[1], x[2], x[3]).squared_distance);
}

/// The smallest distance, by many samples and a search around the best of them: not below the true one, and hardly
/// above.
double smallest_distance(const MovingPoints& points, bool edges) {
  constexpr int kSamples = 500;
  double best = 0;
  for (int k = 0; k <= kSamples; ++k)
    if (distance_at(points, edges, k / double(kSamples)) < distance_at(points, edges, best))
      best = k / double(kSamples);
  double low = std::max(0.0, best - 1.0 / kSamples), high = std::min(1.0, best + 1.0 / kSamples);
  for (int k = 0; k < 100; ++k) {
    const double a = low + (high - low) / 3, b = high - (high - low) / 3;
    (distance_at(points, edges, a) < distance_at(points, edges, b) ? high : low) =
        distance_at(points, edges, a) < distance_at(points, edges, b) ? b : a;
  }
  return std::min(distance_at(points, edges, low), distance_at(points, edges, best));
}

bool comes_near(const MovingPoints& points, bool edges, double distance) {
  return edges ? edge_comes_near_edge(points, distance) : vertex_comes_near_face(points, distance);
}

MovingPoints random_motion(Random& random, std::int64_t kind) {
  MovingPoints points;
  const Vec3 apart = random.point(2), together = kind % 3 == 0 ? random.point(50) : Vec3::Zero();
  for (int i = 0; i < 4; ++i) {
    points.t0[i] = random.point(1) + (i > 0 ? apart : Vec3(Vec3::Zero()));
    points.t1[i] = points.t0[i] + random.point(kind % 2 == 0 ? 0.1 : 3) + together;
  }
  if (kind % 7 == 0) points.t1 = points.t0;
  if (kind % 5 == 0) points.t0[3] = points.t0[2];
  return points;
}

TEST(MovingDistance, TellsWhatSamplesTell) {
  Random random;
  std::int64_t near = 0, far = 0;
  for (std::int64_t n = 0; n < scaled(3000); ++n) {
    const MovingPoints points = random_motion(random, n);
    for (const bool edges : {false, true}) {
      const double smallest = smallest_distance(points, edges);
      for (const double factor : {0.3, 0.9, 0.999, 0.99999, 1.00001, 1.001, 1.1, 4.0}) {
        if (!(smallest > 1e-3)) continue;
        // Samples may have missed another, nearer moment: then near is right though they say far.
        const bool told = comes_near(points, edges, smallest * factor);
        if (factor > 1) {
          ASSERT_TRUE(told) << n << " " << factor;
          ++near;
        } else if (told) {
          double nearest = smallest;
          for (int k = 0; k <= 20000; ++k) nearest = std::min(nearest, distance_at(points, edges, k / 20000.0));
          ASSERT_LT(nearest, smallest * factor * (1 + 1e-5)) << n << " " << factor;
        } else {
          ++far;
        }
      }
      ASSERT_FALSE(comes_near(points, edges, 0));
    }
  }
  EXPECT_GT(near, scaled(1000));
  EXPECT_GT(far, scaled(1000));
}

TEST(MovingDistance, OfAVertexThatSlidesAlongAFace) {
  MovingPoints points{{Vec3(-1e4, 0, 1), Vec3(-1e5, -1e5, 0), Vec3(1e5, -1e5, 0), Vec3(0, 1e5, 0)}, {}};
  points.t1 = points.t0;
  points.t1[0][0] = 1e4;
  EXPECT_TRUE(vertex_comes_near_face(points, 1 + 1e-12));
  EXPECT_FALSE(vertex_comes_near_face(points, 1 - 1e-5));
  points.t1[0][2] = 0.5;  // nearest at the end of the step only
  EXPECT_TRUE(vertex_comes_near_face(points, 0.5 + 1e-9));
  EXPECT_FALSE(vertex_comes_near_face(points, 0.5 - 1e-5));
  // Thrown across the edge of the face, near for an instant.
  MovingPoints edges{{Vec3(-100, -5, 0), Vec3(-100, 5, 0), Vec3(0, 0, 3), Vec3(0, 0, 9)}, {}};
  edges.t1 = edges.t0;
  edges.t1[0][0] = edges.t1[1][0] = 300;
  EXPECT_TRUE(edge_comes_near_edge(edges, 3 + 1e-9));
  EXPECT_FALSE(edge_comes_near_edge(edges, 3 - 1e-5));
}

TEST(MovingDistance, DoesNotDependOnScaleOrOrder) {
  Random random;
  for (std::int64_t n = 0; n < scaled(300); ++n) {
    const MovingPoints points = random_motion(random, n);
    for (const bool edges : {false, true}) {
      const double distance = random.within(0, 2);
      const bool expected = comes_near(points, edges, distance);
      for (const int exponent : {-1000, -300, 40, 900}) {
        MovingPoints other = points;
        for (auto* positions : {&other.t0, &other.t1})
          for (Vec3& x : *positions) x *= std::ldexp(1.0, exponent);
        ASSERT_EQ(comes_near(other, edges, std::ldexp(distance, exponent)), expected) << n << " " << exponent;
      }
      ASSERT_EQ(comes_near({points.t1, points.t0}, edges, distance), expected) << n;
    }
  }
}

std::optional<double> nearness(const MovingPoints& points, bool edges, double distance, double before = 1) {
  return edges ? edge_edge_nearness(points, distance, before) : vertex_face_nearness(points, distance, before);
}

/// How fast a point of one set moves relative to one of the other, at most.
double relative_speed(const MovingPoints& points, bool edges) {
  double fastest = 0;
  const int first = edges ? 2 : 1;
  for (int i = 0; i < first; ++i)
    for (int k = first; k < 4; ++k)
      fastest = std::max(fastest, (points.t1[k] - points.t0[k] - points.t1[i] + points.t0[i]).norm());
  return fastest;
}

TEST(Nearness, IsNoLaterThanSamplesAndHardlyEarlier) {
  Random random;
  std::int64_t never = 0, at_start = 0, later = 0;
  for (std::int64_t n = 0; n < scaled(2000); ++n) {
    const MovingPoints points = random_motion(random, n);
    const bool edges = n % 2 == 0;
    const double distance = n % 9 == 0 ? smallest_distance(points, edges) * (1 + 1e-7) : random.within(0.01, 1.5);
    if (!(distance > 0)) continue;
    const auto time = nearness(points, edges, distance);
    for (int k = 0; k <= 400; ++k) {
      const double t = time.value_or(1) * k / 400;
      if (time && t >= *time) continue;
      ASSERT_GE(distance_at(points, edges, t), distance * (1 - 1e-12) - 1e-13) << n << " " << t;
    }
    if (!time) {
      ++never;
      continue;
    }
    ++(*time == 0 ? at_start : later);
    ASSERT_LE(distance_at(points, edges, *time),
              distance * (1 + 0x1p-20) + relative_speed(points, edges) * 0x1p-20 + 1e-12)
        << n;
    ASSERT_EQ(nearness(points, edges, distance, *time), std::nullopt);
    ASSERT_EQ(nearness(points, edges, distance, *time + 0x1p-20), time);
    ASSERT_EQ(std::ldexp(*time, 20), std::floor(std::ldexp(*time, 20)));
  }
  EXPECT_GT(never, scaled(100));
  EXPECT_GT(at_start, scaled(100));
  EXPECT_GT(later, scaled(100));
}

TEST(Nearness, OfAVertexThatFallsOnAFace) {
  MovingPoints points{{Vec3(0, 0, 1), Vec3(-9, -9, 0), Vec3(9, -9, 0), Vec3(0, 9, 0)}, {}};
  points.t1 = points.t0;
  points.t1[0][2] = -1;
  EXPECT_EQ(vertex_face_nearness(points, 1.5), 0);
  EXPECT_NEAR(vertex_face_nearness(points, 0.5).value(), 0.25, 0x1p-19);
  EXPECT_LE(vertex_face_nearness(points, 0.5).value(), 0.25);
  EXPECT_EQ(vertex_face_nearness(points, 0.5, 0.26), vertex_face_nearness(points, 0.5));
  EXPECT_EQ(vertex_face_nearness(points, 0.5, 0.24), std::nullopt);
  points.t1[0][2] = 0.5;
  EXPECT_EQ(vertex_face_nearness(points, 0.5), std::nullopt);
}

TEST(ClosestPoints, OfSegmentsLieWhereTheirDifferenceSays) {
  Random random;
  for (std::int64_t n = 0; n < scaled(3000); ++n) {
    std::array<Vec3, 2> a{random.point(1), random.point(1)}, b{random.point(1), random.point(1)};
    if (n % 5 == 0) b[1] = b[0] + random.within(-2, 2) * (a[1] - a[0]);
    if (n % 7 == 0) a[1] = a[0];
    if (n % 11 == 0) b[1] = b[0];
    const ClosestSegmentPoints closest = closest_points(a, b);
    ASSERT_EQ(closest.difference.squaredNorm(), squared_distance(a, b));
    ASSERT_EQ(closest.difference, closest_difference(a, b));
    const auto at = [](const std::array<Vec3, 2>& s, double t) { return Vec3((1 - t) * s[0] + t * s[1]); };
    for (const double place : closest.place) {
      ASSERT_GE(place, 0);
      ASSERT_LE(place, 1);
    }
    ASSERT_LT((at(b, closest.place[1]) - at(a, closest.place[0]) - closest.difference).norm(), 1e-12) << n;
    for (int i = 0; i <= 10; ++i)
      for (int k = 0; k <= 10; ++k)
        ASSERT_GE((at(b, k / 10.0) - at(a, i / 10.0)).norm(), closest.difference.norm() - 1e-12) << n;
  }
}

}  // namespace
}  // namespace selvage
