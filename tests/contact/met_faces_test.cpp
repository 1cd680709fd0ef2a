#include "contact/impacts/met_faces.h"

#include "contact/contact_steps.h"
#include "mesh/simplex_corners.h"
#include "solids.h"
#include "test_scale.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace selvage {
namespace {

using solids::Solid;
using test::contacts_of_step;
using test::in_mode;
using test::Random;
using test::scaled;
using test::seed;
using Positions = std::vector<Vec3>;

/// Two boxes of some hundred faces, one over the other.
Solid two_boxes() {
  return solids::together(
      {solids::box({0, 0, 0}, {1, 1, 0.5}, 0.125), solids::box({0.2, 0.1, 0.53}, {1, 0.9, 1}, 0.125)});
}

ContinuousPairs pairs_between(const TriangleMesh& surface, const Positions& t0, const Positions& t1) {
  return ContinuousCollisionFinder(surface, t0, t1).find_pairs();
}

TEST(MetFaces, KnowAllThatMeetAtTheEndOfAStep) {
  const Solid solid = two_boxes();
  const TetMesh mesh = solid.mesh();
  const TriangleMesh surface = boundary_surface(mesh);
  Random random(seed(1));
  int known = 0, meeting = 0;
  for (std::int64_t round = 0; round < scaled(20); ++round) {
    Positions positions = solid.positions;
    std::vector<TrianglePair> at_start = SelfCollisionFinder(surface, positions).find_pairs();
    MetFaces met(surface, surface.triangle_count());
    for (int step = 0; step < 6; ++step) {
      Positions next = positions;
      const Vec3 fall = random.vector(0.01) - Vec3(0, 0, 0.01);
      for (std::size_t v = next.size() / 2; v < next.size(); ++v) next[v] += fall;
      next[random.below(next.size())] += random.vector(0.1);
      met.note(next, pairs_between(surface, positions, next));
      const auto candidates = met.take_candidates(next, at_start);
      at_start = SelfCollisionFinder(surface, next).find_pairs();
      positions = next;
      meeting += static_cast<int>(at_start.size());
      if (!candidates) continue;
      ++known;
      EXPECT_TRUE(std::is_sorted(candidates->begin(), candidates->end()));
      for (const TrianglePair& pair : at_start)
        EXPECT_TRUE(std::binary_search(candidates->begin(), candidates->end(), IndexPair(pair.first, pair.second)));
    }
  }
  EXPECT_GT(known, scaled(40));
  EXPECT_GT(meeting, scaled(40));
}

TEST(MetFaces, SayNothingOfOtherPositionsAndOfTheStepAfterTheNext) {
  const Solid solid = two_boxes();
  const TetMesh mesh = solid.mesh();
  const TriangleMesh surface = boundary_surface(mesh);
  MetFaces met(surface, surface.triangle_count());
  EXPECT_FALSE(met.take_candidates(solid.positions, {}));
  met.note(solid.positions, {});
  Positions other = solid.positions;
  other[3][1] = std::nextafter(other[3][1], 2);
  EXPECT_FALSE(met.take_candidates(other, {}));
  EXPECT_FALSE(met.take_candidates(solid.positions, {}));
  met.note(solid.positions, {});
  EXPECT_TRUE(met.take_candidates(solid.positions, {}));
  EXPECT_FALSE(met.take_candidates(solid.positions, {}));
}

TEST(MetFaces, LeaveOutPairsOfColliders) {
  const Solid solid = two_boxes();
  const TetMesh mesh = solid.mesh();
  const TriangleMesh surface = boundary_surface(mesh);
  const Index vertex = surface.triangles()[0][0];
  Index face = 0;
  while (share_vertex(surface.triangles()[face], surface.triangles()[0])) ++face;
  for (const Index body_faces : {Index{0}, surface.triangle_count()}) {
    MetFaces met(surface, body_faces);
    met.note(solid.positions, {{{vertex, face}}, {}});
    const auto candidates = met.take_candidates(solid.positions, {});
    ASSERT_TRUE(candidates);
    EXPECT_EQ(candidates->empty(), body_faces == 0);
  }
}

/// What a step begins with: the same for a finder that knows the last step as for one that does not.
void expect_same_start(const ContactFinder& kept, const ContactFinder& fresh) {
  EXPECT_TRUE(std::ranges::equal(kept.penetrating_vertices(), fresh.penetrating_vertices()));
  EXPECT_TRUE(std::ranges::equal(kept.penetrating_edges(), fresh.penetrating_edges()));
  EXPECT_EQ(kept.statistics().penetrations.crossings, fresh.statistics().penetrations.crossings);
  EXPECT_EQ(kept.statistics().unguarded_vertices, fresh.statistics().unguarded_vertices);
}

void expect_same_contacts(const std::vector<Contact>& kept, const std::vector<Contact>& fresh) {
  ASSERT_EQ(kept.size(), fresh.size());
  for (std::size_t i = 0; i < kept.size(); ++i) {
    EXPECT_EQ(kept[i].kind, fresh[i].kind);
    EXPECT_EQ(kept[i].vertices, fresh[i].vertices);
    EXPECT_EQ(kept[i].weights, fresh[i].weights);
    EXPECT_EQ(kept[i].normal, fresh[i].normal);
    EXPECT_EQ(kept[i].point, fresh[i].point);
    EXPECT_EQ(kept[i].time, fresh[i].time);
  }
}

/// Steps from pose to pose, by each motion in turn; some begin elsewhere than the last one ended. Where distances
/// squared overflow, which of the ways out is the shortest depends on the order in which they are tried.
void expect_same_over_steps(const Solid& solid, Random& random) {
  const TetMesh mesh = solid.mesh();
  ContactFinder kept(mesh, {}, solid.positions, {}, in_mode(DetectionMode::kHybrid));
  Positions t0 = solid.positions;
  bool overflows = false;
  for (const solids::Motion& motion : solids::motions()) {
    Positions t1 = t0;
    motion.move(t1, random);
    const std::vector<Contact> contacts = contacts_of_step(kept, t0, t1);
    ContactFinder fresh(mesh, {}, t0, {}, in_mode(DetectionMode::kHybrid));
    const std::vector<Contact> contacts_afresh = contacts_of_step(fresh, t0, t1);
    overflows |= motion.name == "blown_up";
    if (!overflows) expect_same_contacts(contacts, contacts_afresh);
    expect_same_start(kept, fresh);
    t0 = t1;
    if (random.below(4) == 0) t0[random.below(t0.size())] += random.vector(0.01);
  }
}

class MetFacesOf : public testing::TestWithParam<solids::Family> {};

TEST_P(MetFacesOf, LeaveEveryStepAsItIs) {
  Random random(seed(2));
  expect_same_over_steps(GetParam().make(random), random);
}

INSTANTIATE_TEST_SUITE_P(Families, MetFacesOf, testing::ValuesIn(solids::families()),
                         [](const auto& family) { return family.param.name; });

TEST(MetFaces, LeaveStepsOfBoxesThatRunIntoOneAnotherAsTheyAre) {
  Random random(seed(3));
  const Solid solid = two_boxes();
  const TetMesh mesh = solid.mesh();
  ContactFinder kept(mesh, {}, solid.positions, {}, in_mode(DetectionMode::kHybrid));
  Positions t0 = solid.positions;
  for (std::int64_t step = 0; step < scaled(12); ++step) {
    Positions t1 = t0;
    for (std::size_t v = t1.size() / 2; v < t1.size(); ++v) t1[v][2] -= 0.006;
    t1[random.below(t1.size())] += random.vector(0.05);
    const std::vector<Contact> contacts = contacts_of_step(kept, t0, t1);
    ContactFinder fresh(mesh, {}, t0, {}, in_mode(DetectionMode::kHybrid));
    expect_same_contacts(contacts, contacts_of_step(fresh, t0, t1));
    expect_same_start(kept, fresh);
    t0 = t1;
  }
}

}  // namespace
}  // namespace selvage
