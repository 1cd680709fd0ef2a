#include "selvage/shapes/shapes.h"

#include "bindings.h"
#include "selvage/shapes/poses.h"
#include "selvage/shapes/sequences.h"

namespace selvage::python {

namespace {

nb::tuple arrays_of(const IndexedMesh& mesh) {
  return nb::make_tuple(array_of(mesh.positions), array_of(mesh.triangles), array_of(mesh.tetrahedra));
}

template <typename T>
void take(const nb::dict& options, const char* name, std::optional<T>& value) {
  if (!options.contains(name)) return;
  try {
    value = nb::cast<T>(options[name]);
  } catch (nb::cast_error&) {
    throw Error(name, nb::cast<std::string>(nb::repr(options[name])) + " is no number of the right kind");
  }
}

void take(const nb::dict& options, const char* name, std::optional<Vec3>& value) {
  if (options.contains(name)) value = vector_of(options[name], name);
}

// 'x', 'y', 'z', or 0, 1, 2.
void take_axis(const nb::dict& options, std::optional<int>& axis) {
  std::string letter;
  if (options.contains("axis") && nb::try_cast(options["axis"], letter)) {
    if (letter != "x" && letter != "y" && letter != "z")
      throw Error("axis", "'" + letter + "' is not an axis", "use x, y or z");
    axis = letter[0] - 'x';
  } else {
    take(options, "axis", axis);
  }
}

ShapeOptions shape_options(const nb::dict& options) {
  ShapeOptions result;
  take(options, "cell", result.cell);
  take(options, "elements", result.elements);
  take(options, "size", result.size);
  take(options, "length", result.length);
  take(options, "radius", result.radius);
  take(options, "inner_radius", result.inner_radius);
  take(options, "tentacles", result.tentacles);
  take(options, "teeth", result.teeth);
  take(options, "seed", result.seed);
  take(options, "slenderness", result.slenderness);
  return result;
}

PoseOptions pose_options(const nb::dict& options) {
  PoseOptions result;
  take_axis(options, result.axis);
  take(options, "turns", result.turns);
  take(options, "angle", result.angle);
  take(options, "crossings", result.crossings);
  take(options, "core", result.core);
  take(options, "offset", result.offset);
  return result;
}

nb::list names_of(std::span<const std::string_view> names) {
  nb::list result;
  for (const std::string_view name : names) result.append(nb::str(name.data(), name.size()));
  return result;
}

}  // namespace

void bind_shapes(nb::module_& m) {
  m.def(
      "shape_arrays",
      [](const std::string& shape, const nb::dict& shape_dict, nb::object pose, const nb::dict& pose_dict) {
        const ShapeOptions options = shape_options(shape_dict);
        const PoseOptions posing = pose_options(pose_dict);
        const std::string name = pose.is_none() ? "" : nb::cast<std::string>(pose);
        const IndexedMesh mesh = without_interpreter([&] {
          IndexedMesh made = make_shape(shape, options);
          if (!name.empty()) apply_pose(made, name, posing);
          return made;
        });
        return arrays_of(mesh);
      },
      nb::arg("shape"), nb::arg("shape_options"), nb::arg("pose").none(), nb::arg("pose_options"),
      nb::sig("def shape_arrays(shape: str, shape_options: dict[str, Any], pose: str | None, "
              "pose_options: dict[str, Any]) -> tuple[Floats, Ints, Ints]"),
      "The arrays (V, F, T) of a shape by its name, posed by the name of a pose. See `selvage.make`.");
  m.def(
      "posed_arrays",
      [](nb::object v, nb::object f, nb::object t, const std::string& pose, const nb::dict& pose_dict) {
        IndexedMesh mesh{.positions = Rows<Vec3>(v, "V").copy(),
                         .tetrahedra = rows_or_none<VertexTuple<4>>(t, "T").copy(),
                         .triangles = rows_or_none<VertexTuple<3>>(f, "F").copy()};
        const PoseOptions options = pose_options(pose_dict);
        without_interpreter([&] { apply_pose(mesh, pose, options); });
        return arrays_of(mesh);
      },
      nb::arg("V").none(), nb::arg("F").none(), nb::arg("T").none(), nb::arg("pose"), nb::arg("pose_options"),
      nb::sig("def posed_arrays(V: ArrayLike, F: ArrayLike | None, T: ArrayLike | None, pose: str, "
              "pose_options: dict[str, Any]) -> tuple[Floats, Ints, Ints]"),
      "The arrays (V, F, T) of a mesh in the pose of that name. See `selvage.pose`.");
  m.def(
      "shape_names", [] { return names_of(shape_names()); }, nb::sig("def shape_names() -> list[str]"),
      "Names that `make` knows.");
  m.def(
      "pose_names", [] { return names_of(pose_names()); }, nb::sig("def pose_names() -> list[str]"),
      "Names of poses that `make` knows.");
  m.def(
      "sequence_names", [] { return names_of(sequence_names()); }, nb::sig("def sequence_names() -> list[str]"),
      "Names of the moving surfaces that `SurfaceSequence` knows.");
  nb::class_<SurfaceSequence>(m, "SurfaceSequence",
                              R"(A surface in motion that runs into itself, by formula, to try things on.

Parameters
----------
name : str
    One of `sequence_names()`: pipe, karate, t-shirt, funnel, flamenco, waves, crumple.
triangles : int
    About how many triangles; 0: the usual number.

Raises
------
selvage.Error
    For an unknown name, or a count that is negative or too large.

Examples
--------
>>> pipe = selvage.SurfaceSequence("pipe", triangles=2000)
>>> selvage.has_self_collisions(pipe.positions(0), pipe.F)
False
>>> selvage.has_self_collisions(pipe.positions(pipe.frame_count - 1), pipe.F)
True
)")
      .def(nb::init<std::string_view, std::int64_t>(), nb::arg("name"), nb::kw_only(), nb::arg("triangles").none() = 0,
           nb::sig("def __init__(self, name: str, *, triangles: int = 0) -> None"))
      .def_prop_ro(
          "F", [](const SurfaceSequence& self) { return array_of(self.triangles()); }, nb::sig("def F(self) -> Ints"),
          "(m, 3) int32: vertices of each triangle.")
      .def_prop_ro("frame_count", &SurfaceSequence::frame_count, "Number of frames.")
      .def(
          "positions",
          [](const SurfaceSequence& self, double frame) {
            return array_of(without_interpreter([&] { return self.positions(frame); }));
          },
          nb::arg("frame"), nb::sig("def positions(self, frame: float) -> Floats"),
          R"((n, 3) float64: positions [m] at a frame from 0 to frame_count - 1; between two frames, too.

Raises
------
selvage.Error
    When the frame is out of range.
)");
}

}  // namespace selvage::python
