#include "self_collision/culling/enhanced_dual_cone.h"

#include "self_collision/culling/planar_embedding.h"

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

/// Whether both points stay on one side of a moving line, by the coefficients in Bernstein form.
bool stay_on_one_side(const PlaneEdge& line, const std::array<Vec2, 2>& p, const std::array<Vec2, 2>& q) {
  double least = HUGE_VAL, most = -HUGE_VAL;
  for (const auto* point : {&p, &q}) {
    const Vec2 e0 = line.head[0] - line.tail[0], e1 = line.head[1] - line.tail[1];
    const Vec2 w0 = (*point)[0] - line.tail[0], w1 = (*point)[1] - line.tail[1];
    for (const double side : {cross(e0, w0), (cross(e0, w1) + cross(e1, w0)) / 2, cross(e1, w1)}) {
      least = std::min(least, side);
      most = std::max(most, side);
    }
  }
  return least > 0 || most < 0;
}

bool may_meet(const PlaneEdge& a, const PlaneEdge& b) {
  if (a.tail_vertex == b.tail_vertex || a.tail_vertex == b.head_vertex || a.head_vertex == b.tail_vertex ||
      a.head_vertex == b.head_vertex)
    return false;
  for (int axis = 0; axis < 2; ++axis)
    if (a.upper[axis] < b.lower[axis] || b.upper[axis] < a.lower[axis]) return false;
  return !stay_on_one_side(a, b.tail, b.head) && !stay_on_one_side(b, a.tail, a.head);
}

/// The contour edges of one quarter, projected, and the box around them.
struct ContourShare {
  std::vector<PlaneEdge> edges;
  DirectionCone binormals;
  Vec2 lower = Vec2::Constant(HUGE_VAL), upper = Vec2::Constant(-HUGE_VAL);

  void add(const PlaneEdge& edge) {
    edges.push_back(edge);
    lower = lower.cwiseMin(edge.lower);
    upper = upper.cwiseMax(edge.upper);
  }
};

bool are_apart(const ContourShare& a, const ContourShare& b) {
  for (int axis = 0; axis < 2; ++axis)
    if (a.upper[axis] < b.lower[axis] || b.upper[axis] < a.lower[axis]) return true;
  return std::none_of(a.edges.begin(), a.edges.end(), [&](const PlaneEdge& edge) {
    return std::any_of(b.edges.begin(), b.edges.end(), [&](const PlaneEdge& other) { return may_meet(edge, other); });
  });
}

}  // namespace

bool EnhancedDualConeResult::does_clear(int child_count) const {
  const unsigned all = (1u << child_count) - 1;
  bool clear = normals_pass && alone == all;
  for (int i = 0; i < child_count; ++i) clear = clear && (apart[i] | 1u << i) == all;
  return clear;
}

template <int kSteps>
EnhancedDualConeResult test_enhanced_dual_cone(const Bvh& bvh, SurfacePieces& pieces, const SurfaceCones<kSteps>& cones,
                                               const std::array<std::span<const Vec3>, kSteps>& poses, Index node) {
  EnhancedDualConeResult result;
  const DirectionCone& normals = cones.normals(node);
  if (!(normals.angle < std::numbers::pi / 2)) return result;
  result.normals_pass = true;
  const ProjectionPlane plane = plane_across(normals.axis);
  const auto project = [&](const Vec3& p) {
    return Vec2(p[0] * plane.u_axis[0] + p[1] * plane.u_axis[1] + p[2] * plane.u_axis[2],
                p[0] * plane.v_axis[0] + p[1] * plane.v_axis[1] + p[2] * plane.v_axis[2]);
  };
  std::array<ContourShare, BvhNode::kWidth> shares;
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
    ContourShare& share = shares[pieces.child_at(bvh.nodes(), node, edge / 3)];
    share.add(projected);
    share.binormals.merge(cones.binormals(edge));
  }
  const BvhNode& parent = bvh.nodes()[node];
  for (int i = 0; i < parent.child_count; ++i) {
    const DirectionCone own = parent.children[i] < 0
                                  ? cones.normals(~parent.children[i])
                                  : cones.triangle_normals(pieces.ranges()[node].last - parent.child_count + i);
    if (passes_dual_cone_test(own, shares[i].binormals)) result.alone |= static_cast<std::uint8_t>(1u << i);
    for (int k = i + 1; k < parent.child_count; ++k) {
      if (!are_apart(shares[i], shares[k])) continue;
      result.apart[i] |= static_cast<std::uint8_t>(1u << k);
      result.apart[k] |= static_cast<std::uint8_t>(1u << i);
    }
  }
  return result;
}

template EnhancedDualConeResult test_enhanced_dual_cone<1>(const Bvh&, SurfacePieces&, const SurfaceCones<1>&,
                                                           const std::array<std::span<const Vec3>, 1>&, Index);
template EnhancedDualConeResult test_enhanced_dual_cone<2>(const Bvh&, SurfacePieces&, const SurfaceCones<2>&,
                                                           const std::array<std::span<const Vec3>, 2>&, Index);

}  // namespace selvage
