#include "self_collision/culling/enhanced_dual_cone.h"

#include "self_collision/culling/dual_cone.h"
#include "self_collision/culling/normal_cone.h"

#include <algorithm>
#include <numbers>

namespace selvage {

namespace {

struct PlaneEdge {
  Index tail_vertex, head_vertex;
  std::array<Vec2, 2> tail, head;  ///< at both ends of a step, or twice the same
  Vec2 lower, upper;
};

double cross(const Vec2& a, const Vec2& b) {
  return a[0] * b[1] - a[1] * b[0];
}

/// Whether both points stay on one side of a moving line, by the coefficients in Bernstein form (the continuous contour
/// test of Tang and others 2009).
bool stay_on_one_side(const PlaneEdge& line, const std::array<Vec2, 2>& p, const std::array<Vec2, 2>& q) {
  double lowest = HUGE_VAL, highest = -HUGE_VAL;
  for (const auto* point : {&p, &q}) {
    const Vec2 e0 = line.head[0] - line.tail[0], e1 = line.head[1] - line.tail[1];
    const Vec2 w0 = (*point)[0] - line.tail[0], w1 = (*point)[1] - line.tail[1];
    for (const double side : {cross(e0, w0), (cross(e0, w1) + cross(e1, w0)) / 2, cross(e1, w1)}) {
      lowest = std::min(lowest, side);
      highest = std::max(highest, side);
    }
  }
  return lowest > 0 || highest < 0;
}

bool may_meet(const PlaneEdge& a, const PlaneEdge& b) {
  if (a.tail_vertex == b.tail_vertex || a.tail_vertex == b.head_vertex || a.head_vertex == b.tail_vertex ||
      a.head_vertex == b.head_vertex)
    return false;
  for (int axis = 0; axis < 2; ++axis)
    if (a.upper[axis] < b.lower[axis] || b.upper[axis] < a.lower[axis]) return false;
  return !stay_on_one_side(a, b.tail, b.head) && !stay_on_one_side(b, a.tail, a.head);
}

/// EDC's boundary edge subset C_i: the contour edges of a node that belong to one sub-surface, projected; their BNC,
/// and the box around them.
struct BoundaryEdges {
  std::vector<PlaneEdge> edges;
  DirectionCone binormals;
  Vec2 lower = Vec2::Constant(HUGE_VAL), upper = Vec2::Constant(-HUGE_VAL);

