#pragma once

namespace selvage::bench {

/// Single precision throughout, as in SPB. Padded to 16 bytes: a vertex never straddles a cache line, and Embree reads
/// the array in place.
struct alignas(16) Float3 {
  float x, y, z;
};

inline Float3 operator+(const Float3& a, const Float3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Float3 operator-(const Float3& a, const Float3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Float3 operator*(float s, const Float3& a) {
  return {s * a.x, s * a.y, s * a.z};
}
inline float dot(const Float3& a, const Float3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Float3 cross(const Float3& a, const Float3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Closest point of a triangle, and the vertices that span the feature it lies on (bit i: vertex i).
struct TrianglePoint {
  Float3 point;
  unsigned mask;
};

/// Voronoi regions of the triangle, tested one after the other.
inline TrianglePoint closest_point(const Float3& p, const Float3& a, const Float3& b, const Float3& c) {
  const Float3 ab = b - a, ac = c - a, ap = p - a;
  const float d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return {a, 0b001};
  const Float3 bp = p - b;
  const float d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return {b, 0b010};
  const float vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {a + (d1 / (d1 - d3)) * ab, 0b011};
  const Float3 cp = p - c;
  const float d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return {c, 0b100};
  const float vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {a + (d2 / (d2 - d6)) * ac, 0b101};
  const float va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return {b + ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (c - b), 0b110};
  const float scale = 1 / (va + vb + vc);
  return {a + (vb * scale) * ab + (vc * scale) * ac, 0b111};
}

}  // namespace selvage::bench
