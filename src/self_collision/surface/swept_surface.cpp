#include "self_collision/surface/swept_surface.h"

#include "core/parallel.h"
#include "core/simd/simd.h"

#include <cmath>

namespace selvage {

namespace {

/// How far a box reaches beyond positions in box units that are rounded to the nearest float: at least to the next one.
Float4 margin_of(Float4 x) {
  const Float4 magnitude = max(x, Float4::broadcast(0) - x);
  return magnitude * Float4::broadcast(0x1p-23f) + Float4::broadcast(0x1p-126f);
}

/// A box around three vertices, larger by so much on all sides.
Box swept_box(const MovingVertex& a, const MovingVertex& b, const MovingVertex& c, float by) {
  const Float8 rows[] = {Float8::load(a.coordinates), Float8::load(b.coordinates), Float8::load(c.coordinates)};
  const Float8 lowest = min(min(rows[0], rows[1]), rows[2]), highest = max(max(rows[0], rows[1]), rows[2]);
  const Float4 lower = min(lowest.low(), lowest.high()), upper = max(highest.low(), highest.high());
  float low[4], high[4];
  (lower - margin_of(lower) - Float4::broadcast(by)).store(low);
  (upper + margin_of(upper) + Float4::broadcast(by)).store(high);
  return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
}

SELVAGE_INLINE MovingVertex rounded_in(const BoxUnits& units, const Vec3& position_t0, const Vec3& position_t1) {
  const Vec3 start = units.map(position_t0), end = units.map(position_t1);
  const auto rounded = [](double x) { return static_cast<float>(x); };
  return {{rounded(start[0]), rounded(start[1]), rounded(start[2]), 0, rounded(end[0]), rounded(end[1]),
           rounded(end[2]), 0}};
}

/// By how much boxes are larger for a margin: its sums with coordinates, which are below 2, are rounded, too.
float widening_of(float margin) {
  return margin > 0 ? margin + 0x1p-21f : 0;
}

void widen(Box& box, double by) {
  for (int k = 0; k < 3; ++k) {
    box.lower[k] = round_down(box.lower[k] - by);
    box.upper[k] = round_up(box.upper[k] + by);
  }
}

}  // namespace

void SweptSurface::place(const TriangleMesh& mesh, std::span<const Vec3> positions_t0,
                         std::span<const Vec3> positions_t1, std::span<const double> thickness, const BoxUnits& units,
                         double margin, double distance) {
  const std::size_t count = positions_t0.size();
  units_ = units;
  // A little more, for the rounding of map_length().
  const auto in_box_units = [&](double length) {
    return length > 0 ? round_up(units.map_length(length) * (1 + 0x1p-19)) : 0;
  };
  margin_ = in_box_units(margin);
  distance_ = in_box_units(distance);
  positions_t0_.resize(count);
  positions_t1_.resize(count);
  rounded_.resize(count);
  thickness_.resize(thickness.size());
  parallel_for(mesh.vertex_count(), kGrain, [&](std::int64_t v) {
    positions_t0_[v] = positions_t0[v];
    positions_t1_[v] = positions_t1[v];
    rounded_[v] = rounded_in(units, positions_t0[v], positions_t1[v]);
    if (!thickness.empty()) thickness_[v] = in_box_units(thickness[v]);
  });
  boxes_.resize(mesh.triangle_count());
  parallel_for(mesh.triangle_count(), kGrain, [&](std::int64_t t) { fit_box(mesh, static_cast<Index>(t)); });
}

void SweptSurface::fit_box(const TriangleMesh& mesh, Index triangle) {
  const auto& [a, b, c] = mesh.triangles()[triangle];
  boxes_[triangle] = swept_box(rounded_[a], rounded_[b], rounded_[c], widening_of(margin_));
  if (distance_ > 0) widen(boxes_[triangle], 0.5 * distance_);
  if (!thickness_.empty()) widen(boxes_[triangle], std::max({thickness_[a], thickness_[b], thickness_[c]}));
}

void SweptSurface::move(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1,
                        std::span<const Index> vertices) {
  parallel_ranges(std::ssize(positions_t0), kGrain, [&](std::int64_t first, std::int64_t last) {
    std::copy(positions_t0.begin() + first, positions_t0.begin() + last, positions_t0_.begin() + first);
    std::copy(positions_t1.begin() + first, positions_t1.begin() + last, positions_t1_.begin() + first);
  });
  parallel_for(std::ssize(vertices), kGrain, [&](std::int64_t i) {
    const Index v = vertices[i];
    rounded_[v] = rounded_in(units_, positions_t0[v], positions_t1[v]);
  });
}

bool SweptSurface::replace(const TriangleMesh& mesh, std::span<const Index> vertices,
                           std::span<const std::array<Vec3, 2>> ends, std::span<const Index> triangles) {
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Index v = vertices[i];
    positions_t0_[v] = ends[i][0];
    positions_t1_[v] = ends[i][1];
    rounded_[v] = rounded_in(units_, ends[i][0], ends[i][1]);
    // NaN is out of range, too.
    for (const float x : rounded_[v].coordinates)
      if (!(std::abs(x) <= 1)) return false;
  }
  for (const Index t : triangles) fit_box(mesh, t);
  return true;
}

}  // namespace selvage
