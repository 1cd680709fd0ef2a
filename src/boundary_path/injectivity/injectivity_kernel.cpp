#include "boundary_path/injectivity/injectivity_kernel.h"

#include "boundary_path/injectivity/parity_rays.h"
#include "core/simd/vec3.h"

#include <bit>

namespace selvage {
inline namespace SELVAGE_ISA {

namespace {

constexpr int kWidth = BvhNode::kWidth;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Where squares and products of three coordinates leave the normal floats, nothing is certain.
constexpr float kTiny = 1e-30f;

Float8 constant(float x) {
  return Float8::broadcast(x);
}

using Vector8 = LaneVec3<Float8>;

/// Eight positions, a row for each coordinate.
template <int D>
SELVAGE_INLINE void gather(const RoundedPositions& positions, const Index* vertices, Float8 (&x)[D]) {
  Float8 rows[4];
  for (int i = 0; i < 4; ++i)
    rows[i] = Float8::join(Float4::load(positions.at[vertices[i]].data()),
                           Float4::load(positions.at[vertices[i + 4]].data()));
  transpose(rows[0], rows[1], rows[2], rows[3]);
  for (int i = 0; i < D; ++i) x[i] = rows[i];
}

/// The boxes of a node's primitives; those of its other children empty.
struct Boxes {
  Float8 lower[3], upper[3];

  template <int D>
  SELVAGE_INLINE void start(const Float8 (&x)[D]) {
    for (int i = 0; i < 3; ++i) lower[i] = upper[i] = i < D ? x[i] : constant(0);
  }
  template <int D>
  SELVAGE_INLINE void add(const Float8 (&x)[D]) {
    for (int i = 0; i < D; ++i) {
      lower[i] = min(lower[i], x[i]);
      upper[i] = max(upper[i], x[i]);
    }
  }
  /// Widened by the error of positions, and by the rounding of that.
  template <int D>
  SELVAGE_INLINE void store(float error, unsigned lanes, BvhNode& node) const {
    const Float8 keep = keep_lanes(constant(std::bit_cast<float>(~0u)), lanes), margin = constant(2 * error);
    const Float8 above = keep_lanes(constant(kInfinity), ~lanes & 0xffu);
    const Float8 below = keep_lanes(constant(-kInfinity), ~lanes & 0xffu);
    for (int i = 0; i < 3; ++i) {
      or_bits(and_bits(i < D ? lower[i] - margin : lower[i], keep), above).store(node.lower[i]);
      or_bits(and_bits(i < D ? upper[i] + margin : upper[i], keep), below).store(node.upper[i]);
    }
  }
};

/// Elements that hold a ray of one of their vertices, of eight: bit 8 k + i for vertex k of element i.
struct Rays {
  std::uint32_t forward = 0, backward = 0;
  unsigned sure = 0xff;  ///< elements that are positive and whose rays are known, for certain
};

/// With positions off by r, edges up to m and shears below 0.3, roundings included: a sheared coordinate is below 1.3 m
/// and off by 4 r + 2^-23 m, a side by m (28 r + 2^-19 m), the first side by four times as much, the determinant by
/// m^2 (128 r + 2^-16 m). (Where m < 7 r the bound is above all that a side can be.)
template <int D>
SELVAGE_INLINE Rays examine_rays(const Float8 (&edges)[D][D], Float8 reach, float error) {
  Float8 shear[2], sides[D + 1];
  for (int i = 0; i < 2; ++i) shear[i] = constant(kRayShear[i]);
  const Float8 volume = ray_sides(edges, shear, sides);
  Float8 side_error = constant(28 * error) + constant(0x1p-19f) * reach;
  Float8 volume_error = (constant(128 * error) + constant(0x1p-16f) * reach) * reach;
  if (D == 3) {
    side_error = side_error * reach;
    volume_error = volume_error * reach;
  }
  side_error = side_error + constant(kTiny);
  Rays rays;
  rays.sure = less_equal(volume_error + constant(kTiny), volume);
  unsigned positive[D + 1], negative[D + 1];
  for (int k = 0; k <= D; ++k) {
    const Float8 bound = k == 0 ? side_error * constant(4) : side_error;
    positive[k] = less_equal(bound, sides[k]);
    negative[k] = less_equal(sides[k], constant(0) - bound);
    rays.sure &= positive[k] | negative[k];
  }
  for (int k = 0; k <= D; ++k) {
    unsigned forward = negative[k] & rays.sure, backward = positive[k] & rays.sure;
    for (int other = 0; other <= D; ++other)
      if (other != k) {
        forward &= positive[other];
        backward &= negative[other];
      }
    rays.forward |= forward << (kWidth * k);
    rays.backward |= backward << (kWidth * k);
  }
  return rays;
}

template <int D>
ElementFindings examine_all(const ElementTask<D>& task, Index first, Index last, Index* doubtful) {
  ElementFindings findings;
  for (Index n = first; n < last; ++n) {
    const LeafNode<D + 1>& leaf = task.leaves[n];
    BvhNode& node = task.nodes[n];
    Float8 base[D], edges[D][D];
    gather(task.positions, leaf.vertices[0], base);
    Boxes boxes;
    boxes.start(base);
    for (int k = 0; k < D; ++k) {
      gather(task.positions, leaf.vertices[k + 1], edges[k]);
      boxes.add(edges[k]);
      for (int i = 0; i < D; ++i) edges[k][i] = edges[k][i] - base[i];
    }
    boxes.template store<D>(task.positions.error, leaf.lanes, node);
    Float8 reach = boxes.upper[0] - boxes.lower[0];
    for (int i = 1; i < D; ++i) reach = max(reach, boxes.upper[i] - boxes.lower[i]);
    const Rays rays = examine_rays(edges, reach, task.positions.error);
    const std::uint32_t lanes = leaf.lanes * 0x01010101u, inner = rays.forward & leaf.inner;
    task.inner_rays[n] = inner;
    findings.inner_rays += std::popcount(inner);
    const std::uint64_t at_boundary = (std::uint64_t{rays.backward} << 32 | rays.forward) &
                                      (~(std::uint64_t{leaf.inner} << 32 | leaf.inner)) &
                                      (std::uint64_t{lanes} << 32 | lanes);
    for (std::uint64_t rest = at_boundary; rest != 0; rest &= rest - 1) {
      const int bit = std::countr_zero(rest);
      // Many may set the same mark at once.
      __atomic_store_n(&task.ray_marks[2 * leaf.vertices[(bit & 31) / kWidth][bit % kWidth] + (bit >> 5)], 1,
                       __ATOMIC_RELAXED);
    }
    for (unsigned rest = leaf.lanes & ~rays.sure; rest != 0; rest &= rest - 1)
      doubtful[findings.doubtful++] = node.children[lowest_lane(rest)];
  }
  return findings;
}

Float8 load(const NormalBox& box) {
  return Float8::load(box.lower.data());
}

/// Widens cones by more than the rounding of the few operations that made them.
constexpr float kConeMargin = 4e-6f;
/// Wider cones skip too little to be worth their test.
constexpr float kSmallestCosine = 0.1f;
/// Above it a direction within the cone cannot be mistaken for one within its opposite: cos 45 degrees and a little.
constexpr float kOneSidedCosine = 0.7072f;

/// The cones around eight boxes of unit vectors: from the origin through the middle c of the box, which is rho = |h|
/// from its corners. A unit vector n in the box has n.c >= (1 + c.c - rho.rho) / 2, and n.c >= c.c - |c| . h as well.
SELVAGE_INLINE void fit_cones(const Float8 (&boxes)[kWidth], ConeNode& cones) {
  Float8 left[4], right[4];
  for (int i = 0; i < 4; ++i) {
    left[i] = boxes[i];
    right[i] = boxes[i + 4];
  }
  transpose(left[0], left[1], left[2], left[3]);
  transpose(right[0], right[1], right[2], right[3]);
  const Float8 half = constant(0.5f), zero = constant(0);
  Vector8 middle, extent;
  Float8 across = zero;
  for (int i = 0; i < 3; ++i) {
    const Float8 lower = Float8::join(left[i].low(), right[i].low());
    const Float8 negated_upper = Float8::join(left[i].high(), right[i].high());
    middle[i] = (lower - negated_upper) * half;
    extent[i] = negate((lower + negated_upper) * half);
    across = across + abs(middle[i]) * extent[i];
  }
  const Float8 squared = max(dot(middle, middle), constant(kTiny)), length = sqrt(squared);
  const Float8 round = (constant(1) + squared - dot(extent, extent)) * half;
  const Float8 cosine = max(round, squared - across) / length - constant(kConeMargin);
  const unsigned bounded = less_equal(constant(kSmallestCosine), cosine);
  for (int i = 0; i < 3; ++i) keep_lanes(middle[i] / length, bounded).store(cones.axis[i]);
  keep_lanes(cosine, bounded).store(cones.cosine);
  keep_lanes(sqrt(max(constant(1) - cosine * cosine, zero)), bounded).store(cones.sine);
  cones.two_sided = bounded & ~less_equal(constant(kOneSidedCosine), cosine);
}

template <int D>
void fit_all_faces(const FaceTask<D>& task, Index first, Index last) {
  for (Index n = first; n < last; ++n) {
    const LeafNode<D>& leaf = task.leaves[n];
    BvhNode& node = task.nodes[n];
    Float8 x[D];
    Boxes boxes;
    gather(task.positions, leaf.vertices[0], x);
    boxes.start(x);
    for (int k = 1; k < D; ++k) {
      gather(task.positions, leaf.vertices[k], x);
      boxes.add(x);
    }
    boxes.template store<D>(task.positions.error, leaf.lanes, node);
    // Lanes without a face repeat the vertices of one, which does no harm.
    Float8 normals[kWidth];
    for (int i = 0; i < kWidth; ++i) {
      normals[i] = load(task.vertex_normals[leaf.vertices[0][i]]);
      for (int k = 1; k < D; ++k) normals[i] = min(normals[i], load(task.vertex_normals[leaf.vertices[k][i]]));
    }
    for (int i = 0; i < node.child_count && node.children[i] < 0; ++i)
      normals[i] = load(task.node_normals[~node.children[i]]);
    Float8 whole = normals[0];
    for (int i = 1; i < node.child_count; ++i) whole = min(whole, normals[i]);
    whole.store(task.node_normals[n].lower.data());
    fit_cones(normals, task.cones[n]);
  }
}

/// A direction that no boundary edge is likely to be across.
constexpr float kGeneric[3] = {0.3571f, 0.6139f, 0.7041f};

/// Facts about eight boundary vertices, from their rims.
struct RimFacts {
  unsigned proven;
  Float8 lower[4], negated_upper[4];  ///< of the faces' unit normals; the last row is 0
};

/// See docs/how_it_works/boundary_path.md: seen along an axis, the boundary faces around the vertex all turn the same
/// way and go around once. With positions off by r and spokes up to m, roundings included: a spoke's coordinate is off
/// by d = 3 r + 2^-23 m, a face's normal (twice its area long) by 11 m d + 2^-21 m^2, a unit normal by twice that over
/// the normal's length.
SELVAGE_INLINE RimFacts examine_rims(const RoundedPositions& positions, const Index* vertices, int length) {
  const Float8 zero = constant(0);
  Vector8 centre, spokes[Rims::kMaxLength + 1], normals[Rims::kMaxLength];
  gather(positions, vertices, centre.at);
  Float8 reach = zero;
  spokes[0] = {{zero, zero, zero}};  // no rim is empty, but the compiler does not know
  for (int k = 0; k < length; ++k) {
    gather(positions, vertices + kWidth * (k + 1), spokes[k].at);
    spokes[k] = spokes[k] - centre;
    for (int i = 0; i < 3; ++i) reach = max(reach, abs(spokes[k][i]));
  }
  spokes[length] = spokes[0];

  RimFacts facts;
  for (int i = 0; i < 4; ++i) facts.lower[i] = facts.negated_upper[i] = i < 3 ? constant(2) : zero;
  Vector8 sum = {{zero, zero, zero}};
  Float8 shortest = constant(kInfinity);
  for (int k = 0; k < length; ++k) {
    normals[k] = cross(spokes[k], spokes[k + 1]);
    const Float8 size = sqrt(dot(normals[k], normals[k])), scale = constant(1) / size;
    shortest = min(size, shortest);
    sum = sum + normals[k];
    normals[k] = scale * normals[k];
    for (int i = 0; i < 3; ++i) {
      facts.lower[i] = min(facts.lower[i], normals[k][i]);
      facts.negated_upper[i] = min(facts.negated_upper[i], negate(normals[k][i]));
    }
  }
  const Float8 spoke_error = constant(3 * positions.error) + reach * constant(0x1p-23f);
  const Float8 normal_error =
      (spoke_error * constant(22) + reach * constant(0x1p-20f)) * reach / shortest + constant(0x1p-20f);
  for (int i = 0; i < 3; ++i) {
    facts.lower[i] = facts.lower[i] - normal_error;
    facts.negated_upper[i] = facts.negated_upper[i] - normal_error;
  }

  const Vector8 axis = (constant(1) / sqrt(dot(sum, sum))) * sum;
  const Vector8 generic = {{constant(kGeneric[0]), constant(kGeneric[1]), constant(kGeneric[2])}};
  const Vector8 across = cross(axis, generic);
  const Float8 least = normal_error + constant(1e-5f);
  const Float8 bound = spoke_error * constant(2) + reach * constant(0x1p-20f) + constant(kTiny);
  // Short normals have squares that leave the normal floats.
  unsigned sure = less_equal(normal_error, constant(0.05f)) & less_equal(constant(1e-15f), shortest);
  unsigned once = 0, twice = 0;
  unsigned below = less_equal(dot(across, spokes[0]), zero);
  for (int k = 1; k <= length; ++k) {
    const Float8 side = dot(across, spokes[k]);
    sure &= less_equal(least, dot(normals[k - 1], axis)) & less_equal(bound, abs(side));
    const unsigned now_below = less_equal(side, zero), rises = below & ~now_below;
    twice |= once & rises;
    once |= rises;
    below = now_below;
  }
  facts.proven = sure & once & ~twice;
  return facts;
}

}  // namespace

ElementFindings examine_elements(const ElementTask<2>& task, Index first, Index last, Index* doubtful) {
  return examine_all(task, first, last, doubtful);
}

ElementFindings examine_elements(const ElementTask<3>& task, Index first, Index last, Index* doubtful) {
  return examine_all(task, first, last, doubtful);
}

void fit_faces(const FaceTask<2>& task, Index first, Index last) {
  fit_all_faces(task, first, last);
}

void fit_faces(const FaceTask<3>& task, Index first, Index last) {
  fit_all_faces(task, first, last);
}

Index prove_rims(const RimTask& task, std::span<const RimBatch> batches, Index* doubtful) {
  Index doubtful_count = 0;
  for (const RimBatch& batch : batches) {
    const Index* const vertices = task.vertices + batch.first;
    RimFacts facts = examine_rims(task.positions, vertices, batch.length);
    transpose(facts.lower[0], facts.lower[1], facts.lower[2], facts.lower[3]);
    transpose(facts.negated_upper[0], facts.negated_upper[1], facts.negated_upper[2], facts.negated_upper[3]);
    for (int i = 0; i < batch.count; ++i) {
      if ((facts.proven >> i & 1) == 0) {
        doubtful[doubtful_count++] = vertices[i];
        continue;
      }
      const Float8 lower = facts.lower[i & 3], negated_upper = facts.negated_upper[i & 3];
      (i < 4 ? Float8::join(lower.low(), negated_upper.low()) : Float8::join(lower.high(), negated_upper.high()))
          .store(task.normals[vertices[i]].lower.data());
      task.proven[vertices[i]] = 1;
    }
  }
  return doubtful_count;
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
