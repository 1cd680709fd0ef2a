#include "bindings.h"

#include <variant>

namespace selvage::python {

namespace {

/// A scene in time. The arrays belong to Python, which may write to them between steps; each step takes them in and
/// writes them back.
struct Simulation {
  std::shared_ptr<const Scene> scene;
  State state;
  nb::object positions, velocities;
  std::shared_ptr<Watch> watch;  ///< holds the user's constraint, for the garbage collector
  using Solver = std::variant<XpbdSolver, NewtonSolver, VbdSolver>;
  std::optional<Solver> solver;
  bool with_contact = false;

  explicit Simulation(std::shared_ptr<const Scene> s) : scene(std::move(s)), state(scene->initial_state) {
    positions = array_of(state.positions);
    velocities = array_of(state.velocities);
    watch = std::make_shared<Watch>();
    make_solver();
  }

  std::int64_t frame() const { return state.steps / scene->substeps; }
  bool wants_contact() const { return frame() >= scene->contact_from_frame; }

  template <typename Made, typename Options>
  void make(Options options, const StepOptions& shared) {
    static_cast<StepOptions&>(options) = shared;
    solver.emplace(std::in_place_type<Made>, scene->model, scene->initial_state, scene->handles, scene->colliders,
                   options);
  }

  void make_solver() {
    StepOptions shared = scene->options;
    with_contact = wants_contact();
    if (!with_contact) shared.contact.mode = DetectionMode::kOff;
    without_interpreter([&] {
      solver.reset();
      if (scene->solver == SolverKind::kNewton) return make<NewtonSolver>(scene->newton, shared);
      if (scene->solver == SolverKind::kVbd)
        return make<VbdSolver>(VbdOptions{{}, scene->options.iterations, scene->vbd_residual}, shared);
      make<XpbdSolver>(scene->options, shared);
    });
    set_constraint();
  }

  void set_constraint() {
    auto* const xpbd = std::get_if<XpbdSolver>(&*solver);
    if (xpbd == nullptr) return;
    if (watch->progress().is_none()) return xpbd->set_constraint({});
    xpbd->set_constraint([held = watch](const StepVertices& vertices, int iteration) {
      const nb::gil_scoped_acquire python;
      call_constraint(held->progress(), vertices, iteration);
    });
  }

  void take_constraint(nb::object constraint) {
    if (!constraint.is_none() && !std::holds_alternative<XpbdSolver>(*solver))
      throw Error("constraint", "the scene's solver is not xpbd, which alone takes one",
                  "set \"solver\": \"xpbd\", or add forces to step()");
    watch->progress() = std::move(constraint);
    set_constraint();
  }

  std::span<const Contact> contacts() const {
    return std::visit([](const auto& s) { return s.contacts(); }, *solver);
  }
  const StepStatistics& statistics() const {
    return std::visit([](const auto& s) -> const StepStatistics& { return s.statistics(); }, *solver);
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
        std::visit([&](auto& made) { made.step(next, force.span()); }, *solver);
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
  result["newton_steps"] = s.newton_steps;
  result["linear_iterations"] = s.linear_iterations;
  result["residual"] = s.residual;
  result["collider_contacts"] = s.collider_contacts;
  result["missed_rounds"] = s.missed_rounds;
  result["hold_back_rounds"] = s.hold_back_rounds;
  result["held_back_vertices"] = s.held_back_vertices;
  result["impacts_met"] = s.impacts_met;
  result["impacts_left"] = s.impacts_left;
  result["unguarded_vertices"] = s.unguarded_vertices;
  result["sleeping_bodies"] = s.sleeping_bodies;
  constexpr std::array<const char*, kContactKinds> kKinds{"vertex_paths", "edge_paths", "centroid_paths",
                                                          "vertex_faces", "edge_edges", "contours"};
  for (std::size_t kind = 0; kind < kKinds.size(); ++kind) result[kKinds[kind]] = s.contact.contacts[kind];
  result["penetrating_vertices"] = s.contact.penetrating_vertices;
  result["penetrating_edges"] = s.contact.penetrating_edges;
  result["path_queries"] = s.contact.path_queries;
  result["blocked_paths"] = s.contact.blocked_paths;
  result["seconds_material"] = s.seconds_material;
  result["seconds_projection"] = s.seconds_projection;
  result["seconds_hold_back"] = s.seconds_hold_back;
  result["seconds_dcd"] = s.contact.seconds_dcd + s.contact.seconds_split;
  result["seconds_refit"] = s.contact.seconds_refit;
  result["seconds_paths"] = s.contact.seconds_paths;
  result["seconds_ccd"] = s.contact.seconds_ccd;
  result["seconds"] = s.seconds;
  return result;
}

}  // namespace

void bind_simulation(nb::module_& m) {
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
          "mesh", [](const Simulation& s) { return mesh_of_scene(*s.scene, s.positions); },
          nb::sig("def mesh(self) -> TetMesh"),
          "All bodies of tetrahedra in one mesh; its `V` is `positions`, and follows it. Without elements where all is "
          "cloth: see `surface`.")
      .def_prop_ro(
          "surface", [](const Simulation& s) { return surface_of_scene(*s.scene, s.positions); },
          nb::sig("def surface(self) -> TriangleMesh"),
          "Boundary of the tetrahedra, then the triangles of cloth; its `V` is `positions`, and follows it.")
      .def_prop_ro(
          "rest_times",
          [](const Simulation& s) {
            std::vector<double> times = s.state.rest_times;
            times.resize(s.scene->model.bodies.size());
            return array_of(times);
          },
          nb::sig("def rest_times(self) -> Floats"),
          "(b,) float64 [s]: for how long each body, with all that is near it, has hardly moved. With `sleep_speed` in "
          "the scene, bodies sleep after half a second of it. Below 0: for how much longer a body that was in another, "
          "or in a collider, is damped.")
      .def(
          "wake", [](Simulation& s) { s.state.rest_times.clear(); },
          "Wakes all bodies. A change of `positions` does so by itself; a velocity and forces wake what they move.")
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
    When a size differs, and naming the first vertex whose position stops being finite, or that the solver throws a
    thousand times as far as all bodies are large; the state is then that before the step.
)")
      .def(
          "step_frame",
          [](Simulation& s) {
            s.step(s.scene->substeps - static_cast<int>(s.state.steps % s.scene->substeps), nb::none());
          },
          "Steps to the end of the frame.")
      .def(
          "set_constraint", [](Simulation& s, nb::object constraint) { s.take_constraint(std::move(constraint)); },
          nb::arg("constraint").none(),
          nb::sig("def set_constraint(self, constraint: Callable[[Floats, Floats, int], object] | None) -> None"),
          R"(Adds a constraint of your own to all steps that follow; None takes it away.

Parameters
----------
constraint : function(positions, inverse_masses, iteration)
    Called in each iteration of a step, after the material and before contacts. It moves rows of `positions` (n, 3) [m]
    in place so that the constraint holds better; those whose `inverse_masses` [1/kg] are 0 stay. What it raises leaves
    `step`, and the state as it was.

Raises
------
selvage.Error
    When the scene's solver is not xpbd.
)")
      .def(
          "contacts", [](const Simulation& s) { return contact_arrays(s.contacts()); },
          nb::sig("def contacts(self) -> Contacts"), "Contacts of the last step.")
      .def(
          "statistics", [](const Simulation& s) { return statistics_of(s.statistics()); },
          nb::sig("def statistics(self) -> dict[str, float]"), "Counts and times of the last step.");
}

}  // namespace selvage::python
