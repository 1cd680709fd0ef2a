#pragma once

#include "page/page.h"
#include "scene/reading/shown_surface.h"

namespace selvage {

/// Puts the surface in the page: blocks `triangles` and `vertices`, and its counts.
void add_surface(Page& page, const ShownSurface& surface);

/// Bytes of the block of a surface's triangles.
std::string pack_triangles(const ShownSurface& surface);

}  // namespace selvage
