#pragma once

#include "page/marks.h"
#include "page/page.h"
#include "selvage/io/mesh_file.h"

#include <filesystem>

namespace selvage {

/// The page of a mesh, as it stands: a surface, or the boundary of tetrahedra.
/// @throws Error  as read_mesh(), or when the page would be longer than browsers open
std::string print_mesh_page(const std::filesystem::path& path);

/// Puts a mesh in a page: its surface, its poses one after the other, and what is marked in the first.
/// @param other_pose  null, or positions of the same vertices: a second pose, which a slider blends with the first
void add_mesh(Page& page, const IndexedMesh& mesh, const std::vector<Vec3>* other_pose, const Marks& marks);

}  // namespace selvage
