#include "selvage/io/mesh_file.h"
#include "selvage/io/coloured_ply.h"
#include "selvage/io/vtu.h"

#include "io/format.h"
#include "io/whole_file.h"
#include "selvage/core/error.h"

#include <fmt/format.h>

#include <algorithm>

namespace selvage {

namespace {

namespace fs = std::filesystem;
using format::Source;

constexpr FileEncoding kAscii = FileEncoding::kAscii, kBinary = FileEncoding::kBinary;

/// The format of each extension. A printer without encoding writes ASCII only.
struct Format {
  std::string_view extension;
  IndexedMesh (*parse)(const Source& source);
  std::string (*print)(const IndexedMesh& mesh, FileEncoding encoding);
  bool holds_triangles;
  bool holds_tetrahedra;
  FileEncoding usual;
};

template <std::string (*Print)(const IndexedMesh&)>
std::string ascii_only(const IndexedMesh& mesh, FileEncoding) {
  return Print(mesh);
}

std::string print_vtu_mesh(const IndexedMesh& mesh, FileEncoding encoding) {
  VtkGrid grid;
  grid.points = mesh.positions;
  grid.triangles = mesh.triangles;
  grid.tetrahedra = mesh.tetrahedra;
  return format::print_vtu(grid, encoding);
}

constexpr Format kFormats[] = {
    {".obj", format::parse_obj, ascii_only<format::print_obj>, true, false, kAscii},
    {".ply", format::parse_ply, format::print_ply, true, false, kBinary},
    {".stl", format::parse_stl, format::print_stl, true, false, kBinary},
    {".off", format::parse_off, format::print_off, true, false, kAscii},
    {".t", format::parse_t, ascii_only<format::print_t>, false, true, kAscii},
    {".node", nullptr, nullptr, false, true, kAscii},
    {".ele", nullptr, nullptr, false, true, kAscii},
    {".mesh", format::parse_medit, ascii_only<format::print_medit>, true, true, kAscii},
    {".msh", format::parse_gmsh, format::print_gmsh, true, true, kBinary},
    {".vtk", format::parse_vtk, format::print_vtk, true, true, kBinary},
    {".vtu", format::parse_vtu, print_vtu_mesh, true, true, kBinary},
};

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return result;
}

const Format& find_format(std::string_view extension, std::string_view name) {
  const std::string wanted = lower(extension);
  for (const Format& format : kFormats) {
    if (format.extension == wanted) return format;
  }
  throw Error(name,
              extension.empty() ? "the file has no extension" : fmt::format("the extension '{}' is unknown", extension),
              "use .obj .ply .stl .off .t .node .ele .mesh .msh .vtk or .vtu");
}

bool is_tetgen(const Format& format) {
  return format.parse == nullptr;
}

template <std::size_t N>
void check_elements(const std::vector<VertexTuple<N>>& elements, std::size_t vertex_count, std::string_view kind,
                    std::string_view name) {
  for (std::size_t i = 0; i < elements.size(); ++i) {
    for (const Index v : elements[i]) {
      if (v >= 0 && static_cast<std::size_t>(v) < vertex_count) continue;
      throw Error(name, fmt::format("{} {} uses vertex {}, but there are {}", kind, i, v, vertex_count),
                  "number vertices from 0");
    }
  }
}

void check_positions(const std::vector<Vec3>& positions, std::string_view name) {
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (positions[i].allFinite()) continue;
    throw Error(name, fmt::format("a coordinate of vertex {} is not finite", i), "write finite positions only");
  }
}

void check_writable(const IndexedMesh& mesh, const Format& format, std::string_view name) {
  const auto refuse = [&](std::string_view elements) {
    throw Error(name, fmt::format("a {} file holds no {}", format.extension, elements),
                "write .msh, .vtu, .vtk or .mesh");
  };
  if (mesh.triangles.empty() && mesh.tetrahedra.empty())
    throw Error(name, "the mesh has no element", "write at least one");
  if (!mesh.triangles.empty() && !format.holds_triangles) refuse("triangles");
  if (!mesh.tetrahedra.empty() && !format.holds_tetrahedra) refuse("tetrahedra");
}

void check_content(const IndexedMesh& mesh, std::string_view name) {
  check_positions(mesh.positions, name);
  check_elements(mesh.triangles, mesh.positions.size(), "triangle", name);
  check_elements(mesh.tetrahedra, mesh.positions.size(), "tetrahedron", name);
  if (mesh.groups.empty()) return;
  const auto is_known = [&](Index g) { return g >= kNone && g < std::ssize(mesh.group_names); };
  if (mesh.groups.size() != mesh.triangles.size() || !std::all_of(mesh.groups.begin(), mesh.groups.end(), is_known))
    throw Error(name, "the groups do not fit the triangles", "give each triangle the number of a name, or none");
}

