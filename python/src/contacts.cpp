#include "bindings.h"
#include "selvage/contact/contact_finder.h"

namespace selvage::python {

namespace {

struct StepContacts {
  nb::object mesh_owner;
  const PlacedTetMesh* mesh;
  std::unique_ptr<ContactFinder> finder;
};

DetectionMode mode_of(const std::string& name) {
  if (name == "off" || name == "none") return DetectionMode::kOff;
  if (name == "ccd") return DetectionMode::kCcd;
  if (name == "dcd") return DetectionMode::kDcd;
  if (name == "hybrid") return DetectionMode::kHybrid;
  throw Error("mode", "there is no '" + name + "'", "choose one of hybrid, ccd, dcd, none");
}

ClosestPointRule rule_of(const std::string& name) {
  if (name == "shortest-path") return ClosestPointRule::kShortestPath;
  if (name == "rest-pose") return ClosestPointRule::kRestPose;
  if (name == "euclidean") return ClosestPointRule::kEuclidean;
  throw Error("rule", "there is no '" + name + "'", "choose one of shortest-path, rest-pose, euclidean");
}

}  // namespace

nb::object contact_arrays(std::span<const Contact> contacts) {
  const std::size_t n = contacts.size();
  Column<std::uint8_t> kind(n), count(n);
  Column<std::int32_t> vertices(n, Contact::kMaxVertices), point_feature(n), surface_feature(n);
  Column<double> weights(n, Contact::kMaxVertices), normal(n, 3), point(n, 3), distance(n), time(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Contact& contact = contacts[i];
    kind[i] = static_cast<std::uint8_t>(contact.kind);
    count[i] = contact.count;
    for (int k = 0; k < Contact::kMaxVertices; ++k) {
      vertices.row(i)[k] = k < contact.count ? contact.vertices[k] : kNone;
      weights.row(i)[k] = k < contact.count ? contact.weights[k] : 0;
    }
    std::copy_n(contact.normal.data(), 3, normal.row(i));
    std::copy_n(contact.point.data(), 3, point.row(i));
    distance[i] = contact.distance;
    time[i] = contact.time;
    point_feature[i] = contact.point_feature;
    surface_feature[i] = contact.surface_feature;
  }
  return result_class("Contacts")(std::move(kind).array(), std::move(count).array(), std::move(vertices).array(),
                                  std::move(weights).array(), std::move(normal).array(), std::move(point).array(),
                                  std::move(distance).array(), std::move(time).array(),
                                  std::move(point_feature).array(), std::move(surface_feature).array());
}

void bind_contacts(nb::module_& m) {
  nb::class_<StepContacts>(m, "ContactFinder",
                           R"(Contacts of a tetrahedral mesh with itself during a step, for a solver of your own.

A step is `begin_step(V0)`, then `find_contacts(V1)` with the positions that the solver proposes. Any positions are
legal, tangled and inverted meshes too.

Parameters
----------
mesh : selvage.TetMesh
    All objects in one; kept alive.
V : (n, 3) array, optional
    Positions where the first step starts [m]; those of the mesh where None.
rest : (n, 3) array, optional
    Rest positions [m], for the rule 'rest-pose'.
objects : (n,) array of whole numbers, optional
    The object that each vertex belongs to, for the rule 'euclidean'; else connected components.
cloth : (k, 3) array of whole numbers, optional
    Triangles of cloth, on vertices that no tetrahedron has.
thickness : (n,) array, optional
    Of cloth at each vertex, 0 where there is none [m]: sheets are held so far apart, all else half as far. Needs `rest`.
mode : str
    'hybrid' (points inside at the start of a step by DCD, all others by CCD), 'ccd', 'dcd' or 'none'.
rule : str
    Where a penetrating point is sent: 'shortest-path'; for comparison 'rest-pose', 'euclidean'.
edges : bool
    Also edges inside elements, and pairs of edges.
interior_points : bool
    Also interior vertices and centroids, by DCD alone.
wait_for_inverted : bool
    No contacts at vertices of inverted elements, which would keep them inverted.
take_turns : bool
    Where more than a tenth of the boundary's vertices are inside: no contacts of edges between two of them, and of
    vertices with only such neighbours in every third step. Bodies in one another come apart at a sixth of the cost.
    For the mode 'hybrid'.

Raises
------
selvage.Error
    When sizes differ, a position is not finite, or the rule lacks what it needs.

Notes
-----
Chen, Diaz, Yuksel 2023, section 4 and supplement, algorithm 5.

Examples
--------
A box falls onto another one, and the step would end with a part of it inside.

>>> box = selvage.make("box", size=(1, 1, 1), cell=0.5)
>>> V0 = np.vstack([box.V, box.V + [0.2, 0.3, 1.05]])
>>> mesh = selvage.TetMesh(V0, np.vstack([box.T, box.T + len(box.V)]))
>>> V1 = V0.copy()
>>> V1[len(box.V):, 2] -= 0.1
>>> finder = selvage.ContactFinder(mesh)
>>> finder.begin_step(V0)
>>> contacts = finder.find_contacts(V1)
>>> float(contacts.gaps(V1).min().round(3))
-0.05
)")
      .def(
          "__init__",
          [](StepContacts* self, nb::object mesh, nb::object v, nb::object rest, nb::object objects, nb::object cloth,
             nb::object thickness, const std::string& mode, const std::string& rule, bool edges, bool interior_points,
             bool wait_for_inverted, bool take_turns) {
            const auto& placed = mesh_argument<PlacedTetMesh>(mesh);
            const Rows<Vec3> x = placed.positions_or(v);
            const Rows<Vec3> at_rest = rows_or_none<Vec3>(rest, "rest");
            const Rows<Index> numbers = rows_or_none<Index>(objects, "objects");
            const Rows<VertexTuple<3>> triangles = rows_or_none<VertexTuple<3>>(cloth, "cloth");
            std::vector<double> half = rows_or_none<double>(thickness, "thickness").copy();
            for (double& value : half) value /= 2;
            const ContactOptions options{.mode = mode_of(mode),
                                         .rule = rule_of(rule),
                                         .detect_edges = edges,
                                         .interior_points = interior_points,
                                         .wait_for_inverted = wait_for_inverted,
                                         .take_turns = take_turns};
            auto finder = without_interpreter([&] {
              return std::make_unique<ContactFinder>(placed.topology, at_rest.span(), x.span(), numbers.span(), options,
                                                     std::span<const VertexTuple<3>>{},
                                                     ContactCloth{triangles.span(), half});
            });
            new (self) StepContacts{mesh, &placed, std::move(finder)};
          },
          nb::arg("mesh").none(), nb::arg("V").none() = nb::none(), nb::kw_only(), nb::arg("rest").none() = nb::none(),
          nb::arg("objects").none() = nb::none(), nb::arg("cloth").none() = nb::none(),
          nb::arg("thickness").none() = nb::none(), nb::arg("mode") = "hybrid", nb::arg("rule") = "shortest-path",
          nb::arg("edges") = true, nb::arg("interior_points") = false, nb::arg("wait_for_inverted") = false,
          nb::arg("take_turns") = false,
          nb::sig("def __init__(self, mesh: TetMesh, V: ArrayLike | None = None, *, rest: ArrayLike | None = None, "
                  "objects: ArrayLike | None = None, cloth: ArrayLike | None = None, "
                  "thickness: ArrayLike | None = None, mode: str = 'hybrid', rule: str = 'shortest-path', "
                  "edges: bool = True, interior_points: bool = False, wait_for_inverted: bool = False, take_turns: "
                  "bool = False) -> None"))
      .def(
          "begin_step",
          [](StepContacts& self, nb::object v, std::int64_t step) {
            const Rows<Vec3> x(v, "V");
            without_interpreter([&] { self.finder->begin_step(x.span(), step); });
          },
          nb::arg("V").none(), nb::arg("step") = 0,
          nb::sig("def begin_step(self, V: ArrayLike, step: int = 0) -> None"),
          R"(Start of a step from positions (n, 3) [m]: splits vertices and edges into penetrating and free ones.

`step` is its number: by DCD alone, where points inside their own connected piece are joined by vertices and a vertex is
among them, the edges among them have no contacts in the last 8 of 64 steps. Both may hold a fold for ever.)")
      .def(
          "find_contacts",
          [](StepContacts& self, nb::object v) {
            const Rows<Vec3> x(v, "V");
            std::vector<Contact> contacts;
            without_interpreter([&] { self.finder->find_contacts(x.span(), contacts); });
            return contact_arrays(contacts);
          },
          nb::arg("V").none(), nb::sig("def find_contacts(self, V: ArrayLike) -> Contacts"),
          R"(Contacts of the step that ends at positions (n, 3) [m], sorted by kind, then by what penetrates.

Returns
-------
selvage.Contacts
    Each is one inequality: normal . sum(weights[i] * V[vertices[i]]) >= 0.

Raises
------
selvage.Error
    When the size differs, a position is not finite, or no step has begun.
)")
      .def_prop_ro(
          "penetrating_vertices",
          [](const StepContacts& self) { return array_of(self.finder->penetrating_vertices()); },
          nb::sig("def penetrating_vertices(self) -> Ints"),
          "(k,) int32: boundary vertices inside an element at the start of the step, ascending; for 'hybrid'.");
}

}  // namespace selvage::python
