#include "selvage/self_collision/continuous_collision.h"

#include "bindings.h"

namespace selvage::python {

namespace {

struct StepFinder {
  nb::object mesh_owner;
  const PlacedTriangleMesh* mesh;
  std::shared_ptr<Watch> watch;
  std::unique_ptr<ContinuousCollisionFinder> finder;
};

static_assert(sizeof(VertexFacePair) == sizeof(IndexPair) && sizeof(EdgeEdgePair) == sizeof(IndexPair));

/// (n, 2): both members of each pair.
template <typename Pair>
nb::object index_array(const std::vector<Pair>& pairs) {
  return array_of(std::span(reinterpret_cast<const VertexTuple<2>*>(pairs.data()), pairs.size()));
}

nb::object pair_arrays(const ContinuousPairs& pairs) {
  return result_class("ContinuousPairs")(index_array(pairs.vertex_face), index_array(pairs.edge_edge));
}

/// What find_pairs() gave, back.
std::optional<ContinuousPairs> step_pairs_of(nb::handle pairs) {
  if (pairs.is_none()) return std::nullopt;
  const Rows<VertexTuple<2>> faces(pairs.attr("vertex_face"), "vertex_face");
  const Rows<VertexTuple<2>> edges(pairs.attr("edge_edge"), "edge_edge");
  ContinuousPairs result;
  for (const auto& [vertex, face] : faces.span()) result.vertex_face.push_back({vertex, face});
  for (const auto& [first, second] : edges.span()) result.edge_edge.push_back({first, second});
  return result;
}

}  // namespace

void bind_continuous_collision(nb::module_& m) {
  nb::class_<StepFinder>(
      m, "ContinuousCollisionFinder", nb::type_slots(CollectedWatch<StepFinder>::slots),
      R"(Continuous self-collision: all pairs of a vertex and a face, and of two edges, that meet during a step.

Vertices move on straight lines at constant speed. Decided exactly: no tolerance, no missed pair, no invented pair.

Parameters
----------
mesh : selvage.TriangleMesh
    Kept alive by the finder.
V0, V1 : (n, 3) arrays
    Positions at the start and at the end of the step [m]. Copied.
method, asked_once, filters, thickness, progress
    As SelfCollisionFinder.

Raises
------
selvage.Error
    When sizes differ, a position is not finite, or an option does not fit the mesh.

Examples
--------
A triangle falls through another one, its tip first.

>>> V0 = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0], [1, 1, 1], [1, 1, 2], [2, 1, 2.0]])
>>> V1 = V0.copy()
>>> V1[3:, 2] -= 2
>>> finder = selvage.ContinuousCollisionFinder(selvage.TriangleMesh(V0, [[0, 1, 2], [3, 4, 5]]), V0, V1)
>>> finder.find_pairs().vertex_face
array([[3, 0],
       [4, 0],
       [5, 0]], dtype=int32)
