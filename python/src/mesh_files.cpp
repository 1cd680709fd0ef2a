#include "bindings.h"
#include "selvage/io/coloured_ply.h"
#include "selvage/io/mesh_file.h"
#include "selvage/io/vtu.h"

#include <nanobind/stl/vector.h>

namespace selvage::python {

namespace {

IndexedMesh indexed_mesh(nb::handle vertices, nb::handle triangles, nb::handle tetrahedra) {
  return {.positions = Rows<Vec3>(vertices, "V").copy(),
          .tetrahedra = rows_or_none<VertexTuple<4>>(tetrahedra, "T").copy(),
          .triangles = rows_or_none<VertexTuple<3>>(triangles, "F").copy()};
}

FileEncoding encoding_of(const std::string& name) {
  if (name == "usual") return FileEncoding::kUsual;
  if (name == "ascii") return FileEncoding::kAscii;
  if (name == "binary") return FileEncoding::kBinary;
  throw Error("encoding", "there is no '" + name + "'", "choose one of usual, ascii, binary");
}

std::vector<Colour8> colours_of(nb::handle array, const char* name) {
  const Rows<std::uint8_t> flat(array, name);
  if (flat.span().size() % 3 != 0) throw Error(name, "is no array of colours", "give (k, 3) numbers from 0 to 255");
  std::vector<Colour8> colours(flat.span().size() / 3);
  for (std::size_t i = 0; i < colours.size(); ++i) std::copy_n(flat.span().data() + 3 * i, 3, colours[i].data());
  return colours;
}

/// Fields of a dict of one-dimensional arrays, each with so many values that they belong to rows.
std::vector<VtkField> fields_of(const nb::dict& fields, std::size_t rows) {
  std::vector<VtkField> result;
  for (const auto [key, value] : fields) {
    const auto name = nb::cast<std::string>(nb::str(key));
    const Rows<double> values(value, name.c_str());
    const std::size_t count = values.span().size();
    const std::size_t components = rows == 0 || count % rows != 0 ? 1 : std::max<std::size_t>(count / rows, 1);
    result.push_back({.name = name, .components = static_cast<int>(components), .values = values.copy()});
  }
  return result;
}

void bind_results(nb::module_& m) {
  m.def(
      "write_coloured_arrays",
      [](const std::filesystem::path& path, nb::object v, nb::object f, nb::object vertices, nb::object triangles) {
        const IndexedMesh mesh = indexed_mesh(v, f, nb::none());
        const std::vector<Colour8> of_vertices = colours_of(vertices, "vertex_colours"),
                                   of_triangles = colours_of(triangles, "triangle_colours");
        without_interpreter([&] { write_coloured_ply(path, mesh, of_vertices, of_triangles); });
      },
      nb::arg("path"), nb::arg("V").none(), nb::arg("F").none(), nb::arg("vertex_colours"), nb::arg("triangle_colours"),
      nb::sig("def write_coloured_arrays(path: str | os.PathLike[str], V: ArrayLike, F: ArrayLike, "
              "vertex_colours: ArrayLike, triangle_colours: ArrayLike) -> None"),
      "Writes a surface with flat arrays of colours. See `selvage.write_coloured_ply`.");
  m.def(
      "write_vtu_arrays",
      [](const std::filesystem::path& path, nb::object v, nb::object f, nb::object t, const nb::dict& points,
         const nb::dict& cells) {
        IndexedMesh mesh = indexed_mesh(v, f, t);
        const std::size_t cell_count = mesh.triangles.size() + mesh.tetrahedra.size();
        VtkGrid grid;
        grid.point_fields = fields_of(points, mesh.positions.size());
        grid.cell_fields = fields_of(cells, cell_count);
        grid.points = std::move(mesh.positions);
        grid.triangles = std::move(mesh.triangles);
        grid.tetrahedra = std::move(mesh.tetrahedra);
        without_interpreter([&] { write_vtu(path, grid); });
      },
      nb::arg("path"), nb::arg("V").none(), nb::arg("F").none(), nb::arg("T").none(), nb::arg("point_fields"),
      nb::arg("cell_fields"),
      nb::sig("def write_vtu_arrays(path: str | os.PathLike[str], V: ArrayLike, F: ArrayLike | None, "
              "T: ArrayLike | None, point_fields: dict[str, Any], cell_fields: dict[str, Any]) -> None"),
      "Writes a grid with flat fields. See `selvage.write_vtu`.");
  m.def(
      "read_labels",
      [](const std::filesystem::path& path) {
        const IndexedMesh mesh = without_interpreter([&] { return read_mesh(path); });
        return nb::make_tuple(array_of(mesh.faces), array_of(mesh.groups), mesh.group_names);
      },
      nb::arg("path"), nb::sig("def read_labels(path: str | os.PathLike[str]) -> tuple[Ints, Ints, list[str]]"),
      "The file's face and the group of each triangle, where there are any, and the names of the groups.");
  m.def("holds_tetrahedra", &holds_tetrahedra, nb::arg("path"),
        nb::sig("def holds_tetrahedra(path: str | os.PathLike[str]) -> bool"),
        R"(Whether the format of a path's extension holds tetrahedra, or surfaces only.

Parameters
----------
path : path

Raises
------
selvage.Error
    For an unknown extension.

Examples
--------
>>> selvage.holds_tetrahedra("a.msh"), selvage.holds_tetrahedra("a.obj")
(True, False)
)");
}

}  // namespace

void bind_mesh_files(nb::module_& m) {
  bind_results(m);
  m.def(
      "read_arrays",
      [](const std::filesystem::path& path) {
        const IndexedMesh mesh = without_interpreter([&] { return read_mesh(path); });
        return nb::make_tuple(array_of(mesh.positions), array_of(mesh.triangles), array_of(mesh.tetrahedra));
      },
      nb::arg("path"), nb::sig("def read_arrays(path: str | os.PathLike[str]) -> tuple[Floats, Ints, Ints]"),
      R"(Reads the arrays of a mesh file: (V, F, T), as the file holds them.

Parameters
----------
path : path
    .obj .ply .stl .off .t .node .ele .mesh .msh .vtk .vtu, ASCII or binary.

Returns
-------
V : (n, 3) float64, F : (k, 3) int32, T : (m, 4) int32
    Positions [m], triangles, tetrahedra; those that the file does not hold are empty. Vertices keep their order and
    are never merged.

Raises
------
selvage.Error
    One line with the file and the line or byte offset.
)");
  m.def(
      "write_arrays",
      [](const std::filesystem::path& path, nb::object v, nb::object f, nb::object t, const std::string& encoding) {
        const IndexedMesh mesh = indexed_mesh(v, f, t);
        const FileEncoding how = encoding_of(encoding);
        without_interpreter([&] { write_mesh(path, mesh, how); });
      },
      nb::arg("path"), nb::arg("V").none(), nb::kw_only(), nb::arg("F").none() = nb::none(),
      nb::arg("T").none() = nb::none(), nb::arg("encoding") = "usual",
      nb::sig("def write_arrays(path: str | os.PathLike[str], V: ArrayLike, *, F: ArrayLike | None = None, "
              "T: ArrayLike | None = None, encoding: str = 'usual') -> None"),
      R"(Writes arrays as a mesh file, whole or not at all.

Parameters
----------
path : path
    Its extension names the format, see `read_arrays`.
V, F, T : arrays
    Positions [m], triangles, tetrahedra.
encoding : str
    'usual' (binary where the format has it), 'ascii' or 'binary'.

Raises
------
selvage.Error
    When the format cannot hold the mesh.
selvage.SystemError
    When the file cannot be written.
)");
}

}  // namespace selvage::python
