#include "selvage/surface_distance/surface_distance.h"

#include "bindings.h"

namespace selvage::python {

namespace {

struct Distance {
  nb::object mesh_owner;
  const PlacedTriangleMesh* mesh;
  std::unique_ptr<SurfaceDistance> surface;
};

class ClosestArrays {
 public:
  explicit ClosestArrays(std::size_t n) : triangle_(n), point_(n, 3), distance_(n), barycentric_(n, 3), feature_(n) {}

  void set(std::size_t i, const SurfacePoint& answer, double distance) {
    triangle_[i] = answer.triangle;
    std::copy_n(answer.point.data(), 3, point_.row(i));
    distance_[i] = distance;
    std::copy_n(answer.barycentric.data(), 3, barycentric_.row(i));
    feature_[i] = static_cast<std::uint8_t>(answer.feature);
  }

  nb::object result() && {
    return result_class("ClosestPoints")(std::move(distance_).array(), std::move(triangle_).array(),
                                         std::move(point_).array(), std::move(barycentric_).array(),
                                         std::move(feature_).array());
  }

 private:
  Column<std::int32_t> triangle_;
  Column<double> point_, distance_, barycentric_;
  Column<std::uint8_t> feature_;
};

}  // namespace

void bind_surface_distance(nb::module_& m) {
  nb::class_<Distance>(m, "SurfaceDistance",
                       R"(Closest points on a triangle surface, and distances from it, signed where it is closed.

Parameters
----------
mesh : selvage.TriangleMesh
    Kept alive.
V : (n, 3) array, optional
    Positions [m]; those of the mesh where None. Copied.

Raises
------
selvage.Error
    When sizes differ, or a position is not finite or too large.

Notes
-----
Signs are exact: they come from winding numbers (Jacobson, Kavan, Sorkine-Hornung 2013), decided by exact predicates.

Examples
--------
>>> ball = selvage.make("ball", radius=1, cell=0.3).surface()
>>> answer = selvage.SurfaceDistance(ball).find_signed_distances([[0, 0, 0], [3, 0, 0]])
>>> answer.distance.round(1)
array([-1.,  2.])
)")
      .def(
          "__init__",
          [](Distance* self, nb::object mesh, nb::object v) {
            const auto& placed = mesh_argument<PlacedTriangleMesh>(mesh);
            const Rows<Vec3> x = placed.positions_or(v);
            auto surface =
                without_interpreter([&] { return std::make_unique<SurfaceDistance>(placed.topology, x.span()); });
            new (self) Distance{mesh, &placed, std::move(surface)};
          },
          nb::arg("mesh").none(), nb::arg("V").none() = nb::none(),
          nb::sig("def __init__(self, mesh: TriangleMesh, V: ArrayLike | None = None) -> None"))
      .def(
          "update",
          [](Distance& self, nb::object v) {
            const Rows<Vec3> x = self.mesh->positions_or(v);
            without_interpreter([&] { self.surface->update(x.span()); });
          },
          nb::arg("V").none() = nb::none(), nb::sig("def update(self, V: ArrayLike | None = None) -> None"),
          "Takes a new pose (n, 3) [m], the mesh's own where None, and refits in O(n).")
      .def_prop_ro(
          "is_closed", [](const Distance& self) { return self.surface->is_closed(); },
          "Whether the surface has an inside.")
      .def(
          "find_closest_points",
          [](const Distance& self, nb::object points) {
            const Rows<Vec3> p(points, "P");
            ClosestArrays arrays(p.span().size());
            Watch watch;
            watch.begin();
            without_interpreter([&] {
              in_pieces(p.span().size(), watch, [&](std::int64_t first, std::int64_t last) {
                for (std::size_t i = first; const SurfacePoint& answer :
                                            self.surface->find_closest_points(p.span().subspan(first, last - first)))
                  arrays.set(i++, answer, answer.distance);
              });
            });
            return std::move(arrays).result();
          },
          nb::arg("P").none(), nb::sig("def find_closest_points(self, P: ArrayLike) -> ClosestPoints"),
          R"(The point of the surface that is closest to each of (k, 3) points [m].

Returns
-------
selvage.ClosestPoints
    Arrays of `distance, triangle, point, barycentric, feature`.

Raises
------
selvage.Error
    When a coordinate is not finite or too large.
)")
      .def(
          "find_signed_distances",
          [](const Distance& self, nb::object points) {
            const Rows<Vec3> p(points, "P");
            ClosestArrays arrays(p.span().size());
            Column<std::int32_t> winding(p.span().size());
            Watch watch;
            watch.begin();
            without_interpreter([&] {
              in_pieces(p.span().size(), watch, [&](std::int64_t first, std::int64_t last) {
                const auto answers = self.surface->find_signed_distances(p.span().subspan(first, last - first));
                for (std::size_t i = first; const SignedDistance& answer : answers) {
                  winding[i] = answer.side.winding_number;
                  arrays.set(i++, answer.closest, answer.distance);
                }
              });
            });
            const nb::object closest = std::move(arrays).result();
            return result_class("SignedDistances")(*closest, std::move(winding).array());
          },
          nb::arg("P").none(), nb::sig("def find_signed_distances(self, P: ArrayLike) -> SignedDistances"),
          R"(The signed distance of each of (k, 3) points [m]: negative inside, exactly 0 on the surface.

Returns
-------
selvage.SignedDistances
    The arrays of ClosestPoints, and `winding_number`.

Raises
------
selvage.Error
    When the surface is not closed, or a coordinate is not finite or too large.
)");
}

}  // namespace selvage::python
