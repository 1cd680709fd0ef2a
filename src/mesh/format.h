#pragma once

#include "selvage/mesh/mesh_file.h"

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
MeshFile parse_mesh(std::string_view extension, const Source& source, const Source& twin = {});

MeshFile parse_obj(const Source& source);
MeshFile parse_ply(const Source& source);
MeshFile parse_stl(const Source& source);
MeshFile parse_off(const Source& source);
MeshFile parse_t(const Source& source);
MeshFile parse_tetgen(const Source& nodes, const Source& elements);
MeshFile parse_medit(const Source& source);
MeshFile parse_gmsh(const Source& source);
MeshFile parse_vtk(const Source& source);
MeshFile parse_vtu(const Source& source);

std::string print_obj(const MeshFile& mesh);
std::string print_ply(const MeshFile& mesh, FileEncoding encoding);
/// STL and OFF. @throws Error  when a coordinate does not fit in a float and the encoding is binary
std::string print_stl(const MeshFile& mesh, FileEncoding encoding);
std::string print_off(const MeshFile& mesh, FileEncoding encoding);
std::string print_t(const MeshFile& mesh);
std::string print_tetgen_nodes(const MeshFile& mesh);
std::string print_tetgen_elements(const MeshFile& mesh);
std::string print_medit(const MeshFile& mesh);
std::string print_gmsh(const MeshFile& mesh, FileEncoding encoding);
std::string print_vtk(const MeshFile& mesh, FileEncoding encoding);
std::string print_vtu(const VtkGrid& grid, FileEncoding encoding);

}  // namespace selvage::format
