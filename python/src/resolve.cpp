#include "selvage/untangling/resolve.h"

#include "bindings.h"

namespace selvage::python {

namespace {

const char* outcome_name(ResolveOutcome outcome) {
  switch (outcome) {
    case ResolveOutcome::kResolved:
      return "resolved";
    case ResolveOutcome::kStuck:
      return "stuck";
    case ResolveOutcome::kGaveUp:
      return "gave-up";
    default:
      return "held";
  }
}

nb::dict row_of(const ResolveIteration& row) {
  nb::dict result;
  result["iteration"] = row.iteration;
  result["triangle_pairs"] = row.triangle_pairs;
  result["penetrating_vertices"] = row.penetrating_vertices;
  result["penetrating_edges"] = row.penetrating_edges;
  result["penetrating_centroids"] = row.penetrating_centroids;
  result["blocked_points"] = row.blocked_points;
  result["waiting_points"] = row.waiting_points;
  result["inverted_elements"] = row.inverted_elements;
  result["deepest"] = row.deepest;
  result["total_depth"] = row.total_depth;
  result["awake_vertices"] = row.awake_vertices;
  result["max_displacement"] = row.max_displacement;
  return result;
}

}  // namespace

void bind_resolve(nb::module_& m) {
  m.def(
      "resolve_arrays",
      [](const PlacedTetMesh& mesh, nb::object rest, bool keep_pose, nb::object pinned, nb::object max_displacement,
         double clearance, int max_iterations, int patience, nb::object progress) {
        ResolveOptions options;
        options.rest_positions = rows_or_none<Vec3>(rest, "rest").copy();
        options.keep_pose = keep_pose;
        options.pinned = rows_or_none<Index>(pinned, "pinned").copy();
        if (!max_displacement.is_none()) options.max_displacement = nb::cast<double>(max_displacement);
        options.clearance = clearance;
        options.max_iterations = max_iterations;
        options.patience = patience;
        Watch watch;
        watch.begin();
        options.on_iteration = [&](const ResolveIteration& row) {
          watch();
          if (progress.is_none()) return;
          const nb::gil_scoped_acquire held;
          progress(row_of(row));
        };
        std::vector<Vec3> positions = mesh.positions.copy();
        const ResolveReport report =
            without_interpreter([&] { return resolve_collisions(mesh.topology, positions, options); });
        nb::list rows;
        for (const ResolveIteration& row : report.iterations) rows.append(row_of(row));
        nb::dict result;
        result["outcome"] = outcome_name(report.outcome);
        result["iterations"] = rows;
        result["tangled_elements"] = array_of(report.tangled_elements);
        result["holding_vertices"] = array_of(report.holding_vertices);
        result["moved_vertices"] = report.moved_vertices;
        result["max_displacement"] = report.max_displacement;
        result["mean_displacement"] = report.mean_displacement;
        result["volume_before"] = report.volume_before;
        result["volume_after"] = report.volume_after;
        result["volume_at_rest"] = report.volume_at_rest;
        result["elastic_energy_before"] = report.elastic_energy_before;
        result["elastic_energy_after"] = report.elastic_energy_after;
        return nb::make_tuple(array_of(positions), result);
      },
      nb::arg("mesh").none(), nb::kw_only(), nb::arg("rest").none() = nb::none(), nb::arg("keep_pose") = false,
      nb::arg("pinned").none() = nb::none(), nb::arg("max_displacement").none() = nb::none(),
      nb::arg("clearance") = 0.05, nb::arg("max_iterations") = 2000, nb::arg("patience") = 60,
      nb::arg("progress").none() = nb::none(),
      nb::sig("def resolve_arrays(mesh: TetMesh, *, rest: ArrayLike | None = None, keep_pose: bool = False, pinned: "
              "ArrayLike | None = None, "
              "max_displacement: float | None = None, clearance: float = 0.05, max_iterations: int = 2000, "
              "patience: int = 60, progress: Callable[[dict[str, Any]], object] | None = None) "
              "-> tuple[Floats, dict[str, Any]]"),
      "Positions without self-collision, and a report as a dict. See `selvage.resolve`.");
}

}  // namespace selvage::python
