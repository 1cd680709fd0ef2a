#include "bindings.h"
#include "selvage/scene/frames.h"
#include "selvage/scene/run.h"

namespace selvage::python {

namespace {

nb::dict row_of(const FrameStatistics& row) {
  nb::dict result;
  result["frame"] = row.frame;
  result["time"] = row.time;
  result["steps"] = row.steps;
  result["vertex_paths"] = row.vertex_paths;
  result["edge_paths"] = row.edge_paths;
  result["centroid_paths"] = row.centroid_paths;
  result["vertex_faces"] = row.vertex_faces;
  result["edge_edges"] = row.edge_edges;
  result["collider_contacts"] = row.collider_contacts;
  result["path_queries"] = row.path_queries;
  result["blocked_paths"] = row.blocked_paths;
  result["held_back_vertices"] = row.held_back_vertices;
  result["impacts_met"] = row.impacts_met;
  result["impacts_left"] = row.impacts_left;
  result["unguarded_vertices"] = row.unguarded_vertices;
  result["halved_steps"] = row.halved_steps;
  result["resolved_bodies"] = row.resolved_bodies;
  result["sleeping_bodies"] = row.sleeping_bodies;
  result["constraints"] = row.constraints;
  result["newton_steps"] = row.newton_steps;
  result["linear_iterations"] = row.linear_iterations;
  result["residual"] = row.residual;
  result["penetrating_vertices"] = row.penetrating_vertices;
  result["deepest_penetration"] = row.deepest_penetration;
  result["penetrating_edges"] = row.penetrating_edges;
  result["deepest_edge"] = row.deepest_edge;
  result["triangle_pairs"] = row.triangle_pairs;
  result["vertices_in_colliders"] = row.vertices_in_colliders;
  result["collider_points"] = row.collider_points;
  result["deepest_in_colliders"] = row.deepest_in_colliders;
  result["deepest_collider_point"] = row.deepest_collider_point;
  result["inverted_elements"] = row.inverted_elements;
  result["flat_elements"] = row.flat_elements;
  result["kinetic_energy"] = row.kinetic_energy;
  result["elastic_energy"] = row.elastic_energy;
  result["gravity_energy"] = row.gravity_energy;
  result["objective"] = row.objective;
  result["fastest"] = row.fastest;
  result["volumes"] = row.volumes;
  result["traversals"] = row.traversals;
  result["path_elements"] = row.path_elements;
  result["seconds_start"] = row.seconds_start;
  result["seconds_material"] = row.seconds_material;
  result["seconds_projection"] = row.seconds_projection;
  result["seconds_dcd"] = row.seconds_dcd;
  result["seconds_paths"] = row.seconds_paths;
  result["seconds_ccd"] = row.seconds_ccd;
  result["seconds_steps"] = row.seconds_steps;
  result["seconds_frame"] = row.seconds_frame;
  return result;
}

nb::dict depths_of(const ColliderCrossings& of) {
  nb::dict result;
  result["vertices"] = of.vertices;
  result["deepest_vertex"] = of.deepest_vertex;
  result["points"] = of.points;
  result["deepest_point"] = of.deepest_point;
  return result;
}

/// As in checks/frame_*.json, with bodies by their numbers.
nb::dict crossings_of(const Crossings& crossings) {
  nb::list pairs, colliders;
  for (const BodyPairCrossings& pair : crossings.bodies.pairs) {
    nb::dict row;
    row["bodies"] = nb::make_tuple(pair.first, pair.second);
    row["triangle_pairs"] = pair.triangle_pairs;
    row["vertices"] = pair.vertices;
    row["deepest_vertex"] = pair.deepest_vertex;
    row["edges"] = pair.edges;
    row["deepest_edge"] = pair.deepest_edge;
    pairs.append(row);
  }
  for (const ColliderCrossings& of : crossings.colliders) colliders.append(depths_of(of));
  nb::dict result;
  result["crosses"] = crossings.any();
  result["body_pairs"] = pairs;
  result["colliders"] = colliders;
  return result;
}

const char* outcome_name(RunOutcome outcome) {
  switch (outcome) {
    case RunOutcome::kFinished:
      return "finished";
    case RunOutcome::kExploded:
      return "exploded";
    case RunOutcome::kImpossibleHandles:
      return "impossible-handles";
    case RunOutcome::kPinched:
      return "pinched";
    default:
      return "no-volume";
  }
}

SurfaceFormat surface_format(nb::handle name) {
  if (name.is_none()) return SurfaceFormat::kNoSurface;
  const auto text = nb::cast<std::string>(nb::str(name));
  if (text == "ply") return SurfaceFormat::kPly;
  if (text == "obj") return SurfaceFormat::kObj;
  throw Error("surface", "there is no '" + text + "'", "choose one of ply, obj");
}

}  // namespace

void bind_runs(nb::module_& m) {
  m.def(
      "run_scene_to",
      [](const SceneHandle& scene, const std::filesystem::path& folder, nb::object frames, bool resume, bool vtu,
         nb::object surface, std::int64_t check_every, nb::object progress, nb::object on_check) {
        RunOptions options{.folder = folder,
                           .resume = resume,
                           .vtu = vtu,
                           .surface = surface_format(surface),
                           .check_every = check_every};
        if (!frames.is_none()) options.frames = nb::cast<std::int64_t>(frames);
        Watch watch;
        watch.begin();
        options.on_step = [&](const selvage::StepProgress&) { watch(); };
        options.on_start = [&](const StartProgress&) { watch(); };
        options.on_frame = [&](const FrameStatistics& row) {
          watch();
          if (progress.is_none()) return;
          const nb::gil_scoped_acquire held;
          progress(row_of(row));
        };
        if (!on_check.is_none())
          options.on_check = [&](std::int64_t frame, const Crossings& crossings) {
            const nb::gil_scoped_acquire held;
            on_check(frame, crossings_of(crossings));
          };
        const RunReport report = without_interpreter([&] { return run_scene(*scene.scene, options); });
        nb::list rows;
        for (const FrameStatistics& row : report.frames) rows.append(row_of(row));
        nb::dict result;
        result["outcome"] = outcome_name(report.outcome);
        result["message"] = report.message;
        result["first_frame"] = report.first_frame;
        result["frames"] = rows;
        result["fingerprint"] = report.fingerprint;
        result["at_end"] = crossings_of(report.crossings);
        const auto free_from =
            scene.scene->options.contact.guarantee ? guaranteed_from(report.frames) : std::optional<std::int64_t>();
        result["guaranteed_from"] = free_from ? nb::object(nb::int_(*free_from)) : nb::object(nb::none());
        return result;
      },
      nb::arg("scene").none(), nb::arg("folder"), nb::kw_only(), nb::arg("frames").none() = nb::none(),
      nb::arg("resume") = false, nb::arg("vtu") = false, nb::arg("surface").none() = nb::none(),
      nb::arg("check_every") = 0, nb::arg("progress").none() = nb::none(), nb::arg("on_check").none() = nb::none(),
      nb::sig("def run_scene_to(scene: Scene, folder: str | os.PathLike[str], *, frames: int | None = None, "
              "resume: bool = False, vtu: bool = False, surface: str | None = None, "
              "check_every: int = 0, progress: Callable[[dict[str, Any]], object] | None = None, "
              "on_check: Callable[[int, dict[str, Any]], object] | None = None) -> dict[str, Any]"),
      "Runs a scene into a folder; its report as a dict. See `selvage.simulate`.");
  m.def(
      "read_topology_arrays",
      [](const std::filesystem::path& folder) {
        const TopologyFile file = without_interpreter([&] { return read_topology(topology_path(folder)); });
        return nb::make_tuple(array_of(file.elements), array_of(file.vertex_bodies), array_of(file.boundary_faces));
      },
      nb::arg("folder"), nb::sig("def read_topology_arrays(folder: str | os.PathLike[str]) -> tuple[Ints, Ints, Ints]"),
      "Elements, the body of each vertex, and boundary faces of a run.");
  m.def(
      "read_frame_arrays",
      [](const std::filesystem::path& folder, std::int64_t frame) {
        const FrameFile file = without_interpreter([&] { return read_frame(frame_path(folder, frame)); });
        return nb::make_tuple(array_of(file.positions), file.header.time, file.header.steps);
      },
      nb::arg("folder"), nb::arg("frame"),
      nb::sig("def read_frame_arrays(folder: str | os.PathLike[str], frame: int) -> tuple[Floats, float, int]"),
      "Positions, time [s] and steps of a frame of a run.");
  m.def(
      "read_rest_arrays",
      [](const std::filesystem::path& folder) {
        return array_of(without_interpreter([&] { return read_frame(rest_path(folder)); }).positions);
      },
      nb::arg("folder"), nb::sig("def read_rest_arrays(folder: str | os.PathLike[str]) -> Floats"),
      "Positions at rest of a run.");
  m.def(
      "read_checkpoint_arrays",
      [](const std::filesystem::path& folder) {
        const CheckpointFile file = without_interpreter([&] { return read_checkpoint(checkpoint_path(folder)); });
        return nb::make_tuple(array_of(file.state.positions), array_of(file.state.velocities), file.state.time,
                              file.header.frame);
      },
      nb::arg("folder"),
      nb::sig("def read_checkpoint_arrays(folder: str | os.PathLike[str]) -> tuple[Floats, Floats, float, int]"),
      "Positions, velocities, time [s] and number of the last whole frame of a run, in double precision.");
  m.def(
      "frame_file", [](const std::filesystem::path& folder, std::int64_t frame) { return frame_path(folder, frame); },
      nb::arg("folder"), nb::arg("frame"),
      nb::sig("def frame_file(folder: str | os.PathLike[str], frame: int) -> pathlib.Path"),
      "Where a frame of a run is stored.");
}

}  // namespace selvage::python
