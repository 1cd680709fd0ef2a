#include "core/json.h"
#include "selvage/scene/run.h"

#include <fmt/format.h>

#include <algorithm>

namespace selvage {

namespace {

using Row = FrameStatistics;

/// Sums over all frames.
struct Totals {
  explicit Totals(const std::vector<Row>& rows) {
    for (const Row& row : rows) {
      ccd += row.vertex_faces + row.edge_edges;
      dcd += row.vertex_paths + row.edge_paths + row.centroid_paths;
      colliders += row.collider_contacts;
      queries += row.path_queries;
      volumes += row.volumes;
      traversals += row.traversals;
      elements += row.path_elements;
      material += row.seconds_material + row.seconds_projection;
      detect += row.seconds_dcd;
      paths += row.seconds_paths;
      continuous += row.seconds_ccd;
      steps += row.seconds_steps;
      frames += row.seconds_frame;
      longest = std::max(longest, row.seconds_frame);
    }
  }
  std::int64_t ccd = 0, dcd = 0, colliders = 0, queries = 0, volumes = 0, traversals = 0, elements = 0;
  double material = 0, detect = 0, paths = 0, continuous = 0, steps = 0, frames = 0, longest = 0;
};

const char* name_of(SolverKind solver) {
  if (solver == SolverKind::kXpbd) return "xpbd";
  return solver == SolverKind::kNewton ? "newton" : "vbd";
}

double ratio(double part, double whole) {
  return whole > 0 ? part / whole : 0;
}

const char* name_of(RunOutcome outcome) {
  switch (outcome) {
    case RunOutcome::kFinished:
      return "finished";
    case RunOutcome::kExploded:
      return "exploded";
    case RunOutcome::kNoVolume:
      return "no volume";
    case RunOutcome::kPinched:
      return "pinched";
    default:
      return "impossible handles";
  }
}

Json averages_per_step(const Totals& totals, double steps) {
  const auto mean = [&](std::int64_t count) { return ratio(static_cast<double>(count), steps); };
  return {{"ccd_contacts", mean(totals.ccd)},
          {"dcd_contacts", mean(totals.dcd)},
          {"collider_contacts", mean(totals.colliders)},
          {"path_queries", mean(totals.queries)},
          {"volumes", mean(totals.volumes)},
          {"traversals", mean(totals.traversals)},
          {"elements", mean(totals.elements)}};
}

Json averages_per_path(const Totals& totals) {
  const auto mean = [&](std::int64_t count) {
    return ratio(static_cast<double>(count), static_cast<double>(totals.queries));
  };
  return {
      {"volumes", mean(totals.volumes)}, {"traversals", mean(totals.traversals)}, {"elements", mean(totals.elements)}};
}

/// Since when nothing can have met, and what that took.
Json guarantee_of(const std::vector<Row>& rows) {
  Json json{{"from_frame", nullptr}};
  if (const auto from = guaranteed_from(rows)) json["from_frame"] = *from;
  std::int64_t held_back = 0, met = 0;
  for (const Row& row : rows) held_back += row.held_back_vertices, met += row.impacts_met;
  json["impacts_met"] = met;
  json["held_back_vertices"] = held_back;
  return json;
}

std::string digits(std::uint64_t fingerprint) {
  return fmt::format("{:016x}", fingerprint);
}

Json state_at_start(const std::vector<Row>& rows) {
  Json json{{"penetrating_vertices", rows.front().penetrating_vertices},
            {"deepest_penetration", rows.front().deepest_penetration}};
  json["resolved_bodies"] = rows.size() > 1 ? rows[1].resolved_bodies : 0;
  return json;
}

/// Pairs of bodies that cross, and colliders that do.
void add_crossings(const Scene& scene, const Crossings& crossings, Json& json) {
  json["body_pairs"] = Json::array();
  for (const BodyPairCrossings& pair : crossings.bodies.pairs)
    json["body_pairs"].push_back({{"bodies",
                                   {scene.model.bodies[static_cast<std::size_t>(pair.first)].name,
                                    scene.model.bodies[static_cast<std::size_t>(pair.second)].name}},
                                  {"triangle_pairs", pair.triangle_pairs},
                                  {"vertices", pair.vertices},
                                  {"deepest_vertex", pair.deepest_vertex},
                                  {"edges", pair.edges},
                                  {"deepest_edge", pair.deepest_edge}});
  json["colliders"] = Json::array();
  for (std::size_t c = 0; c < crossings.colliders.size(); ++c)
    if (const ColliderCrossings& collider = crossings.colliders[c]; collider.any())
      json["colliders"].push_back({{"collider", c},
                                   {"vertices", collider.vertices},
                                   {"deepest_vertex", collider.deepest_vertex},
                                   {"points", collider.points},
                                   {"deepest_point", collider.deepest_point}});
}

Json state_at_end(const Scene& scene, const RunReport& report) {
  const Row& last = report.frames.back();
  Json json{{"fingerprint", digits(report.fingerprint)},
            {"penetrating_vertices", last.penetrating_vertices},
            {"deepest_penetration", last.deepest_penetration},
            {"penetrating_edges", last.penetrating_edges},
            {"deepest_edge", last.deepest_edge},
            {"triangle_pairs", last.triangle_pairs},
            {"inverted_elements", last.inverted_elements},
            {"flat_elements", last.flat_elements},
            {"kinetic_energy", last.kinetic_energy},
            {"elastic_energy", last.elastic_energy},
            {"gravity_energy", last.gravity_energy},
            {"fastest", last.fastest}};
  add_crossings(scene, report.crossings, json);
  return json;
}

}  // namespace

std::string summarize_run(const Scene& scene, const RunReport& report) {
  const Totals totals(report.frames);
  const Row& last = report.frames.back();
  Json json{{"schema", 1}, {"kind", "simulation"}, {"scene", scene.name}, {"scale", scene.scale}};
  json["scene_fingerprint"] = digits(scene.fingerprint);
  json["outcome"] = name_of(report.outcome);
  if (!report.message.empty()) json["message"] = report.message;
  json["bodies"] = scene.model.bodies.size();
  json["vertices"] = scene.model.mesh.vertex_count();
  json["elements"] = scene.model.mesh.element_count();
  if (!scene.model.triangles.empty()) json["cloth_triangles"] = scene.model.triangles.size();
  json["frames"] = last.frame;
  json["frames_per_second"] = scene.frames_per_second;
  json["steps"] = last.steps;
  json["time_step"] = scene.options.time_step;
  json["solver"] = name_of(scene.solver);
  json["iterations"] = scene.options.iterations;
  json["average_per_step"] = averages_per_step(totals, static_cast<double>(last.steps));
  json["average_per_path"] = averages_per_path(totals);
  if (scene.options.contact.guarantee) json["guarantee"] = guarantee_of(report.frames);
  json["at_start"] = state_at_start(report.frames);
  json["at_end"] = state_at_end(scene, report);
  json["frame_seconds"] = {{"average", ratio(totals.frames, static_cast<double>(last.frame))},
                           {"longest", totals.longest}};
  json["shares"] = {{"material", ratio(totals.material, totals.steps)},
                    {"ccd", ratio(totals.continuous, totals.steps)},
                    {"dcd", ratio(totals.detect, totals.steps)},
                    {"paths", ratio(totals.paths, totals.steps)}};
  json["seconds"] = {{"steps", totals.steps}, {"frames", totals.frames}};
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::optional<std::int64_t> guaranteed_from(std::span<const FrameStatistics> frames) {
  auto from = static_cast<std::int64_t>(frames.size()) - 1;
  while (from > 0 && frames[static_cast<std::size_t>(from)].unguarded_vertices == 0) --from;
  if (from + 1 == std::ssize(frames)) return std::nullopt;
  return frames[static_cast<std::size_t>(from)].frame;
}

std::string describe_crossings(const Scene& scene, std::int64_t frame, const Crossings& crossings) {
  Json json{{"schema", 1}, {"kind", "check"}, {"frame", frame}, {"crosses", crossings.any()}};
  add_crossings(scene, crossings, json);
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace selvage
