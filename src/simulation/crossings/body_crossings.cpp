#include "simulation/crossings/body_crossings.h"

#include <algorithm>
#include <map>
#include <utility>

namespace selvage {

namespace {

bool has_vertex(const VertexTuple<4>& element, Index vertex) {
  return std::ranges::find(element, vertex) != element.end();
}

/// What only touches the boundary is in its elements too, by a path of length 0.
bool is_inside(const BoundaryPath<3>& path) {
  return path.status != PathStatus::kFound || path.distance > 0;
}

}  // namespace

/// Sums over pairs of bodies, of which few cross.
class BodyCrossingFinder::Sums {
 public:
  BodyPairCrossings& of(Index a, Index b) {
    BodyPairCrossings& pair = pairs_[std::minmax({a, b})];
    std::tie(pair.first, pair.second) = std::minmax({a, b});
    return pair;
  }
  BodyPairCrossings& total() { return total_; }

  BodyCrossings list() const {
    BodyCrossings all;
    for (const auto& [bodies, pair] : pairs_) all.pairs.push_back(pair);
    all.total = total_;
    return all;
  }

 private:
  std::map<std::pair<Index, Index>, BodyPairCrossings> pairs_;
  BodyPairCrossings total_;
};

BodyCrossingFinder::BodyCrossingFinder(const Model& model, std::span<const Vec3> positions)
    : model_(&model),
      surface_(std::make_unique<TriangleMesh>(surface_of(model))),
      surface_finder_(*surface_, positions),
      bodies_(bodies_of_vertices(model)) {}

BodyCrossings BodyCrossingFinder::measure(const BoundaryPathFinder<3>& finder, std::span<const Vec3> positions) {
  Sums sums;
  edges_.assign(static_cast<std::size_t>(surface_->edge_count()), 0);
  surface_finder_.update(positions);
  pairs_ = surface_finder_.find_pairs();
  for (const TrianglePair& pair : pairs_) {
    if (pair.contact != TriangleContact::kCrossing) continue;
    for (const Index triangle : {pair.first, pair.second})
      for (const Index edge : surface_->triangle_edges()[triangle]) edges_[edge] = 1;
    const Index a = body_of(surface_->triangles()[pair.first][0]), b = body_of(surface_->triangles()[pair.second][0]);
    ++sums.of(a, b).triangle_pairs;
    ++sums.total().triangle_pairs;
  }
  add_vertices(finder, positions, sums);
  add_edges(finder, positions, sums);
  return sums.list();
}

/// What is inside an element of all vertices of cloth.
void BodyCrossingFinder::append_cloth_vertices(const BoundaryPathFinder<3>& finder, std::span<const Vec3> positions,
                                               std::vector<PathQuery<3>>& queries) const {
  std::vector<Index> vertices;
  std::vector<Vec3> points;
  for (const Body& body : model_->bodies)
    for (Index v = body.first_vertex; v < body.first_vertex + body.vertex_count && body.is_cloth(); ++v) {
      vertices.push_back(v);
      points.push_back(positions[v]);
    }
  if (vertices.empty()) return;
  const LocatedPoints<3> located = finder.locate(points);
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::int64_t q = located.first[i]; q < located.first[i + 1]; ++q)
      queries.push_back(PathQuery<3>::of_vertex(vertices[i], points[i], located.queries[q].element));
}

void BodyCrossingFinder::add_vertices(const BoundaryPathFinder<3>& finder, std::span<const Vec3> positions,
                                      Sums& sums) {
  std::vector<PathQuery<3>> queries = finder.find_penetrating_vertices();
  append_cloth_vertices(finder, positions, queries);
  const std::vector<BoundaryPath<3>> paths = finder.find_paths(queries);
  Index last = kNone;
  std::vector<Index> counted_in;  // bodies, of one vertex
  for (std::size_t q = 0; q < queries.size(); ++q) {
    if (!is_inside(paths[q])) continue;
    const Index v = queries[q].source[0], other = body_of(model_->mesh.elements()[queries[q].element][0]);
    BodyPairCrossings& pair = sums.of(body_of(v), other);
    if (std::exchange(last, v) != v) {
      ++sums.total().vertices;
      counted_in.clear();
      for (const Index triangle : surface_->vertex_triangles(v))
        for (const Index edge : surface_->triangle_edges()[triangle])
          if (std::ranges::find(surface_->edges()[edge], v) != surface_->edges()[edge].end()) edges_[edge] = 1;
    }
    if (std::ranges::find(counted_in, other) == counted_in.end()) {
      ++pair.vertices;
      counted_in.push_back(other);
    }
    const double depth = paths[q].status == PathStatus::kFound ? paths[q].distance : 0;
    pair.deepest_vertex = std::max(pair.deepest_vertex, depth);
    sums.total().deepest_vertex = std::max(sums.total().deepest_vertex, depth);
  }
}

void BodyCrossingFinder::add_edges(const BoundaryPathFinder<3>& finder, std::span<const Vec3> positions,
                                   Sums& sums) const {
  std::vector<Vec3> points;
  std::vector<Index> edge_of_point;
  for (Index edge = 0; edge < surface_->edge_count(); ++edge) {
    if (edges_[edge] == 0) continue;
    const auto& [a, b] = surface_->edges()[edge];
    for (int k = 1; k <= kEdgePoints; ++k) {
      const double share = k / (kEdgePoints + 1.0);
      points.emplace_back((1 - share) * positions[a] + share * positions[b]);
      edge_of_point.push_back(edge);
    }
  }
  const LocatedPoints<3> located = finder.locate(points);
  std::vector<PathQuery<3>> queries;
  std::vector<Index> edge_of_query;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::int64_t q = located.first[i]; q < located.first[i + 1]; ++q) {
      const VertexTuple<2>& edge = surface_->edges()[edge_of_point[i]];
      const Index element = located.queries[q].element;
      const VertexTuple<4>& corners = model_->mesh.elements()[element];
      if (has_vertex(corners, edge[0]) || has_vertex(corners, edge[1])) continue;
      queries.push_back(PathQuery<3>::of_edge(edge, points[i], element));
      edge_of_query.push_back(edge_of_point[i]);
    }
  const std::vector<BoundaryPath<3>> paths = finder.find_paths(queries);
  Index last = kNone;
  std::vector<Index> counted_in;  // bodies, of one edge
  for (std::size_t q = 0; q < queries.size(); ++q) {
    if (!is_inside(paths[q])) continue;
    const Index edge = edge_of_query[q], other = body_of(model_->mesh.elements()[queries[q].element][0]);
    BodyPairCrossings& pair = sums.of(body_of(surface_->edges()[edge][0]), other);
    if (std::exchange(last, edge) != edge) {
      ++sums.total().edges;
      counted_in.clear();
    }
    if (std::ranges::find(counted_in, other) == counted_in.end()) {
      ++pair.edges;
      counted_in.push_back(other);
    }
    const double depth = paths[q].status == PathStatus::kFound ? paths[q].distance : 0;
    pair.deepest_edge = std::max(pair.deepest_edge, depth);
    sums.total().deepest_edge = std::max(sums.total().deepest_edge, depth);
  }
}

}  // namespace selvage
