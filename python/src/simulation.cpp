#include "bindings.h"
#include "contacts.h"
#include "scenes.h"
#include "selvage/simulation/xpbd.h"

namespace selvage::python {

namespace {

/// A scene in time. The arrays belong to Python, which may write to them between steps; each step takes them in and
/// writes them back.
struct Simulation {
  std::shared_ptr<const Scene> scene;
  State state;
  nb::object positions, velocities;
  std::shared_ptr<Watch> watch;  ///< holds the user's constraint, for the garbage collector
  std::optional<XpbdSolver> solver;
  bool with_contact = false;

  explicit Simulation(std::shared_ptr<const Scene> s) : scene(std::move(s)), state(scene->initial_state) {
    if (scene->solver != SolverKind::kXpbd)
      throw Error("solver", "is not xpbd, by which alone a Simulation steps",
                  "run the scene with selvage.simulate(), or set \"solver\": \"xpbd\"");
    positions = array_of(state.positions);
    velocities = array_of(state.velocities);
    watch = std::make_shared<Watch>();
    make_solver();
  }

  std::int64_t frame() const { return state.steps / scene->substeps; }
  bool wants_contact() const { return frame() >= scene->contact_from_frame; }

  void make_solver() {
    XpbdOptions options = scene->options;
    with_contact = wants_contact();
    if (!with_contact) options.contact.mode = DetectionMode::kOff;
    without_interpreter([&] {
      solver.reset();
      solver.emplace(scene->model, scene->initial_state, scene->handles, scene->colliders, options);
    });
    set_constraint();
  }

  void set_constraint() {
    if (watch->progress().is_none()) return solver->set_constraint({});
    solver->set_constraint([held = watch](const StepVertices& vertices, int iteration) {
      const nb::gil_scoped_acquire python;
      call_constraint(held->progress(), vertices, iteration);
    });
  }

  /// Calls Python with copies, so that nothing is left hanging when it keeps them.
  static void call_constraint(const nb::object& constraint, const StepVertices& vertices, int iteration) {
    const auto n = static_cast<std::size_t>(vertices.size());
    Column<double> rows(n, 3), masses(n);
    for (std::size_t v = 0; v < n; ++v) {
      std::copy_n(vertices.position(static_cast<Index>(v)).data(), 3, rows.row(v));
      masses[v] = vertices.inverse_mass(static_cast<Index>(v));
    }
    const nb::object array = std::move(rows).array();
    constraint(array, std::move(masses).array(), iteration);
    const Rows<Vec3> moved(array, "positions");
    for (std::size_t v = 0; v < n; ++v)
      if (vertices.inverse_mass(static_cast<Index>(v)) > 0) vertices.position(static_cast<Index>(v)) = moved.span()[v];
  }

  Rows<Vec3> taken(nb::handle array, const char* name) const {
    Rows<Vec3> rows(array, name);
    if (rows.span().size() != state.positions.size())
      throw Error(
          name,
          std::to_string(rows.span().size()) + " rows for " + std::to_string(state.positions.size()) + " vertices",
          "give one per vertex");
    return rows;
  }

  void set(nb::object& target, nb::handle value, const char* name) {
    const Rows<Vec3> rows = taken(value, name);
    target = array_of(rows.span());
  }

  void step(int count, nb::handle forces) {
    const Rows<Vec3> force = forces.is_none() ? Rows<Vec3>() : taken(forces, "forces");
    watch->begin();
    for (int i = 0; i < count; ++i) {
      if (with_contact != wants_contact()) make_solver();
      const Rows<Vec3> x = taken(positions, "positions"), v = taken(velocities, "velocities");
      without_interpreter([&] {
        State next = state;
        // What is moved by hand is awake.
        if (!std::equal(x.span().begin(), x.span().end(), state.positions.begin())) next.rest_times.clear();
        next.positions.assign(x.span().begin(), x.span().end());
        next.velocities.assign(v.span().begin(), v.span().end());
        solver->step(next, force.span());
        state = std::move(next);
      });
      write(positions, state.positions, "positions");
      write(velocities, state.velocities, "velocities");
      if (PyErr_CheckSignals() != 0) throw nb::python_error();
    }
  }

