#include "picture/shown_result.h"

#include "scene/reading/shown_surface.h"
#include "scene/reading/stored_colliders.h"
#include "scene/reading/stored_result.h"
#include "scene/reading/stored_run.h"
#include "selvage/core/error.h"

#include <algorithm>
#include <memory>

namespace selvage {

namespace {

bool lies_in_plane(std::span<const Vec3> positions) {
  return std::all_of(positions.begin(), positions.end(), [](const Vec3& p) { return p[2] == 0; });
}

ShownResult show_poses(std::vector<Vec3> positions, std::vector<VertexTuple<3>> triangles, const std::string& file,
                       std::optional<std::vector<Vec3>> end = {}) {
  if (triangles.empty()) throw Error(file, "has no triangle to draw", "give a mesh of triangles or tetrahedra");
  ShownResult shown;
  shown.scene.vertex_count = positions.size();
  shown.scene.surface = std::move(triangles);
  shown.scene.number_pieces();
  if (lies_in_plane(positions)) {
    shown.scene.ground = false;
    shown.towards = Vec3::UnitZ();
  }
  shown.usual_frames = {0};
  shown.time = [](std::int64_t) { return 0.0; };
  if (end) {
    shown.last_frame = kBlendFrames;
    shown.usual_frames = {0, kBlendFrames};
    shown.read_positions = [a = std::move(positions), b = std::move(*end)](std::int64_t frame) {
      if (frame == 0 || frame == kBlendFrames) return frame == 0 ? a : b;
      const double t = static_cast<double>(frame) / kBlendFrames;
      std::vector<Vec3> blend(a.size());
      for (std::size_t v = 0; v < a.size(); ++v) blend[v] = (1 - t) * a[v] + t * b[v];
      return blend;
    };
  } else {
    shown.read_positions = [a = std::move(positions)](std::int64_t) { return a; };
  }
  return shown;
}

}  // namespace

ShownResult show_run(const std::filesystem::path& folder) {
  const auto run = std::make_shared<const StoredRun>(folder);
  ShownResult shown;
  shown.run = run;
  shown.scene.vertex_count = static_cast<std::size_t>(run->topology.header.vertices);
  shown.scene.surface = run->topology.boundary_faces;
  shown.scene.bodies = run->topology.vertex_bodies;
  if (std::any_of(shown.scene.bodies.begin(), shown.scene.bodies.end(), [](Index body) { return body < 0; }))
    throw Error(topology_path(folder).string(), "has a vertex of no body", "run the scene anew");
  const std::string file = scene_path(folder).string();
  shown.scene.colliders = read_stored_colliders(run->scene, file);
  const Vec3 gravity = read_stored_gravity(run->scene, file);
  if (gravity.norm() > 0) shown.scene.up = -gravity.normalized();
  shown.scene.ground = gravity.norm() > 0;
  shown.last_frame = run->last_frame;
  shown.usual_frames = {run->last_frame};
  if (run->rows.size() > 1 && run->rows[1].time > 0) shown.frames_per_second = std::round(1 / run->rows[1].time);
  shown.read_positions = [run](std::int64_t frame) { return run->read_frame_positions(frame); };
  shown.time = [run](std::int64_t frame) { return run->rows[static_cast<std::size_t>(frame)].time; };
  return shown;
}

ShownResult show_mesh(const std::filesystem::path& path) {
  IndexedMesh mesh = read_mesh(path);
  auto triangles = surface_triangles(mesh);
  return show_poses(std::move(mesh.positions), std::move(triangles), path.string());
}

ShownResult show_result(const std::filesystem::path& path, const std::filesystem::path& after) {
  StoredResult result(path, after);
  Marks marks;
  if (result.kind() != "resolve") marks = result.find_marks();
  ShownResult shown =
      show_poses(std::move(result.mesh.positions), result.triangles, path.string(), std::move(result.end_pose));
  if (result.kind() == "paths") {
    shown.paths.emplace();
    shown.vertex_depth.assign(shown.scene.vertex_count, -1);
    for (const MarkedPath& path_out : marks.paths) {
      if (path_out.depth >= 0) shown.paths->push_back({path_out.from, path_out.to, path_out.depth});
      if (path_out.vertex == kNone) continue;
      double& depth = shown.vertex_depth[static_cast<std::size_t>(path_out.vertex)];
      depth = std::max({depth, path_out.depth, 0.0});
    }
    return shown;
  }
  for (const MarkedPair& pair : marks.pairs)
    shown.scene.marked.insert(shown.scene.marked.end(), pair.triangles.begin(), pair.triangles.end());
  std::sort(shown.scene.marked.begin(), shown.scene.marked.end());
  shown.scene.marked.erase(std::unique(shown.scene.marked.begin(), shown.scene.marked.end()), shown.scene.marked.end());
  return shown;
}

}  // namespace selvage
