#include "simulation/elements/element_edges.h"

#include "core/parallel.h"

#include <tuple>

namespace selvage {

ElementEdges list_element_edges(const TetMesh& mesh) {
  struct Item {
    Index a, b;
    std::int64_t item;

    auto key() const { return std::tie(a, b, item); }
  };
  std::vector<Item> all;
  all.reserve(6 * static_cast<std::size_t>(mesh.element_count()));
  for (std::int64_t e = 0, block = 0; e < mesh.element_count(); ++e) {
    const auto& element = mesh.elements()[e];
    for (int k = 0; k < 4; ++k)
      for (int l = k + 1; l < 4; ++l, ++block) {
        const bool turned = element[k] > element[l];
        all.push_back(
            {std::min(element[k], element[l]), std::max(element[k], element[l]), 2 * block + (turned ? 1 : 0)});
      }
  }
  parallel_sort(all.begin(), all.end(), [](const Item& x, const Item& y) { return x.key() < y.key(); });
  ElementEdges edges;
  edges.first.assign(mesh.vertex_count() + 1, 0);
  edges.items.reserve(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i == 0 || all[i].a != all[i - 1].a || all[i].b != all[i - 1].b) {
      edges.first_items.push_back(static_cast<std::int64_t>(i));
      edges.ends.push_back(all[i].b);
      ++edges.first[all[i].a + 1];
    }
    edges.items.push_back(all[i].item);
  }
  edges.first_items.push_back(static_cast<std::int64_t>(all.size()));
  for (std::size_t v = 1; v < edges.first.size(); ++v) edges.first[v] += edges.first[v - 1];
  return edges;
}

}  // namespace selvage
