#include "selvage/contact/friction.h"

#include "contact/solids.h"
#include "test_scale.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

const Vec3 kUp{0, 0, 1};

TEST(Friction, SticksBelowTheStaticLimit) {
  EXPECT_EQ(friction_correction({0.3, 0.4, -2}, kUp, 1, 0.5, 0.1), Vec3(-0.3, -0.4, 0));
  EXPECT_EQ(friction_correction({0.3, 0, -2}, kUp, 1, 0.31, 0), Vec3(-0.3, 0, 0));
}

TEST(Friction, SlipsAboveItByTheDynamicLimit) {
  const Vec3 slip = friction_correction({3, 4, 7}, kUp, 2, 0.5, 0.25);
  EXPECT_DOUBLE_EQ(slip[0], -0.3);
  EXPECT_DOUBLE_EQ(slip[1], -0.4);
  EXPECT_EQ(slip[2], 0);
}

TEST(Friction, NeverTurnsTheMotionRound) {
  EXPECT_EQ(friction_correction({0.3, 0.4, 0}, kUp, 1, 0.1, 5), Vec3(-0.3, -0.4, 0));
}

TEST(Friction, IsNothingWithoutMotionNormalForceOrCoefficients) {
  EXPECT_EQ(friction_correction({0, 0, 5}, kUp, 1, 0.5, 0.5), Vec3(0, 0, 0));
  EXPECT_EQ(friction_correction({1, 0, 5}, kUp, 0, 0.5, 0.5), Vec3(0, 0, 0));
  EXPECT_EQ(friction_correction({1, 0, 5}, kUp, 1, 0, 0), Vec3(0, 0, 0));
}

TEST(Friction, IsAcrossTheNormalAgainstTheMotionAndWithinItsLimits) {
  solids::Random random(test::seed(1));
  for (std::int64_t n = 0; n < test::scaled(10000); ++n) {
    const Vec3 normal = random.vector(1).normalized(), displacement = random.vector(2);
    const double correction = random.unit(), dynamic_friction = random.unit();
    const double static_friction = dynamic_friction + random.unit();
    const Vec3 change = friction_correction(displacement, normal, correction, static_friction, dynamic_friction);
    const Vec3 tangential = displacement - normal.dot(displacement) * normal;
    EXPECT_NEAR(change.dot(normal), 0, 1e-14);
    EXPECT_NEAR(change.cross(tangential).norm(), 0, 1e-14);
    EXPECT_LE(change.dot(tangential), 0);
    EXPECT_LE(change.norm(), tangential.norm() * (1 + 1e-15));
    EXPECT_LE(change.norm(), static_friction * correction * (1 + 1e-14));
    if (tangential.norm() > static_friction * correction) {
      EXPECT_LE(change.norm(), dynamic_friction * correction * (1 + 1e-14));
    }
  }
}

}  // namespace
}  // namespace selvage
