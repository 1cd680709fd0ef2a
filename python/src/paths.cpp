#include "bindings.h"
#include "selvage/boundary_path/boundary_path.h"

namespace selvage::python {

namespace {

template <int D>
struct PathFinder {
  nb::object mesh_owner;
  const PlacedMesh<SimplexMesh<D>, D>* mesh;
  std::unique_ptr<BoundaryPathFinder<D>> finder;
};

template <int D>
std::vector<PathQuery<D>> queries_of(nb::handle points, nb::handle elements, nb::handle sources) {
  const Rows<Vec<D>> p(points, "points");
  const Rows<Index> e(elements, "elements");
  const auto s = rows_or_none<VertexTuple<2>>(sources, "sources");
  if (e.span().size() != p.span().size())
    throw Error("elements", std::to_string(e.span().size()) + " for " + std::to_string(p.span().size()) + " points",
                "give one per point");
  if (!sources.is_none() && s.span().size() != p.span().size())
    throw Error("sources", std::to_string(s.span().size()) + " for " + std::to_string(p.span().size()) + " points",
                "give one per point");
  std::vector<PathQuery<D>> queries(p.span().size());
  for (std::size_t i = 0; i < queries.size(); ++i) {
    queries[i].point = p.span()[i];
    queries[i].element = e.span()[i];
    queries[i].source = sources.is_none() ? std::array{kNone, kNone} : s.span()[i];
  }
  return queries;
}

/// Queries as arrays: points, elements, sources.
template <int D>
nb::object query_arrays(const std::vector<PathQuery<D>>& queries) {
  Column<double> points(queries.size(), D);
  Column<std::int32_t> elements(queries.size()), sources(queries.size(), 2);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    std::copy_n(queries[i].point.data(), D, points.row(i));
    elements[i] = queries[i].element;
    std::copy_n(queries[i].source.data(), 2, sources.row(i));
  }
  return result_class("PathQueries")(std::move(points).array(), std::move(elements).array(),
                                     std::move(sources).array());
}

/// Answers as one array a member.
template <int D>
class PathArrays {
 public:
  explicit PathArrays(std::size_t n)
      : status_(n), feature_(n), face_(n), barycentric_(n, D), point_(n, D), distance_(n), normal_(n, D) {}

  void set(std::size_t first, std::span<const BoundaryPath<D>> paths) {
    for (std::size_t i = first; const BoundaryPath<D>& path : paths) {
      const bool found = path.status == PathStatus::kFound;
      const double nothing = std::numeric_limits<double>::quiet_NaN();
      status_[i] = static_cast<std::uint8_t>(path.status);
      feature_[i] = static_cast<std::uint8_t>(path.feature);
      face_[i] = found ? path.face : kNone;
      distance_[i] = found ? path.distance : nothing;
      for (int k = 0; k < D; ++k) {
        barycentric_.row(i)[k] = found ? path.barycentric[k] : nothing;
        point_.row(i)[k] = found ? path.point[k] : nothing;
        normal_.row(i)[k] = found ? path.normal[k] : nothing;
      }
      ++i;
    }
  }

  nb::object result() && {
    return result_class("Paths")(std::move(status_).array(), std::move(face_).array(), std::move(point_).array(),
                                 std::move(distance_).array(), std::move(barycentric_).array(),
                                 std::move(feature_).array(), std::move(normal_).array());
  }

