#include "contact/penetration_search.h"

#include "boundary_path/injectivity/star_proof.h"
#include "contact/edge_part.h"
#include "contact/input/collider_triangles.h"
#include "contact/ways_out/path_contact.h"
#include "core/parallel.h"
#include "mesh/simplex_corners.h"
#include "selvage/geometry/predicates.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

namespace selvage {

namespace {

constexpr std::int64_t kEdgesAtOnce = 32;
constexpr std::int64_t kStarsAtOnce = 32;
/// See PenetrationSearch::is_crowded(). Fewer cost little, and with 20 a noodle through itself is out some steps later.
constexpr std::int64_t kCrowdedShare = 10;

template <std::size_t N>
std::array<Vec3, 2> extent_of(const std::array<Index, N>& vertices, std::span<const Vec3> positions) {
  std::array<Vec3, 2> extent{positions[vertices[0]], positions[vertices[0]]};
  for (const Index v : vertices) {
    extent[0] = extent[0].cwiseMin(positions[v]);
    extent[1] = extent[1].cwiseMax(positions[v]);
  }
  return extent;
}

/// Adds an index to a list, once.
bool add_once(std::vector<std::uint8_t>& is_listed, Index i, std::vector<Index>& list) {
  if (std::exchange(is_listed[i], 1) != 0) return false;
  list.push_back(i);
  return true;
}

std::vector<Index> vertices_of_bodies(const TetMesh& mesh, const TriangleMesh& surface, Index body_faces) {
  std::vector<Index> vertices(mesh.boundary_vertices().begin(), mesh.boundary_vertices().end());
  if (body_faces == mesh.boundary_face_count()) return vertices;
  for (const auto& t : surface.triangles().subspan(mesh.boundary_face_count(), body_faces - mesh.boundary_face_count()))
    vertices.insert(vertices.end(), t.begin(), t.end());
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

}  // namespace

PenetrationCounters& PenetrationCounters::operator+=(const PenetrationCounters& other) {
  features += other.features;
  searched += other.searched;
  elements_tested += other.elements_tested;
  crossings += other.crossings;
  return *this;
}

PenetrationSearch::PenetrationSearch(const TetMesh& mesh, const TriangleMesh& surface, Index body_faces,
                                     bool with_edges, std::span<const Vec3> positions, PathOptions options,
                                     bool joins_parts)
    : mesh_(mesh),
      surface_(surface),
      with_edges_(with_edges),
      joins_parts_(joins_parts),
      body_vertices_(vertices_of_bodies(mesh, surface, body_faces)),
      vertex_count_(static_cast<Index>(body_vertices_.size()) + surface.vertex_count() - mesh.vertex_count()),
      vertex_feature_(surface.vertex_count(), kNone),
      positions_(positions.begin(), positions.end()),
      locator_(mesh, mesh_positions()),
      paths_(locator_, options),
      collisions_(surface, positions, options_with_colliders(body_faces, surface)),
      is_suspect_(surface.triangle_count(), 0) {
  for (Index i = 0; i < vertex_count_; ++i) vertex_feature_[vertex_of(i)] = i;
  list_surface_pieces();
}

void PenetrationSearch::list_surface_pieces() {
  Flags is_reached(surface_.triangle_count(), 0);
  std::vector<Index> reached;
  for (Index start = 0; start < surface_.triangle_count(); ++start) {
    if (is_reached[start] != 0) continue;
    pieces_.push_back(start);
    reached.clear();
    add_once(is_reached, start, reached);
    for (std::size_t i = 0; i < reached.size(); ++i)
      for (const Index v : surface_.triangles()[reached[i]])
        for (const Index face : surface_.vertex_triangles(v)) add_once(is_reached, face, reached);
  }
}

void PenetrationSearch::place(std::span<const Vec3> positions) {
  positions_.assign(positions.begin(), positions.end());
  locator_.update(mesh_positions());
  collisions_placed_ = false;
}

void PenetrationSearch::suspect(Index face) {
  add_once(is_suspect_, face, suspects_);
}

void PenetrationSearch::suspect_around(Index vertex) {
  for (const Index face : surface_.vertex_triangles(vertex)) suspect(face);
}

std::vector<TrianglePair> PenetrationSearch::meeting_pairs(std::span<const IndexPair> candidates) const {
  std::vector<TrianglePair> meeting;
  for (const auto& [first, second] : candidates) {
    const TriangleContact contact = classify_contact(corners_of(surface_.triangles()[first], positions_),
                                                     corners_of(surface_.triangles()[second], positions_));
    if (contact != TriangleContact::kDisjoint) meeting.push_back({first, second, contact});
  }
  return meeting;
}

void PenetrationSearch::suspect_crossings(PenetrationCounters& counters,
                                          const std::optional<std::vector<IndexPair>>& candidates) {
  if (candidates) {
    crossings_ = meeting_pairs(*candidates);
  } else {
    if (!collisions_placed_) collisions_.update(positions_);
    collisions_placed_ = true;
    crossings_ = collisions_.find_pairs();
  }
  for (const TrianglePair& pair : crossings_) {
    suspect(pair.first);
    suspect(pair.second);
  }
  counters.crossings += std::ssize(crossings_);
}

/// Faces at inverted elements, and at vertices whose elements may overlap each other.
void PenetrationSearch::suspect_defects() {
  std::vector<Extent> defects;
  for (const Index e : locator_.defective_elements()) defects.push_back(extent_of(mesh_.elements()[e], positions_));
  if (!defects.empty()) {
    paths_.update();
    for (const Index face : paths_.find_faces_near(defects).found) suspect(face);
  }
  const auto boundary = mesh_.boundary_vertices();
  for (const Index v : find_overlapping_stars({boundary.begin(), boundary.end()})) suspect_around(v);
}

/// Of some vertices, those whose elements may overlap, though all were positive. The path finder knows most locally
/// injective vertices already. Of the others, at creases and in hollows, nearly all are proven element by element.
std::vector<Index> PenetrationSearch::find_overlapping_stars(std::vector<Index> vertices) const {
  std::erase_if(vertices, [&](Index v) { return locator_.locally_injective_vertices()[v] != 0; });
  Flags is_apart(vertices.size(), 0);
  parallel_for(std::ssize(vertices), kStarsAtOnce,
               [&](std::int64_t i) { is_apart[i] = is_star_proven_apart(mesh_, positions_, vertices[i]); });
  std::vector<Index> overlapping;
  for (std::size_t i = 0; i < vertices.size(); ++i)
    if (is_apart[i] == 0) overlapping.push_back(vertices[i]);
  return overlapping;
}

/// Removes the bodies' edges between two of some vertices.
std::vector<Penetration> PenetrationSearch::take_deep_edges(std::span<const Penetration> vertices,
                                                            std::vector<Index>& edges) const {
  Flags is_inside(mesh_.vertex_count(), 0);
  for (const Penetration& p : vertices)
    if (const Index v = vertex_of(p.feature); v < mesh_.vertex_count()) is_inside[v] = 1;
  std::vector<Penetration> deep;
  std::erase_if(edges, [&](Index e) {
    const auto& [a, b] = surface_.edges()[e];
    if (std::max(a, b) >= mesh_.vertex_count() || is_inside[a] == 0 || is_inside[b] == 0) return false;
    deep.push_back({vertex_count_ + e, kNone});
    return true;
  });
  return deep;
}

std::vector<Penetration> PenetrationSearch::find_all(PenetrationCounters& counters,
                                                     const std::optional<std::vector<IndexPair>>& candidates,
                                                     bool leaves_deep_edges) {
  for (const Index face : suspects_) is_suspect_[face] = 0;
  suspects_.clear();
  for (const Index face : pieces_) suspect(face);
  suspect_crossings(counters, candidates);
  suspect_defects();

  Flags is_asked(surface_.vertex_count(), 0), is_edge_asked(with_edges_ ? surface_.edge_count() : 0, 0);
  std::vector<Index> edges;
  std::vector<Penetration> found;
  // Faces around a vertex that is inside are suspects of the next round.
  for (std::size_t first = 0; first < suspects_.size();) {
    std::vector<Index> vertices;
    for (; first < suspects_.size(); ++first) {
      for (const Index v : surface_.triangles()[suspects_[first]]) add_once(is_asked, v, vertices);
      if (with_edges_)
        for (const Index e : surface_.triangle_edges()[suspects_[first]]) add_once(is_edge_asked, e, edges);
    }
    const auto inside = find_vertices(vertices);
    for (const PointInside& p : inside) suspect_around(p.point);
    append_vertices(inside, found);
    counters.searched += std::ssize(vertices);
  }
  const auto key = [](const Penetration& p) { return std::pair(p.feature, p.element); };
  std::sort(found.begin(), found.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
  std::int64_t inside_count = 0;
  for (std::size_t i = 0; i < found.size() && found[i].feature < std::ssize(body_vertices_); ++i)
    inside_count += i == 0 || found[i].feature != found[i - 1].feature;
  is_crowded_ = kCrowdedShare * inside_count > std::ssize(body_vertices_);
  std::vector<Penetration> on_edges;
  if (leaves_deep_edges && is_crowded_) on_edges = take_deep_edges(found, edges);
  for (const Penetration& p : find_edges(edges, counters)) on_edges.push_back(p);
  std::sort(on_edges.begin(), on_edges.end(), [](const auto& a, const auto& b) { return a.feature < b.feature; });
  found.insert(found.end(), on_edges.begin(), on_edges.end());
  counters.searched += std::ssize(edges);
  counters.features += feature_count();
  return found;
}

std::vector<Penetration> PenetrationSearch::find(std::span<const Index> features, PenetrationCounters& counters) const {
  std::vector<Index> vertices, edges;
  for (const Index f : features)
    if (is_edge(f)) {
      edges.push_back(edge_of(f));
    } else {
      vertices.push_back(vertex_of(f));
    }
  std::vector<Penetration> found;
  append_vertices(find_vertices(vertices), found);
  const auto on_edges = find_edges(edges, counters);
  found.insert(found.end(), on_edges.begin(), on_edges.end());
  counters.features += std::ssize(features);
  counters.searched += std::ssize(features);
  return found;
}

void PenetrationSearch::append_vertices(std::span<const PointInside> inside, std::vector<Penetration>& found) const {
  for (const auto& [vertex, element] : inside)
    if (!holds_nothing(element)) found.push_back({vertex_feature_[vertex], element});
}

bool PenetrationSearch::holds_nothing(Index element) const {
  const auto& across = mesh_.neighbours()[element];
  return std::any_of(across.begin(), across.end(), [](HalfFace n) { return !n.exists(); }) &&
         orientation(corners_of(mesh_.elements()[element], positions_)) < 0;
}

/// Vertices with each element that holds them and is not their own.
std::vector<PointInside> PenetrationSearch::find_vertices(std::span<const Index> vertices) const {
  std::vector<Index> of_mesh, of_colliders;
  for (const Index v : vertices) (v < mesh_.vertex_count() ? of_mesh : of_colliders).push_back(v);
  std::vector<PointInside> inside;
  for (const auto& query : locator_.locate_vertices(of_mesh)) inside.push_back({query.source[0], query.element});
  if (!of_colliders.empty()) append_collider_vertices(of_colliders, inside);
  return inside;
}

void PenetrationSearch::append_collider_vertices(std::span<const Index> vertices,
                                                 std::vector<PointInside>& inside) const {
  std::vector<Vec3> places;
  for (const Index v : vertices) places.push_back(positions_[v]);
  const auto located = locator_.locate(places);
  for (std::size_t i = 0; i < vertices.size(); ++i)
    for (std::int64_t k = located.first[i]; k < located.first[i + 1]; ++k)
      inside.push_back({vertices[i], located.queries[k].element});
}

/// In order.
std::vector<Penetration> PenetrationSearch::find_edges(std::span<const Index> edges,
                                                       PenetrationCounters& counters) const {
  std::vector<Extent> extents;
  for (const Index e : edges) extents.push_back(extent_of(surface_.edges()[e], positions_));
  const auto near = locator_.find_elements_near(extents);
  std::vector<Penetration> found(edges.size(), {kNone, kNone});
  std::vector<std::int64_t> tested(edges.size(), 0);
  parallel_for(std::ssize(edges), kEdgesAtOnce, [&](std::int64_t i) {
    const auto& ends = surface_.edges()[edges[i]];
    const auto segment = corners_of(ends, positions_);
    std::vector<ElementPart> parts;
    for (std::int64_t k = near.first[i]; k < near.first[i + 1]; ++k) {
      const Index element = near.found[k];
      if (share_vertex(ends, mesh_.elements()[element])) continue;
      ++tested[i];
      const auto part = part_inside(segment, corners_of(mesh_.elements()[element], positions_));
      if (part && !holds_nothing(element)) parts.push_back({element, *part});
    }
    if (parts.empty()) return;
    const EdgePoint middle = middle_of_parts(mesh_, positions_, segment, std::move(parts), joins_parts_);
    found[i] = {vertex_count_ + edges[i], middle.element, middle.place};
  });
  for (const std::int64_t count : tested) counters.elements_tested += count;
  std::erase_if(found, [](const Penetration& p) { return p.feature == kNone; });
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.feature < b.feature; });
  return found;
}

/// Elements near crossings of the boundary, near defects, and at vertices that are not locally injective.
std::vector<Index> PenetrationSearch::suspected_elements() const {
  std::vector<Extent> extents;
  for (const Index face : suspects_) extents.push_back(extent_of(surface_.triangles()[face], positions_));
  for (const Index e : locator_.defective_elements()) extents.push_back(extent_of(mesh_.elements()[e], positions_));
  Flags is_listed(mesh_.element_count(), 0);
  std::vector<Index> elements;
  for (const Index e : locator_.find_elements_near(extents).found) add_once(is_listed, e, elements);
  std::vector<Index> vertices(mesh_.vertex_count());
  std::iota(vertices.begin(), vertices.end(), 0);
  for (const Index v : find_overlapping_stars(std::move(vertices)))
    for (const Index e : mesh_.vertex_elements(v)) add_once(is_listed, e, elements);
  return elements;
}

PenetrationSearch::Interior PenetrationSearch::find_interior() const {
  Interior interior;
  std::vector<Index> elements = suspected_elements(), vertices;
  Flags is_listed(mesh_.element_count(), 0), is_asked(mesh_.vertex_count(), 0);
  for (const Index e : elements) is_listed[e] = 1;
  const auto ask = [&](Index element) {
    for (const Index v : mesh_.elements()[element])
      if (vertex_feature_[v] == kNone) add_once(is_asked, v, vertices);
  };
  for (const Index e : elements) ask(e);
  while (!vertices.empty()) {
    const auto inside = find_vertices(std::exchange(vertices, {}));
    for (const PointInside& p : inside)
      for (const Index e : mesh_.vertex_elements(p.point)) {
        add_once(is_listed, e, elements);
        ask(e);
      }
    interior.vertices.insert(interior.vertices.end(), inside.begin(), inside.end());
  }
  interior.centroids = find_centroids(elements);
  for (auto* points : {&interior.vertices, &interior.centroids}) {
    std::erase_if(*points, [&](const PointInside& p) { return holds_nothing(p.element); });
    std::sort(points->begin(), points->end(), [](const PointInside& a, const PointInside& b) {
      return std::pair(a.point, a.element) < std::pair(b.point, b.element);
    });
  }
  return interior;
}

std::vector<PointInside> PenetrationSearch::find_centroids(std::span<const Index> elements) const {
  std::vector<Vec3> places;
  for (const Index e : elements)
    places.push_back(penetrating_centroid(e, mesh_.elements()[e], e, positions_).query.point);
  const auto located = locator_.locate(places);
  std::vector<PointInside> inside;
  for (std::size_t i = 0; i < elements.size(); ++i)
    for (std::int64_t k = located.first[i]; k < located.first[i + 1]; ++k)
      if (const Index holder = located.queries[k].element;
          !share_vertex(mesh_.elements()[elements[i]], mesh_.elements()[holder]))
        inside.push_back({elements[i], holder});
  return inside;
}

}  // namespace selvage
