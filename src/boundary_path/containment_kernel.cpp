#include "boundary_path/containment_kernel.h"

#include "boundary_path/segment.h"
#include "selvage/bvh/traverse.h"
#include "selvage/geometry/predicates.h"

namespace selvage {
inline namespace SELVAGE_ISA {

namespace {

double det(const double* a, const double* b) {
  return a[0] * b[1] - a[1] * b[0];
}

struct Cross {
  double x, y, z;
  Cross(const double* a, const double* b)
      : x(a[1] * b[2] - a[2] * b[1]), y(a[2] * b[0] - a[0] * b[2]), z(a[0] * b[1] - a[1] * b[0]) {}
  double dot(const double* c) const { return x * c[0] + y * c[1] + z * c[2]; }
};

/// 1 when p is certainly strictly inside a positive simplex, -1 when it is certainly outside, 0 when rounding leaves a
/// doubt. `corner` holds the vertices relative to p.
int filter_inside(const double (&corner)[3][2], double reach) {
  const double bound = 16 * kUnitRoundoff * reach * reach + kTrustAbove;
  const double a = det(corner[1], corner[2]), b = det(corner[2], corner[0]), c = det(corner[0], corner[1]);
  const double least = std::min(std::min(a, b), c);
  return least < -bound ? -1 : least > bound ? 1 : 0;
}

int filter_inside(const double (&corner)[4][3], double reach) {
  const double bound = 64 * kUnitRoundoff * reach * reach * reach + kTrustAbove;
  const Cross cd(corner[2], corner[3]);
  const double first = std::min(cd.dot(corner[1]), -cd.dot(corner[0]));
  if (first < -bound) return -1;
  const Cross ab(corner[0], corner[1]);
  const double least = std::min(first, std::min(ab.dot(corner[3]), -ab.dot(corner[2])));
  return least < -bound ? -1 : least > bound ? 1 : 0;
}

template <int D>
bool holds(const ContainmentScene<D>& scene, const VertexTuple<D + 1>& vertices, const Vec<D>& p) {
  if (scene.all_positive) {
    double corner[D + 1][D];
    double reach = 0;
    for (int k = 0; k <= D; ++k) {
      for (int i = 0; i < D; ++i) {
        corner[k][i] = scene.positions[vertices[k]][i] - p[i];
        reach = std::max(reach, std::abs(corner[k][i]));
      }
    }
    const int sure = filter_inside(corner, reach);
    if (sure != 0) return sure > 0;
  }
  std::array<Vec<D>, D + 1> corners;
  for (int k = 0; k <= D; ++k) corners[k] = scene.positions[vertices[k]];
  return locate_in_simplex<D>(corners, p).inside;
}

/// Boxes of up to eight points that lie near each other, which walk down the hierarchy together.
struct PointGroup {
  static constexpr Index kSize = 8;
  float lower[3][kSize];
  float upper[3][kSize];
  Box around = Box::empty();

  template <int D>
  PointGroup(const BoxFrame<D>& frame, const Vec<D>* points, Index count) {
    for (Index i = 0; i < kSize; ++i) {
      const Box box = i < count ? frame.around_point(points[i]) : Box::empty();
      for (int axis = 0; axis < 3; ++axis) {
        lower[axis][i] = box.lower[axis];
        upper[axis][i] = box.upper[axis];
      }
      around.merge(box);
    }
  }

  /// Which of the points may lie in one child's box of a node.
  unsigned in_child(const BvhNode& node, int child) const {
    unsigned mask = 0xff;
    for (int axis = 0; axis < 3; ++axis) {
      mask &= less_equal(Float8::load(lower[axis]), Float8::broadcast(node.upper[axis][child]));
      mask &= less_equal(Float8::broadcast(node.lower[axis][child]), Float8::load(upper[axis]));
    }
    return mask;
  }
};

template <int D>
void find_all(const ContainmentScene<D>& scene, const PointBatch<D>& batch, std::vector<PointInElement>& found) {
  if (scene.element_nodes.empty()) return;
  Index stack[traversal::kStackSize];
  for (Index first = 0; first < batch.count; first += PointGroup::kSize) {
    const PointGroup group(scene.frame, batch.points + first, std::min(PointGroup::kSize, batch.count - first));
    const traversal::WideBox around(group.around);
    stack[0] = 0;
    for (int top = 1; top > 0;) {
      const BvhNode& node = scene.element_nodes[stack[--top]];
      for (unsigned rest = traversal::overlapping_children(node, around); rest != 0; rest &= rest - 1) {
        const int lane = lowest_lane(rest);
        const Index child = node.children[lane];
        unsigned points = group.in_child(node, lane);
        if (points == 0) continue;
        if (child < 0) {
          stack[top++] = ~child;
          traversal::prefetch_node(scene.element_nodes[~child]);
          continue;
        }
        const auto& vertices = scene.elements[child];
        for (; points != 0; points &= points - 1) {
          const Index i = first + lowest_lane(points);
          if (batch.skip_own && contains(vertices, batch.ids[i])) continue;
          if (holds(scene, vertices, batch.points[i])) append_found(found, {batch.ids[i], child});
        }
      }
    }
  }
}

}  // namespace

void find_containing(const ContainmentScene<2>& scene, const PointBatch<2>& batch, std::vector<PointInElement>& found) {
  find_all(scene, batch, found);
}

void find_containing(const ContainmentScene<3>& scene, const PointBatch<3>& batch, std::vector<PointInElement>& found) {
  find_all(scene, batch, found);
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
