#include "selvage/scene/run.h"

#include "core/timed.h"
#include "scene/fingerprint.h"
#include "scene/run_folder.h"
#include "selvage/boundary_path/boundary_path.h"
#include "selvage/core/error.h"
#include "selvage/self_collision/self_collision.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace selvage {

namespace {

/// Elements whose four vertices are held by two or more handles: until a release, only the handles move them.
class HeldElements {
 public:
  explicit HeldElements(const Scene& scene) : scene_(scene) {
    std::vector<Index> holder(scene.model.rest_positions.size(), kNone);
    for (std::size_t h = 0; h < scene.handles.size(); ++h)
      for (const Index v : scene.handles[h].vertices) holder[v] = static_cast<Index>(h);
    for (Index e = 0; e < scene.model.mesh.element_count(); ++e) {
      Held held{.element = e, .handles = {}, .until = 0};
      for (int i = 0; i < 4; ++i) held.handles[i] = holder[scene.model.mesh.elements()[e][i]];
      const auto [least, most] = std::minmax_element(held.handles.begin(), held.handles.end());
      if (*least == kNone || *least == *most) continue;
      held.until = release_of(held.handles[0]);
      for (const Index h : held.handles) held.until = std::min(held.until, release_of(h));
      held_.push_back(held);
    }
  }

  /// The first that is inverted, or kNone.
  Index find_inverted(const State& state) const {
    for (const Held& held : held_) {
      const auto& [a, b, c, d] = scene_.model.mesh.elements()[held.element];
      const Vec3 &p = state.positions[a], &q = state.positions[b], &r = state.positions[c], &s = state.positions[d];
      if (state.time < held.until && (q - p).cross(r - p).dot(s - p) < 0) return held.element;
    }
    return kNone;
  }

 private:
  struct Held {
    Index element;
    std::array<Index, 4> handles;
    double until;
  };
  double release_of(Index handle) const { return scene_.handles[static_cast<std::size_t>(handle)].release_time; }

  const Scene& scene_;
  std::vector<Held> held_;
};

void measure_motion(const Model& model, const State& state, FrameStatistics& row) {
  for (std::size_t v = 0; v < state.velocities.size(); ++v) {
    const double squared_speed = state.velocities[v].squaredNorm(), inverse_mass = model.inverse_masses[v];
    row.fastest = std::max(row.fastest, std::sqrt(squared_speed));
    if (inverse_mass > 0) row.kinetic_energy += 0.5 * squared_speed / inverse_mass;
  }
}

void measure_penetration(BoundaryPathFinder<3>& finder, const State& state, FrameStatistics& row) {
  finder.update(state.positions);
  row.inverted_elements = finder.defects().inverted_elements;
  const auto queries = finder.find_penetrating_vertices();
  Index last = kNone;
  for (const PathQuery<3>& query : queries) row.penetrating_vertices += std::exchange(last, query.source[0]) != last;
  for (const BoundaryPath<3>& path : finder.find_paths(queries))
    if (path.status == PathStatus::kFound) row.deepest_penetration = std::max(row.deepest_penetration, path.distance);
}

/// Part of an element's volume at rest up to which it is flat.
constexpr double kFlat = 1e-9;

double volume_of(const std::vector<Vec3>& positions, const VertexTuple<4>& element) {
  const Vec3& p = positions[element[0]];
  return (positions[element[1]] - p).cross(positions[element[2]] - p).dot(positions[element[3]] - p) / 6;
}

/// Part of a body's volume at rest up to which it has none.
constexpr double kNoVolume = 1e-3;

/// The first body without volume, or null.
const Body* find_body_without_volume(const Model& model, const State& state) {
  for (const Body& body : model.bodies) {
    double volume = 0, at_rest = 0;
    for (Index e = body.first_element; e < body.first_element + body.element_count; ++e) {
      volume += volume_of(state.positions, model.mesh.elements()[e]);
      at_rest += volume_of(model.rest_positions, model.mesh.elements()[e]);
    }
    if (volume <= kNoVolume * at_rest) return &body;
  }
  return nullptr;
}

void measure_volumes(const Model& model, const State& state, FrameStatistics& row) {
  for (const auto& element : model.mesh.elements())
    row.flat_elements +=
        std::abs(volume_of(state.positions, element)) <= kFlat * volume_of(model.rest_positions, element);
}

void measure_pairs(SelfCollisionFinder& finder, const State& state, FrameStatistics& row) {
  finder.update(state.positions);
  row.triangle_pairs = std::ranges::count(finder.find_pairs(), TriangleContact::kCrossing, &TrianglePair::contact);
}

void add_step(const StepStatistics& step, FrameStatistics& row) {
  const auto& contact = step.contact;
  row.vertex_paths += contact.contacts[static_cast<std::size_t>(ContactKind::kVertexPath)];
  row.edge_paths += contact.contacts[static_cast<std::size_t>(ContactKind::kEdgePath)];
  row.centroid_paths += contact.contacts[static_cast<std::size_t>(ContactKind::kCentroidPath)];
  row.vertex_faces += contact.contacts[static_cast<std::size_t>(ContactKind::kVertexFace)];
  row.edge_edges += contact.contacts[static_cast<std::size_t>(ContactKind::kEdgeEdge)];
  row.collider_contacts += step.collider_contacts;
  row.path_queries += contact.path_queries;
  row.blocked_paths += contact.blocked_paths;
  row.volumes += contact.paths.volumes_visited;
  row.traversals += contact.paths.traversals;
  row.path_elements += contact.paths.elements_visited;
  row.constraints += step.constraints;
  row.held_back_vertices += step.held_back_vertices;
  row.impacts_left += step.impacts_left;
  row.seconds_material += step.seconds_material;
  row.seconds_projection += step.seconds_projection;
  row.seconds_dcd += contact.seconds_refit + contact.seconds_split + contact.seconds_dcd;
  row.seconds_paths += contact.seconds_paths;
  row.seconds_ccd += contact.seconds_ccd;
  row.seconds_steps += step.seconds;
}

/// A scene and the solver that takes it from frame to frame.
class SceneSimulation {
 public:
  explicit SceneSimulation(const Scene& scene)
      : scene_(scene),
        finder_(scene.model.mesh, scene.initial_state.positions),
        surface_(boundary_surface(scene.model.mesh)),
        surface_finder_(surface_, scene.initial_state.positions),
        held_(scene) {}

