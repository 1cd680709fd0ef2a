#include "bindings.h"
#include "selvage/mesh/weld.h"

namespace selvage::python {

namespace {

/// Rows of `neighbours`: what lies across each face, kNone on the boundary.
template <std::size_t N>
nb::object neighbour_elements(std::span<const std::array<HalfFace, N>> neighbours) {
  Column<std::int32_t> column(neighbours.size(), N);
  for (std::size_t i = 0; i < neighbours.size(); ++i)
    for (std::size_t k = 0; k < N; ++k)
      column.row(i)[k] = neighbours[i][k].exists() ? neighbours[i][k].element() : kNone;
  return std::move(column).array();
}

template <typename Mesh, typename Elements>
void init_mesh(Mesh* self, nb::handle vertices, nb::handle elements, const char* elements_name) {
  using Topology = decltype(self->topology);
  auto positions = decltype(self->positions)(vertices, "V");
  const auto rows = Rows<Elements>(elements, elements_name);
  if (std::ssize(positions.span()) > std::numeric_limits<Index>::max())
    throw Error("V", std::to_string(positions.span().size()) + " vertices were given", "give fewer than 2^31");
  const auto count = static_cast<Index>(positions.span().size());
  Topology topology = without_interpreter([&] { return Topology(count, rows.copy()); });
  new (self) Mesh{std::move(topology), std::move(positions)};
}

constexpr const char* kVerticesDoc = R"((n, D) float64: positions of the vertices [m].

The array that the mesh was made of, where that could be used in place. Assigning another array of the same shape gives
the mesh a new pose; finders take it by `update()`.)";

/// What solid and planar meshes have in common.
template <int D>
auto bind_simplex_mesh(nb::module_& m, const char* name, const char* elements_name, const char* doc) {
  using Mesh = PlacedMesh<SimplexMesh<D>, D>;
  using Elements = VertexTuple<D + 1>;
  nb::class_<Mesh> type(m, name, nb::is_weak_referenceable(), doc);
  type.def(
          "__init__",
          [](Mesh* self, nb::object v, nb::object e) { init_mesh<Mesh, Elements>(self, v, e, D == 3 ? "T" : "F"); },
          nb::arg("V").none(), nb::arg(elements_name).none(),
          D == 3 ? nb::sig("def __init__(self, V: ArrayLike, T: ArrayLike) -> None")
                 : nb::sig("def __init__(self, V: ArrayLike, F: ArrayLike) -> None"))
      .def_prop_rw(
          "V", [](const Mesh& self) { return self.positions.array(); }, [](Mesh& self, nb::object v) { self.place(v); },
          nb::for_getter(nb::sig("def V(self) -> Floats")),
          nb::for_setter(nb::sig("def V(self, V: ArrayLike, /) -> None")), kVerticesDoc)
      .def_prop_ro(
          elements_name, [](const Mesh& self) { return array_of(self.topology.elements()); },
          D == 3 ? nb::sig("def T(self) -> Ints") : nb::sig("def F(self) -> Ints"),
          "(m, D + 1) int32: vertices of each element. A new array.")
      .def_prop_ro(
          "boundary_faces", [](const Mesh& self) { return array_of(self.topology.boundary_faces()); },
          nb::sig("def boundary_faces(self) -> Ints"),
          "(b, D) int32: vertices of each boundary face, listed so that normals point outward.")
      .def_prop_ro(
          "boundary_elements",
          [](const Mesh& self) {
            const auto owners = self.topology.boundary_owners();
            Column<std::int32_t> column(owners.size());
            for (std::size_t i = 0; i < owners.size(); ++i) column[i] = owners[i].element();
            return std::move(column).array();
          },
          nb::sig("def boundary_elements(self) -> Ints"), "(b,) int32: the element that each boundary face belongs to.")
      .def_prop_ro(
          "boundary_vertices", [](const Mesh& self) { return array_of(self.topology.boundary_vertices()); },
          nb::sig("def boundary_vertices(self) -> Ints"), "(k,) int32: vertices on the boundary, ascending.")
      .def_prop_ro(
          "neighbours", [](const Mesh& self) { return neighbour_elements(self.topology.neighbours()); },
          nb::sig("def neighbours(self) -> Ints"),
          "(m, D + 1) int32: the element across the face opposite to each vertex; -1 on the boundary.")
      .def_prop_ro(
          "edges",
          [](const Mesh& self) { return array_of(without_interpreter([&] { return self.topology.edges(); })); },
          nb::sig("def edges(self) -> Ints"), "(e, 2) int32: edges of all elements, each once, in lexicographic order.")
      .def_prop_ro(
          "components", [](const Mesh& self) { return array_of(self.topology.element_components()); },
          nb::sig("def components(self) -> Ints"),
          "(m,) int32: connected component (across faces) of each element, from 0 on.")
      .def("__repr__", [name = std::string(name)](const Mesh& self) {
        return "selvage." + name + "(" + std::to_string(self.topology.vertex_count()) + " vertices, " +
               std::to_string(self.topology.element_count()) + " elements, " +
               std::to_string(self.topology.boundary_face_count()) + " boundary faces)";
      });
  return type;
}

}  // namespace

