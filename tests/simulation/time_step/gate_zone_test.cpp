// Where a zone that is held back goes with what carries it.
#include "simulation/time_step/gate_zone.h"

#include "simulation/bodies.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace selvage {
namespace {

using namespace bodies;

/// A box of 0.4 m from z = -0.1 on, and a floor at 0 that moves up by 0.01 m in the step.
struct OnAFloor {
  static constexpr double kUp = 0.01;
  Model model = make(moved(make_box({0.4, 0.4, 0.4}, 0.1), {0, 0, -0.1}), neo_hookean(1e5));
  std::vector<PreparedCollider> colliders =
      prepare_colliders(std::array{Collider{.shape = PlaneShape{Vec3::Zero(), Vec3::UnitZ()}}});
  std::vector<Vec3> still{model.rest_positions.size(), Vec3::Zero()};
  Step step{1, 0, 1.0 / 300, model.rest_positions, still};
  std::vector<double> corrections = max_corrections_of(model);
  std::vector<ColliderContactState> states{model.rest_positions.size()};
  Carriers carriers;
  GateZone zone;

  OnAFloor() {
    carriers.motions = {RigidTransform(), {Eigen::Matrix3d::Identity(), Vec3(0, 0, kUp)}};
    carriers.of_vertex.assign(states.size(), kNone);
    carriers.colliders = colliders;
    carriers.max_corrections = corrections;
    carriers.states = states;
    for (Index v = 0; v < std::ssize(states); ++v) {
      zone.vertices.push_back(v);
      const double depth = -step.positions[v][2];
      if (!(depth > 0)) continue;
      states[v].way_out = Vec3::UnitZ();
      states[v].start_depth = depth;
      states[v].depth_left = depth - 0.025;
      states[v].step = step.number;
    }
  }

  void touch() {
    for (const Index v : zone.vertices)
      if (states[v].start_depth > 0) zone.add(touch_of_vertex(v, 1, step, carriers));
  }
  std::vector<Vec3> ways() const {
    return zone.base_ways(model, step, carriers, model.rest_positions, ZoneBase::kRigid);
  }
};

TEST(GateZone, LeavesAColliderAsContactsLetOutItsDeepestVertex) {
  OnAFloor box;
  box.touch();
  EXPECT_NEAR((box.zone.way_out(box.step, box.carriers) - Vec3(0, 0, 0.025)).norm(), 0, 1e-15);
  for (const Vec3& way : box.ways()) EXPECT_EQ(way, Vec3(0, 0, OnAFloor::kUp));
}

TEST(GateZone, StaysWhereWaysOutLeadToSeveralSides) {
  OnAFloor box;
  box.states[box.zone.vertices[0]].way_out = Vec3::UnitX();
  box.touch();
  EXPECT_EQ(box.zone.way_out(box.step, box.carriers), Vec3::Zero());
}

TEST(GateZone, StaysWhereItOnlyTouchesOrIsHeldElsewhereToo) {
  OnAFloor held;
  held.touch();
  held.zone.add(touch_of_vertex(held.zone.vertices.back(), 0, held.step, held.carriers));
  EXPECT_EQ(held.zone.way_out(held.step, held.carriers), Vec3::Zero());
  OnAFloor above;
  for (ColliderContactState& state : above.states) state.step = 0;
  above.touch();
  EXPECT_EQ(above.zone.way_out(above.step, above.carriers), Vec3::Zero());
}

/// A vertex deep in a floor that stands enters it as soon as it gets deeper, however little: else it would creep in.
TEST(ColliderEntries, AreOfWhatGetsDeeperAndNotOfWhatStaysAsDeep) {
  const OnAFloor box;
  const auto deep =
      std::find_if(box.step.positions.begin(), box.step.positions.end(), [](const Vec3& p) { return p[2] == -0.1; });
  const std::array vertices{static_cast<Index>(deep - box.step.positions.begin())};
  const auto entries = [&](double deeper) {
    std::vector<StepVertex> end(box.states.size(), StepVertex{{0, 0, 1}, 1});
    const Vec3& p = box.step.positions[vertices[0]];
    end[vertices[0]] = {{p[0], p[1], p[2] - deeper}, 1};
    return find_entries(box.colliders, box.step, box.corrections, box.states, vertices, end).size();
  };
  EXPECT_EQ(entries(0.1 * kContactGap * box.corrections[vertices[0]]), 1u);
  EXPECT_EQ(entries(0), 0u);
  EXPECT_EQ(entries(-0.01), 0u);
}

/// Between two plates that close in everything goes with them in proportion, so that nothing meets however near it is.
TEST(GateZone, IsPressedInProportionBetweenPlates) {
  OnAFloor box;
  box.carriers.motions = {{Eigen::Matrix3d::Identity(), Vec3(0, 0, 0.01)},
                          {Eigen::Matrix3d::Identity(), Vec3(0, 0, -0.03)}};
  for (const Index v : box.zone.vertices) {
    const double z = box.step.positions[v][2];
    if (z < -0.099) box.zone.add(touch_of_vertex(v, 0, box.step, box.carriers));
    if (z > 0.299) box.zone.add(touch_of_vertex(v, 1, box.step, box.carriers));
  }
  ASSERT_TRUE(box.zone.is_torn(box.step, box.carriers, 1));
  const std::vector<Vec3> ways = box.zone.bent_ways(box.model, box.step, box.carriers);
  for (const Index v : box.zone.vertices) {
    const double height = (box.step.positions[v][2] + 0.1) / 0.4;
    EXPECT_NEAR((ways[v] - Vec3(0, 0, 0.01 - 0.04 * height)).norm(), 0, 1e-15);
  }
}

}  // namespace
}  // namespace selvage