void check_fields(const std::vector<VtkField>& fields, std::size_t count, std::string_view kind,
                  std::string_view name) {
  for (const VtkField& field : fields) {
    if (field.components >= 1 && field.values.size() == count * static_cast<std::size_t>(field.components)) continue;
    throw Error(name,
                fmt::format("the {} field '{}' has {} values for {} {}s of {} components", kind, field.name,
                            field.values.size(), count, kind, field.components),
                "give each its values");
  }
}

/// The other file of a TetGen pair, with the case of the extension kept.
fs::path twin_of(const fs::path& path) {
  const std::string extension = path.extension().string();
  const bool upper = extension.size() > 1 && extension[1] >= 'A' && extension[1] <= 'Z';
  fs::path twin = path;
  if (lower(extension) == ".node") return twin.replace_extension(upper ? ".ELE" : ".ele");
  return twin.replace_extension(upper ? ".NODE" : ".node");
}

}  // namespace

IndexedMesh format::parse_mesh(std::string_view extension, const Source& source, const Source& twin) {
  const Format& format = find_format(extension, source.name);
  IndexedMesh mesh;
  if (is_tetgen(format)) {
    const bool nodes_first = format.extension == ".node";
    mesh = parse_tetgen(nodes_first ? source : twin, nodes_first ? twin : source);
  } else {
    mesh = format.parse(source);
  }
  if (mesh.triangles.empty() && mesh.tetrahedra.empty()) {
    throw Error(source.name, "the file has no triangle and no tetrahedron", "give a file with at least one");
  }
  return mesh;
}

std::vector<fs::path> files_of_mesh(const fs::path& path) {
  if (is_tetgen(find_format(path.extension().string(), path.string()))) return {path, twin_of(path)};
  return {path};
}

IndexedMesh read_mesh(const fs::path& path) {
  const std::string name = path.string(), extension = path.extension().string();
  const Format& found = find_format(extension, name);
  const std::string bytes = read_whole_file(path);
  if (!is_tetgen(found)) return format::parse_mesh(extension, {bytes, name});
  const fs::path twin = twin_of(path);
  if (!fs::exists(twin)) {
    throw Error(name, fmt::format("its other half {} is missing", twin.string()), "put it beside the file");
  }
  const std::string twin_bytes = read_whole_file(twin), twin_name = twin.string();
  return format::parse_mesh(extension, {bytes, name}, {twin_bytes, twin_name});
}

void check_format_holds(const fs::path& path, const IndexedMesh& mesh) {
  const std::string name = path.string();
  check_writable(mesh, find_format(path.extension().string(), name), name);
}

bool holds_tetrahedra(const fs::path& path) {
  return find_format(path.extension().string(), path.string()).holds_tetrahedra;
}

void write_mesh(const fs::path& path, const IndexedMesh& mesh, FileEncoding encoding) {
  const std::string name = path.string();
  const Format& found = find_format(path.extension().string(), name);
  check_writable(mesh, found, name);
  check_content(mesh, name);
  if (!is_tetgen(found)) {
    const std::string bytes = found.print(mesh, encoding == FileEncoding::kUsual ? found.usual : encoding);
    return write_whole_files(std::array{FileContent{path, bytes}});
  }
  std::string first = format::print_tetgen_nodes(mesh), second = format::print_tetgen_elements(mesh);
  if (found.extension == ".ele") std::swap(first, second);
  write_whole_files(std::array{FileContent{path, first}, FileContent{twin_of(path), second}});
}

void write_coloured_ply(const fs::path& path, const IndexedMesh& mesh, std::span<const Colour8> vertex_colours,
                        std::span<const Colour8> triangle_colours) {
  const std::string name = path.string();
  check_writable(mesh, find_format(".ply", name), name);
  check_content(mesh, name);
  if (vertex_colours.size() != mesh.positions.size() || triangle_colours.size() != mesh.triangles.size())
    throw Error(name,
                fmt::format("{} and {} colours for {} vertices and {} triangles", vertex_colours.size(),
                            triangle_colours.size(), mesh.positions.size(), mesh.triangles.size()),
                "give one for each");
  const std::string bytes = format::print_ply(mesh, kBinary, vertex_colours, triangle_colours);
  write_whole_files(std::array{FileContent{path, bytes}});
}

void write_vtu(const fs::path& path, const VtkGrid& grid, FileEncoding encoding) {
  const std::string name = path.string();
  const std::size_t cells = grid.lines.size() + grid.triangles.size() + grid.tetrahedra.size();
  check_fields(grid.point_fields, grid.points.size(), "point", name);
  check_fields(grid.cell_fields, cells, "cell", name);
  check_positions(grid.points, name);
  check_elements(grid.lines, grid.points.size(), "line", name);
  check_elements(grid.triangles, grid.points.size(), "triangle", name);
  check_elements(grid.tetrahedra, grid.points.size(), "tetrahedron", name);
  const std::string bytes = format::print_vtu(grid, encoding == FileEncoding::kUsual ? kBinary : encoding);
  write_whole_files(std::array{FileContent{path, bytes}});
}

}  // namespace selvage
