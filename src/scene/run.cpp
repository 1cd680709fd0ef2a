#include "selvage/scene/run.h"

#include "core/timed.h"
#include "scene/default_substeps.h"
#include "scene/fingerprint.h"
#include "scene/frame_measures.h"
#include "scene/guarded_steps.h"
#include "scene/run_folder.h"
#include "scene/start/tangled_start.h"
#include "selvage/core/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
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
  row.impacts_met += step.impacts_met;
  row.impacts_left += step.impacts_left;
  row.unguarded_vertices = std::max(row.unguarded_vertices, step.unguarded_vertices);
  row.sleeping_bodies = step.sleeping_bodies;
  row.newton_steps += step.newton_steps;
  row.linear_iterations += step.linear_iterations;
  row.residual = std::max(row.residual, step.residual);
  row.seconds_material += step.seconds_material;
  row.seconds_projection += step.seconds_projection;
  row.seconds_dcd += contact.seconds_refit + contact.seconds_split + contact.seconds_dcd;
  row.seconds_paths += contact.seconds_paths;
  row.seconds_ccd += contact.seconds_ccd;
  row.seconds_steps += step.seconds;
}

StepProgress::Phase longest_phase(const StepStatistics& step) {
  using enum StepProgress::Phase;
  const auto& contact = step.contact;
  // The search of holding back is in the seconds of contacts too.
  const double finding = contact.seconds_refit + contact.seconds_split + contact.seconds_dcd + contact.seconds_paths +
                         contact.seconds_ccd - step.seconds_hold_back;
  const std::array<std::pair<double, StepProgress::Phase>, 4> phases{{{step.seconds_material, kMaterial},
                                                                      {finding, kFindingContacts},
                                                                      {step.seconds_projection, kProjection},
                                                                      {step.seconds_hold_back, kHoldingBack}}};
  return std::ranges::max_element(phases)->second;
}

/// A scene and what takes it from frame to frame.
class SceneSimulation {
 public:
  SceneSimulation(const Scene& scene, const RunOptions& options)
      : scene_(scene), options_(options), measures_(scene), held_(scene) {}

  /// Takes the state to the end of the frame.
  /// @param rows  of all frames before
  FrameStatistics run_frame(State& state, std::int64_t frame, std::span<const FrameStatistics> rows) {
    GuardedSteps& steps = steps_of(frame);
    const int halvings = default_halvings(scene_, state, rows);
    FrameStatistics row;
    if (frame == 1) resolve_start(state, rows.front(), row);
    timed(row.seconds_frame, [&] {
      for (int step = 0; step < scene_.substeps; ++step)
        row.halved_steps += steps.step(state, halvings, [&](const SceneSolver& solver) {
          add_step(solver.statistics(), row);
          row.objective = solver.objective();
          if (options_.on_step)
            options_.on_step({frame, step + 1, scene_.substeps, longest_phase(solver.statistics())});
        });
      measures_.measure(state, frame, row);
    });
    return row;
  }

  FrameMeasures& measures() { return measures_; }
  Index find_inverted_held_element(const State& state) const { return held_.find_inverted(state); }

 private:
  void resolve_start(State& state, const FrameStatistics& start, FrameStatistics& row) {
    if (!scene_.resolves_tangled_start || scene_.contact_from_frame > 0 || start.penetrating_vertices == 0 ||
        scene_.options.contact.mode == DetectionMode::kOff)
      return;
    timed(row.seconds_start, [&] {
      // A run that is continued has measured nothing yet.
      FrameStatistics again;
      measures_.measure(state, 0, again);
      row.resolved_bodies = resolve_tangled_start(scene_, measures_.crossings().bodies, state, options_.on_start);
    });
  }
  GuardedSteps& steps_of(std::int64_t frame) {
    const bool contact = frame > scene_.contact_from_frame;
    if (!steps_ || contact != with_contact_) {
      steps_.reset();
      steps_.emplace(scene_, contact);
      with_contact_ = contact;
    }
    return *steps_;
  }

  const Scene& scene_;
  const RunOptions& options_;
  FrameMeasures measures_;
  HeldElements held_;
  std::optional<GuardedSteps> steps_;
  bool with_contact_ = false;
};

void stop(RunReport& report, RunOutcome outcome, std::int64_t frame, const std::string& what) {
  report.outcome = outcome;
  report.message = fmt::format("frame {}: {}", frame, what);
}

/// Runs one frame; false when the run ends with it.
bool advance(SceneSimulation& simulation, std::int64_t frame, State& state, RunReport& report) {
  try {
    report.frames.push_back(simulation.run_frame(state, frame, report.frames));
  } catch (const SystemError&) {
    throw;
  } catch (const PinchError& error) {
    stop(report, RunOutcome::kPinched, frame, error.what());
    return false;
  } catch (const Error& error) {
    stop(report, RunOutcome::kExploded, frame, error.what());
    return false;
  }
  const Index inverted = simulation.find_inverted_held_element(state);
  const Body* empty = simulation.measures().find_body_without_volume();
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

/// Checks come before the frame is stored: a run that is continued never lacks one.
void store(const RunFolder& folder, const RunOptions& options, const Scene& scene, const State& state,
           const FrameStatistics& row, FrameMeasures& measures) {
  try {
    const bool is_checked = options.check_every > 0 && row.frame % options.check_every == 0;
    if (is_checked) folder.store_check(row.frame, describe_crossings(scene, row.frame, measures.crossings()));
    folder.store_frame(state, measures.stored_positions(state), row);
    if (is_checked && options.on_check) options.on_check(row.frame, measures.crossings());
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
  SceneSimulation simulation(scene, options);
  folder.begin();
  if (stopped) {
    state = std::move(stopped->state);
    report.frames = std::move(stopped->rows);
    report.first_frame = stopped->frame;
  } else {
    simulation.measures().measure(state, 0, report.frames.emplace_back());
    store(folder, options, scene, state, report.frames.back(), simulation.measures());
  }
  if (options.on_frame) options.on_frame(report.frames.back());
  const std::int64_t last = options.frames.value_or(scene.frames);
  for (std::int64_t frame = report.first_frame + 1; frame <= last; ++frame) {
    if (!advance(simulation, frame, state, report)) break;
    store(folder, options, scene, state, report.frames.back(), simulation.measures());
    if (options.on_frame) options.on_frame(report.frames.back());
  }
  // A frame that failed has moved on from the last whole one.
  if (report.outcome != RunOutcome::kFinished) state = std::move(folder.find_stop()->state);
  report.fingerprint = fingerprint_of(state);
  FrameStatistics again;
  simulation.measures().measure(state, report.frames.back().frame, again);
  report.crossings = simulation.measures().crossings();
  folder.store_summary(summarize_run(scene, report));
  return report;
}

}  // namespace selvage
