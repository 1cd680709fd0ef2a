#pragma once

#include "self_collision/pose_frame.h"
#include "selvage/core/simd.h"

namespace selvage {
inline namespace SELVAGE_ISA {

/// The same corner of eight triangles.
struct WideCorner {
  Float8 x, y, z;
};

/// Gathers eight rows (x, y, z, any) into a corner.
SELVAGE_INLINE WideCorner gather_corner(const std::array<float, 4>* rows, const Index (&vertices)[8]) {
  Float4 low[4], high[4];
  for (int i = 0; i < 4; ++i) {
    low[i] = Float4::load(rows[vertices[i]].data());
    high[i] = Float4::load(rows[vertices[i + 4]].data());
  }
  transpose(low[0], low[1], low[2], low[3]);
  transpose(high[0], high[1], high[2], high[3]);
  return {Float8::join(low[0], high[0]), Float8::join(low[1], high[1]), Float8::join(low[2], high[2])};
}

SELVAGE_INLINE WideCorner operator-(const WideCorner& a, const WideCorner& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
SELVAGE_INLINE WideCorner cross(const WideCorner& a, const WideCorner& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
SELVAGE_INLINE Float8 dot(const WideCorner& a, const WideCorner& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
SELVAGE_INLINE Float8 negative(Float8 a) {
  return Float8::broadcast(0) - a;
}
SELVAGE_INLINE Float8 magnitude(Float8 a) {
  return max(a, negative(a));
}
/// Largest magnitude of a coordinate.
SELVAGE_INLINE Float8 reach(const WideCorner& a) {
  return max(max(magnitude(a.x), magnitude(a.y)), magnitude(a.z));
}

/// Lanes in which the points all lie strictly on one side of the triangle's plane, and farther from it than `distance`.
/// Each coordinate is off by at most kFrameRounding, which the answer allows for.
SELVAGE_INLINE unsigned beside_plane(const WideCorner (&triangle)[3], const WideCorner (&points)[3], Float8 distance) {
  const WideCorner u = triangle[1] - triangle[0], v = triangle[2] - triangle[0], normal = cross(u, v);
  const WideCorner w[3] = {points[0] - triangle[0], points[1] - triangle[0], points[2] - triangle[0]};
  const Float8 heights[3] = {dot(normal, w[0]), dot(normal, w[1]), dot(normal, w[2])};
  const Float8 edge_reach = max(reach(u), reach(v));
  const Float8 far_reach = max(edge_reach, max(max(reach(w[0]), reach(w[1])), reach(w[2])));
  // A height is a sum of six products of three differences, each off by `error` (two roundings of positions, its own,
  // and its share of what products and sums round off): by 6 (2 edge_reach far_reach + edge_reach^2) times that.
  const Float8 error = Float8::broadcast(2 * kFrameRounding) + far_reach * Float8::broadcast(0x1p-22f);
  Float8 bound = error * edge_reach * far_reach * Float8::broadcast(20) + Float8::broadcast(1e-30f);
  // The true normal is at most 1.8 edge_reach long for each edge_reach of an edge: 3 covers its error as well.
  const Float8 longest = sqrt(dot(normal, normal)) * Float8::broadcast(1.00001f) +
                         error * edge_reach * Float8::broadcast(8) + Float8::broadcast(1e-18f);
  bound = bound + distance * longest;
  const Float8 lowest = min(min(heights[0], heights[1]), heights[2]);
  const Float8 highest = max(max(heights[0], heights[1]), heights[2]);
  return less_equal(bound, lowest) | less_equal(highest, negative(bound));
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
