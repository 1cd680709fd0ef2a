#pragma once

#include "selvage/io/mesh_file.h"

#include <string>

namespace selvage {

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
