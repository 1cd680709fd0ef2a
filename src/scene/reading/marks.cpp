#include "scene/reading/marks.h"

namespace selvage {

MarkFinder::MarkFinder(const TetMesh& mesh, std::span<const Vec3> positions)
    : MarkFinder(mesh, {mesh.boundary_faces().begin(), mesh.boundary_faces().end()}, positions) {}

MarkFinder::MarkFinder(const TetMesh& mesh, std::vector<VertexTuple<3>> surface, std::span<const Vec3> positions)
    : surface_(mesh.vertex_count(), std::move(surface)), paths_(mesh, positions), pairs_(surface_, positions) {}

Marks MarkFinder::find(std::span<const Vec3> positions) {
  paths_.update(positions);
  pairs_.update(positions);
  Marks marks;
  const auto queries = paths_.find_penetrating_vertices();
  const auto found = paths_.find_paths(queries);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const Index vertex = queries[i].source[0];
    const Vec3& from = positions[static_cast<std::size_t>(vertex)];
    const bool has_path = found[i].status == PathStatus::kFound;
    const MarkedPath path{vertex, from, has_path ? found[i].point : from, has_path ? found[i].distance : -1};
    if (marks.paths.empty() || marks.paths.back().vertex != vertex) {
      marks.paths.push_back(path);
    } else if (path.depth > marks.paths.back().depth) {
      marks.paths.back() = path;
    }
  }
  for (const TrianglePair& pair : pairs_.find_pairs())
    if (pair.contact == TriangleContact::kCrossing && marks.pairs.size() < kMaxPairs)
      marks.pairs.push_back({{pair.first, pair.second}, MarkKind::kCrossing});
  return marks;
}

}  // namespace selvage