 private:
  Column<std::uint8_t> status_, feature_;
  Column<std::int32_t> face_;
  Column<double> barycentric_, point_, distance_, normal_;
};

template <int D>
nb::object find_paths(const PathFinder<D>& self, nb::handle points, nb::handle elements, nb::handle sources,
                      nb::handle warm_start, nb::object progress) {
  const std::vector<PathQuery<D>> queries = queries_of<D>(points, elements, sources);
  const Rows<Index> warm = rows_or_none<Index>(warm_start, "warm_start");
  if (!warm_start.is_none() && warm.span().size() != queries.size())
    throw Error("warm_start", std::to_string(warm.span().size()) + " for " + std::to_string(queries.size()) + " points",
                "give one per point");
  PathArrays<D> arrays(queries.size());
  Watch watch(std::move(progress));
  watch.begin();
  without_interpreter([&] {
    in_pieces(std::ssize(queries), watch, [&](std::int64_t first, std::int64_t last) {
      const auto count = static_cast<std::size_t>(last - first);
      const auto start = warm.span().empty() ? std::span<const Index>() : warm.span().subspan(first, count);
      arrays.set(first, self.finder->find_paths(std::span(queries).subspan(first, count), start));
    });
  });
  return std::move(arrays).result();
}

template <int D>
nb::object locate(const PathFinder<D>& self, nb::handle points) {
  const Rows<Vec<D>> p(points, "points");
  const LocatedPoints<D> located = without_interpreter([&] { return self.finder->locate(p.span()); });
  Column<std::int32_t> elements(located.queries.size());
  Column<std::int64_t> which(located.queries.size());
  for (std::size_t i = 0; i < p.span().size(); ++i)
    for (std::int64_t k = located.first[i]; k < located.first[i + 1]; ++k) {
      which[k] = static_cast<std::int64_t>(i);
      elements[k] = located.queries[k].element;
    }
  return result_class("LocatedPoints")(std::move(which).array(), std::move(elements).array());
}

template <int D>
nb::dict defects_of(const PathFinder<D>& self) {
  const MeshDefects& defects = self.finder->defects();
  nb::dict result;
  result["inverted_elements"] = defects.inverted_elements;
  result["degenerate_elements"] = defects.degenerate_elements;
  result["overwound_interior_ridges"] = defects.overwound_interior_ridges;
  result["overwound_boundary_ridges"] = defects.overwound_boundary_ridges;
  return result;
}

template <int D>
void bind_path_finder(nb::module_& m, const char* name, const char* doc) {
  using Mesh = PlacedMesh<SimplexMesh<D>, D>;
  using Finder = PathFinder<D>;
  nb::class_<Finder>(m, name, doc)
      .def(
          "__init__",
          [](Finder* self, nb::object mesh, nb::object v) {
            const auto& placed = mesh_argument<Mesh>(mesh);
            const Rows<Vec<D>> x = placed.positions_or(v);
            auto finder =
                without_interpreter([&] { return std::make_unique<BoundaryPathFinder<D>>(placed.topology, x.span()); });
            new (self) Finder{mesh, &placed, std::move(finder)};
          },
          nb::arg("mesh").none(), nb::arg("V").none() = nb::none(),
          D == 3 ? nb::sig("def __init__(self, mesh: TetMesh, V: ArrayLike | None = None) -> None")
                 : nb::sig("def __init__(self, mesh: PlanarMesh, V: ArrayLike | None = None) -> None"))
      .def(
          "update",
          [](Finder& self, nb::object v) {
            const Rows<Vec<D>> x = self.mesh->positions_or(v);
            without_interpreter([&] { self.finder->update(x.span()); });
          },
          nb::arg("V").none() = nb::none(), nb::sig("def update(self, V: ArrayLike | None = None) -> None"),
          R"(Takes a new pose (n, D) [m], the mesh's own where None, and refits in O(n). Not while another thread asks.

Raises
------
selvage.Error
    When sizes differ or a position is not finite.
)")
      .def(
          "find_paths",
          [](const Finder& self, nb::object points, nb::object elements, nb::object sources, nb::object warm,
             nb::object progress) { return find_paths<D>(self, points, elements, sources, warm, progress); },
          nb::arg("points").none(), nb::arg("elements").none(), nb::kw_only(), nb::arg("sources").none() = nb::none(),
          nb::arg("warm_start").none() = nb::none(), nb::arg("progress").none() = nb::none(),
          nb::sig("def find_paths(self, points: ArrayLike, elements: ArrayLike, *, sources: ArrayLike | None = None, "
                  "warm_start: ArrayLike | None = None, progress: Callable[[float], object] | None = None) -> Paths"),
          R"(Shortest paths from points to the boundary, one per point.

Parameters
----------
points : (k, D) array
    [m]
elements : (k,) array of whole numbers
    The element that each point is taken to be in: where a mesh overlaps itself one place holds several points.
sources : (k, 2) array of whole numbers, optional
    For a boundary point that has penetrated: (vertex, -1) or the two vertices of its edge; (-1, -1): none. Boundary
    faces that have all of them are no candidates.
warm_start : (k,) array of whole numbers, optional
    A boundary face that may be near each answer, or -1; say `face` of the last step. Never changes an answer.
progress : function, optional
    Called now and then with the share that is done.

Returns
-------
selvage.Paths
    Arrays of `status, face, point, distance, barycentric, feature, normal`. NaN and -1 where no path was found.

Raises
------
selvage.Error
    When an element is out of range, a point is not finite, or an array has the wrong size.

Notes
-----
The same bits for any number of threads; O(log n) expected per point. Chen, Diaz, Yuksel 2023, section 3.
)")
      .def(
          "find_penetrating_vertices",
          [](const Finder& self) {
            return query_arrays<D>(without_interpreter([&] { return self.finder->find_penetrating_vertices(); }));
          },
          nb::sig("def find_penetrating_vertices(self) -> PathQueries"),
          R"(Boundary vertices inside an element that is not theirs.

Returns
-------
selvage.PathQueries
    Arrays of `points, elements, sources`, to be given to `find_paths(*queries[:2], sources=queries.sources)`; the
    vertices are `sources[:, 0]`. Ascending by vertex, then element.
)")
      .def("locate", &locate<D>, nb::arg("points").none(),
           nb::sig("def locate(self, points: ArrayLike) -> LocatedPoints"),
           R"(Elements that hold each of (k, D) points [m]; all of them, where a mesh overlaps itself.

Returns
-------
selvage.LocatedPoints
    Arrays of `point` (number of the point) and `element`, one row per pair, ascending.

Raises
------
selvage.Error
    When a point is not finite.
)")
      .def_prop_ro("defects", &defects_of<D>, nb::sig("def defects(self) -> dict[str, int]"),
                   "Counts of where the pose is not locally injective: inverted and degenerate elements, overwound "
                   "ridges.");
}

}  // namespace

