#include "selvage/geometry/moving_distance.h"

#include "selvage/geometry/closest_point.h"
#include "selvage/geometry/distance.h"
#include "test_scale.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
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

}  // namespace
}  // namespace selvage
