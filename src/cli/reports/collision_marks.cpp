#include "cli/reports/collision_marks.h"

#include "picture/scene_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace selvage::cli {

namespace {

constexpr std::array<const char*, 4> kContactNames{"near", "touching", "crossing", "coplanar overlap"};
constexpr Colour8 kMeetsColour{213, 94, 0}, kNearColour{240, 228, 66}, kFirstColour{200, 200, 200},
    kSecondColour{160, 190, 215};

/// Calls `visit(triangle)` for each triangle of each pair, and for each vertex that meets a face and each edge the
/// vertices with `visit_vertex(vertex)`.
template <typename Visit, typename VisitVertex>
void visit_pairs(const CollisionReport& report, Visit&& visit, VisitVertex&& visit_vertex) {
  for (const TrianglePair& pair : report.pairs) {
    visit(pair.first);
    visit(pair.second);
  }
  for (const VertexFacePair& pair : report.moving_pairs.vertex_face) {
    visit_vertex(pair.vertex);
    visit(pair.face);
  }
  for (const EdgeEdgePair& pair : report.moving_pairs.edge_edge)
    for (const Index e : {pair.first, pair.second})
      for (const Index v : report.surface.edges()[e]) visit_vertex(v);
}

/// How much a triangle or a vertex has to do with the pairs.
enum class Mark : std::uint8_t { kNone, kNear, kMeets };

/// Marks of the triangles: of a pair of features, all triangles that have the vertex or the edge.
std::vector<Mark> mark_triangles(const CollisionReport& report) {
  std::vector<Mark> marks(report.surface.triangles().size(), Mark::kNone);
  const auto raise = [&](Index t, Mark mark) { marks[t] = std::max(marks[t], mark); };
  for (const TrianglePair& pair : report.pairs)
    for (const Index t : {pair.first, pair.second}) raise(t, Mark::kMeets);
  const auto mark_of = [&](const auto& near, std::size_t i) {
    return report.moves() || near[i].distance == 0 ? Mark::kMeets : Mark::kNear;
  };
  const ContinuousPairs& pairs = report.moving_pairs;
  for (std::size_t i = 0; i < pairs.vertex_face.size(); ++i) {
    const Mark mark = mark_of(report.near.vertex_face, i);
    raise(pairs.vertex_face[i].face, mark);
    for (const Index t : report.surface.vertex_triangles(pairs.vertex_face[i].vertex)) raise(t, mark);
  }
  for (std::size_t i = 0; i < pairs.edge_edge.size(); ++i)
    for (const Index e : {pairs.edge_edge[i].first, pairs.edge_edge[i].second})
      for (const Index t : report.surface.edge_triangles(e)) raise(t, mark_of(report.near.edge_edge, i));
  return marks;
}

/// Distance of each vertex's nearest pair; the thickness where there is none. [m]
std::vector<double> vertex_distances(const CollisionReport& report) {
  std::vector<double> distances(report.positions.size(), report.thickness);
  const auto lower = [&](std::span<const Index> vertices, double distance) {
    for (const Index v : vertices) distances[v] = std::min(distances[v], distance);
  };
  for (const NearVertexFace& pair : report.near.vertex_face) {
    lower(std::array{pair.vertex}, pair.distance);
    lower(report.surface.triangles()[pair.face], pair.distance);
  }
  for (const NearEdges& pair : report.near.edge_edge)
    for (const Index e : {pair.first, pair.second}) lower(report.surface.edges()[e], pair.distance);
  for (const TrianglePair& pair : report.pairs)
    for (const Index t : {pair.first, pair.second}) lower(report.surface.triangles()[t], 0);
  return distances;
}

}  // namespace

const char* contact_name(TriangleContact contact) {
  return kContactNames[static_cast<std::size_t>(contact)];
}

PairCounts::PairCounts(const CollisionReport& report)
    : of_triangles(report.surface.triangles().size(), 0), of_vertices(report.positions.size(), 0) {
  visit_pairs(
      report, [&](Index t) { ++of_triangles[t]; }, [&](Index v) { ++of_vertices[v]; });
}

