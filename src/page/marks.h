#pragma once

#include "page/page.h"
#include "scene/reading/marks.h"
#include "scene/reading/shown_surface.h"

namespace selvage {

/// Stores the marks of a pose as block `marks<pose>`, and notes in the page that there is one: three int32, the number
/// of paths, of pairs, and whether there are features; by pack_integers() the shown vertex of each path (or -1); of
/// each path seven float32, its depth, `from` and `to`; by pack_integers() the triangles of each pair, and its
/// features; a byte for the kind of each.
void add_marks(Page& page, const ShownSurface& surface, std::size_t pose, const Marks& marks);

}  // namespace selvage
