#include "bindings.h"

#include <nanobind/stl/vector.h>

namespace selvage::python {

namespace {

nb::object slice_of(Index first, Index count) {
  return nb::steal(PySlice_New(nb::int_(first).ptr(), nb::int_(first + count).ptr(), nullptr));
}

const char* solver_name(SolverKind solver) {
  switch (solver) {
    case SolverKind::kNewton:
      return "newton";
    case SolverKind::kVbd:
      return "vbd";
    default:
      return "xpbd";
  }
}

nb::list bodies_of(const Scene& scene) {
  nb::list bodies;
  for (const Body& body : scene.model.bodies) {
    nb::dict row;
    row["name"] = body.name;
    row["vertices"] = slice_of(body.first_vertex, body.vertex_count);
    row["elements"] = slice_of(body.first_element, body.element_count);
    row["triangles"] = slice_of(body.first_triangle, body.triangle_count);
    row["is_cloth"] = body.is_cloth();
    bodies.append(row);
  }
  return bodies;
}

}  // namespace

PlacedTetMesh mesh_of_scene(const Scene& scene, const nb::object& positions) {
  return {scene.model.mesh, Rows<Vec3>(positions, "positions")};
}

PlacedTriangleMesh surface_of_scene(const Scene& scene, const nb::object& positions) {
  TriangleMesh surface = without_interpreter([&] { return surface_of(scene.model); });
  return {std::move(surface), Rows<Vec3>(positions, "positions")};
}

void bind_scenes(nb::module_& m) {
  m.def(
      "scene_of_text",
      [](const std::string& text, const std::filesystem::path& path, const std::string& scale,
         const std::vector<std::string>& changes) {
        return without_interpreter(
            [&] { return SceneHandle{std::make_shared<Scene>(parse_scene(text, path, scale, changes))}; });
      },
      nb::arg("text"), nb::arg("path"), nb::arg("scale"), nb::arg("changes"),
      nb::sig("def scene_of_text(text: str, path: str | os.PathLike[str], scale: str, changes: list[str]) -> Scene"),
      "A scene from its JSON text; `path` stands for it in errors. See `selvage.read_scene`.");
  m.def(
      "scene_of_file",
      [](const std::filesystem::path& path, const std::string& scale, const std::vector<std::string>& changes) {
        return without_interpreter(
            [&] { return SceneHandle{std::make_shared<Scene>(read_scene(path, scale, changes))}; });
      },
      nb::arg("path"), nb::arg("scale"), nb::arg("changes"),
      nb::sig("def scene_of_file(path: str | os.PathLike[str], scale: str, changes: list[str]) -> Scene"),
      "A scene from its file. See `selvage.read_scene`.");
  nb::class_<SceneHandle>(m, "Scene",
                          R"(A scene ready to run, with all meshes read or made. `selvage.read_scene` makes it.

Examples
--------
>>> scene = selvage.read_scene({"selvage_scene": 1, "bodies": [{"mesh": {"shape": "box", "cell": 0.5}}]})
>>> scene.frames, scene.frames_per_second, scene.substeps
(60, 60, 5)
>>> [body["name"] for body in scene.bodies]
['body0']
)")
      .def_prop_ro(
          "name", [](const SceneHandle& s) { return s.scene->name; }, "Name of the file, without extension.")
      .def_prop_ro(
          "frames", [](const SceneHandle& s) { return s.scene->frames; }, "Frames to run.")
      .def_prop_ro(
          "frames_per_second", [](const SceneHandle& s) { return s.scene->frames_per_second; }, "Frames a second.")
      .def_prop_ro(
          "substeps", [](const SceneHandle& s) { return s.scene->substeps; }, "Steps a frame.")
      .def_prop_ro(
          "time_step", [](const SceneHandle& s) { return s.scene->options.time_step; }, "[s] of one step.")
      .def_prop_ro(
          "bodies", [](const SceneHandle& s) { return bodies_of(*s.scene); },
          nb::sig("def bodies(self) -> list[dict[str, Any]]"),
          "Of each body its `name`, whether it `is_cloth`, and its slices of the vertices, of `mesh.T` (`elements`) "
          "and of "
          "`triangles`.")
      .def_prop_ro(
          "solver", [](const SceneHandle& s) { return solver_name(s.scene->solver); }, "'xpbd', 'newton' or 'vbd'.")
      .def_prop_ro(
          "triangles", [](const SceneHandle& s) { return array_of(s.scene->model.triangles); },
          nb::sig("def triangles(self) -> Ints"), "(m, 3) int32: the triangles of all cloth.")
      .def_prop_ro(
          "fingerprint", [](const SceneHandle& s) { return s.scene->fingerprint; },
          "A number of all that decides a run: two scenes with the same one run alike.")
      .def_prop_ro(
          "rest_positions", [](const SceneHandle& s) { return array_of(s.scene->model.rest_positions); },
          nb::sig("def rest_positions(self) -> Floats"), "(n, 3) float64: where nothing is stressed [m].")
      .def_prop_ro(
          "inverse_masses", [](const SceneHandle& s) { return array_of(s.scene->model.inverse_masses); },
          nb::sig("def inverse_masses(self) -> Floats"), "(n,) float64 [1/kg]; 0: pinned, or without element.")
      .def_prop_ro(
          "mesh",
          [](const SceneHandle& s) { return mesh_of_scene(*s.scene, array_of(s.scene->initial_state.positions)); },
          nb::sig("def mesh(self) -> TetMesh"),
          "All bodies of tetrahedra in one mesh, where they start; without elements where all is cloth.")
      .def_prop_ro(
          "surface",
          [](const SceneHandle& s) { return surface_of_scene(*s.scene, array_of(s.scene->initial_state.positions)); },
          nb::sig("def surface(self) -> TriangleMesh"),
          "Boundary of the tetrahedra, then the triangles of cloth, where they start.")
      .def("__repr__", [](const SceneHandle& s) {
        return "<selvage.Scene '" + s.scene->name + "': " + std::to_string(s.scene->model.bodies.size()) + " bodies, " +
               std::to_string(s.scene->model.mesh.element_count()) + " elements" +
               (s.scene->model.triangles.empty()
                    ? ""
                    : ", " + std::to_string(s.scene->model.triangles.size()) + " triangles of cloth") +
               ">";
      });
}

}  // namespace selvage::python
