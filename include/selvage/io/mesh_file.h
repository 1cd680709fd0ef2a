#pragma once

#include "selvage/mesh/indexed_mesh.h"

#include <filesystem>

namespace selvage {

/// How a format that has both is written.
enum class FileEncoding {
  kUsual,  ///< binary; ASCII for OFF, of which few programs read the binary form
  kAscii,
  kBinary,
};

/// Reads a mesh; the format follows from the file's extension:
/// .obj .ply .stl .off (surfaces; polygons are split into fans), .t, TetGen .node or .ele (its twin is found beside
/// it), MEDIT .mesh, Gmsh .msh (2.2 and 4.1), VTK .vtk (legacy) and .vtu; ASCII and binary where the format has both.
///
/// STL has no shared vertices: each triangle gets three vertices of its own.
/// @throws Error  one line with the file and the line or byte offset: unknown extension, truncated file, wrong counts,
///                counts larger than the file can hold, NaN or infinite coordinates, indices out of range, a repeated
///                vertex in an element, no element at all
IndexedMesh read_mesh(const std::filesystem::path& path);

/// Checks whether write_mesh() could write this mesh. Call it before long work that moves vertices only.
/// @throws Error  unknown extension, or elements of a kind that the format does not have
void check_format_holds(const std::filesystem::path& path, const IndexedMesh& mesh);

/// Whether the format of the extension holds tetrahedra, or surfaces only.
/// @throws Error  unknown extension
bool holds_tetrahedra(const std::filesystem::path& path);

/// Writes a mesh in the format of the extension; whole or not at all (written beside and renamed). Coordinates survive
/// a round trip bit for bit where the format can hold them (ASCII is written with the shortest exact digits; binary STL
/// and OFF hold floats only).
/// @throws Error        unknown extension, elements or coordinates that the format cannot hold
/// @throws SystemError  the file cannot be written
void write_mesh(const std::filesystem::path& path, const IndexedMesh& mesh,
                FileEncoding encoding = FileEncoding::kUsual);

/// The files that hold the mesh at this path: itself, and the other half of a TetGen pair.
/// @throws Error  unknown extension
std::vector<std::filesystem::path> files_of_mesh(const std::filesystem::path& path);

}  // namespace selvage
