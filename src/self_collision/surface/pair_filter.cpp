#include "self_collision/surface/pair_filter.h"

#include "selvage/core/error.h"
#include "selvage/geometry/closest_point.h"
#include "selvage/geometry/distance.h"

#include <fmt/format.h>

#include <algorithm>

namespace selvage {

namespace {

void check_size(const char* name, std::size_t size, Index count, const char* of) {
  if (size != 0 && size != static_cast<std::size_t>(count))
    throw Error(name, fmt::format("{} entries for {} {}", size, count, of), "give one each, or none at all");
}

IndexPair ascending(IndexPair pair) {
  return pair.first <= pair.second ? pair : IndexPair(pair.second, pair.first);
}

void sort_pairs(const char* name, std::vector<IndexPair>& pairs, Index count) {
  for (IndexPair& pair : pairs) {
    pair = ascending(pair);
    if (pair.first < 0 || pair.second >= count)
      throw Error(name, fmt::format("there is no pair of triangles {} and {}", pair.first, pair.second),
                  fmt::format("triangles lie in [0, {})", count));
  }
  std::sort(pairs.begin(), pairs.end());
}

bool is_empty(const PairFilters& f) {
  return f.groups.empty() && f.layers.empty() && f.is_static.empty() && f.allowed_pairs.empty() &&
         f.forbidden_pairs.empty() && f.neighbour_rings == 0 && f.rest_distance == 0;
}

}  // namespace

std::optional<PairFilter> PairFilter::where_needed(const TriangleMesh& mesh, const PairFilters& filters) {
  PairFilter filter(mesh, filters);
  return is_empty(filters) ? std::nullopt : std::optional(std::move(filter));
}

PairFilter::PairFilter(const TriangleMesh& mesh, const PairFilters& filters) : mesh_(mesh), filters_(filters) {
  check_size("groups", filters_.groups.size(), mesh.triangle_count(), "triangles");
  check_size("layers", filters_.layers.size(), mesh.triangle_count(), "triangles");
  check_size("seen_layers", filters_.seen_layers.size(), mesh.triangle_count(), "triangles");
  check_size("is_static", filters_.is_static.size(), mesh.triangle_count(), "triangles");
  check_size("rest_positions", filters_.rest_positions.size(), mesh.vertex_count(), "vertices");
  if (filters_.layers.empty() && !filters_.seen_layers.empty())
    throw Error("seen_layers", "there are no layers to be seen", "give layers too");
  if (filters_.seen_layers.empty()) filters_.seen_layers = filters_.layers;
  if (filters_.neighbour_rings < 0) throw Error("neighbour_rings", "is negative", "give 0 or more");
  if (!(filters_.rest_distance >= 0)) throw Error("rest_distance", "is not 0 or more", "give a length");
  if (filters_.rest_distance > 0 && filters_.rest_positions.empty())
    throw Error("rest_distance", "there are no positions at rest", "give rest_positions too");
  sort_pairs("allowed_pairs", filters_.allowed_pairs, mesh.triangle_count());
  sort_pairs("forbidden_pairs", filters_.forbidden_pairs, mesh.triangle_count());
}

bool PairFilter::labels_keep(Index a, Index b) const {
  const PairFilters& f = filters_;
  if (!f.groups.empty() && f.groups[a] != kNone && f.groups[a] == f.groups[b]) return false;
  if (!f.is_static.empty() && f.is_static[a] != 0 && f.is_static[b] != 0) return false;
  if (!f.layers.empty() && ((f.seen_layers[a] & f.layers[b]) == 0 || (f.seen_layers[b] & f.layers[a]) == 0))
    return false;
  const IndexPair pair = ascending({a, b});
  const auto lists = [&](const std::vector<IndexPair>& pairs) {
    return std::binary_search(pairs.begin(), pairs.end(), pair);
  };
  return !lists(f.forbidden_pairs) && (f.allowed_pairs.empty() || lists(f.allowed_pairs));
}

bool PairFilter::labels_keep_any(std::span<const Index> a, std::span<const Index> b) const {
  return std::any_of(a.begin(), a.end(), [&](Index i) {
    return std::any_of(b.begin(), b.end(), [&](Index j) { return i != j && labels_keep(i, j); });
  });
}

/// Whether a path of neighbour_rings edges or fewer leads from a vertex of a to one of b.
bool PairFilter::are_neighbours(std::span<const Index> a, std::span<const Index> b) const {
  if (filters_.neighbour_rings == 0) return false;
  std::vector<Index> reached(a.begin(), a.end()), ring = reached;
  const auto has = [](std::span<const Index> list, Index v) {
    return std::find(list.begin(), list.end(), v) != list.end();
  };
  for (int n = 0; n < filters_.neighbour_rings; ++n) {
    std::vector<Index> next;
    for (const Index v : ring)
      for (const Index t : mesh_.vertex_triangles(v))
        for (const Index w : mesh_.triangles()[t])
          if (!has(reached, w)) {
            if (has(b, w)) return true;
            reached.push_back(w);
            next.push_back(w);
          }
    ring = std::move(next);
  }
  return std::any_of(a.begin(), a.end(), [&](Index v) { return has(b, v); });
}

std::array<Vec3, 3> PairFilter::at_rest(Index triangle) const {
  const auto& [a, b, c] = mesh_.triangles()[triangle];
  return {filters_.rest_positions[a], filters_.rest_positions[b], filters_.rest_positions[c]};
}

bool PairFilter::keeps_triangles(Index a, Index b) const {
  if (!labels_keep(a, b) || are_neighbours(mesh_.triangles()[a], mesh_.triangles()[b])) return false;
  const double d = filters_.rest_distance;
  return d == 0 || !is_nearer(squared_distance(at_rest(a), at_rest(b)), d);
}

bool PairFilter::keeps_vertex_face(Index vertex, Index face) const {
  if (!labels_keep_any(mesh_.vertex_triangles(vertex), std::span(&face, 1)) ||
      are_neighbours(std::span(&vertex, 1), mesh_.triangles()[face]))
    return false;
  const double d = filters_.rest_distance;
  if (d == 0) return true;
  const auto [p, q, r] = at_rest(face);
  return !is_nearer(closest_point_on_triangle(filters_.rest_positions[vertex], p, q, r).squared_distance, d);
}

bool PairFilter::keeps_edges(Index a, Index b) const {
  const auto& [a0, a1] = mesh_.edges()[a];
  const auto& [b0, b1] = mesh_.edges()[b];
  if (!labels_keep_any(mesh_.edge_triangles(a), mesh_.edge_triangles(b)) ||
      are_neighbours(mesh_.edges()[a], mesh_.edges()[b]))
    return false;
  const double d = filters_.rest_distance;
  const auto& x = filters_.rest_positions;
  return d == 0 || !is_nearer(squared_distance(std::array{x[a0], x[a1]}, std::array{x[b0], x[b1]}), d);
}

}  // namespace selvage
