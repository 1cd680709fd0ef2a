#pragma once

#include "selvage/scene/scene.h"
#include "selvage/simulation/crossings.h"
#include "selvage/untangling/resolve.h"

#include <functional>
#include <optional>

namespace selvage {

/// Statistics of one frame: counts summed over its steps, and measurements at its end.
struct FrameStatistics {
  std::int64_t frame = 0;
  double time = 0;         ///< at its end [s]
  std::int64_t steps = 0;  ///< done since the beginning

  // Contacts by kind (ContactKind), and with colliders.
  std::int64_t vertex_paths = 0, edge_paths = 0, centroid_paths = 0, vertex_faces = 0, edge_edges = 0;
  std::int64_t collider_contacts = 0;
  std::int64_t path_queries = 0, blocked_paths = 0;  ///< points asked for their way out, and those without one
  std::int64_t held_back_vertices = 0;               ///< see StepStatistics, over all steps
  std::int64_t impacts_met = 0, impacts_left = 0;    ///< likewise
  std::int64_t unguarded_vertices = 0;               ///< likewise, the most of all steps
  /// Taken in two of half their length: Scene::may_halve_steps, or to guarantee them; halves that are halved count too.
  std::int64_t halved_steps = 0;
  /// Brought out of themselves before the frame, which is the first: Scene::resolves_tangled_start.
  std::int64_t resolved_bodies = 0;
  std::int64_t sleeping_bodies = 0;    ///< in the last step: StepOptions::sleep_speed
  std::int64_t constraints = 0;        ///< of the material, over all iterations
  std::int64_t newton_steps = 0;       ///< of the implicit solvers: see StepStatistics
  std::int64_t linear_iterations = 0;  ///< likewise
  double residual = 0;                 ///< likewise, the largest of all steps [m]

  // At the end of the frame.
  std::int64_t penetrating_vertices = 0;  ///< boundary vertices inside an element that is not theirs
  double deepest_penetration = 0;         ///< longest shortest path to the boundary of one of them [m]
  std::int64_t penetrating_edges = 0;     ///< boundary edges that run through an element without a vertex of theirs
  double deepest_edge = 0;                ///< likewise of a point between their ends [m]
  std::int64_t triangle_pairs = 0;        ///< triangles of the boundary that cross and share no vertex, by exact tests
  // Sums and largest of ColliderCrossings over all colliders.
  std::int64_t vertices_in_colliders = 0, collider_points = 0;
  double deepest_in_colliders = 0, deepest_collider_point = 0;
  std::int64_t inverted_elements = 0;
  std::int64_t flat_elements = 0;  ///< volume of either sign of at most 1e-9 of that at rest
  // Measured by the materials alone, alike for all solvers [J].
  double kinetic_energy = 0;
  double elastic_energy = 0;  ///< of elements, springs and cloth; 0 at rest
  double gravity_energy = 0;  ///< 0 where all masses are in the origin
  double objective = 0;       ///< NewtonSolver::objective(), VbdSolver::objective() of the last step [J]
  double fastest = 0;         ///< speed of the fastest vertex [m/s]

  // Costs. They are no part of the result: a run that was continued has other hierarchies than one that never stopped,
  // and visits other nodes.
  std::int64_t volumes = 0, traversals = 0, path_elements = 0;  ///< of shortest paths (SPB table 1)
  // Time spent [s]: bringing bodies out of themselves before the frame; material solve; projections and friction; DCD
  // at the start and end of steps with the refits that it needs; shortest paths; CCD; all steps; steps and measurement.
  double seconds_start = 0, seconds_material = 0, seconds_projection = 0, seconds_dcd = 0, seconds_paths = 0,
         seconds_ccd = 0;
  double seconds_steps = 0, seconds_frame = 0;
};

/// Bodies in one another and in colliders at the end of a frame.
struct Crossings {
  BodyCrossings bodies;
  std::vector<ColliderCrossings> colliders;  ///< one a collider of the scene

