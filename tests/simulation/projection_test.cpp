// A contact and the vertices that it moves.
#include "simulation/xpbd/project_contacts.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

namespace selvage {
namespace {

/// A vertex below the middle of a face that looks up, or where a test puts it.
struct Scratch {
  std::vector<StepVertex> rows;
  std::vector<Vec3> start;
  std::vector<double> max_corrections = std::vector<double>(4, 1);
  Contact contact;
  FrictionState friction_state{};
  std::vector<ColliderContactState> collider_states;  ///< of one collider

  Scratch(const std::array<double, 4>& masses, const Vec3& barycentric, double depth) {
    const std::array<Vec3, 3> corners{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}};
    Vec3 point = -depth * Vec3::UnitZ();
    for (int i = 0; i < 3; ++i) point += barycentric[i] * corners[i];
    start = {point, corners[0], corners[1], corners[2]};
    for (int i = 0; i < 4; ++i)
      rows.push_back({{start[i][0], start[i][1], start[i][2]}, masses[i] > 0 ? 1 / masses[i] : 0});
    contact.count = 4;
    contact.vertices = {0, 1, 2, 3};
    contact.weights = {1, -barycentric[0], -barycentric[1], -barycentric[2]};
    contact.normal = Vec3::UnitZ();
  }

  Vec3 position(int i) const { return Eigen::Map<const Eigen::Vector3d>(rows[i].position); }
  Vec3 moved(int i) const { return position(i) - start[i]; }
  double gap() const {
    double gap = 0;
    for (int i = 0; i < 4; ++i) gap += contact.weights[i] * contact.normal.dot(position(i));
    return gap;
  }
  void project(Friction friction = {0, 0}) {
    const std::vector<Vec3> velocities(start.size(), Vec3::Zero());
    std::vector<Vec3> ejected = velocities;
    ContactFriction of_contact{friction, friction_state};
    project_contacts({&contact, 1}, {0, 0, 1, start, velocities}, max_corrections, {collider_states, 1, 0},
                     {&of_contact, 1}, ejected, rows);
    friction_state = of_contact.state;
  }
};

TEST(Projection, ClosesTheGapAndKeepsMomentumWhateverTheMasses) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> exponent(-3, 3), share(0, 1);
  for (int n = 0; n < 1000; ++n) {
    std::array<double, 4> masses;
    for (double& mass : masses) mass = std::pow(10.0, exponent(random));
    Vec3 barycentric{share(random), share(random), share(random)};
    barycentric /= barycentric.sum();
    Scratch scratch(masses, barycentric, 0.1);
    scratch.project();
    EXPECT_NEAR(scratch.gap(), 0, 1e-12);
    Vec3 momentum = Vec3::Zero();
    double all = 0;
    for (int i = 0; i < 4; ++i) {
      momentum += masses[i] * scratch.moved(i);
      all += masses[i];
      // Of weights that sum to 1, the largest is at most 1.37 times the sum of their squares.
      EXPECT_LE(scratch.moved(i).norm(), 1.37 * 0.1);
    }
    EXPECT_LE(momentum.norm(), 1e-15 * all);
  }
}

/// The face lies on a floor that has pushed it in the step.
TEST(Projection, PushesNoVertexIntoAColliderThatHasPushedIt) {
  for (const bool in_this_step : {true, false}) {
    Scratch scratch({1, 1, 1, 1}, {0.2, 0.3, 0.5}, 0.1);
    scratch.collider_states.resize(4);
    for (int i = 1; i < 4; ++i) {
      scratch.collider_states[i].normal = Vec3::UnitZ();
      scratch.collider_states[i].step = in_this_step ? 0 : 7;
    }
    scratch.project();
    EXPECT_NEAR(scratch.gap(), 0, 1e-15);
    if (!in_this_step) {
      EXPECT_LT(scratch.moved(1)[2], -0.01);
      continue;
    }
    EXPECT_NEAR(scratch.moved(0)[2], 0.1, 1e-15);
    for (int i = 1; i < 4; ++i) {
      EXPECT_EQ(scratch.moved(i), Vec3::Zero().eval());
      EXPECT_GT(scratch.collider_states[i].friction.normal_sum, 0) << "it bears what the contact pushes";
    }
  }
}

/// Along the collider it moves, by no more than it might else.
TEST(Projection, LetsAVertexSlideAlongACollider) {
  for (const double degrees : {5.0, 40.0, 85.0}) {
    Scratch scratch({0, 1, 1, 1}, {0.2, 0.3, 0.5}, 0.1);
    const double angle = degrees * std::numbers::pi / 180;
    const Vec3 normal(std::sin(angle), 0, std::cos(angle));
    scratch.collider_states.resize(4);
    for (int i = 1; i < 4; ++i) {
      scratch.collider_states[i].normal = normal;
      scratch.collider_states[i].step = 0;
    }
    scratch.project();
    EXPECT_GT(scratch.gap(), degrees > 80 ? -1e-12 : -0.1);
    for (int i = 1; i < 4; ++i) {
      EXPECT_NEAR(scratch.moved(i).dot(normal), 0, 1e-15);
      EXPECT_LE(scratch.moved(i).norm(), 1.3701 * 0.1);
    }
  }
}