void bind_paths(nb::module_& m) {
  bind_path_finder<3>(m, "BoundaryPathFinder",
                      R"(Shortest paths from interior points to the boundary of a mesh that may intersect itself.

Parameters
----------
mesh : selvage.TetMesh
    Kept alive by the finder.
V : (n, 3) array, optional
    Positions [m]; those of the mesh where None. Copied.

Raises
------
selvage.Error
    When sizes differ or a position is not finite.

Notes
-----
Several threads may ask at once; `update` needs the finder for itself. Chen, Diaz, Yuksel 2023, Shortest Path to
Boundary for Self-Intersecting Meshes, https://doi.org/10.1145/3592136

Examples
--------
>>> mesh = selvage.make("rod", cell=0.06, pose="self-crossing", crossings=1)
>>> finder = selvage.BoundaryPathFinder(mesh)
>>> inside = finder.find_penetrating_vertices()
>>> paths = finder.find_paths(inside.points, inside.elements, sources=inside.sources)
>>> bool(paths.found.all()), len(paths) == len(inside)
(True, True)
>>> finder.update(mesh.V * 2)
>>> again = finder.find_paths(inside.points * 2, inside.elements, sources=inside.sources, warm_start=paths.face)
>>> bool(np.allclose(again.distance, 2 * paths.distance))
True
)");
  bind_path_finder<2>(m, "PlanarPathFinder", R"(Shortest paths to the boundary of a triangle mesh in the plane.

Parameters
----------
mesh : selvage.PlanarMesh
    Kept alive by the finder.
V : (n, 2) array, optional
    Positions [m]; those of the mesh where None. Copied.

Raises
------
selvage.Error
    When sizes differ or a position is not finite.

Examples
--------
>>> mesh = selvage.PlanarMesh([[0, 0], [4, 0], [0, 4]], [[0, 1, 2]])
>>> selvage.PlanarPathFinder(mesh).find_paths([[1, 0.5]], [0]).distance
array([0.5])
)");
}

}  // namespace selvage::python
