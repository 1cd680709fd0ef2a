#include "self_collision/surfaces.h"
#include "selvage/self_collision/continuous_collision.h"
#include "selvage/self_collision/proximity.h"
#include "selvage/shapes/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

namespace selvage {
namespace {

/// Listens to how far queries have come.
class Listener {
 public:
  SelfCollisionOptions options() {
    SelfCollisionOptions options;
    options.on_progress = [this](double share) { shares_.push_back(share); };
    return options;
  }

  /// What was heard since the last time goes up to 1 in at least `fewest` steps.
  void expect_whole(std::size_t fewest) {
    ASSERT_GE(shares_.size(), fewest);
    EXPECT_GT(shares_.front(), 0);
    EXPECT_EQ(std::adjacent_find(shares_.begin(), shares_.end(), std::greater_equal<>()), shares_.end());
    EXPECT_EQ(shares_.back(), 1);
    shares_.clear();
  }

 private:
  std::vector<double> shares_;
};

class Progress : public testing::Test {
 protected:
  Progress() {
    surfaces::Random random(1);
    for (Vec3& x : cloth_.positions)
      for (int axis = 0; axis < 3; ++axis) x[axis] += random.within(-0.05, 0.05);
  }

  IndexedMesh cloth_ = make_cloth(4, 4, 0.1);
  TriangleMesh mesh_{static_cast<Index>(cloth_.positions.size()), cloth_.triangles};
  Listener listener_;
};

TEST_F(Progress, OfAPoseIsToldPieceByPiece) {
  const SelfCollisionFinder plain(mesh_, cloth_.positions), finder(mesh_, cloth_.positions, listener_.options());
  const auto pairs = finder.find_pairs();
  listener_.expect_whole(10);
  EXPECT_EQ(pairs, plain.find_pairs());
  EXPECT_EQ(finder.find_segments(pairs), plain.find_segments(pairs));
  listener_.expect_whole(1);
  finder.find_pairs_of(std::vector<Index>{0, 1, 2});
  listener_.expect_whole(1);
  finder.find_pairs_with(plain);
  listener_.expect_whole(10);
}

TEST_F(Progress, OfAStepIsToldPieceByPiece) {
  std::vector<Vec3> end = cloth_.positions;
  for (Vec3& x : end) x[2] = -x[2];
  const ContinuousCollisionFinder plain(mesh_, cloth_.positions, end),
      finder(mesh_, cloth_.positions, end, listener_.options());
  const ContinuousPairs pairs = finder.find_pairs();
  listener_.expect_whole(10);
  EXPECT_EQ(pairs.edge_edge, plain.find_pairs().edge_edge);
  finder.find_impact_times(pairs.vertex_face);
  listener_.expect_whole(2);
  finder.find_impact_times(pairs.edge_edge);
  listener_.expect_whole(2);
  EXPECT_EQ(finder.find_free_step(pairs), plain.find_free_step(pairs));
  listener_.expect_whole(4);
}

TEST_F(Progress, OfPairsWithinADistanceIsToldPieceByPiece) {
  const ProximityFinder plain(mesh_, cloth_.positions, 0.05),
      finder(mesh_, cloth_.positions, 0.05, {}, listener_.options().on_progress);
  EXPECT_EQ(finder.find_pairs().edge_edge.size(), plain.find_pairs().edge_edge.size());
  listener_.expect_whole(10);
}

TEST_F(Progress, WhatItThrowsEndsTheQueryAndTheFinderServesAgain) {
  struct Enough {};
  bool is_enough = true;
  SelfCollisionOptions options;
  options.on_progress = [&](double) {
    if (is_enough) throw Enough();
  };
  const SelfCollisionFinder finder(mesh_, cloth_.positions, options);
  const ContinuousCollisionFinder moving(mesh_, cloth_.positions, cloth_.positions, options);
  const ProximityFinder near(mesh_, cloth_.positions, 0.05, {}, options.on_progress);
  EXPECT_THROW(finder.find_pairs(), Enough);
  EXPECT_THROW(moving.find_pairs(), Enough);
  EXPECT_THROW(near.find_pairs(), Enough);
  is_enough = false;
  EXPECT_EQ(finder.find_pairs(), SelfCollisionFinder(mesh_, cloth_.positions).find_pairs());
  EXPECT_EQ(moving.find_pairs(), ContinuousCollisionFinder(mesh_, cloth_.positions, cloth_.positions).find_pairs());
  EXPECT_EQ(near.find_pairs().vertex_face.size(),
            ProximityFinder(mesh_, cloth_.positions, 0.05).find_pairs().vertex_face.size());
}

}  // namespace
}  // namespace selvage