  void add(const PlaneEdge& edge) {
    edges.push_back(edge);
    lower = lower.cwiseMin(edge.lower);
    upper = upper.cwiseMax(edge.upper);
  }
};

/// EDC's ContourOverlapTest.
bool are_apart(const BoundaryEdges& a, const BoundaryEdges& b) {
  for (int axis = 0; axis < 2; ++axis)
    if (a.upper[axis] < b.lower[axis] || b.upper[axis] < a.lower[axis]) return true;
  return std::none_of(a.edges.begin(), a.edges.end(), [&](const PlaneEdge& edge) {
    return std::any_of(b.edges.begin(), b.edges.end(), [&](const PlaneEdge& other) { return may_meet(edge, other); });
  });
}

/// The contour of a node, cut into the subsets of its children.
template <int kSteps>
std::array<BoundaryEdges, BvhNode::kWidth> split_contour(const Bvh& bvh, SurfacePieces& pieces,
                                                         const SurfaceCones<kSteps>& cones,
                                                         const std::array<std::span<const Vec3>, kSteps>& poses,
                                                         Index node, const ProjectionPlane& plane) {
  const auto project = [&](const Vec3& p) {
    return Vec2(p[0] * plane.u_axis[0] + p[1] * plane.u_axis[1] + p[2] * plane.u_axis[2],
                p[0] * plane.v_axis[0] + p[1] * plane.v_axis[1] + p[2] * plane.v_axis[2]);
  };
  std::array<BoundaryEdges, BvhNode::kWidth> subsets;
  std::vector<char> workspace;
  for (const Index edge : pieces.contours(node, workspace).edges) {
    PlaneEdge projected{pieces.tail(edge), pieces.head(edge), {}, {}, {}, {}};
    for (int s = 0; s < 2; ++s) {
      projected.tail[s] = project(poses[s % kSteps][projected.tail_vertex]);
      projected.head[s] = project(poses[s % kSteps][projected.head_vertex]);
    }
    projected.lower =
        projected.tail[0].cwiseMin(projected.head[0]).cwiseMin(projected.tail[1].cwiseMin(projected.head[1]));
    projected.upper =
        projected.tail[0].cwiseMax(projected.head[0]).cwiseMax(projected.tail[1].cwiseMax(projected.head[1]));
    BoundaryEdges& subset = subsets[pieces.child_at(bvh.nodes(), node, edge / 3)];
    subset.add(projected);
    subset.binormals.merge(cones.binormals(edge));
  }
  return subsets;
}

}  // namespace

bool EnhancedDualConeResult::all_pass(int child_count) const {
  const unsigned all = (1u << child_count) - 1;
  bool pass = passes_normal_test && passes_alone == all;
  for (int i = 0; i < child_count; ++i) pass = pass && (apart[i] | 1u << i) == all;
  return pass;
}

template <int kSteps>
EnhancedDualConeResult test_enhanced_dual_cone(const Bvh& bvh, SurfacePieces& pieces, const SurfaceCones<kSteps>& cones,
                                               const std::array<std::span<const Vec3>, kSteps>& poses, Index node) {
  EnhancedDualConeResult result;
  const DirectionCone& normals = cones.normals(node);
  if (!(normals.angle < std::numbers::pi / 2)) return result;
  result.passes_normal_test = true;
  const auto subsets = split_contour<kSteps>(bvh, pieces, cones, poses, node, plane_across(normals.axis));
  const BvhNode& parent = bvh.nodes()[node];
  for (int i = 0; i < parent.child_count; ++i) {
    const DirectionCone own = parent.children[i] < 0
                                  ? cones.normals(~parent.children[i])
                                  : cones.triangle_normals(pieces.ranges()[node].last - parent.child_count + i);
    if (passes_dual_cone_test(own, subsets[i].binormals)) result.passes_alone |= static_cast<std::uint8_t>(1u << i);
    for (int k = i + 1; k < parent.child_count; ++k) {
      if (!are_apart(subsets[i], subsets[k])) continue;
      result.apart[i] |= static_cast<std::uint8_t>(1u << k);
      result.apart[k] |= static_cast<std::uint8_t>(1u << i);
    }
  }
  return result;
}

template <int kSteps>
CulledPairs cull_by_enhanced_dual_cones_as_published(bool simple_traversal, const Bvh& bvh, SurfacePieces& pieces,
                                                     const typename SurfaceCones<kSteps>::Poses& poses) {
  const SurfaceCones<kSteps> cones(bvh, pieces, poses);
  const auto nodes = bvh.nodes();
  CulledPairs culled;
  if (!simple_traversal) culled.siblings.assign(nodes.size(), 0);
  std::vector<std::uint8_t> passed(nodes.size(), 0);  // condition 2 in the test of the parent
  cull_from_root<NoWorkspace>(bvh, pieces, 1, culled, [&](Index n, NoWorkspace&) {
    if (passed[n] != 0) return true;
    if (nodes[n].children[0] >= 0) return false;
    const EnhancedDualConeResult result = test_enhanced_dual_cone<kSteps>(bvh, pieces, cones, poses, n);
    if (result.all_pass(nodes[n].child_count)) return true;
    if (simple_traversal) return false;
    for (int i = 0; i < nodes[n].child_count && nodes[n].children[i] < 0; ++i) {
      passed[~nodes[n].children[i]] = static_cast<std::uint8_t>(result.passes_alone >> i & 1);
      culled.siblings[~nodes[n].children[i]] = result.apart[i];
    }
    return false;
  });
  culled.counters.tested_nodes -= std::count(passed.begin(), passed.end(), 1);
  return culled;
}

template <int kSteps>
CulledPairs cull_by_enhanced_dual_cones(const Bvh& bvh, SurfacePieces& pieces,
                                        const typename SurfaceCones<kSteps>::Poses& poses,
                                        PlanarEmbeddingTest<kSteps>& test) {
  return cull_by_normal_cones<kSteps>(ContourTest::kMonotoneRuns, bvh, pieces, poses, test);
}

template EnhancedDualConeResult test_enhanced_dual_cone<1>(const Bvh&, SurfacePieces&, const SurfaceCones<1>&,
                                                           const std::array<std::span<const Vec3>, 1>&, Index);
template EnhancedDualConeResult test_enhanced_dual_cone<2>(const Bvh&, SurfacePieces&, const SurfaceCones<2>&,
                                                           const std::array<std::span<const Vec3>, 2>&, Index);
template CulledPairs cull_by_enhanced_dual_cones_as_published<1>(bool, const Bvh&, SurfacePieces&,
                                                                 const SurfaceCones<1>::Poses&);
template CulledPairs cull_by_enhanced_dual_cones_as_published<2>(bool, const Bvh&, SurfacePieces&,
                                                                 const SurfaceCones<2>::Poses&);
template CulledPairs cull_by_enhanced_dual_cones<1>(const Bvh&, SurfacePieces&, const SurfaceCones<1>::Poses&,
                                                    PlanarEmbeddingTest<1>&);
template CulledPairs cull_by_enhanced_dual_cones<2>(const Bvh&, SurfacePieces&, const SurfaceCones<2>::Poses&,
                                                    PlanarEmbeddingTest<2>&);

}  // namespace selvage
