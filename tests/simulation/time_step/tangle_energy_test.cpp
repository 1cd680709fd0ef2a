// Bodies that overlap get no kinetic energy by their ways out, and no momentum.
#include "simulation/time_step/tangle_energy.h"

#include "random.h"
#include "simulation/bodies.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

using namespace bodies;

/// Three boxes of different masses with velocities by chance, before and after ways out.
struct TangledBoxes {
  Model model =
      make(std::vector<IndexedMesh>{make_box({1, 1, 1}, 0.5), make_box({1, 1, 2}, 0.5), make_box({2, 2, 1}, 0.5)},
           neo_hookean(1e5));
  std::vector<StepVertex> vertices;
  std::vector<Index> body_of;
  std::vector<Vec3> before, after;

  explicit TangledBoxes(double speed_after) {
    test::Random random(7);
    for (Index b = 0; b < std::ssize(model.bodies); ++b)
      for (Index i = 0; i < model.bodies[b].vertex_count; ++i) body_of.push_back(b);
    for (Index v = 0; v < std::ssize(body_of); ++v) {
      vertices.push_back({{}, model.inverse_masses[v]});
      before.push_back(random.vector(4));
      after.push_back(speed_after * random.vector(1) + Vec3(0.3, 0, 0));
    }
  }

  Index first(Index body) const { return model.bodies[body].first_vertex; }
  Contact way_out(Index from, Index to, ContactKind kind = ContactKind::kVertexPath) const {
    return {.kind = kind, .count = 2, .vertices = {from, to}, .weights = {1, -1}};
  }
  double mass(Index v) const { return 1 / vertices[v].inverse_mass; }
  template <typename Of>
  auto sum(std::initializer_list<Index> bodies, Of&& of) const {
    auto total = of(0);
    total *= 0;
    for (const Index b : bodies)
      for (Index v = first(b); v < first(b) + model.bodies[b].vertex_count; ++v)
        if (vertices[v].inverse_mass > 0) total += of(v);
    return total;
  }
  double energy(std::initializer_list<Index> bodies, const std::vector<Vec3>& velocities) const {
    return sum(bodies, [&](Index v) { return 0.5 * mass(v) * velocities[v].squaredNorm(); });
  }
  Vec3 momentum(std::initializer_list<Index> bodies, const std::vector<Vec3>& velocities) const {
    return sum(bodies, [&](Index v) { return Vec3(mass(v) * velocities[v]); });
  }
  std::vector<Vec3> limited(const std::vector<Contact>& contacts, double speed = 0) const {
    std::vector<Vec3> velocities = after;
    limit_tangle_energy(model, contacts, vertices, body_of, before, speed, velocities);
    return velocities;
  }
};

TEST(TangleEnergy, IsThatOfBeforeWithTheMomentumOfAfter) {
  const TangledBoxes boxes(9);
  const auto velocities = boxes.limited({boxes.way_out(boxes.first(0), boxes.first(1))});
  EXPECT_NEAR(boxes.energy({0, 1}, velocities), boxes.energy({0, 1}, boxes.before),
              1e-9 * boxes.energy({0, 1}, boxes.after));
  EXPECT_LT((boxes.momentum({0, 1}, velocities) - boxes.momentum({0, 1}, boxes.after)).norm(), 1e-9);
  for (Index v = boxes.first(2); v < std::ssize(velocities); ++v) EXPECT_EQ(velocities[v], boxes.after[v]);
}

TEST(TangleEnergy, LeavesASpeedThatIsAlwaysAllowed) {
  const TangledBoxes boxes(9);
  const std::vector<Contact> contacts = {boxes.way_out(0, boxes.first(1))};
  const double mass = boxes.sum({0, 1}, [&](Index v) { return boxes.mass(v); });
  const double common = boxes.momentum({0, 1}, boxes.after).squaredNorm() / (2 * mass);
  const double energy = boxes.energy({0, 1}, boxes.limited(contacts, 5));
  EXPECT_NEAR(energy, common + mass * 25 / 2, 1e-9 * energy);
  EXPECT_EQ(boxes.limited(contacts, 10), boxes.after);
}

TEST(TangleEnergy, OfOneBodyInItself) {
  const TangledBoxes boxes(9);
  const auto velocities = boxes.limited({boxes.way_out(boxes.first(1), boxes.first(1) + 1, ContactKind::kEdgePath)});
  EXPECT_NEAR(boxes.energy({1}, velocities), boxes.energy({1}, boxes.before), 1e-9 * boxes.energy({1}, boxes.after));
  for (Index v = 0; v < boxes.first(1); ++v) EXPECT_EQ(velocities[v], boxes.after[v]);
}

TEST(TangleEnergy, IsLeftWhereItIsLessAndWhereBodiesOnlyTouch) {
  const TangledBoxes slow(0.1), fast(9);
  EXPECT_EQ(slow.limited({slow.way_out(0, slow.first(1))}), slow.after);
  EXPECT_EQ(fast.limited({fast.way_out(0, fast.first(1), ContactKind::kVertexFace)}), fast.after);
  EXPECT_EQ(fast.limited({fast.way_out(0, static_cast<Index>(fast.body_of.size()))}), fast.after);  // of a collider
}

TEST(TangleEnergy, HeldVerticesKeepTheirVelocity) {
  TangledBoxes boxes(9);
  boxes.vertices[3].inverse_mass = 0;
  boxes.after[3] = Vec3(50, 0, 0);
  const auto velocities = boxes.limited({boxes.way_out(0, boxes.first(1))});
  EXPECT_EQ(velocities[3], boxes.after[3]);
  EXPECT_NEAR(boxes.energy({0, 1}, velocities), boxes.energy({0, 1}, boxes.before),
              1e-9 * boxes.energy({0, 1}, boxes.after));
}

}  // namespace
}  // namespace selvage
