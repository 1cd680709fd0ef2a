#pragma once

#include "self_collision/culling/planar_embedding.h"
#include "self_collision/surfaces.h"
#include "selvage/self_collision/self_collision.h"

#include <gtest/gtest.h>

namespace selvage {

using Pairs = std::vector<TrianglePair>;

inline SelfCollisionOptions by(CullingMethod method, bool adjacent = false) {
  SelfCollisionOptions options;
  options.method = method;
  options.include_adjacent = adjacent;
  return options;
}

inline Pairs pairs_by(CullingMethod method, const surfaces::Surface& surface, bool adjacent = false,
                      SelfCollisionCounters* counters = nullptr) {
  const TriangleMesh mesh = surface.mesh();
  return SelfCollisionFinder(mesh, surface.positions, by(method, adjacent)).find_pairs(counters);
}

/// Methods that miss nothing.
inline constexpr CullingMethod kAccurate[] = {CullingMethod::kNormalCone, CullingMethod::kEnhancedDualCone,
                                              CullingMethod::kAuto};

inline void expect_methods_agree(const surfaces::Surface& surface) {
  for (const bool adjacent : {false, true}) {
    const Pairs expected = pairs_by(CullingMethod::kBvh, surface, adjacent);
    for (const CullingMethod method : kAccurate)
      ASSERT_EQ(pairs_by(method, surface, adjacent), expected)
          << culling_method_names()[static_cast<int>(method)] << (adjacent ? " adjacent" : "");
  }
}

/// Per triangle its place in the order of the leaves.
inline std::vector<Index> places(const Bvh& bvh) {
  const std::vector<Index> order = bvh.leaf_order();
  std::vector<Index> place(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) place[order[i]] = static_cast<Index>(i);
  return place;
}

/// A surface with its hierarchy and all that is known of its pieces.
struct PreparedSurface {
  explicit PreparedSurface(const surfaces::Surface& surface) : mesh(surface.mesh()), positions(surface.positions) {
    std::vector<Box> boxes;
    for (const VertexTuple<3>& t : mesh.triangles())
      boxes.push_back(bounding_box<3>(std::array<Vec3, 3>{positions[t[0]], positions[t[1]], positions[t[2]]}));
    bvh = Bvh(boxes);
    pieces = SurfacePieces(mesh, bvh);
    embedding.place(pieces, {positions});
  }
  PreparedSurface(const PreparedSurface&) = delete;

  const SurfacePieces::Contours& contours(Index node) { return pieces.contours(node, workspace.waiting); }

  TriangleMesh mesh;
  std::vector<Vec3> positions;
  Bvh bvh;
  SurfacePieces pieces;
  PlanarEmbeddingTest<1> embedding;
  PlanarEmbeddingTest<1>::Workspace workspace;
};

}  // namespace selvage
