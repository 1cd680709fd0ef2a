#include "self_collision/culling/self_culling.h"

#include "core/parallel.h"
#include "self_collision/culling/enhanced_dual_cone.h"

#include <algorithm>
#include <numbers>

namespace selvage {

namespace {

/// Smaller pieces cost about as much to clear as their triangles to compare.
constexpr Index kSmallestPiece = 32;

/// Asks nodes from the root down, those below a node only where the node itself is not cleared.
///
/// @param smallest   nodes with fewer triangles are not asked
/// @param is_clear   `bool is_clear(Index node, Workspace&)`, thread-safe
template <typename Workspace, typename IsClear>
void clear_from_root(const Bvh& bvh, const SurfacePieces& pieces, Index smallest, CulledPairs& spared,
                     IsClear&& is_clear) {
  const auto nodes = bvh.nodes();
  spared.cleared.assign(nodes.size(), 0);
  std::vector<Index> asked = {0}, below;
  while (!asked.empty()) {
    parallel_ranges(std::ssize(asked), 64, [&](std::int64_t first, std::int64_t last) {
      Workspace workspace;
      for (std::int64_t i = first; i < last; ++i)
        if (is_clear(asked[i], workspace)) spared.cleared[asked[i]] = 1;
    });
    below.clear();
    for (const Index n : asked) {
      ++spared.counters.tested_nodes;
      if (spared.cleared[n] != 0) {
        ++spared.counters.cleared_nodes;
        spared.counters.cleared_triangles += pieces.ranges()[n].size();
        continue;
      }
      for (int i = 0; i < nodes[n].child_count && nodes[n].children[i] < 0; ++i) {
        const Index child = ~nodes[n].children[i];
        if (pieces.ranges()[child].size() >= smallest) below.push_back(child);
      }
    }
    std::swap(asked, below);
  }
}

/// Whether a sample of the smallest pieces, the likeliest to be graphs, has enough of them to pay for asking all. What
/// is measured for the sample need not be measured again, but it is little.
template <int kSteps>
bool is_worth_asking(const SurfacePieces& pieces, PlanarEmbeddingTest<kSteps>& test, bool knows_neighbours) {
  constexpr std::size_t kOneOf = 16, kMinSampled = 16, kMaxSampled = 32;
  // What has to be clear for one that is asked: a triangle spared brings more where it would be compared during a step
  // with its neighbours.
  const double worthwhile_share = kSteps == 1 || knows_neighbours ? 0.75 : 1.0 / 16;
  std::vector<Index> small;
  for (std::size_t n = 0; n < pieces.ranges().size(); ++n)
    if (const Index size = pieces.ranges()[n].size(); size >= kSmallestPiece && size < 4 * kSmallestPiece)
      small.push_back(static_cast<Index>(n));
  if (small.size() < kMinSampled) return true;
  const std::size_t step = std::max(std::min(kOneOf, small.size() / kMinSampled), small.size() / kMaxSampled);
  std::int64_t may_fail = 0;
  for (std::size_t i = 0; i < small.size(); i += step) may_fail += pieces.ranges()[small[i]].size();
  may_fail = static_cast<std::int64_t>((1 - worthwhile_share) * static_cast<double>(may_fail));
  typename PlanarEmbeddingTest<kSteps>::Workspace workspace;
  for (std::size_t i = 0; i < small.size() && may_fail >= 0; i += step) {
    const SurfacePieces::Range range = pieces.ranges()[small[i]];
    test.measure(range);
    if (!test.is_graph(small[i], workspace)) may_fail -= range.size();
  }
  return may_fail >= 0;
}

struct NoWorkspace {};

/// Binormals of contour edges that are not on the border of the whole surface.
template <int kSteps>
DirectionCone inner_binormals(SurfacePieces& pieces, const SurfaceCones<kSteps>& cones, Index node) {
  DirectionCone inner;
  std::vector<char> workspace;
  for (const Index edge : pieces.contours(node, workspace).edges)
    if (pieces.opposite(edge) != kNone) inner.merge(cones.binormals(edge));
  return inner;
}

/// As published: children that pass a test alone, and pairs of them that pass together, are left out even where the
/// others do not pass.
///
/// @param simple_traversal  only nodes that pass all tests are left out
template <int kSteps>
void spare_as_published(bool simple_traversal, const Bvh& bvh, SurfacePieces& pieces, const SurfaceCones<kSteps>& cones,
                        const typename PlanarEmbeddingTest<kSteps>::Poses& poses, CulledPairs& spared) {
  const auto nodes = bvh.nodes();
  if (!simple_traversal) spared.siblings.assign(nodes.size(), 0);
  std::vector<std::uint8_t> alone(nodes.size(), 0);
  clear_from_root<NoWorkspace>(bvh, pieces, 1, spared, [&](Index n, NoWorkspace&) {
    if (alone[n] != 0) return true;
    if (nodes[n].children[0] >= 0) return false;
    const EnhancedDualConeResult result = test_enhanced_dual_cone<kSteps>(bvh, pieces, cones, poses, n);
    if (result.does_clear(nodes[n].child_count)) return true;
    if (simple_traversal) return false;
    for (int i = 0; i < nodes[n].child_count && nodes[n].children[i] < 0; ++i) {
      alone[~nodes[n].children[i]] = static_cast<std::uint8_t>(result.alone >> i & 1);
      spared.siblings[~nodes[n].children[i]] = result.apart[i];
    }
    return false;
  });
  spared.counters.tested_nodes -= std::count(alone.begin(), alone.end(), 1);
}

}  // namespace

template <int kSteps>
CulledPairs cull_self_pairs(const SelfCollisionOptions& options, const Bvh& bvh, SurfacePieces& pieces,
                            const typename PlanarEmbeddingTest<kSteps>::Poses& poses, PlanarEmbeddingTest<kSteps>& test,
                            std::span<const MovingRow> rounded, bool knows_neighbours) {
  const CullingMethod method = options.method;
  CulledPairs spared;
  if (method == CullingMethod::kBvh || bvh.nodes().empty()) return spared;
  if (method == CullingMethod::kAuto) {
    test.take(pieces, poses, rounded);
    if (!is_worth_asking(pieces, test, knows_neighbours)) return spared;
    test.measure({0, static_cast<Index>(pieces.triangles().size())});
    clear_from_root<typename PlanarEmbeddingTest<kSteps>::Workspace>(
        bvh, pieces, kSmallestPiece, spared, [&](Index n, typename PlanarEmbeddingTest<kSteps>::Workspace& workspace) {
          return test.is_graph(n, workspace);
        });
    return spared;
  }
  const SurfaceCones<kSteps> cones(bvh, pieces, poses);
  switch (method) {
    case CullingMethod::kDualCone:
      clear_from_root<NoWorkspace>(bvh, pieces, 1, spared, [&](Index n, NoWorkspace&) {
        return passes_dual_cone_test(cones.normals(n), cones.border_binormals(n));
      });
      break;
    case CullingMethod::kDualConeInternal:
      clear_from_root<NoWorkspace>(bvh, pieces, 1, spared, [&](Index n, NoWorkspace&) {
        return bvh.nodes()[n].children[0] < 0 && passes_dual_cone_test(cones.normals(n), cones.border_binormals(n)) &&
               passes_dual_cone_test(cones.normals(n), inner_binormals(pieces, cones, n));
      });
      break;
    case CullingMethod::kEnhancedDualConePublished:
      spare_as_published<kSteps>(options.simple_traversal, bvh, pieces, cones, poses, spared);
      break;
    default: {
      test.place(pieces, poses);
      const ContourTest contour =
          method == CullingMethod::kNormalCone ? ContourTest::kAllEdges : ContourTest::kMonotoneRuns;
      clear_from_root<typename PlanarEmbeddingTest<kSteps>::Workspace>(
          bvh, pieces, 1, spared, [&](Index n, typename PlanarEmbeddingTest<kSteps>::Workspace& workspace) {
            if (bvh.nodes()[n].children[0] >= 0) return false;  // no less to ask than to compare
            // The cone says where to look, and the test makes sure: cones are rounded.
            if (!(cones.normals(n).angle < std::numbers::pi / 2)) return false;
            const ProjectionPlane plane = plane_across(cones.normals(n).axis);
            return test.do_triangles_face(n, plane) && test.is_contour_embedded(n, plane, workspace, contour);
          });
    }
  }
  return spared;
}

template CulledPairs cull_self_pairs<1>(const SelfCollisionOptions&, const Bvh&, SurfacePieces&,
                                        const PlanarEmbeddingTest<1>::Poses&, PlanarEmbeddingTest<1>&,
                                        std::span<const MovingRow>, bool);
template CulledPairs cull_self_pairs<2>(const SelfCollisionOptions&, const Bvh&, SurfacePieces&,
                                        const PlanarEmbeddingTest<2>::Poses&, PlanarEmbeddingTest<2>&,
                                        std::span<const MovingRow>, bool);

}  // namespace selvage
