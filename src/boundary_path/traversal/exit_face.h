#pragma once

#include "boundary_path/traversal/segment.h"

namespace selvage {
inline namespace SELVAGE_ISA {

/// A face of an element that the line passes through properly, listed so that its normal points along the line.
template <int D>
struct ExitFace {
  HalfFace next;  ///< what lies behind it
  typename Segment<D>::RaySpaceVertex corners[D];
};

template <int D>
FacePoints<D> face_points(const PathInput<D>& input, Index element, int face) {
  const auto ids = SimplexMesh<D>::face_of(input.elements[element].vertices, face);
  FacePoints<D> points;
  for (int i = 0; i < D; ++i) points[i] = input.positions[ids[i]];
  return points;
}

/// Steps into the next element and turns the exit face into the one through which the segment leaves it (SPB
/// supplement, algorithm 2). False when it runs exactly through an edge or a vertex there.
template <int D>
SELVAGE_INLINE bool select_exit_face(const PathInput<D>& input, const Segment<D>& segment, ExitFace<D>& exit_face) {
  const auto& [vertices, neighbours] = input.elements[exit_face.next.element()];
  const auto apex = segment.to_ray_space(vertices[exit_face.next.face()]);
  int behind;  // the corner that does not see the line any more
  if constexpr (D == 3) {
    int a = segment.clear_side(exit_face.corners[0], apex), b = segment.clear_side(exit_face.corners[1], apex),
        c = segment.clear_side(exit_face.corners[2], apex);
    const auto is_clear = [&] { return (((a < 0) & (b > 0)) | ((b < 0) & (c > 0)) | ((c < 0) & (a > 0))) != 0; };
    if (!is_clear()) {  // two that are on different sides are enough
      a = segment.side(exit_face.corners[0], apex);
      b = segment.side(exit_face.corners[1], apex);
      c = segment.side(exit_face.corners[2], apex);
      if (!is_clear()) return false;
    }
    behind = 1 + ((a < 0) & (b > 0)) - ((b < 0) & (c > 0));  // without a branch: it would be unpredictable
  } else {
    const int side = segment.side(apex);
    if (side == 0) return false;
    behind = side > 0 ? 1 : 0;
  }
  exit_face.next = {neighbours[position_in(vertices, exit_face.corners[behind].vertex)]};
  // Number by number: a copy of the whole would wait until the numbers have left for the memory.
  auto& corner = exit_face.corners[behind];
  for (int k = 0; k < D - 1; ++k) corner.across[k] = apex.across[k];
  corner.along = apex.along;
  corner.reach = apex.reach;
  corner.vertex = apex.vertex;
  return true;
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
