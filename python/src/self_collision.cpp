#include "bindings.h"

#include <nanobind/stl/vector.h>

namespace selvage::python {

namespace {

struct CollisionFinder {
  nb::object mesh_owner;
  const PlacedTriangleMesh* mesh;
  std::shared_ptr<Watch> watch;
  std::unique_ptr<SelfCollisionFinder> finder;
};

nb::object pair_arrays(const std::vector<TrianglePair>& pairs) {
  Column<std::int32_t> triangles(pairs.size(), 2);
  Column<std::uint8_t> contact(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    triangles.row(i)[0] = pairs[i].first;
    triangles.row(i)[1] = pairs[i].second;
    contact[i] = static_cast<std::uint8_t>(pairs[i].contact);
  }
  return result_class("TrianglePairs")(std::move(triangles).array(), std::move(contact).array());
}

std::vector<TrianglePair> pairs_of(nb::handle triangles) {
  const Rows<IndexPair> rows(triangles, "pairs");
  std::vector<TrianglePair> pairs;
  pairs.reserve(rows.span().size());
  for (const auto& [first, second] : rows.span()) pairs.push_back({first, second, TriangleContact::kCrossing});
  return pairs;
}

nb::object segment_array(const std::vector<CommonSegment>& segments) {
  Column<double> ends(segments.size(), 6);
  for (std::size_t i = 0; i < segments.size(); ++i)
    for (int k = 0; k < 6; ++k)
      ends.row(i)[k] = segments[i] ? (*segments[i])[k / 3][k % 3] : std::numeric_limits<double>::quiet_NaN();
  return std::move(ends).array().attr("reshape")(segments.size(), 2, 3);
}

}  // namespace

PairFilters filters_of(nb::handle filters) {
  if (filters.is_none()) return {};
  if (nb::isinstance<PairFilters>(filters)) return nb::cast<const PairFilters&>(filters);
  throw Error("filters", std::string("a ") + Py_TYPE(filters.ptr())->tp_name + " was given",
              "give a selvage.PairFilters");
}

SelfCollisionOptions collision_options(const std::string& method, bool adjacent, bool asked_once, nb::handle filters,
                                       nb::handle thickness, const std::shared_ptr<Watch>& watch) {
  SelfCollisionOptions options;
  options.method = culling_method(method);
  options.include_adjacent = adjacent;
  options.asked_once = asked_once;
  options.filters = filters_of(filters);
  options.thickness = rows_or_none<double>(thickness, "thickness").copy();
  options.on_progress = progress_of(watch);
  return options;
}

void bind_filters(nb::module_& m) {
  nb::class_<PairFilters>(m, "PairFilters", R"(Filters of the pairs of a surface. What is left out filters nothing.

Labels belong to triangles. A vertex or an edge counts as every triangle that it lies on.

Parameters
----------
groups : (m,) array of whole numbers
    Triangles of the same group are no pair; -1: in no group.
layers, seen_layers : (m,) arrays of whole numbers
    Bits: the layers that a triangle is on, and those that it collides with. A pair stays when each collides with a
    layer of the other; without `seen_layers`, when they have a layer in common.
static : (m,) array of booleans
    The triangle never moves; two that do not are no pair.
allowed_pairs, forbidden_pairs : (k, 2) arrays of whole numbers
    Pairs of triangles: no others are pairs unless the list is empty; and none of these is.
neighbour_rings : int
    Where a path of this many edges or fewer joins the two there is no pair.
rest_positions : (n, 3) array, rest_distance : float
    What is nearer than `rest_distance` at rest is no pair [m].

Raises
------
selvage.Error
    When an array has another type or shape. That sizes fit the mesh is checked where the filters are used.

Examples
--------
>>> pipe = selvage.SurfaceSequence("pipe", triangles=2000)
>>> V, F = pipe.positions(pipe.frame_count - 1), pipe.F
>>> one_group = selvage.PairFilters(groups=np.zeros(len(F), int))
>>> selvage.has_self_collisions(V, F), selvage.has_self_collisions(V, F, filters=one_group)
(True, False)
)")
      .def(
          "__init__",
          [](PairFilters* self, nb::object groups, nb::object layers, nb::object seen_layers, nb::object is_static,
             nb::object allowed, nb::object forbidden, int rings, nb::object rest, double rest_distance) {
            PairFilters filters{.groups = rows_or_none<Index>(groups, "groups").copy(),
                                .layers = rows_or_none<std::uint32_t>(layers, "layers").copy(),
                                .seen_layers = rows_or_none<std::uint32_t>(seen_layers, "seen_layers").copy(),
                                .is_static = rows_or_none<std::uint8_t>(is_static, "static").copy(),
                                .allowed_pairs = rows_or_none<IndexPair>(allowed, "allowed_pairs").copy(),
                                .forbidden_pairs = rows_or_none<IndexPair>(forbidden, "forbidden_pairs").copy(),
                                .neighbour_rings = rings,
                                .rest_positions = rows_or_none<Vec3>(rest, "rest_positions").copy(),
                                .rest_distance = rest_distance};
            new (self) PairFilters(std::move(filters));
          },
          nb::kw_only(), nb::arg("groups").none() = nb::none(), nb::arg("layers").none() = nb::none(),
          nb::arg("seen_layers").none() = nb::none(), nb::arg("static").none() = nb::none(),
          nb::arg("allowed_pairs").none() = nb::none(), nb::arg("forbidden_pairs").none() = nb::none(),
          nb::arg("neighbour_rings") = 0, nb::arg("rest_positions").none() = nb::none(), nb::arg("rest_distance") = 0.0,
          nb::sig("def __init__(self, *, groups: ArrayLike | None = None, layers: ArrayLike | None = None, "
                  "seen_layers: ArrayLike | None = None, static: ArrayLike | None = None, "
                  "allowed_pairs: ArrayLike | None = None, forbidden_pairs: ArrayLike | None = None, "
                  "neighbour_rings: int = 0, rest_positions: ArrayLike | None = None, "
                  "rest_distance: float = 0.0) -> None"));
}

void bind_self_collision(nb::module_& m) {
  bind_filters(m);
  m.def(
      "culling_methods",
      [] {
        nb::list names;
        for (const std::string_view name : culling_method_names()) names.append(nb::str(name.data(), name.size()));
        return names;
      },
      nb::sig("def culling_methods() -> list[str]"), "Names of the methods of self-collision; 'auto' is the fastest.");
  nb::class_<CollisionFinder>(
      m, "SelfCollisionFinder", nb::type_slots(CollectedWatch<CollisionFinder>::slots),
      R"(Discrete self-collision of a surface: all pairs of triangles that meet, decided exactly.

Parameters
----------
mesh : selvage.TriangleMesh
    Kept alive by the finder.
V : (n, 3) array, optional
    Positions [m]; those of the mesh where None. Copied.
method : str
    One of `culling_methods()`.
adjacent : bool
    Also pairs that share a vertex or an edge and meet anywhere else.
asked_once : bool
    Spend less time on building, and more on the one search.
filters : selvage.PairFilters, optional
thickness : (n,) array, optional
    Thickness at each vertex [m]: pairs count that are nearer than the sum of theirs.
progress : function, optional
    Called during a query with the share that is done, on any thread.

Raises
------
selvage.Error
    When sizes differ, a position is not finite, or an option does not fit the mesh.

Notes
-----
Several threads may ask at once; `update` needs the finder for itself.

Examples
--------
>>> pipe = selvage.SurfaceSequence("pipe", triangles=2000)
>>> finder = selvage.SelfCollisionFinder(selvage.TriangleMesh(pipe.positions(0), pipe.F))
>>> finder.has_pairs()
False
>>> finder.update(pipe.positions(pipe.frame_count - 1))
>>> len(finder.find_pairs()) > 0
True
)")
      .def(
          "__init__",
          [](CollisionFinder* self, nb::object mesh, nb::object v, const std::string& method, bool adjacent,
             bool asked_once, nb::object filters, nb::object thickness, nb::object progress) {
            const auto& placed = mesh_argument<PlacedTriangleMesh>(mesh);
            const Rows<Vec3> x = placed.positions_or(v);
            const auto watch = std::make_shared<Watch>(std::move(progress));
            SelfCollisionOptions options = collision_options(method, adjacent, asked_once, filters, thickness, watch);
            auto finder = without_interpreter(
                [&] { return std::make_unique<SelfCollisionFinder>(placed.topology, x.span(), std::move(options)); });
            new (self) CollisionFinder{mesh, &placed, watch, std::move(finder)};
          },
          nb::arg("mesh").none(), nb::arg("V").none() = nb::none(), nb::kw_only(), nb::arg("method") = "auto",
          nb::arg("adjacent") = false, nb::arg("asked_once") = false, nb::arg("filters").none() = nb::none(),
          nb::arg("thickness").none() = nb::none(), nb::arg("progress").none() = nb::none(),
          nb::sig("def __init__(self, mesh: TriangleMesh, V: ArrayLike | None = None, *, method: str = 'auto', "
                  "adjacent: bool = False, asked_once: bool = False, filters: PairFilters | None = None, "
                  "thickness: ArrayLike | None = None, progress: Callable[[float], object] | None = None) -> None"))
      .def(
          "update",
          [](CollisionFinder& self, nb::object v) {
            const Rows<Vec3> x = self.mesh->positions_or(v);
            without_interpreter([&] { self.finder->update(x.span()); });
          },
          nb::arg("V").none() = nb::none(), nb::sig("def update(self, V: ArrayLike | None = None) -> None"),
          "Takes a new pose (n, 3) [m], the mesh's own where None, and refits in O(n).")
      .def(
          "rebuild",
          [](CollisionFinder& self, nb::object v) {
            const Rows<Vec3> x = self.mesh->positions_or(v);
            without_interpreter([&] { self.finder->rebuild(x.span()); });
          },
          nb::arg("V").none() = nb::none(), nb::sig("def rebuild(self, V: ArrayLike | None = None) -> None"),
          "As `update`, but builds the hierarchy anew.")
      .def(
          "find_pairs",
          [](const CollisionFinder& self) {
            self.watch->begin();
            return pair_arrays(without_interpreter([&] { return self.finder->find_pairs(); }));
          },
          nb::sig("def find_pairs(self) -> TrianglePairs"),
          "All pairs of triangles that meet, sorted; the same for any number of threads.")
      .def(
          "has_pairs",
          [](const CollisionFinder& self) {
            self.watch->begin();
            return without_interpreter([&] { return self.finder->has_pairs(); });
          },
          "Whether there is any pair: stops at the first.")
      .def(
          "find_pairs_of",
          [](const CollisionFinder& self, nb::object triangles) {
            const Rows<Index> rows(triangles, "triangles");
            self.watch->begin();
            return pair_arrays(without_interpreter([&] { return self.finder->find_pairs_of(rows.span()); }));
          },
          nb::arg("triangles").none(), nb::sig("def find_pairs_of(self, triangles: ArrayLike) -> TrianglePairs"),
          R"(All pairs with at least one of the given triangles, each once; sorted.

Raises
------
selvage.Error
    When a triangle is out of range or given twice.
)")
      .def(
          "find_pairs_with",
          [](const CollisionFinder& self, const CollisionFinder& other) {
            self.watch->begin();
            return pair_arrays(without_interpreter([&] { return self.finder->find_pairs_with(*other.finder); }));
          },
          nb::arg("other"), nb::sig("def find_pairs_with(self, other: SelfCollisionFinder) -> TrianglePairs"),
          "All pairs (triangle of this surface, triangle of the other) that meet; sorted.")
      .def(
          "find_segments",
          [](const CollisionFinder& self, nb::object pairs) {
            const std::vector<TrianglePair> rows = pairs_of(pairs);
            self.watch->begin();
            return segment_array(without_interpreter([&] { return self.finder->find_segments(rows); }));
          },
          nb::arg("pairs").none(), nb::sig("def find_segments(self, pairs: ArrayLike) -> Floats"),
          R"((k, 2, 3) float64: ends [m] of the segment that the triangles of each of (k, 2) pairs have in common.

Equal ends where it is a point; NaN where they overlap in one plane or do not meet. Whether there is a segment is
exact, its ends are rounded.

Raises
------
selvage.Error
    When a triangle is out of range.
)")
      .def(
          "find_segments_with",
          [](const CollisionFinder& self, const CollisionFinder& other, nb::object pairs) {
            const std::vector<TrianglePair> rows = pairs_of(pairs);
            self.watch->begin();
            return segment_array(
                without_interpreter([&] { return self.finder->find_segments_with(*other.finder, rows); }));
          },
          nb::arg("other"), nb::arg("pairs").none(),
          nb::sig("def find_segments_with(self, other: SelfCollisionFinder, pairs: ArrayLike) -> Floats"),
          "As `find_segments`, for pairs that `find_pairs_with` gave.");
}

}  // namespace selvage::python
