#include "export/export_run.h"

#include "export/poses.h"
#include "scene/reading/stored_run.h"
#include "selvage/core/error.h"

namespace selvage {

namespace fs = std::filesystem;

std::vector<fs::path> files_of_export(const fs::path& path) {
  const fs::path extension = path.extension();
  if (extension == ".pc2") return {path, fs::path(path).replace_extension(".obj")};
  if (extension == ".glb" || extension == ".usda") return {path};
  throw Error(path.string(), "the extension names no format of runs", "use .pc2, .glb or .usda");
}

std::vector<ExportedFile> export_run(const fs::path& folder, const fs::path& path, std::int64_t every) {
  const std::vector<fs::path> files = files_of_export(path);
  const StoredRun run(folder);
  const ShownSurface surface(static_cast<std::size_t>(run.topology.header.vertices), run.topology.boundary_faces);
  ExportedPoses poses{run.name(), surface, run.frames(every), 60, {}};
  if (run.scene.is_object()) poses.frames_per_second = run.scene.value("frames_per_second", 60);
  poses.pose = [&](std::size_t i) {
    const std::vector<Vec3> all = run.read_frame_positions(poses.frames[i]);
    std::vector<Float3> shown;
    shown.reserve(surface.vertices.size());
    for (const Index v : surface.vertices) {
      const Vec3& p = all[static_cast<std::size_t>(v)];  // a float, widened
      shown.push_back({static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
    }
    return shown;
  };
  if (path.extension() == ".pc2") return {{files[0], print_pc2(poses)}, {files[1], print_pc2_mesh(poses)}};
  if (path.extension() == ".glb") return {{files[0], print_glb(poses)}};
  return {{files[0], print_usda(poses)}};
}

}  // namespace selvage
