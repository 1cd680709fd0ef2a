// A path that a packet finds must be one to the traversal that follows it alone and exactly, and few may be missed.
// Searches near inverted elements must end together as each does alone.
#include "boundary_path/packets/traversal_packet.h"
#include "boundary_path/families/families.h"
#include "boundary_path/injectivity/deformed_mesh.h"
#include "boundary_path/search/candidate.h"
#include "boundary_path/traversal/tet_traversal.h"
#include "selvage/shapes/poses.h"
#include "selvage/shapes/shapes.h"
#include "test_scale.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

/// A mesh and its pose as traversals read them.
class Material {
 public:
  Material(const std::vector<Vec3>& positions, const std::vector<VertexTuple<4>>& elements)
      : mesh_(static_cast<Index>(positions.size()), elements), topology_(mesh_), pose_(mesh_, topology_) {
    pose_.rebuild(positions);
    input_.positions = pose_.positions().data();
    input_.elements = topology_.elements.data();
    input_.boundary_faces = mesh_.boundary_faces().data();
    input_.boundary_owners = mesh_.boundary_owners().data();
    input_.face_stars = topology_.face_stars.data();
    input_.is_split = topology_.is_split.data();
    input_.rounded = pose_.rounded_positions().data();
    input_.rounding = pose_.rounding();
    input_.box_origin = pose_.box_origin();
  }

  const TetMesh& mesh() const { return mesh_; }
  const PathTopology<3>& topology() const { return topology_; }
  const PathInput<3>& input() const { return input_; }

 private:
  TetMesh mesh_;
  PathTopology<3> topology_;
  DeformedMesh<3> pose_;
  PathInput<3> input_{};
};

/// A point strictly inside an element, at times very close to one of its faces.
PathQuery<3> random_query(const Material& material, test::Random& random) {
  const Index element = random.below(material.mesh().elements().size());
  Vec3 point = Vec3::Zero();
  double total = 0;
  for (Index v : material.mesh().elements()[element]) {
    const double weight = random.below(8) == 0 ? 1e-6 : random.within(0.1, 1);
    point += weight * material.input().positions[v];
    total += weight;
  }
  return {point / total, element};
}

struct Tally {
  std::int64_t paths = 0, found = 0, others = 0, blocked = 0;
};

/// Sixteen queries: the paths to the face near in the mesh, or to any.
void compare(const Material& material, test::Random& random, TetTraversalPacket& packet, Tally& tally) {
  const PathInput<3>& input = material.input();
  std::array<PathQuery<3>, kPacketSize> queries;
  std::array<Candidate<3>, kPacketSize> candidates;
  alignas(64) float query_points[3][kPacketSize] = {};
  unsigned traversals = 0;
  packet.clear();
  for (int lane = 0; lane < kPacketSize; ++lane) {
    queries[lane] = random_query(material, random);
    const CandidateFactory<3> factory(input, queries[lane].point);
    const Index hint = material.topology().hints[queries[lane].element];
    const Index face = random.below(3) == 0 ? random.below(material.mesh().boundary_faces().size()) : hint;
    candidates[lane] = factory.make(face, factory.estimate(face));
    for (int i = 0; i < 3; ++i)
      query_points[i][lane] = static_cast<float>(queries[lane].point[i] - input.box_origin.position[i]);
    if (is_split(input, candidates[lane])) continue;
    if (TetTraversal<3>(input, queries[lane], true, nullptr).starts_at(candidates[lane])) continue;
    packet.add(lane, queries[lane].element, candidates[lane]);
    traversals |= 1u << lane;
  }
  const unsigned found = packet.follow(query_points);
  const unsigned blocked = packet.blocked();
  ASSERT_EQ((found | blocked) & ~traversals, 0u);
  ASSERT_EQ(found & blocked, 0u);
  for (int lane = 0; lane < kPacketSize; ++lane) {
    if ((traversals >> lane & 1) == 0) continue;
    PathCounters counters;
    const bool is_path = TetTraversal<3>(input, queries[lane], true, &counters).follow(candidates[lane], false).valid;
    tally.paths += is_path;
    tally.others += !is_path;
    if ((blocked >> lane & 1) != 0) {
      ++tally.blocked;
      ASSERT_FALSE(is_path) << "element " << queries[lane].element << ", face " << candidates[lane].face;
    }
    if ((found >> lane & 1) == 0) continue;
    ++tally.found;
    ASSERT_TRUE(is_path) << "element " << queries[lane].element << ", face " << candidates[lane].face;
    ASSERT_EQ(packet.elements_visited(lane), counters.elements_visited);
  }
}

