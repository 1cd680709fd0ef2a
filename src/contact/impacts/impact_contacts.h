#pragma once

#include "selvage/contact/contact.h"
#include "selvage/mesh/triangle_mesh.h"
#include "selvage/self_collision/continuous_collision.h"

#include <optional>

namespace selvage {

/// A surface during a step.
struct SurfaceStep {
  const TriangleMesh& surface;
  std::span<const Vec3> positions_t0;
  std::span<const Vec3> positions_t1;
  /// Triangles from the first to before the last are cloth: neither of its sides is the outer one.
  Index first_cloth = 0, last_cloth = 0;

  bool is_cloth(Index triangle) const { return triangle >= first_cloth && triangle < last_cloth; }
  /// Of triangles around a vertex or an edge, which are all of one kind.
  bool is_cloth(std::span<const Index> triangles) const { return !triangles.empty() && is_cloth(triangles.front()); }
};

/// The contact of a vertex that runs into a face at the given time. Its normal is that of the face at that time, on the
/// side that the vertex comes from: against its velocity relative to the face. Where they touch at the start of the
/// step, or the vertex only grazes the face, that is the outer side. Of a face that is flat then, the normal points to
/// where the vertex started; nothing where it started there. Where another triangle of the vertex rises steeply through
/// the plane of the face, the normal is against the closest of those triangles instead: it lifts the vertex off, and
/// does not stop it.
///
/// Of cloth neither side is the outer one, and its triangles may rise on both. Where the two meet nearly along the
/// face, the normal points to where the vertex started.
std::optional<Contact> vertex_face_contact(const SurfaceStep& step, VertexFacePair pair, double time);

/// The contact of two edges that run into each other at the given time: the first is the point, the second the
/// surface. The normal is across both at that time, on the side that the first comes from. Where they touch at the
/// start of the step, or only graze, it is the side from the second edge's outer side to the first's. Of edges that are
/// parallel then, the normal points from the one to the other as they started; nothing where they touched. Fitted to
/// the triangles of both edges as above.
std::optional<Contact> edge_edge_contact(const SurfaceStep& step, EdgeEdgePair pair, double time);

/// Closest points of two segments, as places between their ends: 0 to 1.
std::array<double, 2> closest_places(const std::array<Vec3, 2>& a, const std::array<Vec3, 2>& b);

/// Of pairs in order: for each vertex its earliest, of equally early ones the first. Their places.
std::vector<Index> first_impacts(std::span<const VertexFacePair> pairs, std::span<const double> times);

/// Pairs that are the earliest of at least one of their edges. Their places, ascending.
std::vector<Index> first_impacts(std::span<const EdgeEdgePair> pairs, std::span<const double> times, Index edge_count);

}  // namespace selvage
