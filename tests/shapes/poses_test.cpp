#include "selvage/shapes/poses.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <numbers>
#include <random>

#include "mesh/mesh_checks.h"
#include "selvage/core/error.h"
#include "selvage/shapes/shapes.h"

namespace selvage {
namespace {

using std::numbers::pi;

/// Bar 6 long in x, 0.5 wide in y, 0.4 in z, as random points with the corners among them.
std::vector<Vec3> bar_points(int count) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Vec3> points = {{0, 0, 0}, {6, 0.5, 0.4}};
  for (int i = 0; i < count; ++i) points.emplace_back(6 * unit(random), 0.5 * unit(random), 0.4 * unit(random));
  return points;
}

/// Determinant of a pose at points of the bar, by central differences: the moved copies are posed along with the bar.
std::vector<double> determinants(const std::function<void(std::span<Vec3>)>& pose) {
  const double step = 1e-5;
  std::vector<Vec3> points = bar_points(200);
  const std::size_t first = points.size();
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> inner(0.01, 0.99);
  for (int i = 0; i < 300; ++i) {
    const Vec3 p(6 * inner(random), 0.5 * inner(random), 0.4 * inner(random));
    for (int axis = 0; axis < 3; ++axis) {
      points.push_back(p + step * Vec3::Unit(axis));
      points.push_back(p - step * Vec3::Unit(axis));
    }
  }
  pose(points);
  std::vector<double> result;
  for (std::size_t i = first; i < points.size(); i += 6) {
    const auto column = [&](int axis) { return Vec3((points[i + 2 * axis] - points[i + 2 * axis + 1]) / (2 * step)); };
    result.push_back(column(0).cross(column(1)).dot(column(2)));
  }
  return result;
}

TEST(Poses, DeterminantsStayPositive) {
  for (const double det : determinants([](auto p) { pose_twist(p, 0, 1.7); })) EXPECT_NEAR(det, 1, 1e-6);
  const auto expect_positive = [](const std::vector<double>& values, double smallest, double largest) {
    for (const double det : values) {
      EXPECT_GT(det, smallest - 1e-6);
      EXPECT_LT(det, largest + 1e-6);
    }
  };
  // 1 - k u with u up to half of the thinner width, 0.2.
  const double bend = 2 * pi * 1.3 / 6 * 0.2;
  expect_positive(determinants([](auto p) { pose_bend(p, 0, 1.3); }), 1 - bend, 1 + bend);
  expect_positive(determinants([](auto p) { pose_bend(p, 0, -1.3); }), 1 - bend, 1 + bend);
  expect_positive(determinants([](auto p) { pose_fold(p, 0, 4.2); }), 0.3, 1.7);
  const double loops = 2 * pi * 2 * 1.8 / 6 * 0.2;
  expect_positive(determinants([](auto p) { pose_self_crossing(p, 0, 2); }), 1 - loops, 1 + loops);
}

TEST(Poses, BendTowardsTheThinnerAxisKeepsTheOther) {
  std::vector<Vec3> rest = bar_points(50), posed = rest;
  pose_bend(posed, 0, 1.2);
  const double radius = 6 / (2 * pi * 1.2);
  for (std::size_t i = 0; i < rest.size(); ++i) {
    EXPECT_EQ(posed[i][1], rest[i][1]);
    // The arc's centre stands one radius above the middle.
    const double to_centre = std::hypot(posed[i][0] - 3, posed[i][2] - 0.2 - radius);
    EXPECT_NEAR(to_centre, radius - (rest[i][2] - 0.2), 1e-12);
  }
}

TEST(Poses, FoldTurnsOneEndByItsAngle) {
  std::vector<Vec3> points = {{0, 0, 0}, {0.1, 0, 0}, {5.9, 0, 0}, {6, 0, 0}, {0, 0.5, 0.4}};
  pose_fold(points, 0, 2.5);
  const Vec3 begin = (points[1] - points[0]).normalized(), end = (points[3] - points[2]).normalized();
  EXPECT_NEAR(std::atan2(begin[0] * end[2] - begin[2] * end[0], begin.dot(end)), 2.5, 1e-9);
}

/// Proper crossings of a polyline with itself, in the plane of two axes.
int count_crossings(const std::vector<Vec3>& line, int u, int v) {
  const auto side = [&](std::size_t a, std::size_t b, std::size_t c) {
    return (line[b][u] - line[a][u]) * (line[c][v] - line[a][v]) -
           (line[b][v] - line[a][v]) * (line[c][u] - line[a][u]);
  };
  int count = 0;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    for (std::size_t j = i + 2; j + 1 < line.size(); ++j) {
      count += side(i, i + 1, j) * side(i, i + 1, j + 1) < 0 && side(j, j + 1, i) * side(j, j + 1, i + 1) < 0;
    }
  }
  return count;
}

