#include "contact/tangles.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace selvage {

namespace {

Index first_of(std::vector<Index>& parents, Index point) {
  while (parents[point] != point) point = parents[point] = parents[parents[point]];
  return point;
}

}  // namespace

Index number_tangles(const TetMesh& mesh, std::span<const Index> pieces, std::span<PenetratingPoint> points) {
  std::vector<std::pair<Index, Index>> places;  // vertices, and the points that have them
  for (Index i = 0; i < std::ssize(points) && !pieces.empty(); ++i) {
    const PenetratingPoint& point = points[i];
    if (point.vertices[0] >= mesh.vertex_count()) continue;  // of a collider
    const auto elements = mesh.vertex_elements(point.vertices[0]);
    if (elements.empty()) continue;  // of cloth
    const Index own = elements.front();
    if (pieces[own] != pieces[point.query.element]) continue;
    for (int k = 0; k < point.count; ++k) places.push_back({point.vertices[k], i});
  }
  std::sort(places.begin(), places.end());
  // The parent of each point is itself or one before it.
  std::vector<Index> parents(points.size());
  std::iota(parents.begin(), parents.end(), 0);
  for (std::size_t k = 1; k < places.size(); ++k) {
    if (places[k].first != places[k - 1].first) continue;
    const Index a = first_of(parents, places[k - 1].second), b = first_of(parents, places[k].second);
    parents[std::max(a, b)] = std::min(a, b);
  }
  Index count = 0;
  for (Index i = 0; i < std::ssize(points); ++i)
    points[i].tangle = parents[i] == i ? count++ : points[parents[i]].tangle;
  return count;
}

}  // namespace selvage
