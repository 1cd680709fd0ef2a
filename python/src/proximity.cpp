#include "selvage/self_collision/proximity.h"

#include "bindings.h"

namespace selvage::python {

namespace {

struct NearFinder {
  nb::object mesh_owner;
  const PlacedTriangleMesh* mesh;
  std::shared_ptr<Watch> watch;
  std::unique_ptr<ProximityFinder> finder;
};

nb::object near_arrays(const NearPairs& pairs) {
  const std::size_t faces = pairs.vertex_face.size(), edges = pairs.edge_edge.size();
  Column<std::int32_t> vertex_face(faces, 2), edge_edge(edges, 2);
  Column<double> face_distance(faces), barycentric(faces, 3), face_nearest(faces, 6);
  Column<double> edge_distance(edges), place(edges, 2), edge_nearest(edges, 6);
  for (std::size_t i = 0; i < faces; ++i) {
    const NearVertexFace& pair = pairs.vertex_face[i];
    vertex_face.row(i)[0] = pair.vertex;
    vertex_face.row(i)[1] = pair.face;
    face_distance[i] = pair.distance;
    std::copy_n(pair.barycentric.data(), 3, barycentric.row(i));
    for (int k = 0; k < 6; ++k) face_nearest.row(i)[k] = pair.nearest[k / 3][k % 3];
  }
  for (std::size_t i = 0; i < edges; ++i) {
    const NearEdges& pair = pairs.edge_edge[i];
    edge_edge.row(i)[0] = pair.first;
    edge_edge.row(i)[1] = pair.second;
    edge_distance[i] = pair.distance;
    std::copy_n(pair.place.data(), 2, place.row(i));
    for (int k = 0; k < 6; ++k) edge_nearest.row(i)[k] = pair.nearest[k / 3][k % 3];
  }
  return result_class("NearPairs")(std::move(vertex_face).array(), std::move(edge_edge).array(),
                                   std::move(face_distance).array(), std::move(edge_distance).array(),
                                   std::move(barycentric).array(), std::move(place).array(),
                                   std::move(face_nearest).array().attr("reshape")(faces, 2, 3),
                                   std::move(edge_nearest).array().attr("reshape")(edges, 2, 3));
}

}  // namespace

void bind_proximity(nb::module_& m) {
  nb::class_<NearFinder>(m, "ProximityFinder", nb::type_slots(CollectedWatch<NearFinder>::slots),
                         R"(Pairs of a surface within a distance of each other: vertices and faces, edges and edges.

Parameters
----------
mesh : selvage.TriangleMesh
    Kept alive by the finder.
V : (n, 3) array, optional
    Positions [m]; those of the mesh where None. Copied.
distance : float
    Pairs count that are nearer; positive [m].
filters : selvage.PairFilters, optional
progress : function, optional
    Called during a query with the share that is done, on any thread.

Raises
------
selvage.Error
    When sizes differ, a position or the distance is not finite or not positive, or a filter does not fit the mesh.

Examples
--------
>>> V = [[0, 0, 0], [4, 0, 0], [0, 4, 0], [1, 1, 0.25], [-1, 1, 2], [-1, 2, 0.5]]
>>> finder = selvage.ProximityFinder(selvage.TriangleMesh(V, [[0, 1, 2], [3, 4, 5]]), distance=0.5)
>>> near = finder.find_pairs()
>>> near.vertex_face, near.vertex_face_distance
(array([[3, 0]], dtype=int32), array([0.25]))
)")
      .def(
          "__init__",
          [](NearFinder* self, nb::object mesh, nb::object v, double distance, nb::object filters,
             nb::object progress) {
            const auto& placed = mesh_argument<PlacedTriangleMesh>(mesh);
            const Rows<Vec3> x = placed.positions_or(v);
            const auto watch = std::make_shared<Watch>(std::move(progress));
            PairFilters chosen = filters_of(filters);
            auto finder = without_interpreter([&] {
              return std::make_unique<ProximityFinder>(placed.topology, x.span(), distance, std::move(chosen),
                                                       progress_of(watch));
            });
            new (self) NearFinder{mesh, &placed, watch, std::move(finder)};
          },
          nb::arg("mesh").none(), nb::arg("V").none() = nb::none(), nb::kw_only(), nb::arg("distance"),
          nb::arg("filters").none() = nb::none(), nb::arg("progress").none() = nb::none(),
          nb::sig("def __init__(self, mesh: TriangleMesh, V: ArrayLike | None = None, *, distance: float, "
                  "filters: PairFilters | None = None, progress: Callable[[float], object] | None = None) -> None"))
      .def(
          "update",
          [](NearFinder& self, nb::object v) {
            const Rows<Vec3> x = self.mesh->positions_or(v);
            without_interpreter([&] { self.finder->update(x.span()); });
          },
          nb::arg("V").none() = nb::none(), nb::sig("def update(self, V: ArrayLike | None = None) -> None"),
          "Takes a new pose (n, 3) [m], the mesh's own where None, and refits in O(n).")
      .def(
          "rebuild",
          [](NearFinder& self, nb::object v) {
            const Rows<Vec3> x = self.mesh->positions_or(v);
            without_interpreter([&] { self.finder->rebuild(x.span()); });
          },
          nb::arg("V").none() = nb::none(), nb::sig("def rebuild(self, V: ArrayLike | None = None) -> None"),
          "As `update`, but builds the hierarchy anew.")
      .def(
          "find_pairs",
          [](const NearFinder& self) {
            self.watch->begin();
            return near_arrays(without_interpreter([&] { return self.finder->find_pairs(); }));
          },
          nb::sig("def find_pairs(self) -> NearPairs"),
          R"(All pairs nearer than the distance, each once, sorted.

Returns
-------
selvage.NearPairs
    For each of both lists the pairs, distances [m], where on the face or along the edges, and the nearest points [m].
)");
}

}  // namespace selvage::python
