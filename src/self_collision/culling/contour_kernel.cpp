#include "self_collision/culling/contour_kernel.h"

#include "self_collision/surface/motion_filter.h"

#include <limits>

namespace selvage {
inline namespace SELVAGE_ISA {

namespace {

constexpr int kWidth = EdgeBlock::kWidth;

/// Bounds the error of a dot or cross product of two differences of coordinates, divided by the sum of the factors'
/// absolute components. Coordinates are below 1 and off by 2^-25, so a difference is off by less than 2^-22, and the
/// product by less than 2^-21 of that sum; the rest is for what is below the products of the errors.
constexpr float kSlack = 1.0f / (1 << 19);

SELVAGE_INLINE Float8 wide(float x) {
  return Float8::broadcast(x);
}
SELVAGE_INLINE unsigned less(Float8 a, Float8 b) {
  return ~less_equal(b, a) & less_equal(a, b);
}

using WideVec2 = LaneVec2<Float8>;

/// Vectors that move linearly: one at each end of the step.
template <int kSteps>
struct Moving8 {
  WideVec2 at[kSteps];
};
template <int kSteps>
SELVAGE_INLINE Moving8<kSteps> operator-(const Moving8<kSteps>& a, const Moving8<kSteps>& b) {
  Moving8<kSteps> difference;
  for (int s = 0; s < kSteps; ++s) difference.at[s] = a.at[s] - b.at[s];
  return difference;
}
template <int kSteps>
SELVAGE_INLINE Float8 length(const Moving8<kSteps>& a) {
  Float8 longest = abs_sum(a.at[0]);
  for (int s = 1; s < kSteps; ++s) longest = max(longest, abs_sum(a.at[s]));
  return longest;
}

/// Bounds of a product of two moving vectors: the smallest and the largest of its coefficients in Bernstein form.
struct Bounds8 {
  Float8 lower;
  Float8 upper;
};
template <int kSteps, typename Product>
SELVAGE_INLINE Bounds8 bound_product(const Moving8<kSteps>& a, const Moving8<kSteps>& b, Product&& product) {
  const Float8 first = product(a.at[0], b.at[0]);
  if constexpr (kSteps == 1) {
    return {first, first};
  } else {
    const Float8 last = product(a.at[1], b.at[1]);
    const Float8 middle = (product(a.at[0], b.at[1]) + product(a.at[1], b.at[0])) * wide(0.5f);
    return {min(min(first, last), middle), max(max(first, last), middle)};
  }
}
template <int kSteps>
SELVAGE_INLINE Bounds8 bound_cross(const Moving8<kSteps>& a, const Moving8<kSteps>& b) {
  return bound_product(a, b, [](const WideVec2& p, const WideVec2& q) { return cross(p, q); });
}
template <int kSteps>
SELVAGE_INLINE Bounds8 bound_dot(const Moving8<kSteps>& a, const Moving8<kSteps>& b) {
  return bound_product(a, b, [](const WideVec2& p, const WideVec2& q) { return dot(p, q); });
}

/// Eight consecutive vertices, from a place on.
template <int kSteps>
SELVAGE_INLINE Moving8<kSteps> load(const PlanarLoops<kSteps>& loops, Index place) {
  Moving8<kSteps> points;
  for (int s = 0; s < kSteps; ++s)
    points.at[s] = {{Float8::load(loops.coordinates[s][0] + place), Float8::load(loops.coordinates[s][1] + place)}};
  return points;
}
template <int kSteps>
SELVAGE_INLINE Moving8<kSteps> broadcast(const PlanarLoops<kSteps>& loops, Index place) {
  Moving8<kSteps> point;
  for (int s = 0; s < kSteps; ++s)
    point.at[s] = {{wide(loops.coordinates[s][0][place]), wide(loops.coordinates[s][1][place])}};
  return point;
}

/// Lanes whose points `a` and `b`, seen from the tail of `edge`, are certainly on one side of its line all the time.
template <int kSteps>
SELVAGE_INLINE unsigned on_one_side(const Moving8<kSteps>& edge, const Moving8<kSteps>& a, const Moving8<kSteps>& b) {
  const Bounds8 side_a = bound_cross(edge, a), side_b = bound_cross(edge, b);
  const Float8 margin = (length(edge) + max(length(a), length(b))) * wide(kSlack);
  return less(margin, min(side_a.lower, side_b.lower)) | less(max(side_a.upper, side_b.upper), negate(margin));
}

/// The boxes that edges sweep.
struct Boxes8 {
  Float8 lower[2];
  Float8 upper[2];
};
template <int kSteps>
SELVAGE_INLINE Boxes8 sweep_boxes(const Moving8<kSteps>& tail, const Moving8<kSteps>& head) {
  Boxes8 boxes{{min(tail.at[0][0], head.at[0][0]), min(tail.at[0][1], head.at[0][1])},
               {max(tail.at[0][0], head.at[0][0]), max(tail.at[0][1], head.at[0][1])}};
  for (int s = 1; s < kSteps; ++s) {
    boxes.lower[0] = min(boxes.lower[0], min(tail.at[s][0], head.at[s][0]));
    boxes.lower[1] = min(boxes.lower[1], min(tail.at[s][1], head.at[s][1]));
    boxes.upper[0] = max(boxes.upper[0], max(tail.at[s][0], head.at[s][0]));
    boxes.upper[1] = max(boxes.upper[1], max(tail.at[s][1], head.at[s][1]));
  }
  return boxes;
}
SELVAGE_INLINE unsigned are_boxes_apart(const Boxes8& a, const Boxes8& b) {
  const Float8 margin = wide(kSlack);
  return less(a.upper[0] + margin, b.lower[0]) | less(b.upper[0] + margin, a.lower[0]) |
         less(a.upper[1] + margin, b.lower[1]) | less(b.upper[1] + margin, a.lower[1]);
}

/// The edges of a block.
template <int kSteps>
struct Edges8 {
  Moving8<kSteps> tail;
  Moving8<kSteps> head;
  Boxes8 boxes;
  unsigned present;

  SELVAGE_INLINE Edges8(const PlanarLoops<kSteps>& loops, const EdgeBlock& block)
      : tail(load(loops, block.first)),
        head(load(loops, block.first + 1)),
        boxes(sweep_boxes(tail, head)),
        present((1u << block.count) - 1) {}
};

/// Whether an edge and the one that follows it, by the places of their tails, certainly meet in their common vertex
/// only.
template <int kSteps>
SELVAGE_INLINE bool turns_freely(const PlanarLoops<kSteps>& loops, Index before, Index after) {
  const Moving8<kSteps> in = broadcast(loops, before + 1) - broadcast(loops, before);
  const Moving8<kSteps> out = broadcast(loops, after + 1) - broadcast(loops, after);
  const Bounds8 turn = bound_cross(in, out), forward = bound_dot(in, out);
  const Float8 margin = (length(in) + length(out)) * wide(kSlack);
  return ((less(margin, turn.lower) | less(turn.upper, negate(margin)) | less(margin, forward.lower)) & 1u) != 0;
}

/// Whether two edges that may touch certainly do so only where one follows the other.
template <int kSteps>
SELVAGE_INLINE bool follow_freely(const PlanarLoops<kSteps>& loops, Index p, Index q) {
  const Index* const v = loops.vertices;
  const bool p_then_q = v[p + 1] == v[q], q_then_p = v[q + 1] == v[p];
  if (p_then_q == q_then_p || v[p] == v[q] || v[p + 1] == v[q + 1]) return false;
  return p_then_q ? turns_freely(loops, p, q) : turns_freely(loops, q, p);
}

/// Whether edges of one block certainly meet those of another, or each other, only where one follows the other.
template <int kSteps>
SELVAGE_INLINE bool are_apart(const PlanarLoops<kSteps>& loops, const EdgeBlock& p, const EdgeBlock& q) {
  const bool same = &p == &q;
  const Edges8<kSteps> own(loops, p), others(loops, q);
  const Boxes8 around_q{{wide(q.lower[0]), wide(q.lower[1])}, {wide(q.upper[0]), wide(q.upper[1])}};
  for (unsigned near = own.present & ~are_boxes_apart(own.boxes, around_q); near != 0; near &= near - 1) {
    const int i = lowest_lane(near);
    const Moving8<kSteps> tail = broadcast(loops, p.first + i), head = broadcast(loops, p.first + i + 1);
    const unsigned apart = are_boxes_apart(sweep_boxes(tail, head), others.boxes) |
                           on_one_side(head - tail, others.tail - tail, others.head - tail) |
                           on_one_side(others.head - others.tail, tail - others.tail, head - others.tail);
    const unsigned wanted = same ? others.present & (~0u << (i + 1)) : others.present;
    for (unsigned rest = wanted & ~apart; rest != 0; rest &= rest - 1)
      if (!follow_freely(loops, p.first + i, q.first + lowest_lane(rest))) return false;
  }
  return true;
}

/// Whether all edges of a block certainly have a positive dot product with a direction all the time: then the block is
/// a chain that meets itself nowhere.
template <int kSteps>
SELVAGE_INLINE bool does_advance(const Edges8<kSteps>& edges, const WideVec2& direction) {
  const Float8 margin = abs_sum(direction) * wide(kSlack);
  unsigned advancing = edges.present;
  for (int s = 0; s < kSteps; ++s) advancing &= less(margin, dot(edges.head.at[s] - edges.tail.at[s], direction));
  return advancing == edges.present;
}

/// Whether a block, or two that follow one another, certainly advance along one direction: the chord, or one to its
/// side, for contours are often saws.
template <int kSteps>
SELVAGE_INLINE bool is_monotone(const PlanarLoops<kSteps>& loops, const EdgeBlock& first, const EdgeBlock& last) {
  constexpr float kSides[] = {0, 0.5f, -0.5f};
  const WideVec2 chord = (broadcast(loops, last.first + last.count) - broadcast(loops, first.first)).at[0];
  const Edges8<kSteps> head_edges(loops, first), tail_edges(loops, last);
  for (const float side : kSides) {
    const WideVec2 direction{{chord[0] - chord[1] * wide(side), chord[1] + chord[0] * wide(side)}};
    if (does_advance(head_edges, direction) && does_advance(tail_edges, direction)) return true;
  }
  return false;
}

SELVAGE_INLINE bool are_block_boxes_apart(const EdgeBlock& p, const EdgeBlock& q) {
  return p.upper[0] + kSlack < q.lower[0] || q.upper[0] + kSlack < p.lower[0] || p.upper[1] + kSlack < q.lower[1] ||
         q.upper[1] + kSlack < p.lower[1];
}

template <int kSteps>
SELVAGE_INLINE bool is_simple(const PlanarLoops<kSteps>& loops, ContourTest test) {
  const bool use_runs = test == ContourTest::kMonotoneRuns;
  for (std::size_t i = 0; i < loops.blocks.size(); ++i) {
    const EdgeBlock& block = loops.blocks[i];
    if (!(use_runs && is_monotone(loops, block, block)) && !are_apart(loops, block, block)) return false;
    for (std::size_t j = i + 1; j < loops.blocks.size(); ++j) {
      const EdgeBlock& other = loops.blocks[j];
      if (are_block_boxes_apart(block, other)) continue;
      if (use_runs && j == i + 1 && block.continues && is_monotone(loops, block, other)) continue;
      if (!are_apart(loops, block, other)) return false;
    }
  }
  return true;
}

template <int kSteps>
SELVAGE_INLINE void fit(const PlanarLoops<kSteps>& loops) {
  const auto smaller_half = [](Float8 a) { return min(a.low(), a.high()); };
  for (EdgeBlock& block : loops.blocks) {
    const Boxes8 boxes = Edges8<kSteps>(loops, block).boxes;
    float bounds[4];
    reduce_min(smaller_half(boxes.lower[0]), smaller_half(boxes.lower[1]), smaller_half(negate(boxes.upper[0])),
               smaller_half(negate(boxes.upper[1])))
        .store(bounds);
    for (int axis = 0; axis < 2; ++axis) {
      block.lower[axis] = bounds[axis];
      block.upper[axis] = -bounds[2 + axis];
    }
  }
}

}  // namespace

void measure_moving_areas(const MovingVertex* positions, const VertexTuple<3>* triangles, Index first, Index last,
                          const MovingAreaRows& areas) {
  constexpr Index kAhead = 2 * kWidth;
  const auto size = [](const WideVec3& a) { return abs_sum(a); };
  const auto size_of_both = [&](const MovingCorner& a) { return max(size(a.start), size(a.end)); };
  Float8 sums[3] = {wide(0), wide(0), wide(0)};
  for (Index place = first; place < last; place += kWidth) {
    Index vertices[3][kWidth];
    for (int lane = 0; lane < kWidth; ++lane) {
      const Index t = place + lane < last ? place + lane : last - 1;
      for (int k = 0; k < 3; ++k) vertices[k][lane] = triangles[t][k];
    }
    if (place + kAhead + kWidth <= last)
      for (int lane = 0; lane < kWidth; ++lane)
        for (const Index vertex : triangles[place + kAhead + lane]) prefetch(positions + vertex);
    const MovingCorner origin = gather_moving(positions, vertices[0]);
    const MovingCorner e = gather_moving(positions, vertices[1]) - origin;
    const MovingCorner f = gather_moving(positions, vertices[2]) - origin;
    const WideVec3 a = cross(e.start, f.end), b = cross(e.end, f.start);
    const Float8 half = wide(0.5f);
    const WideVec3 coefficients[3] = {cross(e.start, f.start), half * (a + b), cross(e.end, f.end)};
    // Each component of an edge is off by two roundings of positions and its own, and each product by both of its
    // factors' errors: summed over the components of the cross product, twice the one edge's for each unit of the
    // other's size, and six times the product of both. The rest is what products and sums round off, here and in a dot
    // product.
    const Float8 size_e = size_of_both(e), size_f = size_of_both(f);
    const Float8 error = (size_e + size_f) * wide(4.1f * kBoxRounding) + size_e * size_f * wide(0x1p-20f) +
                         wide(32 * kBoxRounding * kBoxRounding);
    error.store(areas.errors + place);
    const int present = last - place < kWidth ? last - place : kWidth;
    for (int k = 0; k < 3; ++k) {
      for (int c = 0; c < 3; ++c) coefficients[c][k].store(areas.rows[c][k] + place);
      sums[k] = sums[k] + keep_first(coefficients[0][k] + coefficients[2][k], present);
    }
    if ((place + kWidth) % kAreaGroup != 0 && place + kWidth < last) continue;
    for (int k = 0; k < 3; ++k) {
      float lanes[kWidth];
      sums[k].store(lanes);
      double sum = 0;
      for (const float lane : lanes) sum += lane;
      areas.group_sums[place / kAreaGroup].data()[k] = sum;
      sums[k] = wide(0);
    }
  }
}

void mark_contour(const Index* opposite, Index first, Index last, char* marks) {
  const auto count = static_cast<std::uint32_t>(last - first);
  for (std::uint32_t i = 0; i < count; ++i)  // kNone is outside, too
    marks[i] = static_cast<char>(static_cast<std::uint32_t>(opposite[first + i] - first) >= count);
}

bool do_all_face(const AreaVectors& areas, std::size_t first, std::size_t last, const ProjectionPlane& plane) {
  // Below it products of floats lose bits.
  const Float8 smallest = wide(std::numeric_limits<float>::min() * (1 << 24));
  for (std::size_t i = first; i < last; i += kWidth) {
    Float8 facing = negate(Float8::load(areas.rows[3] + i));
    for (int axis = 0; axis < 3; ++axis)
      facing = facing + Float8::load(areas.rows[axis] + i) * wide(plane.normal[axis]);
    const unsigned present = last - i < kWidth ? (1u << (last - i)) - 1 : 0xffu;
    if ((less_equal(smallest, facing) & present) != present) return false;
  }
  return true;
}

void fit_blocks(const PlanarLoops<1>& loops) {
  fit(loops);
}
void fit_blocks(const PlanarLoops<2>& loops) {
  fit(loops);
}
bool is_contour_simple(const PlanarLoops<1>& loops, ContourTest test) {
  return is_simple(loops, test);
}
bool is_contour_simple(const PlanarLoops<2>& loops, ContourTest test) {
  return is_simple(loops, test);
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