std::pair<Vec3, Vec3> place_of_collisions(const CollisionReport& report) {
  Vec3 lower = Vec3::Constant(HUGE_VAL), upper = -lower;
  const auto add = [&](Index v) {
    lower = lower.cwiseMin(report.positions[v]);
    upper = upper.cwiseMax(report.positions[v]);
  };
  visit_pairs(
      report,
      [&](Index t) {
        for (const Index v : report.surface.triangles()[t]) add(v);
      },
      add);
  return {lower, upper};
}

VtkGrid mark_collisions(const CollisionReport& report) {
  VtkGrid grid;
  grid.points = report.positions;
  grid.triangles.assign(report.surface.triangles().begin(), report.surface.triangles().end());
  const PairCounts counts(report);
  grid.cell_fields.push_back({"collisions", 1, {counts.of_triangles.begin(), counts.of_triangles.end()}});
  const auto add_of_triangles = [&](const char* name, auto&& value) {
    VtkField field{name, 1, {}};
    for (Index t = 0; t < report.surface.triangle_count(); ++t) field.values.push_back(value(t));
    grid.cell_fields.push_back(std::move(field));
  };
  if (report.has_polygons()) add_of_triangles("face", [&](Index t) { return report.face_in_file(t); });
  if (report.second) add_of_triangles("mesh", [&](Index t) { return report.is_of_second_mesh(t) ? 1 : 0; });
  if (report.moves() || report.thickness > 0)
    grid.point_fields.push_back({"collisions", 1, {counts.of_vertices.begin(), counts.of_vertices.end()}});
  if (!report.moves() && report.thickness > 0) grid.point_fields.push_back({"distance", 1, vertex_distances(report)});
  return grid;
}

ColouredSurface colour_collisions(const CollisionReport& report) {
  ColouredSurface result;
  result.mesh.positions = report.positions;
  result.mesh.triangles.assign(report.surface.triangles().begin(), report.surface.triangles().end());
  const std::vector<Mark> marks = mark_triangles(report);
  std::vector<Mark> vertex_marks(report.positions.size(), Mark::kNone);
  for (std::size_t t = 0; t < marks.size(); ++t)
    for (const Index v : result.mesh.triangles[t]) vertex_marks[v] = std::max(vertex_marks[v], marks[t]);
  const auto colour = [](Mark mark, bool is_second) {
    if (mark == Mark::kNone) return is_second ? kSecondColour : kFirstColour;
    return mark == Mark::kMeets ? kMeetsColour : kNearColour;
  };
  for (std::size_t v = 0; v < vertex_marks.size(); ++v)
    result.vertices.push_back(colour(vertex_marks[v], static_cast<Index>(v) >= report.first_vertices()));
  for (std::size_t t = 0; t < marks.size(); ++t)
    result.triangles.push_back(colour(marks[t], report.is_of_second_mesh(static_cast<Index>(t))));
  return result;
}

Image draw_collisions(const CollisionReport& report) {
  DrawnScene scene;
  scene.vertex_count = report.positions.size();
  scene.surface.assign(report.surface.triangles().begin(), report.surface.triangles().end());
  if (report.second) {
    scene.bodies.assign(scene.vertex_count, 0);
    std::fill(scene.bodies.begin() + report.first_vertices(), scene.bodies.end(), 1);
  } else {
    scene.number_pieces();
  }
  const std::vector<Mark> marks = mark_triangles(report);
  for (std::size_t t = 0; t < marks.size(); ++t)
    if (marks[t] != Mark::kNone) scene.marked.push_back(static_cast<Index>(t));
  SceneView view;
  if (std::all_of(report.positions.begin(), report.positions.end(), [](const Vec3& p) { return p[2] == 0; })) {
    scene.ground = false;
    view.view.towards = Vec3::UnitZ();
  }
  ScenePictures pictures(scene, view);
  pictures.add_frame(report.positions, 0);
  return pictures.draw(report.positions, 0);
}

std::string unshared_hint(const CollisionReport& report) {
  std::string files;
  for (const CheckedSurface* mesh : {&report.first, report.second ? &*report.second : nullptr})
    if (mesh != nullptr && mesh->shares_nothing) files += (files.empty() ? "" : ", ") + mesh->file;
  if (files.empty()) return files;
  // Between two meshes no neighbours are compared.
  return fmt::format(
      "{}: no triangles share a vertex, so that {}; try --weld", files,
      report.second ? "vertices and edges count once for each triangle" : "neighbours count as touching");
}

}  // namespace selvage::cli
