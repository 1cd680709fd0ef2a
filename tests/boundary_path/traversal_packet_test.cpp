// A path that a packet finds must be one to the traversal that follows it alone and exactly, and few may be missed.
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

TEST(TetTraversalPacket, FindsNoOthersOnALattice) {
  const families::Pieces<3> grid = families::grid(6, 5, 4);
  const Tally tally = compare_many(Material(grid.positions, grid.elements));
  EXPECT_GT(tally.found, 0);
  EXPECT_LE(tally.found, tally.paths);
}

}  // namespace
}  // namespace selvage