void bind_meshes(nb::module_& m) {
  nb::class_<PlacedTriangleMesh> surface(m, "TriangleMesh", nb::is_weak_referenceable(),
                                         R"(A triangle surface in space: open, closed, of several parts or non-manifold.

Parameters
----------
V : (n, 3) array
    Positions [m]. float64 in C order is used in place, anything else converted.
F : (m, 3) array of whole numbers
    Vertices of each triangle, from 0.

Raises
------
selvage.Error
    When an array has another shape or type, there is no triangle, an index is out of range, or a triangle repeats a
    vertex.

Examples
--------
>>> mesh = selvage.TriangleMesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
>>> mesh
selvage.TriangleMesh(3 vertices, 1 triangles)
>>> mesh.edges
array([[0, 1],
       [0, 2],
       [1, 2]], dtype=int32)
)");
  surface
      .def(
          "__init__",
          [](PlacedTriangleMesh* self, nb::object v, nb::object f) {
            init_mesh<PlacedTriangleMesh, VertexTuple<3>>(self, v, f, "F");
          },
          nb::arg("V").none(), nb::arg("F").none(), nb::sig("def __init__(self, V: ArrayLike, F: ArrayLike) -> None"))
      .def_prop_rw(
          "V", [](const PlacedTriangleMesh& self) { return self.positions.array(); },
          [](PlacedTriangleMesh& self, nb::object v) { self.place(v); },
          nb::for_getter(nb::sig("def V(self) -> Floats")),
          nb::for_setter(nb::sig("def V(self, V: ArrayLike, /) -> None")), kVerticesDoc)
      .def_prop_ro(
          "F", [](const PlacedTriangleMesh& self) { return array_of(self.topology.triangles()); },
          nb::sig("def F(self) -> Ints"), "(m, 3) int32: vertices of each triangle. A new array.")
      .def_prop_ro(
          "edges", [](const PlacedTriangleMesh& self) { return array_of(self.topology.edges()); },
          nb::sig("def edges(self) -> Ints"),
          "(e, 2) int32: each edge once, vertices ascending, in lexicographic order. Pairs of edges name these rows.")
      .def_prop_ro(
          "triangle_edges", [](const PlacedTriangleMesh& self) { return array_of(self.topology.triangle_edges()); },
          nb::sig("def triangle_edges(self) -> Ints"), "(m, 3) int32: the edge opposite to each vertex of a triangle.")
      .def_prop_ro(
          "neighbours", [](const PlacedTriangleMesh& self) { return neighbour_elements(self.topology.neighbours()); },
          nb::sig("def neighbours(self) -> Ints"),
          "(m, 3) int32: the triangle across the edge opposite to each vertex; -1 where an edge has not two triangles.")
      .def_prop_ro(
          "is_oriented", [](const PlacedTriangleMesh& self) { return self.topology.is_oriented(); },
          "Whether neighbours agree on which side of the surface is which.")
      .def_prop_ro(
          "pieces",
          [](const PlacedTriangleMesh& self) {
            return array_of(without_interpreter([&] { return connected_pieces(self.topology); }));
          },
          nb::sig("def pieces(self) -> Ints"),
          "(m,) int32: connected piece of each triangle, from 0 on: triangles with a common vertex are of one piece. "
          "As "
          "`PairFilters(groups=mesh.pieces)` they leave only the pairs of different pieces.")
      .def(
          "weld",
          [](const PlacedTriangleMesh& self) {
            IndexedMesh mesh{.positions = self.positions.copy(),
                             .tetrahedra = {},
                             .triangles = {self.topology.triangles().begin(), self.topology.triangles().end()}};
            std::vector<Index> numbers;
            TriangleMesh surface = without_interpreter([&] {
              numbers = weld_triangles(mesh, find_first_in_place(mesh.positions));
              return TriangleMesh(static_cast<Index>(mesh.positions.size()), std::move(mesh.triangles));
            });
            if (numbers.empty())
              for (Index t = 0; t < surface.triangle_count(); ++t) numbers.push_back(t);
            nb::object placed =
                nb::cast(PlacedTriangleMesh{std::move(surface), Rows<Vec3>(self.positions.array(), "V")});
            return nb::make_tuple(std::move(placed), array_of(numbers));
          },
          nb::sig("def weld(self) -> tuple[TriangleMesh, Ints]"),
          R"(The same surface, its vertices joined where they are in one place, as those of an STL file.

Returns
-------
TriangleMesh
    On the same vertices; those that are no longer used stay.
(k,) int32
    The number that each of its triangles had before: those with two corners in one place are left out.

Raises
------
selvage.Error
    When no triangle is left.

Examples
--------
>>> V = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
>>> mesh, numbers = selvage.TriangleMesh(V, [[0, 1, 2], [3, 4, 5]]).weld()
>>> mesh.F
array([[0, 1, 2],
       [1, 4, 2]], dtype=int32)
)")
      .def("__repr__", [](const PlacedTriangleMesh& self) {
        return "selvage.TriangleMesh(" + std::to_string(self.topology.vertex_count()) + " vertices, " +
               std::to_string(self.topology.triangle_count()) + " triangles)";
      });

  bind_simplex_mesh<3>(m, "TetMesh", "T", R"(A mesh of tetrahedra.

Parameters
----------
V : (n, 3) array
    Positions [m]. float64 in C order is used in place, anything else converted.
T : (m, 4) array of whole numbers
    Vertices of each tetrahedron, from 0; positive where det(v1 - v0, v2 - v0, v3 - v0) > 0.

Raises
------
selvage.Error
    When an array has another shape or type, there is no element, an index is out of range, an element repeats a
    vertex, or more than two elements share a face.

Examples
--------
>>> mesh = selvage.TetMesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 1, 2, 3]])
>>> mesh
selvage.TetMesh(4 vertices, 1 elements, 4 boundary faces)
>>> mesh.surface()
selvage.TriangleMesh(4 vertices, 4 triangles)
)")
      .def(
          "surface",
          [](const PlacedTetMesh& self) {
            TriangleMesh surface = without_interpreter([&] { return boundary_surface(self.topology); });
            return PlacedTriangleMesh{std::move(surface), Rows<Vec3>(self.positions.array(), "V")};
          },
          nb::sig("def surface(self) -> TriangleMesh"),
          R"(The boundary as a TriangleMesh, outward; triangle i is boundary face i. Vertices keep their numbers.)");

  bind_simplex_mesh<2>(m, "PlanarMesh", "F", R"(A mesh of triangles in the plane.

Parameters
----------
V : (n, 2) array
    Positions [m].
F : (m, 3) array of whole numbers
    Vertices of each triangle, from 0, counter-clockwise.

Raises
------
selvage.Error
    As TetMesh.

Examples
--------
>>> selvage.PlanarMesh([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]]).boundary_faces
array([[1, 2],
       [2, 0],
       [0, 1]], dtype=int32)
)");
}

}  // namespace selvage::python