Tally compare_many(const Material& material) {
  test::Random random(test::seed(7));
  TetTraversalPacket packet(material.input());
  Tally tally;
  for (std::int64_t i = 0; i < test::scaled(2000) && !testing::Test::HasFatalFailure(); ++i)
    compare(material, random, packet, tally);
  return tally;
}

TEST(TetTraversalPacket, FindsMostPathsAndNoOthersWhereTheMeshCrossesItself) {
  IndexedMesh rod = make_rod(RodCurve::kStraight, 4, 0.1, 0.04);
  pose_self_crossing(rod.positions, 0, 2);
  const Tally tally = compare_many(Material(rod.positions, rod.tetrahedra));
  EXPECT_GT(tally.paths, 10);
  EXPECT_GT(static_cast<double>(tally.found), 0.8 * static_cast<double>(tally.paths));
  EXPECT_GT(tally.others, 10);
  EXPECT_GT(static_cast<double>(tally.blocked), 0.5 * static_cast<double>(tally.others));
}

/// Forty candidates, which is more than there are lanes, of one query. From the middle of an element of a lattice many
/// lines run through edges and vertices.
void compare_backward_searches(const Material& material, test::Random& random, Tally& tally) {
  const PathInput<3>& input = material.input();
  PathQuery<3> query = random_query(material, random);
  if (random.below(2) == 0) {
    query.point.setZero();
    for (Index v : input.elements[query.element].vertices) query.point += 0.25 * input.positions[v];
  }
  const CandidateFactory<3> factory(input, query.point);
  std::vector<Candidate<3>> candidates;
  while (candidates.size() < 40) {
    const Index face = random.below(material.mesh().boundary_faces().size());
    candidates.push_back(factory.make(face, factory.estimate(face)));
  }
  std::array<bool, 40> are_valid;
  PathCounters together, alone;
  TetTraversal<3>(input, query, true, &together).follow_backwards(candidates, are_valid.data());
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const KernelVector<Index> goals{query.element};
    BackwardSearch<3> search(input, query.point, candidates[i], goals, &alone);
    bool goes_on = search.find_line();
    while (goes_on) goes_on = search.advance();
    ASSERT_EQ(search.has_arrived(), are_valid[i]) << "element " << query.element << ", face " << candidates[i].face;
    ++(are_valid[i] ? tally.found : tally.blocked);
  }
  ASSERT_EQ(together.traversals, alone.traversals);
  ASSERT_EQ(together.elements_visited, alone.elements_visited);
  ASSERT_EQ(together.exact_decisions, alone.exact_decisions);
}

Tally compare_many_backward_searches(const Material& material, std::int64_t queries) {
  test::Random random(test::seed(8));
  Tally tally;
  for (std::int64_t i = 0; i < test::scaled(queries) && !testing::Test::HasFatalFailure(); ++i)
    compare_backward_searches(material, random, tally);
  return tally;
}

TEST(LinePacket, EndsSearchesAsTheyEndAlone) {
  std::int64_t found = 0, blocked = 0;
  for (const auto& family : families::solid_families()) {
    SCOPED_TRACE(family.name);
    const Tally tally = compare_many_backward_searches(Material(family.mesh.positions, family.mesh.elements), 20);
    found += tally.found;
    blocked += tally.blocked;
  }
  EXPECT_GT(found, 1000);
  EXPECT_GT(blocked, 1000);
}

TEST(LinePacket, EndsSearchesAsTheyEndAloneNearManyInvertedElements) {
  IndexedMesh ball = make_ball(1, 0.1);
  for (Vec3& x : ball.positions)
    if (x.norm() < 0.5) x = -x;
  const Tally tally = compare_many_backward_searches(Material(ball.positions, ball.tetrahedra), 300);
  EXPECT_GT(tally.found, test::scaled(50));
  EXPECT_GT(tally.blocked, test::scaled(500));
}

TEST(TetTraversalPacket, FindsNoOthersOnALattice) {
  const families::Pieces<3> grid = families::grid(6, 5, 4);
  const Tally tally = compare_many(Material(grid.positions, grid.elements));
  EXPECT_GT(tally.found, 0);
  EXPECT_LE(tally.found, tally.paths);
}

}  // namespace
}  // namespace selvage