  /// In place, so that arrays that Python holds show the new state.
  static void write(nb::handle array, const std::vector<Vec3>& values, const char* name) {
    const Rows<Vec3> rows(array, name);
    std::copy(values.begin(), values.end(), const_cast<Vec3*>(rows.span().data()));
  }
};

nb::dict statistics_of(const StepStatistics& s) {
  nb::dict result;
  result["constraints"] = s.constraints;
  result["collider_contacts"] = s.collider_contacts;
  result["held_back_vertices"] = s.held_back_vertices;
  result["impacts_left"] = s.impacts_left;
  result["unguarded_vertices"] = s.unguarded_vertices;
  result["sleeping_bodies"] = s.sleeping_bodies;
  result["penetrating_vertices"] = s.contact.penetrating_vertices;
  result["path_queries"] = s.contact.path_queries;
  result["blocked_paths"] = s.contact.blocked_paths;
  result["seconds_material"] = s.seconds_material;
  result["seconds_projection"] = s.seconds_projection;
  result["seconds_dcd"] = s.contact.seconds_dcd + s.contact.seconds_split;
  result["seconds_paths"] = s.contact.seconds_paths;
  result["seconds_ccd"] = s.contact.seconds_ccd;
  result["seconds"] = s.seconds;
  return result;
}

PlacedTetMesh mesh_of(const Scene& scene, const nb::object& positions) {
  return {scene.model.mesh, Rows<Vec3>(positions, "positions")};
}

nb::list bodies_of(const Scene& scene) {
  nb::list bodies;
  for (const Body& body : scene.model.bodies) {
    nb::dict row;
    row["name"] = body.name;
    row["vertices"] = nb::steal(
        PySlice_New(nb::int_(body.first_vertex).ptr(), nb::int_(body.first_vertex + body.vertex_count).ptr(), nullptr));
    row["elements"] = nb::steal(PySlice_New(nb::int_(body.first_element).ptr(),
                                            nb::int_(body.first_element + body.element_count).ptr(), nullptr));
    bodies.append(row);
  }
  return bodies;
}

void bind_scene(nb::module_& m) {
  m.def(
      "scene_of_text",
      [](const std::string& text, const std::filesystem::path& path, const std::string& scale) {
        return without_interpreter(
            [&] { return SceneHandle{std::make_shared<Scene>(parse_scene(text, path, scale))}; });
      },
      nb::arg("text"), nb::arg("path"), nb::arg("scale"),
      nb::sig("def scene_of_text(text: str, path: str | os.PathLike[str], scale: str) -> Scene"),
      "A scene from its JSON text; `path` stands for it in errors. See `selvage.read_scene`.");
  m.def(
      "scene_of_file",
      [](const std::filesystem::path& path, const std::string& scale) {
        return without_interpreter([&] { return SceneHandle{std::make_shared<Scene>(read_scene(path, scale))}; });
      },
      nb::arg("path"), nb::arg("scale"),
      nb::sig("def scene_of_file(path: str | os.PathLike[str], scale: str) -> Scene"),
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
          "Of each body its `name`, and the slices `vertices` and `elements` of the arrays that are its.")
      .def_prop_ro(
          "rest_positions", [](const SceneHandle& s) { return array_of(s.scene->model.rest_positions); },
          nb::sig("def rest_positions(self) -> Floats"), "(n, 3) float64: where nothing is stressed [m].")
      .def_prop_ro(
          "inverse_masses", [](const SceneHandle& s) { return array_of(s.scene->model.inverse_masses); },
          nb::sig("def inverse_masses(self) -> Floats"), "(n,) float64 [1/kg]; 0: pinned, or without element.")
      .def_prop_ro(
          "mesh", [](const SceneHandle& s) { return mesh_of(*s.scene, array_of(s.scene->initial_state.positions)); },
          nb::sig("def mesh(self) -> TetMesh"), "All bodies in one mesh, where they start.")
      .def("__repr__", [](const SceneHandle& s) {
        return "<selvage.Scene '" + s.scene->name + "': " + std::to_string(s.scene->model.bodies.size()) + " bodies, " +
               std::to_string(s.scene->model.mesh.element_count()) + " elements>";
      });
}

}  // namespace

void bind_simulation(nb::module_& m) {
  bind_scene(m);
  nb::class_<Simulation>(m, "SceneSimulation", nb::type_slots(CollectedWatch<Simulation>::slots),
                         "A scene step by step. See `selvage.Simulation`.")
      .def(
          "__init__", [](Simulation* self, const SceneHandle& s) { new (self) Simulation(s.scene); },
          nb::arg("scene").none(), nb::sig("def __init__(self, scene: Scene) -> None"))
      .def_prop_rw(
          "positions", [](const Simulation& s) { return s.positions; },
          [](Simulation& s, nb::object v) { s.set(s.positions, v, "positions"); },
          nb::for_getter(nb::sig("def positions(self) -> Floats")),
          nb::for_setter(nb::sig("def positions(self, value: ArrayLike, /) -> None")),
          R"((n, 3) float64 [m]. Each step writes into this very array; write to it between steps to move vertices.)")
      .def_prop_rw(
          "velocities", [](const Simulation& s) { return s.velocities; },
          [](Simulation& s, nb::object v) { s.set(s.velocities, v, "velocities"); },
          nb::for_getter(nb::sig("def velocities(self) -> Floats")),
          nb::for_setter(nb::sig("def velocities(self, value: ArrayLike, /) -> None")),
          R"((n, 3) float64 [m/s]. As `positions`.)")
      .def_prop_ro(
          "time", [](const Simulation& s) { return s.state.time; }, "[s]")
      .def_prop_ro(
          "steps", [](const Simulation& s) { return s.state.steps; }, "Steps done so far.")
      .def_prop_ro("frame", &Simulation::frame, "Whole frames done so far.")
      .def_prop_ro(
          "scene", [](const Simulation& s) { return SceneHandle{s.scene}; }, nb::sig("def scene(self) -> Scene"),
          "The scene that is simulated.")
      .def_prop_ro(
          "mesh", [](const Simulation& s) { return mesh_of(*s.scene, s.positions); },
          nb::sig("def mesh(self) -> TetMesh"), "All bodies in one mesh; its `V` is `positions`, and follows it.")
      .def(
          "step", [](Simulation& s, int count, nb::object forces) { s.step(count, forces); }, nb::arg("count") = 1,
          nb::kw_only(), nb::arg("forces").none() = nb::none(),
          nb::sig("def step(self, count: int = 1, *, forces: ArrayLike | None = None) -> None"),
          R"(Takes the simulation so many time steps further.

Parameters
----------
count : int
    Number of steps.
forces : (n, 3) array, optional
    That act in these steps besides gravity [N].

Raises
------
selvage.Error
    When a size differs, and naming the first vertex whose position stops being finite; the state is then that before
    the step.
)")
      .def(
          "step_frame",
          [](Simulation& s) {
            s.step(s.scene->substeps - static_cast<int>(s.state.steps % s.scene->substeps), nb::none());
          },
          "Steps to the end of the frame.")
      .def(
          "set_constraint",
          [](Simulation& s, nb::object constraint) {
            s.watch->progress() = std::move(constraint);
            s.set_constraint();
          },
          nb::arg("constraint").none(),
          nb::sig("def set_constraint(self, constraint: Callable[[Floats, Floats, int], object] | None) -> None"),
          R"(Adds a constraint of your own to all steps that follow; None takes it away.

Parameters
----------
constraint : function(positions, inverse_masses, iteration)
    Called in each iteration of a step, after the material and before contacts. It moves rows of `positions` (n, 3) [m]
    in place so that the constraint holds better; those whose `inverse_masses` [1/kg] are 0 stay. What it raises leaves
    `step`, and the state as it was.
)")
      .def(
          "contacts", [](const Simulation& s) { return contact_arrays(s.solver->contacts()); },
          nb::sig("def contacts(self) -> Contacts"), "Contacts of the last step.")
      .def(
          "statistics", [](const Simulation& s) { return statistics_of(s.solver->statistics()); },
          nb::sig("def statistics(self) -> dict[str, float]"), "Counts and times of the last step.");
}

}  // namespace selvage::python
