#include "bindings.h"
#include "selvage/io/mesh_file.h"

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

}  // namespace

void bind_mesh_files(nb::module_& m) {
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