/// A heavy point slides over a light face that a collider holds: along the normal only the point can move, across it
/// the face goes with the point.
TEST(Projection, TakesALightFaceOnAColliderAlongByFriction) {
  Scratch scratch({10, 1e-3, 1e-3, 1e-3}, {0.2, 0.3, 0.5}, 0.1);
  scratch.collider_states.resize(4);
  for (int i = 1; i < 4; ++i) {
    scratch.collider_states[i].normal = Vec3::UnitZ();
    scratch.collider_states[i].step = 0;
  }
  scratch.rows[0].position[0] += 0.05;
  scratch.project({1, 1});
  EXPECT_NEAR(scratch.moved(0)[0], 0.05, 1e-4);
  EXPECT_NEAR(scratch.moved(0)[2], 0.1, 1e-15);
  Vec3 face = Vec3::Zero();
  for (int i = 1; i < 4; ++i) {
    EXPECT_LE(scratch.moved(i).norm(), 1.3701 * 0.05);
    face -= scratch.contact.weights[i] * scratch.moved(i);
  }
  EXPECT_NEAR(face[0], scratch.moved(0)[0], 1e-12);
  EXPECT_NEAR(face[2], 0, 1e-15);
}

TEST(Projection, LeavesPinnedVerticesWhereTheyAre) {
  Scratch held({1, 0, 0, 0}, {0.2, 0.3, 0.5}, 0.1);
  held.project();
  EXPECT_NEAR(held.moved(0)[2], 0.1, 1e-15);
  Scratch corner({2, 0, 3, 4}, {0.2, 0.3, 0.5}, 0.1);
  corner.project();
  EXPECT_EQ(corner.moved(1), Vec3::Zero().eval());
  EXPECT_NEAR(corner.gap(), 0, 1e-15);
  Scratch all({0, 0, 0, 0}, {0.2, 0.3, 0.5}, 0.1);
  all.project();
  for (int i = 0; i < 4; ++i) EXPECT_EQ(all.moved(i), Vec3::Zero().eval());
}

/// Where all else is held, a vertex would have to move by the depth over its weight.
TEST(Projection, MovesNoVertexOfLittleWeightFar) {
  for (const double weight : {0.4, 1e-2, 1e-6, 1e-300}) {
    Scratch held({0, 0, 0, 1}, {0.5, 0.5 - weight, weight}, 0.1);
    held.project({1, 1});
    EXPECT_LE(held.moved(3).norm(), 1.37 * 0.1) << weight;
    EXPECT_LT(held.moved(3)[2], 0) << weight;
    EXPECT_GE(held.gap(), -0.1) << weight;
  }
}

/// A point of an edge close to its end, at a face that has this end too: together they move the point by little.
TEST(Projection, MovesNoVertexOfAnEdgeAtItsOwnFaceFar) {
  Scratch scratch({1, 1, 1, 1}, {0.5, 0.5, 0}, 0.1);
  scratch.contact.count = 3;
  scratch.contact.weights = {0.1, -0.05, -0.05};
  scratch.start[0][2] = scratch.rows[0].position[2] = -1;  // a tenth of that deep
  scratch.project();
  EXPECT_LE(scratch.moved(0)[2], 1.37 * 0.1);
  EXPECT_GT(scratch.moved(0)[2], 0.1);
}

TEST(Projection, MovesTwoEqualBodiesEquallyFar) {
  Scratch scratch({1, 1, 1, 1}, {1, 0, 0}, 0.1);
  scratch.project();
  EXPECT_NEAR(scratch.moved(0)[2], 0.05, 1e-15);
  EXPECT_NEAR(scratch.moved(1)[2], -0.05, 1e-15);
  EXPECT_EQ(scratch.moved(2), Vec3::Zero().eval());
}

/// Only contacts by DCD, and by the least of the largest corrections.
TEST(Projection, SendsNoPointFartherThanTheLeastOfItsLargestCorrections) {
  for (const auto kind : {ContactKind::kVertexPath, ContactKind::kVertexFace}) {
    Scratch scratch({1, 1, 1, 1}, {0.2, 0.3, 0.5}, 0.1);
    scratch.contact.kind = kind;
    scratch.max_corrections = {0.08, 0.03, 1, 1};
    scratch.project();
    EXPECT_NEAR(scratch.gap(), kind == ContactKind::kVertexPath ? -0.07 : 0, 1e-15);
  }
}

/// As far as it was, at most by a little; what was inside comes out to the surface.
TEST(Projection, KeepsPointsByCcdInFrontOfTheSurface) {
  struct Meeting {
    ContactKind kind;
    double before, after;
  };
  for (const auto& [kind, before, after] :
       {Meeting{ContactKind::kVertexFace, -0.5, 0}, Meeting{ContactKind::kVertexFace, 0, 0},
        Meeting{ContactKind::kVertexFace, 0.4 * kContactGap, 0.4 * kContactGap},
        Meeting{ContactKind::kEdgeEdge, 0.5, kContactGap}, Meeting{ContactKind::kEdgePath, 0.5, 0}}) {
    Scratch scratch({1, 1, 1, 1}, {0.2, 0.3, 0.5}, 0.1);
    scratch.contact.kind = kind;
    scratch.start[0][2] = before;
    scratch.project();
    EXPECT_NEAR(scratch.gap(), after, 1e-15) << before;
  }
}

TEST(Projection, MovesNothingWhereThePointIsOutside) {
  Scratch scratch({1, 1, 1, 1}, {0.2, 0.3, 0.5}, -0.1);
  scratch.project({1, 1});
  for (int i = 0; i < 4; ++i) EXPECT_EQ(scratch.moved(i), Vec3::Zero().eval());
}

}  // namespace
}  // namespace selvage
