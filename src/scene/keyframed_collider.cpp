#include "scene/keyframed_collider.h"

#include "selvage/core/error.h"
#include "selvage/io/mesh_file.h"
#include "selvage/io/point_cache.h"
#include "simulation/colliders/prepared_collider.h"

#include <fmt/format.h>

#include <algorithm>

namespace selvage {

namespace {

namespace fs = std::filesystem;

/// A surface, or the boundary of a solid.
IndexedMesh read_surface(const fs::path& path) {
  IndexedMesh mesh = read_mesh(path);
  if (!mesh.tetrahedra.empty()) {
    const TetMesh solid(static_cast<Index>(mesh.positions.size()), mesh.tetrahedra);
    mesh.triangles.assign(solid.boundary_faces().begin(), solid.boundary_faces().end());
  }
  return mesh;
}

/// The files that a name with a star stands for, in the order of their names: those with fewer digits first.
std::vector<fs::path> files_like(const fs::path& pattern) {
  const std::string name = pattern.filename().string();
  const std::size_t star = name.find('*');
  if (star == std::string::npos) return {pattern};
  const std::string_view head = std::string_view(name).substr(0, star), tail = std::string_view(name).substr(star + 1);
  std::vector<fs::path> files;
  std::error_code error;
  const fs::path folder = pattern.has_parent_path() ? pattern.parent_path() : fs::path(".");
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string other = entry.path().filename().string();
    if (other.size() >= head.size() + tail.size() && other.starts_with(head) && other.ends_with(tail))
      files.push_back(entry.path());
  }
  if (files.empty()) throw Error(pattern.string(), "no file has such a name", "name files that exist");
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    const std::string first = a.string(), second = b.string();
    return std::pair(first.size(), first) < std::pair(second.size(), second);
  });
  return files;
}

void read_files(const KeyframeSource& source, double rate, KeyframedShape& shape) {
  std::vector<fs::path> files;
  for (const fs::path& file : source.files) {
    const std::vector<fs::path> like = files_like(file);
    files.insert(files.end(), like.begin(), like.end());
  }
  for (std::size_t i = 0; i < files.size(); ++i) {
    IndexedMesh mesh = read_surface(files[i]);
    if (i == 0) shape.triangles = mesh.triangles;
    if (i > 0 && mesh.positions.size() != shape.positions[0].size())
      throw Error(
          files[i].string(),
          fmt::format("has {} vertices, the first key frame {}", mesh.positions.size(), shape.positions[0].size()),
          "give the same surface in every key frame");
    if (mesh.triangles != shape.triangles)
      throw Error(files[i].string(), "has other triangles than the first key frame",
                  "give the same surface in every key frame");
    shape.positions.push_back(std::move(mesh.positions));
    shape.times.push_back(source.start + static_cast<double>(i) / rate);
  }
}

void read_cache(const KeyframeSource& source, double rate, KeyframedShape& shape) {
  IndexedMesh mesh = read_surface(source.mesh);
  PointCache cache = read_point_cache(source.cache);
  if (cache.samples[0].size() != mesh.positions.size())
    throw Error(source.cache.string(),
                fmt::format("moves {} vertices, but {} has {}", cache.samples[0].size(), source.mesh.string(),
                            mesh.positions.size()),
                "give the mesh that it was made of");
  shape.triangles = std::move(mesh.triangles);
  for (std::size_t i = 0; i < cache.samples.size(); ++i)
    shape.times.push_back(source.start + (cache.first_frame + static_cast<double>(i) * cache.frames_per_sample) / rate);
  shape.positions = std::move(cache.samples);
}

}  // namespace

KeyframedShape read_keyframed_shape(const KeyframeSource& source, const Placement& place, double frames_per_second) {
  const double rate = source.frames_per_second > 0 ? source.frames_per_second : frames_per_second;
  KeyframedShape shape;
  try {
    if (source.files.empty()) {
      read_cache(source, rate, shape);
    } else {
      read_files(source, rate, shape);
    }
    if (!source.times.empty() && source.times.size() != shape.positions.size())
      throw Error("times", fmt::format("has {} numbers for {} key frames", source.times.size(), shape.positions.size()),
                  "give one for each");
    if (!source.times.empty()) shape.times = source.times;
    for (auto& positions : shape.positions)
      for (Vec3& p : positions) p = place.apply(p);
    const MeshCollider first("surface", {shape.positions.front(), shape.triangles});
    const SurfaceMotion motion("surface", shape, first);  // refuses what is not one solid
  } catch (const Error& error) {
    throw Error(source.where, error.what());
  }
  return shape;
}

}  // namespace selvage
