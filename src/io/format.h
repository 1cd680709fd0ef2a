#pragma once

#include "selvage/io/coloured_ply.h"
#include "selvage/io/mesh_file.h"
#include "selvage/io/vtu.h"

#include <string>
#include <string_view>

/// The mesh file formats behind selvage/mesh/mesh_file.h, one reader and one writer each, from and to memory: no
/// function here touches the disk.
namespace selvage::format {

/// A file's content and the name that error messages give it.
struct Source {
  std::string_view bytes;
  std::string_view name;
};

/// Reads a mesh of the format that `extension` (with its dot, any case) names; checks all that read_mesh promises.
///
/// @param twin  the other file of a format made of two: for .node the .ele and the other way round
/// @throws Error  as read_mesh does
IndexedMesh parse_mesh(std::string_view extension, const Source& source, const Source& twin = {});

IndexedMesh parse_obj(const Source& source);
IndexedMesh parse_ply(const Source& source);
IndexedMesh parse_stl(const Source& source);
IndexedMesh parse_off(const Source& source);
IndexedMesh parse_t(const Source& source);
IndexedMesh parse_tetgen(const Source& nodes, const Source& elements);
IndexedMesh parse_medit(const Source& source);
IndexedMesh parse_gmsh(const Source& source);
IndexedMesh parse_vtk(const Source& source);
IndexedMesh parse_vtu(const Source& source);

std::string print_obj(const IndexedMesh& mesh);
std::string print_ply(const IndexedMesh& mesh, FileEncoding encoding);
/// With colours where there are any.
std::string print_ply(const IndexedMesh& mesh, FileEncoding encoding, std::span<const Colour8> vertex_colours,
                      std::span<const Colour8> triangle_colours);
/// STL and OFF. @throws Error  when a coordinate does not fit in a float and the encoding is binary
std::string print_stl(const IndexedMesh& mesh, FileEncoding encoding);
std::string print_off(const IndexedMesh& mesh, FileEncoding encoding);
std::string print_t(const IndexedMesh& mesh);
std::string print_tetgen_nodes(const IndexedMesh& mesh);
std::string print_tetgen_elements(const IndexedMesh& mesh);
std::string print_medit(const IndexedMesh& mesh);
std::string print_gmsh(const IndexedMesh& mesh, FileEncoding encoding);
std::string print_vtk(const IndexedMesh& mesh, FileEncoding encoding);
std::string print_vtu(const VtkGrid& grid, FileEncoding encoding);

}  // namespace selvage::format
