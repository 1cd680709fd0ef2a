#pragma once

#include "selvage/mesh/simplex_mesh.h"

#include <optional>

namespace selvage {

/// A part of a segment: 0 at the segment's first end, 1 at its second.
struct EdgePart {
  double first, last;
  double middle() const { return (first + last) / 2; }
};

/// The part of a segment inside a tetrahedron. Nothing where the two do not meet (decided exactly), or the part is so
/// short that its middle, rounded, is not inside (likewise). A flat tetrahedron holds nothing, an inverted one what its
/// mirror image holds.
std::optional<EdgePart> part_inside(const std::array<Vec3, 2>& segment, const std::array<Vec3, 4>& tetrahedron);

/// The part of an edge in an element.
struct ElementPart {
  Index element;
  EdgePart part;
};

/// A point of an edge, and an element that holds it.
struct EdgePoint {
  double place;  ///< 0 at the edge's first end, 1 at its second
  Index element;
};

/// The point that represents the parts of an edge inside elements: of the runs of parts in connected elements, the one
/// whose middle is closest to the edge's; of that run the middle.
///
/// Why not the part in a single element: an edge that dips into a body from the side cuts a sliver off an element at
/// the body's border. However shallow the edge is, the sliver is closer to the side, and would be pushed out there.
///
/// @param parts  at least one, in any order
/// @param joins  or else each part is a run of its own, as in SPB
EdgePoint middle_of_parts(const TetMesh& mesh, std::span<const Vec3> positions, const std::array<Vec3, 2>& segment,
                          std::vector<ElementPart> parts, bool joins = true);

}  // namespace selvage
