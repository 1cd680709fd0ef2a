#include "selvage/shapes/sequences.h"

#include "selvage/self_collision/self_collision.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

std::size_t count_pairs(const SurfaceSequence& sequence, double frame) {
  const TriangleMesh mesh(sequence.vertex_count(), sequence.triangles());
  return SelfCollisionFinder(mesh, sequence.positions(frame)).find_pairs().size();
}

TEST(Sequences, OnlyTheWavesNeverMeetThemselves) {
  for (const std::string_view name : sequence_names()) {
    const SurfaceSequence sequence(name, 4'000);
    std::size_t pairs = 0;
    for (int frame = 0; frame < sequence.frame_count(); frame += 17) pairs += count_pairs(sequence, frame);
    EXPECT_EQ(pairs == 0, name == "waves") << name;
  }
}

TEST(Sequences, PipeShirtAndFunnelBeginApart) {
  for (const char* name : {"pipe", "t-shirt", "funnel"})
    EXPECT_EQ(count_pairs(SurfaceSequence(name, 4'000), 0), 0u) << name;
}

TEST(Sequences, PairsGrowWithTheSideOfTheTriangles) {
  // Surfaces cross along curves: twice as many cells along each side meet in about twice as many pairs, not four times.
  const double coarse = count_pairs(SurfaceSequence("crumple", 16'000), 40);
  const double fine = count_pairs(SurfaceSequence("crumple", 64'000), 40);
  EXPECT_GT(fine, 1.5 * coarse);
  EXPECT_LT(fine, 3 * coarse);
}

}  // namespace
}  // namespace selvage