  /// Whether bodies stand in one another or in a collider: triangles cross, or vertices or points are inside.
  bool any() const;
};

/// A step that has been done, while its frame goes on.
struct StepProgress {
  std::int64_t frame;  ///< the step's
  int step;            ///< done of the frame
  int steps;           ///< of a frame
  /// What most of the step's time went to.
  enum class Phase : std::uint8_t { kMaterial, kFindingContacts, kProjection, kHoldingBack } phase;
};

/// Before an iteration that brings a body out of itself: Scene::resolves_tangled_start.
struct StartProgress {
  Index body;
  const ResolveIteration& iteration;
};

enum class SurfaceFormat : std::uint8_t { kNoSurface, kPly, kObj };

/// Options of a run, and files to write besides frames, statistics and checkpoints.
struct RunOptions {
  std::filesystem::path folder;                       ///< made if it is not there
  std::optional<std::int64_t> frames{};               ///< instead of the scene's
  bool resume = false;                                ///< continue the run that the folder holds; without one, begin
  bool vtu = false;                                   ///< vtu/frame_000000.vtu and frames.pvd
  SurfaceFormat surface = SurfaceFormat::kNoSurface;  ///< surface/frame_000000.ply
  std::int64_t check_every = 0;                       ///< checks/frame_000000.json after so many frames; 0: never
  /// Called after each frame, and once with the frame that the run begins or continues from.
  std::function<void(const FrameStatistics&)> on_frame{};
  /// Called after each step, before each iteration that brings a body out of itself, and after each check of a frame.
  /// What one of these functions throws ends the run and leaves run_scene(); the folder then is that of a run that was
  /// killed, and `resume` continues it.
  std::function<void(const StepProgress&)> on_step{};
  std::function<void(const StartProgress&)> on_start{};
  std::function<void(std::int64_t frame, const Crossings&)> on_check{};
};

/// How a run ended.
enum class RunOutcome : std::uint8_t {
  kFinished,
  kExploded,           ///< a position stopped being finite
  kImpossibleHandles,  ///< handles inverted an element whose four vertices they hold
  kNoVolume,           ///< at the end of a frame a body had at most 1/1000 of its volume at rest
  kPinched,            ///< a step could not be guaranteed: PinchError
};

struct RunReport {
  RunOutcome outcome = RunOutcome::kFinished;
  std::string message;                  ///< unless finished: the frame, and why the run stopped there
  std::int64_t first_frame = 0;         ///< that this call began or continued from
  std::vector<FrameStatistics> frames;  ///< from frame 0 on, those of earlier calls too
  std::uint64_t fingerprint = 0;        ///< of every bit of the positions and velocities after the last frame
  Crossings crossings;                  ///< at the end of the last frame
};

/// Runs a scene and writes its files (docs/guides/run_files.md) to a folder.
///
/// A run that is killed at any moment is continued with `resume` from its last whole frame, and every file ends bit for
/// bit as if it had never stopped, but for what the statistics say of its cost; files of frames are whole or not there.
///
/// @throws Error        before anything is written: no folder is named, or frames are negative; the folder holds a run
///                      and `resume` is false, or the run of another scene; another process writes to it; a file in it
///                      is damaged
/// @throws SystemError  when a file cannot be written; it names the frame, and all frames before stay as they are
RunReport run_scene(const Scene& scene, const RunOptions& options);

/// Counts, averages per step, shares of time and the last frame's figures as JSON, as in summary.json.
std::string summarize_run(const Scene& scene, const RunReport& report);

/// The frame at whose end bodies penetrated nowhere, and since when nothing has met, in a run with
/// ContactOptions::guarantee; nothing where bodies still penetrated in the last frame's steps, or there was no step.
std::optional<std::int64_t> guaranteed_from(std::span<const FrameStatistics> frames);

/// Crossings of a frame as JSON, as in checks/frame_000000.json and in summary.json under `at_end`.
std::string describe_crossings(const Scene& scene, std::int64_t frame, const Crossings& crossings);

}  // namespace selvage
