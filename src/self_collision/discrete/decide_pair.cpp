#include "self_collision/discrete/discrete_kernel.h"
#include "self_collision/surface/pair_filter.h"
#include "selvage/geometry/distance.h"

#include <algorithm>

namespace selvage {

namespace {

std::array<Vec3, 3> corners_of(const SurfaceView& surface, const VertexTuple<3>& vertices) {
  return {surface.positions[vertices[0]], surface.positions[vertices[1]], surface.positions[vertices[2]]};
}

/// Puts the vertices that the triangles share first, in one order. Returns how many there are.
int bring_shared_first(VertexTuple<3>& a, VertexTuple<3>& b) {
  int shared = 0;
  for (int i = 0; i < 3; ++i) {
    const auto same = std::find(b.begin() + shared, b.end(), a[i]);
    if (same == b.end()) continue;
    std::iter_swap(b.begin() + shared, same);
    std::swap(a[shared], a[i]);
    ++shared;
  }
  return shared;
}

double thickness_of(const SurfaceView& surface, const VertexTuple<3>& vertices) {
  if (surface.vertex_thickness == nullptr) return 0;
  double largest = 0;
  for (const Index v : vertices) largest = std::max(largest, surface.vertex_thickness[v]);
  return largest;
}

/// How two triangles without a common vertex meet; nothing where they do not, nor are they too near.
std::optional<TriangleContact> meeting(const DiscreteInput& input, const VertexTuple<3>& a, const VertexTuple<3>& b) {
  const auto corners_a = corners_of(input.a, a), corners_b = corners_of(input.b, b);
  const TriangleContact contact = classify_contact(corners_a, corners_b);
  if (contact != TriangleContact::kDisjoint) return contact;
  const double thickness = thickness_of(input.a, a) + thickness_of(input.b, b);
  if (thickness > 0 && is_nearer(squared_distance(corners_a, corners_b), thickness)) return contact;
  return std::nullopt;
}

/// How two triangles meet elsewhere than in the vertices that they share, which come first.
std::optional<TriangleContact> meeting_elsewhere(const DiscreteInput& input, const VertexTuple<3>& a,
                                                 const VertexTuple<3>& b, int shared) {
  const auto corners_a = corners_of(input.a, a), corners_b = corners_of(input.b, b);
  const bool meet =
      shared == 3 || (shared == 2 ? meet_beyond_edge(corners_a, corners_b) : meet_beyond_vertex(corners_a, corners_b));
  if (!meet) return std::nullopt;
  return classify_contact(corners_a, corners_b);
}

bool is_wanted(const DiscreteInput& input, Index first, Index second) {
  return input.filter == nullptr || input.filter->keeps_triangles(first, second);
}

void note_pair(const DiscreteInput& input, Index first, Index second, TriangleContact contact, DiscreteResult& result) {
  if (input.one_surface && second < first) std::swap(first, second);
  result.pairs.push_back({first, second, contact});
  if (result.stop != nullptr) result.stop->store(true, std::memory_order_relaxed);
}

}  // namespace

void decide_pair(const DiscreteInput& input, Index first, Index second, DiscreteResult& result) {
  if (!is_wanted(input, first, second)) return;
  ++result.counters.exact_tests;
  VertexTuple<3> a = input.a.triangles[first], b = input.b.triangles[second];
  const int shared = input.one_surface ? bring_shared_first(a, b) : 0;
  const auto contact = shared == 0 ? meeting(input, a, b) : meeting_elsewhere(input, a, b, shared);
  if (contact) note_pair(input, first, second, *contact, result);
}

void take_crossing_pairs(const DiscreteInput& input, const Index* first, const Index* second, int count,
                         DiscreteResult& result) {
  for (int i = 0; i < count; ++i)
    if (is_wanted(input, first[i], second[i]))
      note_pair(input, first[i], second[i], TriangleContact::kCrossing, result);
}

}  // namespace selvage
