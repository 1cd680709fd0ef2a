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
                                std::span<Vec3> positions) {
  std::vector<int> halvings(positions.size(), 0);
  for (;;) {
    std::vector<Index> now = find_inverted(mesh, positions), turned, vertices;
    std::set_difference(now.begin(), now.end(), inverted.begin(), inverted.end(), std::back_inserter(turned));
    // Ends at the latest where all vertices are back: no other elements were inverted there.
    if (turned.empty()) return now;
    for (const Index e : turned) vertices.insert(vertices.end(), mesh.elements()[e].begin(), mesh.elements()[e].end());
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    for (const Index v : vertices)
      positions[v] = halvings[v]++ < kHalvings ? Vec3((before[v] + positions[v]) / 2) : before[v];
  }
}

}  // namespace selvage