  void measure(const State& state, std::int64_t frame, FrameStatistics& row) {
    row.frame = frame;
    row.time = state.time;
    row.steps = state.steps;
    measure_motion(scene_.model, state, row);
    measure_penetration(finder_, state, row);
    measure_volumes(scene_.model, state, row);
    measure_pairs(surface_finder_, state, row);
  }

  /// Takes the state to the end of the frame.
  FrameStatistics run_frame(State& state, std::int64_t frame) {
    XpbdSolver& solver = solver_of(frame);
    FrameStatistics row;
    timed(row.seconds_frame, [&] {
      for (int step = 0; step < scene_.substeps; ++step) {
        solver.step(state);
        add_step(solver.statistics(), row);
      }
      measure(state, frame, row);
    });
    return row;
  }

  Index find_inverted_held_element(const State& state) const { return held_.find_inverted(state); }

 private:
  XpbdSolver& solver_of(std::int64_t frame) {
    const bool contact = frame > scene_.contact_from_frame;
    if (!solver_ || contact != with_contact_) {
      XpbdOptions options = scene_.options;
      if (!contact) options.contact.mode = DetectionMode::kOff;
      solver_.reset();
      solver_.emplace(scene_.model, scene_.initial_state, scene_.handles, scene_.colliders, options);
      with_contact_ = contact;
    }
    return *solver_;
  }

  const Scene& scene_;
  BoundaryPathFinder<3> finder_;
  TriangleMesh surface_;
  SelfCollisionFinder surface_finder_;  // refitted from frame to frame
  HeldElements held_;
  std::optional<XpbdSolver> solver_;
  bool with_contact_ = false;
};

void stop(RunReport& report, RunOutcome outcome, std::int64_t frame, const std::string& what) {
  report.outcome = outcome;
  report.message = fmt::format("frame {}: {}", frame, what);
}

/// Runs one frame; false when the run ends with it.
bool advance(const Scene& scene, SceneSimulation& simulation, std::int64_t frame, State& state, RunReport& report) {
  try {
    report.frames.push_back(simulation.run_frame(state, frame));
  } catch (const SystemError&) {
    throw;
  } catch (const Error& error) {
    stop(report, RunOutcome::kExploded, frame, error.what());
    return false;
  }
  const Index inverted = simulation.find_inverted_held_element(state);
  const Body* empty = find_body_without_volume(scene.model, state);
  if (inverted == kNone && empty == nullptr) return true;
  report.frames.pop_back();
  if (inverted != kNone)
    stop(report, RunOutcome::kImpossibleHandles, frame,
         fmt::format("handles invert element {}, whose four vertices they hold", inverted));
  else
    stop(report, RunOutcome::kNoVolume, frame,
         fmt::format("body '{}' has no volume left; give it room, or take more substeps", empty->name));
  return false;
}

void store(const RunFolder& folder, const State& state, const FrameStatistics& row) {
  try {
    folder.store_frame(state, row);
  } catch (const SystemError& error) {
    throw SystemError(fmt::format("frame {}", row.frame), error.what());
  }
}

std::uint64_t fingerprint_of(const State& state) {
  Fingerprint print;
  print.add(std::span<const Vec3>(state.positions));
  print.add(std::span<const Vec3>(state.velocities));
  return print.value();
}

}  // namespace

RunReport run_scene(const Scene& scene, const RunOptions& options) {
  if (options.folder.empty()) throw Error("folder", "is not named", "name one for the files of the run");
  if (options.frames.value_or(0) < 0)
    throw Error("frames", fmt::format("are {}", *options.frames), "give a number that is not negative");
  const RunFolder folder(scene, options);
  RunReport report;
  State state = scene.initial_state;
  auto stopped = folder.find_stop();
  SceneSimulation simulation(scene);
  folder.begin();
  if (stopped) {
    state = std::move(stopped->state);
    report.frames = std::move(stopped->rows);
    report.first_frame = stopped->frame;
  } else {
    simulation.measure(state, 0, report.frames.emplace_back());
    store(folder, state, report.frames.back());
  }
  if (options.on_frame) options.on_frame(report.frames.back());
  const std::int64_t last = options.frames.value_or(scene.frames);
  for (std::int64_t frame = report.first_frame + 1; frame <= last; ++frame) {
    if (!advance(scene, simulation, frame, state, report)) break;
    store(folder, state, report.frames.back());
    if (options.on_frame) options.on_frame(report.frames.back());
  }
  // A frame that failed has moved on from the last whole one.
  report.fingerprint = fingerprint_of(report.outcome == RunOutcome::kFinished ? state : folder.find_stop()->state);
  folder.store_summary(summarize_run(scene, report));
  return report;
}

}  // namespace selvage
