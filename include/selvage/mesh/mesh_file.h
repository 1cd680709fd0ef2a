#pragma once

#include "selvage/core/types.h"

#include <filesystem>
#include <string>

namespace selvage {

/// What a mesh file holds: vertices in the order of the file, never merged or dropped, and the elements that use them.
/// A file has tetrahedra, triangles, or both (some formats list a tetrahedral mesh's surface too).
struct MeshFile {
  std::vector<Vec3> positions;  ///< [m]
  std::vector<VertexTuple<4>> tetrahedra;
  std::vector<VertexTuple<3>> triangles;
};

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
MeshFile read_mesh(const std::filesystem::path& path);

/// The door of write_mesh(), to be asked before long work on a mesh of which only vertices will move.
/// @throws Error  unknown extension, or elements of a kind that the format does not have
void check_format_holds(const std::filesystem::path& path, const MeshFile& mesh);

/// Writes a mesh in the format of the extension; whole or not at all (written beside and renamed). Coordinates survive
/// a round trip bit for bit where the format can hold them (ASCII is written with the shortest exact digits; binary STL
/// and OFF hold floats only).
/// @throws Error        unknown extension, elements or coordinates that the format cannot hold
/// @throws SystemError  the file cannot be written
void write_mesh(const std::filesystem::path& path, const MeshFile& mesh, FileEncoding encoding = FileEncoding::kUsual);

/// The files that hold the mesh at this path: itself, and the other half of a TetGen pair.
/// @throws Error  unknown extension
std::vector<std::filesystem::path> files_of_mesh(const std::filesystem::path& path);

/// Named values, one per point or per cell, for VTK output. `components` values belong to each.
struct VtkField {
  std::string name;
  int components = 1;
  std::vector<double> values;
};

/// An unstructured VTK grid of points, lines, triangles and tetrahedra with fields, as ParaView reads it.
/// Cells are ordered lines, triangles, tetrahedra; cell fields follow that order.
struct VtkGrid {
  std::vector<Vec3> points;
  std::vector<VertexTuple<2>> lines;
  std::vector<VertexTuple<3>> triangles;
  std::vector<VertexTuple<4>> tetrahedra;
  std::vector<VtkField> point_fields;
  std::vector<VtkField> cell_fields;
};

/// Writes a .vtu file, whole or not at all.
/// @throws Error        when a field's size does not match
/// @throws SystemError  when the file cannot be written
void write_vtu(const std::filesystem::path& path, const VtkGrid& grid, FileEncoding encoding = FileEncoding::kUsual);

}  // namespace selvage
