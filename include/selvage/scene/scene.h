#pragma once

#include "selvage/simulation/newton.h"
#include "selvage/simulation/vbd.h"
#include "selvage/simulation/xpbd.h"

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace selvage {

/// The solver of a scene.
enum class SolverKind : std::uint8_t { kXpbd, kNewton, kVbd };

/// A scene ready to run: the contents of its file, with all meshes read or made.
struct Scene {
  std::string name;   ///< of the file, without folder and extension
  std::string scale;  ///< empty: as the file stands
  Model model;
  State initial_state;
  std::vector<Handle> handles;
  std::vector<Collider> colliders;
  SolverKind solver = SolverKind::kXpbd;
  XpbdOptions options;         ///< those of a step hold for all solvers, iterations for xpbd and vbd
  NewtonOptions newton;        ///< but for those of a step
  double vbd_residual = 0;     ///< see VbdOptions
  int frames = 60;             ///< to run, if nothing else is asked for
  int frames_per_second = 60;  ///< each of `substeps` steps
  int substeps = 5;
  /// Whether run_scene() takes steps in halves and quarters while bodies are pressed thin: where xpbd chooses substeps.
  bool may_halve_steps = false;
  /// Whether run_scene() brings bodies that are far inside themselves out before frame 1 (docs/guides/simulate.md).
  bool resolves_tangled_start = true;
  std::int64_t contact_from_frame = 0;  ///< until then bodies pass through themselves and one another
  /// Of all that decides a run: two scenes with the same fingerprint run alike.
  std::uint64_t fingerprint = 0;
};

/// Reads a scene file (docs/guides/scene_files.md) and the meshes that it names, relative to its folder.
///
/// @param path   of the file
/// @param scale  name of a scale that the scene has; empty: as the file stands
/// @param changes  values in place of the file's, after those of the scale, in this order: each a JSON pointer and a
///                 value in JSON, or else a text, as in `/bodies/0/mesh/length=3`
/// @throws Error  one line: file, path within (as in bodies[2].material.poisson_ratio), what is wrong, what is allowed;
///                of a change whose place cannot be in a scene, the change
Scene read_scene(const std::filesystem::path& path, std::string_view scale = {},
                 std::span<const std::string> changes = {});

/// The same for a text that is not in a file; `path` stands for it in errors and where meshes are looked for.
Scene parse_scene(std::string_view text, const std::filesystem::path& path, std::string_view scale = {},
                  std::span<const std::string> changes = {});

}  // namespace selvage
