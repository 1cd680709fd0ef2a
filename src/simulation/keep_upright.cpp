#include "simulation/keep_upright.h"

#include "selvage/geometry/predicates.h"

#include <algorithm>

namespace selvage {

namespace {

/// How often the way of a vertex is halved before it stays.
constexpr int kHalvings = 3;

}  // namespace

std::vector<Index> find_inverted(const TetMesh& mesh, std::span<const Vec3> positions) {
  std::vector<Index> inverted;
  for (Index e = 0; e < mesh.element_count(); ++e) {
    const auto& [a, b, c, d] = mesh.elements()[e];
    if (orientation(std::array{positions[a], positions[b], positions[c], positions[d]}) <= 0) inverted.push_back(e);
  }
  return inverted;
}

std::vector<Index> keep_upright(const TetMesh& mesh, std::span<const Vec3> before, std::span<const Index> inverted,
                                int evenings, std::span<Vec3> positions) {
  const auto mean_way = [&](Index v) {
    Vec3 sum = Vec3::Zero();
    for (const Index e : mesh.vertex_elements(v))
      for (const Index w : mesh.elements()[e]) sum += positions[w] - before[w];
    return Vec3(sum / (4.0 * static_cast<double>(mesh.vertex_elements(v).size())));
  };
  std::vector<int> shortened(positions.size(), 0);
  std::vector<Vec3> ways;
  for (;;) {
    std::vector<Index> now = find_inverted(mesh, positions), turned, vertices;
    std::set_difference(now.begin(), now.end(), inverted.begin(), inverted.end(), std::back_inserter(turned));
    // Ends at the latest where all vertices are back: no other elements were inverted there.
    if (turned.empty()) return now;
    for (const Index e : turned) vertices.insert(vertices.end(), mesh.elements()[e].begin(), mesh.elements()[e].end());
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    ways.clear();
    for (const Index v : vertices) {
      const int round = shortened[v]++;
      if (round < evenings) {
        ways.push_back(mean_way(v));
      } else {
        ways.push_back((round < evenings + kHalvings ? 0.5 : 0.0) * (positions[v] - before[v]));
      }
    }
    for (std::size_t i = 0; i < vertices.size(); ++i) positions[vertices[i]] = before[vertices[i]] + ways[i];
  }
}

}  // namespace selvage
