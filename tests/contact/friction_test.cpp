#include "selvage/contact/friction.h"

#include "solids.h"
#include "test_scale.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

const Vec3 kUp{0, 0, 1};

/// Correction of a contact that is projected once. The default drift is too fast for friction to stop.
Vec3 friction_of(const Vec3& displacement, const Vec3& normal, double normal_correction, const Friction& friction,
                 const Vec3& drift = {1e3, 2e3, 3e3}) {
  FrictionState state;
  return friction_correction(displacement, drift, normal, normal_correction, friction, state);
}

TEST(Friction, SticksBelowTheStaticLimit) {
  EXPECT_EQ(friction_of({0.3, 0.4, -2}, kUp, 1, {0.5, 0.1}), Vec3(-0.3, -0.4, 0));
  EXPECT_EQ(friction_of({0.3, 0, -2}, kUp, 1, {0.31, 0}), Vec3(-0.3, 0, 0));
}

TEST(Friction, SlipsByTheDynamicLimitAboveTheStaticLimit) {
  const Vec3 slip = friction_of({3, 4, 7}, kUp, 2, {0.5, 0.25});
  EXPECT_DOUBLE_EQ(slip[0], -0.3);
  EXPECT_DOUBLE_EQ(slip[1], -0.4);
  EXPECT_EQ(slip[2], 0);
}

TEST(Friction, NeverReversesTheMotion) {
  for (const Vec3& drift : {Vec3(0, 0, 0), Vec3(8, 0, 0)})
    EXPECT_EQ(friction_of({0.3, 0.4, 0}, kUp, 1, {0.1, 5}, drift), Vec3(-0.3, -0.4, 0));
}

/// A point that rests, or drifts so slowly that dynamic friction stops it, is held up to the static limit.
TEST(Friction, AppliesTheStaticLimitToPointsThatStopWithinTheStep) {
  const Friction friction{0.5, 0.25};
  for (const Vec3& drift : {Vec3(0, 0, 0), Vec3(0.49, 0, 0), Vec3(0, -0.49, 7)})
    EXPECT_EQ(friction_of({3, 0, -2}, kUp, 2, friction, drift), Vec3(-1, 0, 0)) << drift;
  for (const Vec3& drift : {Vec3(0.51, 0, 0), Vec3(0, -0.51, 7)})
    EXPECT_EQ(friction_of({3, 0, -2}, kUp, 2, friction, drift), Vec3(-0.5, 0, 0)) << drift;
}

TEST(Friction, IsZeroWithoutMotionNormalCorrectionOrCoefficients) {
  EXPECT_EQ(friction_of({0, 0, 5}, kUp, 1, {0.5, 0.5}), Vec3(0, 0, 0));
  EXPECT_EQ(friction_of({1, 0, 5}, kUp, 0, {0.5, 0.5}), Vec3(0, 0, 0));
  EXPECT_EQ(friction_of({1, 0, 5}, kUp, 1, {0, 0}), Vec3(0, 0, 0));
}

TEST(Friction, IsTangentialAgainstTheMotionAndWithinItsLimits) {
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

/// A point is pulled by 1 before each projection. Only the first projection corrects along the normal.
TEST(Friction, LimitsUseTheSumOfNormalCorrectionsOfTheStep) {
  const Vec3 pull{1, 0, 0}, drift{20, 0, 0};
  for (const bool holds : {true, false}) {
    FrictionState state;
    Vec3 displacement = pull;
    displacement += friction_correction(displacement, drift, kUp, 10, {holds ? 0.31 : 0.29, 0.2}, state);
    EXPECT_EQ(displacement[0], 0);
    for (int i = 0; i < 2; ++i) {
      displacement += pull;
      displacement += friction_correction(displacement, drift, kUp, 0, {holds ? 0.31 : 0.29, 0.2}, state);
    }
    // Pulled by 3 in all, and held by 0.2 * 10.
    EXPECT_DOUBLE_EQ(displacement[0], holds ? 0 : 1);
  }
}

/// The result after the last projection depends on the sums alone, not on how the projections divide them.
TEST(Friction, IsTheSameForAnyNumberOfProjections) {
  test::Random random(test::seed(2));
  for (std::int64_t n = 0; n < test::scaled(1000); ++n) {
    const Vec3 normal = random.vector(1).normalized();
    const Friction friction{0.6, 0.6};
    std::array<Vec3, 4> slips;
    std::array<double, 4> normal_corrections;
    for (Vec3& slip : slips) slip = random.vector(1);
    for (double& c : normal_corrections) c = random.unit();
    FrictionState state;
    Vec3 displacement = Vec3::Zero(), all = Vec3::Zero();
    for (int i = 0; i < 4; ++i) {
      all += slips[i];
      displacement += slips[i];
      displacement += friction_correction(displacement, Vec3::Zero(), normal, normal_corrections[i], friction, state);
    }
    const double sum = normal_corrections[0] + normal_corrections[1] + normal_corrections[2] + normal_corrections[3];
    EXPECT_NEAR((displacement - all - friction_of(all, normal, sum, friction)).norm(), 0, 1e-13);
    EXPECT_NEAR(state.normal_sum, sum, 1e-14);
  }
}

}  // namespace
}  // namespace selvage
