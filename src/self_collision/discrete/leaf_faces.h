#pragma once

#include "core/simd/simd16.h"
#include "self_collision/surface/leaf_vertices.h"
#include "self_collision/surface/plane_filter.h"

namespace selvage {

inline namespace SELVAGE_ISA {

/// The children of a node that are triangles, in one pose and in box units, a row for each coordinate, so that any
/// eight pairs of those of two nodes are compared at once and nothing is gathered.
struct alignas(64) LeafFaces {
  using Rows = float[3][BvhNode::kWidth];
  Rows origin;                  ///< a vertex
  Rows edges[2];                ///< from there to the others
  Rows normal;                  ///< their cross product
  float size[BvhNode::kWidth];  ///< along no axis do points of the triangle's box lie farther apart

  /// @param rows  the place of each vertex, see DeformedSurface::rounded()
  SELVAGE_INLINE void fill(const std::array<float, 4>* rows, const LeafVertices& leaves) {
    WideVec3 corners[3];
    for (int k = 0; k < 3; ++k)
      corners[k] = gather_corner(rows, [&](int lane) { return std::max(leaves.corners[k][lane], 0); });
    const WideVec3 u = corners[1] - corners[0], v = corners[2] - corners[0];
    const auto extent = [&](Float8 a, Float8 b, Float8 c) { return max(max(a, b), c) - min(min(a, b), c); };
    const Float8 largest = max(
        max(extent(corners[0][0], corners[1][0], corners[2][0]), extent(corners[0][1], corners[1][1], corners[2][1])),
        extent(corners[0][2], corners[1][2], corners[2][2]));
    store(corners[0], origin);
    store(u, edges[0]);
    store(v, edges[1]);
    store(cross(u, v), normal);
    // Upper bounds of boxes are up to three floats larger than needed.
    (largest + Float8::broadcast(4 * kBoxRounding)).store(size);
  }

 private:
  SELVAGE_INLINE static void store(const WideVec3& corner, Rows& rows) {
    corner[0].store(rows[0]);
    corner[1].store(rows[1]);
    corner[2].store(rows[2]);
  }
};

/// A cache of the faces of nodes: a search comes back to some nodes many times.
class FaceCache {
 public:
  FaceCache(const std::array<float, 4>* rows, const LeafVertices* leaves) : rows_(rows), leaves_(leaves) {
    std::fill(std::begin(nodes_), std::end(nodes_), kNone);
  }

  SELVAGE_INLINE const LeafFaces& of(Index node) { return at(place_of(node), node); }

  /// The same, and keeps the result of of() for another node valid.
  SELVAGE_INLINE const LeafFaces& of(Index node, Index kept) {
    return at(place_of(node) == place_of(kept) && node != kept ? kSize : place_of(node), node);
  }

 private:
  static constexpr std::uint32_t kSize = 256;

  static std::uint32_t place_of(Index node) { return static_cast<std::uint32_t>(node) % kSize; }
  SELVAGE_INLINE const LeafFaces& at(std::uint32_t place, Index node) {
    if (nodes_[place] != node) {
      nodes_[place] = node;
      faces_[place].fill(rows_, leaves_[node]);
    }
    return faces_[place];
  }

  const std::array<float, 4>* rows_;
  const LeafVertices* leaves_;
  Index nodes_[kSize + 1];
  LeafFaces faces_[kSize + 1];
};

/// Eight entries of rows.
SELVAGE_INLINE WideVec3 pick_rows(const LeafFaces::Rows& rows, Int8 lanes) {
  const auto pick = [&](const float* row) { return pick_lanes(Float8::load(row), lanes); };
  return {{pick(rows[0]), pick(rows[1]), pick(rows[2])}};
}

/// Lanes in which a number and its sums with two others are all at least `bound`, or all at most -bound.
SELVAGE_INLINE unsigned all_beyond(Float8 first, Float8 step, Float8 other_step, Float8 bound) {
  const Float8 second = first + step, third = first + other_step;
  return less_equal(bound, min(min(first, second), third)) | less_equal(max(max(first, second), third), negate(bound));
}

/// Lanes of eight pairs of triangles in which one lies, for certain, on one side of the plane of the other. Only for
/// triangles whose boxes meet.
///
/// @param i, k  which triangle of a, and of b; only the lowest three bits count
SELVAGE_INLINE unsigned beside_faces(const LeafFaces& a, Int8 i, const LeafFaces& b, Int8 k) {
  const WideVec3 normal_a = pick_rows(a.normal, i), normal_b = pick_rows(b.normal, k);
  const WideVec3 way = pick_rows(b.origin, k) - pick_rows(a.origin, i);
  const Float8 size_a = pick_lanes(Float8::load(a.size), i), size_b = pick_lanes(Float8::load(b.size), k);
  // Boxes that meet reach no farther than this from any vertex of either. As in heights_over(), but that heights are
  // sums of two dot products, each rounded.
  const Float8 far = size_a + size_b;
  const Float8 error = Float8::broadcast(2 * kBoxRounding) + far * Float8::broadcast(0x1p-21f);
  const Float8 share = error * far * Float8::broadcast(20), smallest = Float8::broadcast(1e-30f);
  const auto along = [&](const LeafFaces::Rows& edge) { return dot(normal_a, pick_rows(edge, k)); };
  const auto across = [&](const LeafFaces::Rows& edge) { return dot(normal_b, pick_rows(edge, i)); };
  return all_beyond(dot(normal_a, way), along(b.edges[0]), along(b.edges[1]), share * size_a + smallest) |
         all_beyond(negate(dot(normal_b, way)), across(a.edges[0]), across(a.edges[1]), share * size_b + smallest);
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