TEST(Poses, SelfCrossingCrossesAsOftenAsAskedAndKeepsLength) {
  for (const int crossings : {1, 2, 5}) {
    std::vector<Vec3> line;
    for (int i = 0; i <= 700; ++i) line.emplace_back(0, 10.0 * i / 700, 0);
    pose_self_crossing(line, 1, crossings);
    EXPECT_EQ(count_crossings(line, 1, 2), crossings);
    double length = 0;
    for (std::size_t i = 1; i < line.size(); ++i) length += (line[i] - line[i - 1]).norm();
    EXPECT_NEAR(length, 10, 0.01);
  }
}

TEST(Poses, OverlapMovesTheSecondObjectOnly) {
  std::vector<Vec3> points(6, Vec3(1, 2, 3));
  pose_overlap(points, 4, {1, 0, -1});
  EXPECT_EQ(points[3], Vec3(1, 2, 3));
  EXPECT_EQ(points[4], Vec3(2, 2, 2));
}

TEST(Poses, SwirlTurnsNeighbouringArmsAgainstEachOther) {
  // A cross of four bars that share the middle cube: arms along +x, +y, -x, -y.
  IndexedMesh cross = make_box({8.4, 8.4, 0.4}, 0.4);
  std::erase_if(cross.tetrahedra, [&](const VertexTuple<4>& t) {
    const Vec3 middle =
        (cross.positions[t[0]] + cross.positions[t[1]] + cross.positions[t[2]] + cross.positions[t[3]]) / 4;
    return std::abs(middle[0] - 4.2) > 0.2 && std::abs(middle[1] - 4.2) > 0.2;
  });
  IndexedMesh posed = cross;
  pose_swirl(posed, 0.2, 0.1);
  const Vec3 centre(4.2, 4.2, 0.2);
  double turn[4] = {};
  std::vector<char> used(cross.positions.size(), 0);
  for (const auto& t : cross.tetrahedra) {
    for (Index v : t) used[v] = 1;
  }
  for (std::size_t v = 0; v < used.size(); ++v) {
    const Vec3 p = cross.positions[v] - centre, q = posed.positions[v] - centre;
    if (!used[v] || std::max(std::abs(p[0]), std::abs(p[1])) < 4.19) continue;
    EXPECT_NEAR(p.norm(), q.norm(), 1e-12);
    const int arm = std::abs(p[0]) > std::abs(p[1]) ? (p[0] > 0 ? 0 : 2) : (p[1] > 0 ? 1 : 3);
    turn[arm] = std::atan2(p[0] * q[1] - p[1] * q[0], p[0] * q[0] + p[1] * q[1]);
  }
  EXPECT_LT(turn[0] * turn[1], 0);
  EXPECT_LT(turn[1] * turn[2], 0);
  EXPECT_LT(turn[2] * turn[3], 0);
  EXPECT_EQ(test::count_not_positive(posed), 0);
}

TEST(Poses, RefuseWhatWouldTurnElementsInsideOut) {
  std::vector<Vec3> cube = make_box({1, 1, 1}, 0.5).positions;
  EXPECT_THROW(pose_bend(cube, 0, 1.2), Error);
  EXPECT_THROW(pose_fold(cube, 0, 4), Error);
  EXPECT_THROW(pose_self_crossing(cube, 0, 1), Error);
  EXPECT_EQ(cube, make_box({1, 1, 1}, 0.5).positions) << "a refused pose moves nothing";
}

TEST(Poses, RefuseBadArguments) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<Vec3> bar = bar_points(5), none, flat = {{0, 0, 0}, {0, 1, 1}};
  EXPECT_THROW(pose_twist(bar, 3, 1), Error);
  EXPECT_THROW(pose_twist(bar, -1, 1), Error);
  EXPECT_THROW(pose_twist(bar, 0, nan), Error);
  EXPECT_THROW(pose_bend(bar, 0, nan), Error);
  EXPECT_THROW(pose_bend(none, 0, 1), Error);
  EXPECT_THROW(pose_bend(flat, 0, 1), Error);
  EXPECT_THROW(pose_fold(bar, 0, nan), Error);
  EXPECT_THROW(pose_self_crossing(bar, 0, 0), Error);
  EXPECT_THROW(pose_overlap(bar, 100, {0, 0, 0}), Error);
  EXPECT_THROW(pose_overlap(bar, 0, {0, nan, 0}), Error);
  IndexedMesh mesh = make_box({1, 1, 1}, 1);
  EXPECT_THROW(pose_swirl(mesh, 1.5, 1), Error);
  EXPECT_THROW(pose_swirl(mesh, 0.5, nan), Error);
}

}  // namespace
}  // namespace selvage
