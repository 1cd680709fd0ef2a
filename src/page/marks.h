#pragma once

#include "page/page.h"
#include "scene/reading/marks.h"
#include "scene/reading/shown_surface.h"
#include "scene/reading/touches.h"

namespace selvage {

/// Stores the marks of a pose as block `marks<pose>`, and notes in the page that there is one: four int32, the number
/// of paths, of pairs, whether there are features, and the number of touches; by pack_integers() the shown vertex of
/// each path (or -1); of each path seven float32, its depth, `from` and `to`; by pack_integers() the triangles of each
/// pair, and its features; a byte for the kind of each; by pack_integers() the two shown vertices of each touch; then
/// in bytes the kind of each, its place (of 255), and x, y and z of its normal (of 127).
void add_marks(Page& page, const ShownSurface& surface, std::size_t pose, const Marks& marks,
               std::span<const Touch> touches = {});

}  // namespace selvage
