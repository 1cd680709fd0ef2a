#pragma once

#include "picture/paths_picture.h"
#include "picture/scene_picture.h"
#include "scene/reading/stored_run.h"

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

namespace selvage {

/// A run, a mesh or a result as poses that are drawn one by one.
struct ShownResult {
  DrawnScene scene;
  std::int64_t last_frame = 0;  ///< poses are numbered from 0
  double frames_per_second = 30;
  std::vector<std::int64_t> usual_frames{};  ///< of a still picture, unless others are asked for
  std::shared_ptr<const StoredRun> run{};    ///< null: no run
  std::function<std::vector<Vec3>(std::int64_t frame)> read_positions{};
  std::function<double(std::int64_t frame)> time{};  ///< [s]
  std::optional<Vec3> towards{};                     ///< direction to the eye that suits it; none: the usual one

  /// Of `paths`: way out of each point, and the depth of each vertex [m], below 0 where it is not inside.
  std::optional<std::vector<DrawnPath>> paths{};
  std::vector<double> vertex_depth{};
};

/// A run's folder, up to its last whole frame.
/// @throws Error  when the folder holds no run, or a file in it is missing or damaged
ShownResult show_run(const std::filesystem::path& folder);

/// A mesh as it stands: a surface, or the boundary of tetrahedra.
/// @throws Error  as read_mesh(), or when it has no triangle
ShownResult show_mesh(const std::filesystem::path& path);

/// The JSON that `check`, `paths` or `resolve` wrote. Pairs that collide are marked; a mesh with an end pose (of `check
/// --to`, of `resolve`) has kBlendFrames + 1 poses, from the one to the other.
/// @param after  mesh that `resolve` wrote; empty: the one that the result names
/// @throws Error  as StoredResult
ShownResult show_result(const std::filesystem::path& path, const std::filesystem::path& after = {});

inline constexpr std::int64_t kBlendFrames = 30;

}  // namespace selvage
