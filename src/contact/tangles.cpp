#include "contact/tangles.h"

#include "core/union_find.h"

#include <algorithm>
#include <utility>

namespace selvage {

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
  UnionFind tangles(points.size());
  for (std::size_t k = 1; k < places.size(); ++k)
    if (places[k].first == places[k - 1].first) tangles.join(places[k - 1].second, places[k].second);
  const std::vector<Index> numbers = tangles.numbered();
  Index count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].tangle = numbers[i];
    count = std::max(count, numbers[i] + 1);
  }
  return count;
}

}  // namespace selvage
