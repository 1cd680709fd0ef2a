#include "selvage/contact/friction.h"

#include "solids.h"
#include "test_scale.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

const Vec3 kUp{0, 0, 1};

/// Of a contact that is projected once, of what slides too fast to be stopped if nothing else is said.
Vec3 friction_of(const Vec3& displacement, const Vec3& normal, double pressed, const Friction& friction,
                 const Vec3& drift = {1e3, 2e3, 3e3}) {
  Grip grip;
  return friction_correction(displacement, drift, normal, pressed, friction, grip);
}

TEST(Friction, SticksBelowTheStaticLimit) {
  EXPECT_EQ(friction_of({0.3, 0.4, -2}, kUp, 1, {0.5, 0.1}), Vec3(-0.3, -0.4, 0));
  EXPECT_EQ(friction_of({0.3, 0, -2}, kUp, 1, {0.31, 0}), Vec3(-0.3, 0, 0));
}

TEST(Friction, SlipsAboveItByTheDynamicLimit) {
  const Vec3 slip = friction_of({3, 4, 7}, kUp, 2, {0.5, 0.25});
  EXPECT_DOUBLE_EQ(slip[0], -0.3);
  EXPECT_DOUBLE_EQ(slip[1], -0.4);
  EXPECT_EQ(slip[2], 0);
}

TEST(Friction, NeverTurnsTheMotionRound) {
  for (const Vec3& drift : {Vec3(0, 0, 0), Vec3(8, 0, 0)})
    EXPECT_EQ(friction_of({0.3, 0.4, 0}, kUp, 1, {0.1, 5}, drift), Vec3(-0.3, -0.4, 0));
}

/// What lies still, or slides so slowly that dynamic friction stops it, is held by the static limit.
TEST(Friction, HoldsBackWhatItStopsWithinTheStepByTheStaticLimit) {
  const Friction friction{0.5, 0.25};
  for (const Vec3& drift : {Vec3(0, 0, 0), Vec3(0.49, 0, 0), Vec3(0, -0.49, 7)})
    EXPECT_EQ(friction_of({3, 0, -2}, kUp, 2, friction, drift), Vec3(-1, 0, 0)) << drift;
  for (const Vec3& drift : {Vec3(0.51, 0, 0), Vec3(0, -0.51, 7)})
    EXPECT_EQ(friction_of({3, 0, -2}, kUp, 2, friction, drift), Vec3(-0.5, 0, 0)) << drift;
}

TEST(Friction, IsNothingWithoutMotionNormalForceOrCoefficients) {
  EXPECT_EQ(friction_of({0, 0, 5}, kUp, 1, {0.5, 0.5}), Vec3(0, 0, 0));
  EXPECT_EQ(friction_of({1, 0, 5}, kUp, 0, {0.5, 0.5}), Vec3(0, 0, 0));
  EXPECT_EQ(friction_of({1, 0, 5}, kUp, 1, {0, 0}), Vec3(0, 0, 0));
}

TEST(Friction, IsAcrossTheNormalAgainstTheMotionAndWithinItsLimits) {
  test::Random random(test::seed(1));
  for (std::int64_t n = 0; n < test::scaled(10000); ++n) {
    const Vec3 normal = random.vector(1).normalized(), displacement = random.vector(2);
    const double correction = random.unit(), dynamic_friction = random.unit();
    const double static_friction = dynamic_friction + random.unit();
    const Vec3 change = friction_of(displacement, normal, correction, {static_friction, dynamic_friction});
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

/// A point that is pulled by 1 after each projection but pressed by the first alone.
TEST(Friction, HoldsByAllThatWasPressedInTheStep) {
  const Vec3 pull{1, 0, 0}, drift{20, 0, 0};
  for (const bool holds : {true, false}) {
    Grip grip;
    Vec3 displacement = pull;
    displacement += friction_correction(displacement, drift, kUp, 10, {holds ? 0.31 : 0.29, 0.2}, grip);
    EXPECT_EQ(displacement[0], 0);
    for (int i = 0; i < 2; ++i) {
      displacement += pull;
      displacement += friction_correction(displacement, drift, kUp, 0, {holds ? 0.31 : 0.29, 0.2}, grip);
    }
    // Pulled by 3 in all, and held by 0.2 * 10.
    EXPECT_DOUBLE_EQ(displacement[0], holds ? 0 : 1);
  }
}

/// However a step's pressing and sliding are divided among projections, the last leaves the same.
TEST(Friction, IsTheSameHoweverManyProjections) {
  test::Random random(test::seed(2));
  for (std::int64_t n = 0; n < test::scaled(1000); ++n) {
    const Vec3 normal = random.vector(1).normalized();
    const Friction friction{0.6, 0.6};
    std::array<Vec3, 4> slips;
    std::array<double, 4> pressed;
    for (Vec3& slip : slips) slip = random.vector(1);
    for (double& p : pressed) p = random.unit();
    Grip grip;
    Vec3 displacement = Vec3::Zero(), all = Vec3::Zero();
    for (int i = 0; i < 4; ++i) {
      all += slips[i];
      displacement += slips[i];
      displacement += friction_correction(displacement, Vec3::Zero(), normal, pressed[i], friction, grip);
    }
    const double sum = pressed[0] + pressed[1] + pressed[2] + pressed[3];
    EXPECT_NEAR((displacement - all - friction_of(all, normal, sum, friction)).norm(), 0, 1e-13);
    EXPECT_NEAR(grip.pressed, sum, 1e-14);
  }
}

}  // namespace
}  // namespace selvage
