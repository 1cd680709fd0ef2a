#pragma once

#include "boundary_path/packets/packet_search.h"

/// Where the points of a PacketSearch are, in space and in their elements.
namespace selvage {
inline namespace SELVAGE_ISA {

template <int D>
void PacketSearch<D>::prefetch_ends(std::span<const PathTask<D>> tasks) const {
  for (const PathTask<D>& task : tasks) {
    const PathElement<D>& element = input_.elements[task.query.element];
    for (const Index v : element.vertices) prefetch(input_.rounded + v);
    for (const Index neighbour : element.neighbours) prefetch_across(input_, neighbour);
    if (const Index hint = input_.hints[task.query.element]; hint != kNone) prefetch(input_.face_stars + hint);
  }
}

template <int D>
void PacketSearch<D>::place(int lane) {
  const PathQuery<D>& query = searches_[lane].query();
  const Box box = input_.box_origin.around_point(query.point);
  for (int i = 0; i < 3; ++i) {
    query_point_[i][lane] = 0;
    lower_[i][lane] = box.lower[i];
    upper_[i][lane] = box.upper[i];
  }
  for (int i = 0; i < D; ++i)
    query_point_[i][lane] = static_cast<float>(query.point[i] - input_.box_origin.position[i]);
}

template <int D>
void PacketSearch<D>::take_sources(int lane) {
  const PathQuery<D>& query = searches_[lane].query();
  const bool bars = !searches_[lane].may_cull_towards_source();
  const int count = query.source[0] == kNone ? 0 : query.source[1] == kNone ? 1 : 2;
  most_sources_ = count > most_sources_ ? count : most_sources_;
  any_barring_ |= bars && query.source[0] != kNone;
  const Index sources[2] = {query.source[0], query.source[1] == kNone ? query.source[0] : query.source[1]};
  for (int i = 0; i < 2; ++i) {
    sources_[i][lane] = std::bit_cast<float>(sources[i]);
    barring_sources_[i][lane] = std::bit_cast<float>(bars ? sources[i] : kNone);
  }
}

/// Parts that a point splits elements into, one for each vertex that it replaces.
struct ElementParts {
  Float16 least;  ///< signed volume, times the sign of the element's own
  Float16 bound;  ///< of the error: see ElementSplits::error_bound()

  SELVAGE_INLINE ElementParts(const Vector16& p, const Vector16 (&corners)[4], float rounding) {
    Vector16 edges[3];
    for (int k = 0; k < 3; ++k) edges[k] = corners[k + 1] - corners[0];
    const Vector16 from_corner = p - corners[0];
    Float16 whole = Float16::broadcast(1), without_one = Float16::broadcast(0);
    for (int i = 0; i < 3; ++i) {
      Float16 low = p[i], high = low;
      for (const Vector16& corner : corners) {
        low = min(low, corner[i]);
        high = max(high, corner[i]);
      }
      const Float16 extent = high - low + Float16::broadcast(8 * rounding);
      without_one = without_one * extent + whole;
      whole = whole * extent;
    }
    bound = whole * Float16::broadcast(0x1p-15f) + without_one * Float16::broadcast(64 * rounding) +
            Float16::broadcast(1e-35f);
    const Vector16 normal = cross(edges[1], edges[2]);
    const Float16 volume = dot(normal, edges[0]), zero = Float16::broadcast(0);
    const Float16 parts[3] = {dot(normal, from_corner), dot(cross(edges[2], edges[0]), from_corner),
                              dot(cross(edges[0], edges[1]), from_corner)};
    const Float16 rest = ((volume - parts[0]) - parts[1]) - parts[2];
    const Float16 smallest = min(min(parts[0], parts[1]), min(parts[2], rest));
    const Float16 largest = max(max(parts[0], parts[1]), max(parts[2], rest));
    least = select_less(zero, volume, smallest, zero - largest);
  }
};

/// Lanes whose points certainly lie strictly inside their elements.
template <int D>
unsigned PacketSearch<D>::find_inside(std::span<const PathTask<D>> tasks) const {
  if constexpr (D == 2) {
    return 0;  // rare enough to be looked at one by one
  } else {
    const int count = static_cast<int>(tasks.size());
    VertexTuple<4> vertices[kWidth];
    for (int i = 0; i < kWidth; ++i)
      vertices[i] = input_.elements[tasks[i < count ? i : count - 1].query.element].vertices;
    Vector16 corners[4];
    for (int k = 0; k < 4; ++k) corners[k] = gather(input_.rounded, [&](int lane) { return vertices[lane][k]; });
    const Vector16 p = load_axes<Float16>(query_point_);
    const ElementParts parts(p, corners, input_.rounding);
    const Float16 huge = Float16::broadcast(1e30f);  // what overflows tells nothing
    return less_equal(parts.bound, parts.least) & less_equal(parts.bound, huge) & 0xffffu >> (kWidth - count);
  }
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
