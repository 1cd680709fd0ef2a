#include "selvage/contact/friction.h"
#include "simulation/bodies.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

using namespace bodies;

/// A slab that starts on a slope of that angle, touching it.
struct Slope {
  Model model;
  State state;
  Vec3 down, normal;

  explicit Slope(double degrees, double youngs_modulus = 1e5)
      : model(make(make_box({0.2, 0.2, 0.1}, 0.05), neo_hookean(youngs_modulus, 0.3))) {
    const double angle = degrees * M_PI / 180;
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, Vec3::UnitY()).toRotationMatrix();
    down = turn * Vec3::UnitX();
    normal = turn * Vec3::UnitZ();
    std::vector<Vec3> positions = model.rest_positions;
    for (Vec3& p : positions) p = turn * p;
    state = make_state(model, positions);
  }

  /// How fast its middle slides after that many steps [m/s].
  double run(double at_rest, double sliding, int steps, double velocity_damping = 0) {
    XpbdOptions options = without_contact();
    options.iterations = 10;
    options.velocity_damping = velocity_damping;
    XpbdSolver solver(model, state, {}, {{PlaneShape{Vec3::Zero(), normal}, {}, {at_rest, sliding}}}, options);
    for (int i = 0; i < steps; ++i) solver.step(state);
    return momentum(model, state).dot(down) / (1000 * 0.2 * 0.2 * 0.1);
  }
};

TEST(Slope, HoldsABlockUpToTheAngleOfFriction) {
  // tan 20 degrees is 0.364, tan 30 degrees 0.577.
  EXPECT_LT(std::abs(Slope(20).run(0.45, 0.45, 300)), 0.01);
  EXPECT_LT(std::abs(Slope(30).run(0.65, 0.65, 300)), 0.01);
  EXPECT_GT(Slope(20).run(0.30, 0.30, 300), 0.3);
  EXPECT_GT(Slope(30).run(0.50, 0.50, 300), 0.3);
}

TEST(Slope, LetsABlockSlideAsCoulombSays) {
  for (const double degrees : {20.0, 30.0, 40.0})
    for (const double sliding : {0.0, 0.1, 0.3}) {
      const double angle = degrees * M_PI / 180;
      const double expected = 9.81 * (std::sin(angle) - sliding * std::cos(angle));
      EXPECT_NEAR(Slope(degrees).run(sliding, sliding, 300), expected, 0.05 * expected + 0.02) << degrees << sliding;
    }
}

TEST(Slope, StartsToSlideOnlyAboveStaticFriction) {
  // The tangent of 25 degrees is 0.466.
  for (const bool holds : {true, false}) {
    Slope slope(25);
    slope.run(5, 5, 200, 30);  // shaking and uneven pressure fade
    const double speed = slope.run(holds ? 0.7 : 0.42, 0.4, 300);
    EXPECT_EQ(std::abs(speed) < 0.01, holds) << speed;
    EXPECT_EQ(speed > 0.3, !holds) << speed;
  }
}

/// The tangent of 16.7 degrees is 0.3; dynamic friction alone would hold up to 11.3. A softer block than this would be
/// thrown off by its own trembling when gravity sets in.
TEST(Slope, HoldsABlockThatIsLaidDownByStaticFriction) {
  for (const double degrees : {12.0, 14.0, 16.0})
    EXPECT_LT(std::abs(Slope(degrees, 1e6).run(0.3, 0.2, 300)), 1e-3) << degrees;
  const double angle = 17.5 * M_PI / 180;
  const double expected = 9.81 * (std::sin(angle) - 0.2 * std::cos(angle));
  EXPECT_NEAR(Slope(17.5, 1e6).run(0.3, 0.2, 300), expected, 0.2 * expected);
}

/// How fast a block slides on a slope that is another body, whose vertices are held [m/s].
double slide_on_body(double degrees, const Friction& friction, const XpbdOptions& chosen, int steps) {
  const std::array meshes{moved(make_box({0.4, 0.4, 0.1}, 0.05), {0, 0.3, 1e-4}),
                          moved(make_box({3, 1, 0.1}, 0.1), {-0.5, 0, -0.1})};
  const Model model = make(meshes, neo_hookean(1e6, 0.3));
  State state = make_state(model, model.rest_positions);
  Handle ground;
  for (Index v = model.bodies[1].first_vertex; v < model.mesh.vertex_count(); ++v) ground.vertices.push_back(v);
  XpbdOptions options = chosen;
  options.friction = friction;
  const double angle = degrees * M_PI / 180;
  options.gravity = 9.81 * Vec3(std::sin(angle), 0, -std::cos(angle));
  XpbdSolver solver(model, state, {ground}, {}, options);
  for (int i = 0; i < steps; ++i) solver.step(state);
  return momentum(model, state)[0] / (1000 * 0.4 * 0.4 * 0.1);
}

TEST(Slope, OfABodyLetsABlockSlideAsCoulombSays) {
  XpbdOptions options;
  options.time_step = 1.0 / 600;
  options.iterations = 10;
  constexpr int kSteps = 240;
  for (const DetectionMode mode : {DetectionMode::kHybrid, DetectionMode::kCcd}) {
    options.contact.mode = mode;
    EXPECT_LT(std::abs(slide_on_body(15, {0.3, 0.3}, options, kSteps)), 0.01);
    EXPECT_LT(std::abs(slide_on_body(15.5, {0.3, 0.2}, options, kSteps)), 1e-3);
    for (const double friction : {0.0, 0.3}) {
      const double angle = 20 * M_PI / 180;
      const double expected = kSteps * options.time_step * 9.81 * (std::sin(angle) - friction * std::cos(angle));
      EXPECT_NEAR(slide_on_body(20, {friction, friction}, options, kSteps), expected, 0.03 * expected + 0.01)
          << friction;
    }
  }
}

}  // namespace
}  // namespace selvage
