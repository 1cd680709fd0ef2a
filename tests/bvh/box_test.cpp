#include "bvh/box.h"

#include "bvh/test_boxes.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

constexpr float kFloatInfinity = std::numeric_limits<float>::infinity();
constexpr float kLargest = std::numeric_limits<float>::max();
constexpr float kSmallest = std::numeric_limits<float>::denorm_min();

TEST(Rounding, FloatsStayWhatTheyAre) {
  for (const float x : {0.0f, -0.0f, 1.0f, -1.0f, kSmallest, -kSmallest, kLargest, -kLargest, 0.1f}) {
    EXPECT_EQ(round_down(x), x);
    EXPECT_EQ(round_up(x), x);
  }
}

TEST(Rounding, BeyondTheFloatsIsInfinite) {
  EXPECT_EQ(round_down(1e300), kLargest);
  EXPECT_EQ(round_up(1e300), kFloatInfinity);
  EXPECT_EQ(round_down(-1e300), -kFloatInfinity);
  EXPECT_EQ(round_up(-1e300), -kLargest);
  const double just_above = std::nextafter(double{kLargest}, 1e300);
  EXPECT_EQ(round_down(just_above), kLargest);
  EXPECT_EQ(round_up(just_above), kFloatInfinity);
}

TEST(Rounding, NextToZero) {
  EXPECT_EQ(round_down(1e-300), 0.0f);
  EXPECT_EQ(round_up(1e-300), kSmallest);
  EXPECT_EQ(round_down(-1e-300), -kSmallest);
  EXPECT_EQ(round_up(-1e-300), 0.0f);
}

TEST(Rounding, IsOutwardAndTightAtAllMagnitudes) {
  test::Random random(1);
  for (int i = 0; i < 200000; ++i) {
    const double x = random.within(-1, 1) * std::pow(10.0, random.within(-50, 37));
    const float below = round_down(x), above = round_up(x);
    ASSERT_LE(below, x);
    ASSERT_GE(above, x);
    ASSERT_TRUE(below == above || std::nextafterf(below, kFloatInfinity) == above) << x;
  }
}

TEST(BoundingBox, HoldsItsPointsInSpaceAndPlane) {
  const std::vector<Vec3> space = {{0.1, 2, -3}, {0.2, -1, 1e300}, {0.15, 0, 0}};
  const Box box = bounding_box<3>(std::span<const Vec3>(space));
  for (int axis = 0; axis < 3; ++axis)
    for (const Vec3& point : space) {
      EXPECT_LE(box.lower[axis], point[axis]);
      EXPECT_GE(box.upper[axis], point[axis]);
    }
  EXPECT_EQ(box.upper[2], kFloatInfinity);
  const std::vector<Vec2> plane = {{1, 2}, {3, -4}};
  EXPECT_EQ(bounding_box<2>(std::span<const Vec2>(plane)), (Box{{1, -4, 0}, {3, 2, 0}}));
  EXPECT_EQ(bounding_box<3>({}), Box::empty());
}

TEST(Box, MergesAndMeasures) {
  Box box = Box::empty();
  box.merge({{0, 0, 0}, {1, 1, 1}});
  box.merge({{-1, 0, 0}, {0, 2, 3}});
  EXPECT_EQ(box, (Box{{-1, 0, 0}, {1, 2, 3}}));
  EXPECT_EQ(box.half_area(), 2 * 2 + 2 * 3 + 3 * 2);
  box.merge(Box::empty());
  EXPECT_EQ(box, (Box{{-1, 0, 0}, {1, 2, 3}}));
}

}  // namespace
}  // namespace selvage