>>> round(finder.find_free_step(), 3)
0.5
)")
      .def(
          "__init__",
          [](StepFinder* self, nb::object mesh, nb::object v0, nb::object v1, const std::string& method,
             bool asked_once, nb::object filters, nb::object thickness, nb::object progress) {
            const auto& placed = mesh_argument<PlacedTriangleMesh>(mesh);
            const Rows<Vec3> x0(v0, "V0"), x1(v1, "V1");
            const auto watch = std::make_shared<Watch>(std::move(progress));
            SelfCollisionOptions options = collision_options(method, false, asked_once, filters, thickness, watch);
            auto finder = without_interpreter([&] {
              return std::make_unique<ContinuousCollisionFinder>(placed.topology, x0.span(), x1.span(),
                                                                 std::move(options));
            });
            new (self) StepFinder{mesh, &placed, watch, std::move(finder)};
          },
          nb::arg("mesh").none(), nb::arg("V0").none(), nb::arg("V1").none(), nb::kw_only(), nb::arg("method") = "auto",
          nb::arg("asked_once") = false, nb::arg("filters").none() = nb::none(),
          nb::arg("thickness").none() = nb::none(), nb::arg("progress").none() = nb::none(),
          nb::sig("def __init__(self, mesh: TriangleMesh, V0: ArrayLike, V1: ArrayLike, *, method: str = 'auto', "
                  "asked_once: bool = False, filters: PairFilters | None = None, thickness: ArrayLike | None = None, "
                  "progress: Callable[[float], object] | None = None) -> None"))
      .def(
          "update",
          [](StepFinder& self, nb::object v0, nb::object v1) {
            const Rows<Vec3> x0(v0, "V0"), x1(v1, "V1");
            without_interpreter([&] { self.finder->update(x0.span(), x1.span()); });
          },
          nb::arg("V0").none(), nb::arg("V1").none(), nb::sig("def update(self, V0: ArrayLike, V1: ArrayLike) -> None"),
          "Takes a new step, (n, 3) [m] each, and refits in O(n).")
      .def(
          "move_ends",
          [](StepFinder& self, nb::object vertices, nb::object v1) {
            const Rows<Index> moved(vertices, "vertices");
            const Rows<Vec3> x1(v1, "V1");
            self.watch->begin();
            return pair_arrays(without_interpreter([&] { return self.finder->move_ends(moved.span(), x1.span()); }));
          },
          nb::arg("vertices").none(), nb::arg("V1").none(),
          nb::sig("def move_ends(self, vertices: ArrayLike, V1: ArrayLike) -> ContinuousPairs"),
          R"(Takes other ends for some vertices, and finds the pairs with one of these among those that meet now.

For solvers that move a few vertices and ask again: costs what is near them. Pairs of other vertices are those of before.

Parameters
----------
vertices : (k,) array of integers
    In any order.
V1 : (n, 3) array
    The end of the step [m], at other vertices as it was.

Raises
------
selvage.Error
    As `update`, and when a vertex is out of range.
)")
      .def(
          "rebuild",
          [](StepFinder& self, nb::object v0, nb::object v1) {
            const Rows<Vec3> x0(v0, "V0"), x1(v1, "V1");
            without_interpreter([&] { self.finder->rebuild(x0.span(), x1.span()); });
          },
          nb::arg("V0").none(), nb::arg("V1").none(),
          nb::sig("def rebuild(self, V0: ArrayLike, V1: ArrayLike) -> None"),
          "As `update`, but builds the hierarchy anew.")
      .def(
          "find_pairs",
          [](const StepFinder& self) {
            self.watch->begin();
            return pair_arrays(without_interpreter([&] { return self.finder->find_pairs(); }));
          },
          nb::sig("def find_pairs(self) -> ContinuousPairs"),
          R"(All pairs that meet during the step, its ends included; sorted.

Returns
-------
selvage.ContinuousPairs
    `vertex_face` (k, 2) and `edge_edge` (l, 2), rows of `mesh.edges`.
)")
      .def(
          "has_pairs",
          [](const StepFinder& self) {
            self.watch->begin();
            return without_interpreter([&] { return self.finder->has_pairs(); });
          },
          "Whether there is any pair: stops at the first.")
      .def(
          "find_impact_times",
          [](const StepFinder& self, nb::object given) {
            const auto pairs = step_pairs_of(given);
            if (!pairs) throw Error("pairs", "None was given", "give those of find_pairs()");
            self.watch->begin();
            std::vector<double> faces, edges;
            without_interpreter([&] {
              faces = self.finder->find_impact_times(pairs->vertex_face);
              edges = self.finder->find_impact_times(pairs->edge_edge);
            });
            return nb::make_tuple(array_of(faces), array_of(edges));
          },
          nb::arg("pairs").none(),
          nb::sig("def find_impact_times(self, pairs: ContinuousPairs) -> tuple[Floats, Floats]"),
          R"(Times of first impact of both lists of pairs, as fractions of the step.

Never later than the true time, at most 1e-6 earlier; NaN where a pair does not meet.

Raises
------
selvage.Error
    When a vertex, a face or an edge is out of range.
)")
      .def(
          "find_free_step",
          [](const StepFinder& self, nb::object given) {
            const auto pairs = step_pairs_of(given);
            self.watch->begin();
            return without_interpreter(
                [&] { return pairs ? self.finder->find_free_step(*pairs) : self.finder->find_free_step(); });
          },
          nb::arg("pairs").none() = nb::none(),
          nb::sig("def find_free_step(self, pairs: ContinuousPairs | None = None) -> float"),
          R"(The largest fraction of the step that is free of collisions: 1 where nothing meets.

No later than the earliest true time of impact, at most 1e-6 earlier. Thickness does not count.

Parameters
----------
pairs : selvage.ContinuousPairs, optional
    Those that `find_pairs()` gave, where they are known already.
)")
      .def(
          "find_separated_step",
          [](const StepFinder& self, nb::object given) {
            const auto pairs = step_pairs_of(given);
            self.watch->begin();
            return without_interpreter(
                [&] { return pairs ? self.finder->find_separated_step(*pairs) : self.finder->find_separated_step(); });
          },
          nb::arg("pairs").none() = nb::none(),
          nb::sig("def find_separated_step(self, pairs: ContinuousPairs | None = None) -> float"),
          "The largest fraction of the step during which every pair stays apart by the sum of its thickness.");
}

}  // namespace selvage::python
