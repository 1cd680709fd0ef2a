#include "bindings.h"
#include "selvage/geometry/continuous.h"
#include "selvage/geometry/moving_distance.h"
#include "selvage/geometry/predicates.h"
#include "selvage/geometry/triangle_triangle.h"

namespace selvage::python {

namespace {

template <typename Row>
void expect_rows(const Rows<Row>& rows, std::size_t count, const char* name) {
  if (rows.span().size() != count)
    throw Error(name, std::to_string(rows.span().size()) + " points for " + std::to_string(count),
                "give as many in each array");
}

template <std::size_t N>
std::array<Vec3, N> points_of(std::span<const Vec3> points, std::size_t i) {
  std::array<Vec3, N> result;
  std::copy_n(points.begin() + static_cast<std::ptrdiff_t>(N * i), N, result.begin());
  return result;
}

nb::object signs_2d(nb::object a, nb::object b, nb::object c) {
  const Rows<Vec2> x(a, "a"), y(b, "b"), z(c, "c");
  const std::size_t n = x.span().size();
  expect_rows(y, n, "b");
  expect_rows(z, n, "c");
  Column<std::int32_t> signs(n);
  without_interpreter([&] {
    for (std::size_t i = 0; i < n; ++i) signs[i] = orient2d(x.span()[i], y.span()[i], z.span()[i]);
  });
  return std::move(signs).array();
}

nb::object signs_3d(nb::object a, nb::object b, nb::object c, nb::object d) {
  const Rows<Vec3> x(a, "a"), y(b, "b"), z(c, "c"), w(d, "d");
  const std::size_t n = x.span().size();
  expect_rows(y, n, "b");
  expect_rows(z, n, "c");
  expect_rows(w, n, "d");
  Column<std::int32_t> signs(n);
  without_interpreter([&] {
    for (std::size_t i = 0; i < n; ++i) signs[i] = orient3d(x.span()[i], y.span()[i], z.span()[i], w.span()[i]);
  });
  return std::move(signs).array();
}

nb::object contacts_of_triangles(nb::object a, nb::object b) {
  const Rows<Vec3> x(a, "A"), y(b, "B");
  expect_rows(y, x.span().size(), "B");
  const std::size_t n = x.span().size() / 3;
  Column<std::uint8_t> contact(n);
  without_interpreter([&] {
    for (std::size_t i = 0; i < n; ++i)
      contact[i] = static_cast<std::uint8_t>(classify_contact(points_of<3>(x.span(), i), points_of<3>(y.span(), i)));
  });
  return std::move(contact).array();
}

std::optional<double> first_time(const MovingPoints& points, bool of_edges, double distance) {
  if (distance > 0) return of_edges ? edge_edge_nearness(points, distance) : vertex_face_nearness(points, distance);
  return of_edges ? edge_edge_impact(points) : vertex_face_impact(points);
}

nb::object first_times(nb::object t0, nb::object t1, bool of_edges, double distance) {
  const Rows<Vec3> x(t0, "X0"), y(t1, "X1");
  expect_rows(y, x.span().size(), "X1");
  if (!(distance >= 0) || !std::isfinite(distance))
    throw Error("distance", "is negative or not finite", "give 0 or a positive number");
  const std::size_t n = x.span().size() / 4;
  Column<double> times(n);
  without_interpreter([&] {
    for (std::size_t i = 0; i < n; ++i)
      times[i] = first_time({points_of<4>(x.span(), i), points_of<4>(y.span(), i)}, of_edges, distance)
                     .value_or(std::numeric_limits<double>::quiet_NaN());
  });
  return std::move(times).array();
}

}  // namespace

void bind_geometry(nb::module_& m) {
  m.def("orient2d", &signs_2d, nb::arg("a").none(), nb::arg("b").none(), nb::arg("c").none(),
        nb::sig("def orient2d(a: ArrayLike, b: ArrayLike, c: ArrayLike) -> Ints"),
        R"(Signs of the areas of triangles: 1 counter-clockwise, -1 clockwise, 0 exactly collinear.

Exact for all finite numbers, those whose products overflow or underflow, too.

Parameters
----------
a, b, c : (k, 2) arrays
    The corners [m].

Returns
-------
(k,) int32

Raises
------
selvage.Error
    When an array has another shape or type.

Examples
--------
>>> selvage.orient2d([[0, 0]], [[1, 0]], [[0.1, 1e-300]])
array([1], dtype=int32)
)");
  m.def("orient3d", &signs_3d, nb::arg("a").none(), nb::arg("b").none(), nb::arg("c").none(), nb::arg("d").none(),
        nb::sig("def orient3d(a: ArrayLike, b: ArrayLike, c: ArrayLike, d: ArrayLike) -> Ints"),
        R"(Signs of the volumes of tetrahedra: 1 positive, -1 inverted, 0 exactly flat.

Exact for all finite numbers, those whose products overflow or underflow, too.

Parameters
----------
a, b, c, d : (k, 3) arrays
    The corners [m].

Returns
-------
(k,) int32

Raises
------
selvage.Error
    When an array has another shape or type.

Examples
--------
>>> mesh = selvage.make("ball", cell=0.4)
>>> signs = selvage.orient3d(*(mesh.V[mesh.T[:, i]] for i in range(4)))
>>> bool((signs == 1).all())
True
)");
  m.def("contact_codes", &contacts_of_triangles, nb::arg("A"), nb::arg("B"),
        nb::sig("def contact_codes(A: ArrayLike, B: ArrayLike) -> Codes"),
        "Codes of TriangleContact of triangles, three rows each. See `selvage.triangle_contacts`.");
  m.def("first_times", &first_times, nb::arg("X0"), nb::arg("X1"), nb::arg("of_edges"), nb::arg("distance"),
        nb::sig("def first_times(X0: ArrayLike, X1: ArrayLike, of_edges: bool, distance: float) -> Floats"),
        "First times of impact or nearness of moving points, four rows each. See `selvage.impact_times`.");
}

}  // namespace selvage::python
