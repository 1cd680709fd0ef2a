#pragma once

#include "selvage/mesh/indexed_mesh.h"

#include <cstdint>
#include <filesystem>

namespace selvage {

/// Red, green and blue, from 0 to 255.
using Colour8 = std::array<std::uint8_t, 3>;

/// Writes a surface as a binary .ply file with colours, whole or not at all. Programs show those of the vertices
/// (Blender, ParaView) or of the faces (MeshLab).
///
/// @param vertex_colours    (n_vertices)
/// @param triangle_colours  (n_triangles)
/// @throws Error        when the mesh is no legal surface, or numbers of colours do not match
/// @throws SystemError  when the file cannot be written
void write_coloured_ply(const std::filesystem::path& path, const IndexedMesh& mesh,
                        std::span<const Colour8> vertex_colours, std::span<const Colour8> triangle_colours);

}  // namespace selvage
