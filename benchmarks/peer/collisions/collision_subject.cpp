#include "peer/collisions/collision_subject.h"

#include "scene/reading/stored_run.h"
#include "selvage/core/error.h"
#include "selvage/mesh/simplex_mesh.h"
#include "selvage/shapes/sequences.h"

#include <fmt/format.h>

#include <algorithm>

namespace selvage::bench {

namespace {

/// The triangles of a surface, or the boundary of a tetrahedral mesh.
TriangleMesh surface_of(const IndexedMesh& file) {
  const Index vertex_count = static_cast<Index>(file.positions.size());
  if (file.tetrahedra.empty()) return {vertex_count, file.triangles};
  return boundary_surface(TetMesh(vertex_count, file.tetrahedra));
}

}  // namespace

CollisionSubject::CollisionSubject(std::string_view sequence, std::int64_t triangles, int frames) {
  const SurfaceSequence motion(sequence, triangles);
  mesh_ = TriangleMesh(motion.vertex_count(), motion.triangles());
  name_ = triangles == 0 ? std::string(sequence) : fmt::format("{}-{}k", sequence, mesh_.triangle_count() / 1000);
  const int count = std::min<int>(frames, motion.frame_count());
  const int first = (motion.frame_count() - count) * 9 / 10;
  for (int i = 0; i < count; ++i) frames_.push_back(motion.positions(first + i));
}

CollisionSubject::CollisionSubject(const std::filesystem::path& run, int frames) {
  const StoredRun stored(run);
  name_ = stored.name();
  mesh_ = TriangleMesh(static_cast<Index>(stored.topology.header.vertices), stored.topology.boundary_faces);
  const std::int64_t first = std::max<std::int64_t>(stored.last_frame + 1 - frames, 0);
  for (std::int64_t i = first; i <= stored.last_frame; ++i) frames_.push_back(stored.read_frame_positions(i));
  if (frames_.size() < 2 || mesh_.triangle_count() == 0)
    throw Error(run.string(), fmt::format("holds {} frames of {} triangles", frames_.size(), mesh_.triangle_count()),
                "give the folder of a run of two frames or more");
}

CollisionSubject::CollisionSubject(std::string name, const IndexedMesh& file, int frames)
    : name_(std::move(name)), mesh_(surface_of(file)), frames_(frames, file.positions) {}

}  // namespace selvage::bench
