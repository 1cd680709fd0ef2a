#include "boundary_path/containment_kernel.h"

#include "boundary_path/segment.h"
#include "selvage/bvh/traverse.h"
#include "selvage/geometry/predicates.h"

namespace selvage {
inline namespace SELVAGE_ISA {

namespace {

/// Eight pairs of a point and an element whose box holds it, waiting to be looked at together.
///
/// First in single precision, with a bound of all rounding, which rejects nearly every element that does not hold the
/// point; what is left is decided exactly.
template <int D>
class PairFilter {
 public:
  PairFilter(const ContainmentScene<D>& scene, const PointBatch<D>& batch, std::vector<PointInElement>& found)
      : scene_(scene), batch_(batch), found_(found) {}

  /// `point` is the place in the batch.
  void add(Index point, Index element) {
    for (int k = 0; k <= D; ++k) {
      const auto& x = scene_.rounded[scene_.elements[element][k]];
      for (int i = 0; i < D; ++i) corners_[k][i][count_] = x[i];
    }
    for (int i = 0; i < D; ++i)
      point_[i][count_] = static_cast<float>(batch_.points[point][i] - scene_.frame.origin[i]);
    pairs_[count_++] = {point, element};
    if (count_ == kSize) flush();
  }

  void flush() {
    for (unsigned rest = may_hold() & ((1u << count_) - 1); rest != 0; rest &= rest - 1) {
      const auto [point, element] = pairs_[lowest_lane(rest)];
      std::array<Vec<D>, D + 1> corners;
      for (int k = 0; k <= D; ++k) corners[k] = scene_.positions[scene_.elements[element][k]];
      if (locate_in_simplex<D>(corners, batch_.points[point]).inside)
        append_found(found_, {batch_.ids[point], element});
    }
    count_ = 0;
  }

 private:
  static constexpr int kSize = 8;
  using Lanes = Float8;

  static Lanes negative(Lanes a) { return Lanes::broadcast(0) - a; }
  static Lanes magnitude(Lanes a) { return max(a, negative(a)); }

  /// Signed volumes (times D!) of the element's parts: entry k with vertex k replaced by the point.
  static void split(const Lanes (&c)[3][2], Lanes (&part)[3]) {
    const auto det = [](const Lanes* a, const Lanes* b) { return a[0] * b[1] - a[1] * b[0]; };
    part[0] = det(c[1], c[2]);
    part[1] = det(c[2], c[0]);
    part[2] = det(c[0], c[1]);
  }
  static void split(const Lanes (&c)[4][3], Lanes (&part)[4]) {
    const auto cross = [](const Lanes* a, const Lanes* b, Lanes* r) {
      r[0] = a[1] * b[2] - a[2] * b[1];
      r[1] = a[2] * b[0] - a[0] * b[2];
      r[2] = a[0] * b[1] - a[1] * b[0];
    };
    const auto dot = [](const Lanes* a, const Lanes* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
    Lanes ab[3], cd[3];
    cross(c[0], c[1], ab);
    cross(c[2], c[3], cd);
    part[0] = dot(cd, c[1]);
    part[1] = negative(dot(cd, c[0]));
    part[2] = dot(ab, c[3]);
    part[3] = negative(dot(ab, c[2]));
  }

  /// Which of the pairs cannot be ruled out.
  unsigned may_hold() const {
    Lanes c[D + 1][D], part[D + 1];
    Lanes reach = Lanes::broadcast(0);
    for (int k = 0; k <= D; ++k) {
      for (int i = 0; i < D; ++i) {
        c[k][i] = Lanes::load(corners_[k][i]) - Lanes::load(point_[i]);
        reach = max(reach, magnitude(c[k][i]));
      }
    }
    split(c, part);
    Lanes least = part[0], greatest = part[0], total = part[0];
    for (int k = 1; k <= D; ++k) {
      least = min(least, part[k]);
      greatest = max(greatest, part[k]);
      total = total + part[k];
    }
    // Each coordinate is off by three roundings: two positions, one difference. A part is a sum of D! products of D
    // coordinates, each product off by D (three roundings) reach^(D-1), and by as many floating-point roundings.
    const Lanes error = Lanes::broadcast(3 * scene_.rounding) + reach * Lanes::broadcast(0x1p-22f);
    Lanes bound = error * reach * Lanes::broadcast(32);
    if (D == 3) bound = bound * reach;
    bound = bound + Lanes::broadcast(1e-35f);
    const Lanes four = Lanes::broadcast(4) * bound;
    const unsigned outside_positive = less_equal(least, negative(bound)) & less_equal(four, total);
    const unsigned outside_negative = less_equal(bound, greatest) & less_equal(total, negative(four));
    return ~(outside_positive | outside_negative);
  }

  const ContainmentScene<D>& scene_;
  const PointBatch<D>& batch_;
  std::vector<PointInElement>& found_;
  alignas(32) float corners_[D + 1][D][kSize]{};
  alignas(32) float point_[D][kSize]{};
  struct {
    Index point, element;
  } pairs_[kSize];
  int count_ = 0;
};

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
  PairFilter<D> filter(scene, batch, found);
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
          filter.add(i, child);
        }
      }
    }
  }
  filter.flush();
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
