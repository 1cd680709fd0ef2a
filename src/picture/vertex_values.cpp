#include "picture/vertex_values.h"

#include "scene/reading/stored_colliders.h"
#include "selvage/core/error.h"

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

constexpr std::array<std::string_view, 5> kNames{"body", "depth", "speed", "strain", "contact"};
constexpr double kTopStrain = 0.5;
constexpr std::size_t kInside = 1, kFirstKind = 2;  // among the names of contacts

/// In the order of MarkKind, after free and inside; without a name where runs have none.
const std::vector<std::string_view> kContactNames{"free",          "inside",  "", "", "crossing", "", "vertex and face",
                                                  "edge and edge", "collider"};

/// Products of two edges of a triangle: of the first with itself, with the second, of the second with itself.
std::array<double, 3> edge_products(std::span<const Vec3> x, const VertexTuple<3>& t) {
  const Vec3 u = x[t[1]] - x[t[0]], v = x[t[2]] - x[t[0]];
  return {u.dot(u), u.dot(v), v.dot(v)};
}

double triangle_strain(std::span<const Vec3> rest, std::span<const Vec3> positions, const VertexTuple<3>& t) {
  // The squared stretches are the eigenvalues of R^-1 N.
  const auto [r11, r12, r22] = edge_products(rest, t);
  const auto [n11, n12, n22] = edge_products(positions, t);
  const double determinant = r11 * r22 - r12 * r12;
  if (!(determinant > 0)) return 0;
  const double trace = (r22 * n11 - 2 * r12 * n12 + r11 * n22) / determinant;
  const double product = (n11 * n22 - n12 * n12) / determinant;
  const double largest = trace / 2 + std::sqrt(std::max(0.0, trace * trace / 4 - product));
  const double smallest = largest > 0 ? std::max(0.0, product / largest) : 0;
  return std::max(std::sqrt(std::max(0.0, largest)) - 1, 1 - std::sqrt(smallest));
}

double largest_of(const StoredRun& run, double FrameStatistics::*member) {
  double largest = 0;
  for (const FrameStatistics& row : run.rows)
    if (std::isfinite(row.*member)) largest = std::max(largest, row.*member);
  return largest > 0 ? largest : 1;
}

}  // namespace

std::span<const std::string_view> colour_names() {
  return kNames;
}

std::vector<double> vertex_strains(std::span<const Vec3> rest, std::span<const Vec3> positions,
                                   std::span<const VertexTuple<3>> triangles) {
  std::vector<double> strains(positions.size(), 0);
  for (const auto& t : triangles) {
    const double strain = triangle_strain(rest, positions, t);
    for (const Index v : t)
      strains[static_cast<std::size_t>(v)] = std::max(strains[static_cast<std::size_t>(v)], strain);
  }
  return strains;
}

VertexValues::VertexValues(std::shared_ptr<const StoredRun> run, ColourBy by) : run_(std::move(run)), by_(by) {
  if (by == ColourBy::kDepth)
    scale_ = {largest_of(*run_, &FrameStatistics::deepest_penetration), "depth [m]", true, {}};
  if (by == ColourBy::kSpeed) scale_ = {largest_of(*run_, &FrameStatistics::fastest), "speed [m/s]", false, {}};
  if (by == ColourBy::kContact) scale_ = {1, "", false, kContactNames};
  if (by != ColourBy::kStrain) return;
  scale_ = {kTopStrain, "strain", false, {}};
  const auto path = rest_path(run_->folder);
  if (!std::filesystem::exists(path))
    throw Error(path.string(), "is missing, so that strains are not known", "colour by something else");
  rest_ = run_->read_positions(path);
}

std::vector<double> VertexValues::at(std::int64_t frame) {
  const std::vector<Vec3> positions = run_->read_frame_positions(frame);
  if (by_ == ColourBy::kDepth) return depths(frame, positions);
  if (by_ == ColourBy::kSpeed) return speeds(frame, positions);
  if (by_ == ColourBy::kContact) return contacts(frame, positions);
  return vertex_strains(rest_, positions, run_->topology.boundary_faces);
}

/// Between the frame and the one before; of the first, between it and the next.
std::vector<double> VertexValues::speeds(std::int64_t frame, std::span<const Vec3> positions) const {
  std::vector<double> values(positions.size(), 0);
  if (run_->last_frame == 0) return values;
  const std::int64_t other = frame > 0 ? frame - 1 : 1;
  const std::vector<Vec3> neighbours = run_->read_frame_positions(other);
  const auto time = [&](std::int64_t f) { return run_->rows[static_cast<std::size_t>(f)].time; };
  const double seconds = std::abs(time(frame) - time(other));
  if (!(seconds > 0)) return values;
  for (std::size_t v = 0; v < values.size(); ++v) values[v] = (positions[v] - neighbours[v]).norm() / seconds;
  return values;
}

Marks VertexValues::find_marks(std::int64_t frame, std::span<const Vec3> positions) {
  if (!mesh_) {
    const auto vertices = static_cast<Index>(run_->topology.header.vertices);
    mesh_.emplace(run_->topology.elements.empty() ? TetMesh::without_elements(vertices)
                                                  : TetMesh(vertices, run_->topology.elements));
  }
  const FrameStatistics& row = run_->rows[static_cast<std::size_t>(frame)];
  if (row.penetrating_vertices + row.triangle_pairs == 0) return {};
  if (!marks_) marks_.emplace(*mesh_, run_->topology.boundary_faces, positions);
  return marks_->find(positions);
}

std::vector<double> VertexValues::depths(std::int64_t frame, std::span<const Vec3> positions) {
  std::vector<double> values(positions.size(), 0);
  for (const MarkedPath& path : find_marks(frame, positions).paths) {
    double& depth = values[static_cast<std::size_t>(path.vertex)];
    depth = std::max(depth, path.depth);
  }
  return values;
}

/// Inside stands above what a vertex' triangles do, and that above what it touches.
std::vector<double> VertexValues::contacts(std::int64_t frame, std::span<const Vec3> positions) {
  std::vector<double> values(positions.size(), 0);
  const auto number = [](MarkKind kind) { return static_cast<double>(kFirstKind + static_cast<std::size_t>(kind)); };
  const Marks marks = find_marks(frame, positions);
  for (const MarkedPair& pair : marks.pairs)
    for (const Index t : pair.triangles)
      for (const Index v : run_->topology.boundary_faces[static_cast<std::size_t>(t)])
        values[static_cast<std::size_t>(v)] = number(pair.kind);
  if (!touches_)
    touches_.emplace(TriangleMesh(mesh_->vertex_count(), run_->topology.boundary_faces), run_->read_frame_positions(0),
                     read_stored_colliders(run_->scene, scene_path(run_->folder).string()));
  for (const Touch& touch : touches_->find(positions, run_->rows[static_cast<std::size_t>(frame)].time))
    for (const Index v : touch.vertices) {
      double& value = values[static_cast<std::size_t>(v)];
      if (value == 0) value = number(touch.kind);
    }
  for (const MarkedPath& path : marks.paths) values[static_cast<std::size_t>(path.vertex)] = kInside;
  return values;
}

}  // namespace selvage
