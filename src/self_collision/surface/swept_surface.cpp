#include "self_collision/surface/swept_surface.h"

#include "core/parallel.h"
#include "core/simd/simd.h"

namespace selvage {

namespace {

/// How far a box reaches beyond positions in box units that are rounded to the nearest float: at least to the next one.
Float4 margin_of(Float4 x) {
  const Float4 magnitude = max(x, Float4::broadcast(0) - x);
  return magnitude * Float4::broadcast(0x1p-23f) + Float4::broadcast(0x1p-126f);
}

Box swept_box(const MovingVertex& a, const MovingVertex& b, const MovingVertex& c) {
  const Float8 rows[] = {Float8::load(a.coordinates), Float8::load(b.coordinates), Float8::load(c.coordinates)};
  const Float8 lowest = min(min(rows[0], rows[1]), rows[2]), highest = max(max(rows[0], rows[1]), rows[2]);
  const Float4 lower = min(lowest.low(), lowest.high()), upper = max(highest.low(), highest.high());
  float low[4], high[4];
  (lower - margin_of(lower)).store(low);
  (upper + margin_of(upper)).store(high);
  return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
}

}  // namespace

void SweptSurface::place(const TriangleMesh& mesh, std::span<const Vec3> positions_t0,
                         std::span<const Vec3> positions_t1, std::span<const double> thickness, const BoxUnits& units) {
  const std::size_t count = positions_t0.size();
  positions_t0_.resize(count);
  positions_t1_.resize(count);
  rounded_.resize(count);
  thickness_.resize(thickness.size());
  parallel_for(mesh.vertex_count(), kGrain, [&](std::int64_t v) {
    positions_t0_[v] = positions_t0[v];
    positions_t1_[v] = positions_t1[v];
    const Vec3 start = units.map(positions_t0[v]), end = units.map(positions_t1[v]);
    const auto rounded = [](double x) { return static_cast<float>(x); };
    rounded_[v] = {{rounded(start[0]), rounded(start[1]), rounded(start[2]), 0, rounded(end[0]), rounded(end[1]),
                    rounded(end[2]), 0}};
    // A little more, for the rounding of map_length(): pairs that are too far apart are rejected later.
    if (!thickness.empty()) thickness_[v] = round_up(units.map_length(thickness[v]) * (1 + 0x1p-19));
  });
  boxes_.resize(mesh.triangle_count());
  parallel_for(mesh.triangle_count(), kGrain, [&](std::int64_t t) {
    const auto& [a, b, c] = mesh.triangles()[t];
    boxes_[t] = swept_box(rounded_[a], rounded_[b], rounded_[c]);
    if (thickness.empty()) return;
    const double largest = std::max({thickness_[a], thickness_[b], thickness_[c]});
    for (int k = 0; k < 3; ++k) {
      boxes_[t].lower[k] = round_down(boxes_[t].lower[k] - largest);
      boxes_[t].upper[k] = round_up(boxes_[t].upper[k] + largest);
    }
  });
}

}  // namespace selvage
