#include "cli/reports/collision_report.h"

#include "selvage/core/error.h"

#include <fmt/format.h>

namespace selvage::cli {

namespace {

/// Puts the second mesh behind the first; without one, the first is the whole.
void join_surfaces(CollisionReport& report) {
  if (!report.second) {
    report.surface = std::move(report.first.surface);
    report.positions = std::move(report.first.positions);
    report.end_positions = std::move(report.first.end_positions);
    return;
  }
  std::vector<VertexTuple<3>> triangles(report.first.surface.triangles().begin(),
                                        report.first.surface.triangles().end());
  const Index shift = report.first.surface.vertex_count();
  for (const auto& [a, b, c] : report.second->surface.triangles())
    triangles.push_back({a + shift, b + shift, c + shift});
  report.positions = report.first.positions;
  report.positions.insert(report.positions.end(), report.second->positions.begin(), report.second->positions.end());
  if (report.moves()) {
    report.end_positions = report.first.end_positions;
    report.end_positions.insert(report.end_positions.end(), report.second->positions.begin(),
                                report.second->positions.end());
  }
  report.surface = {static_cast<Index>(report.positions.size()), std::move(triangles)};
}

/// Leaves pairs within each of the two meshes out.
PairFilters filters_of(const CollisionReport& report, const CollisionRequest& request) {
  PairFilters filters = request.filters;
  if (!report.second) return filters;
  filters.groups.assign(report.surface.triangles().size(), 1);
  std::fill_n(filters.groups.begin(), report.first_triangles(), 0);
  return filters;
}

SelfCollisionOptions options_of(const CollisionReport& report, const CollisionRequest& request,
                                std::function<void(double)> on_progress) {
  SelfCollisionOptions options;
  options.method = culling_method(request.method);
  // One pose is compared in less time than it takes to find out where there is no need to.
  if (options.method == CullingMethod::kAuto && !report.moves()) options.method = CullingMethod::kBvh;
  options.asked_once = true;
  options.include_adjacent = request.adjacent;
  options.on_progress = std::move(on_progress);
  return options;
}

/// Shows how far each phase has come.
class Phases {
 public:
  explicit Phases(const CollisionRequest& request) : request_(request) {}

  /// @param from, to  the phase's part of the whole
  void begin(std::string_view phase, double from, double to) {
    phase_ = phase;
    from_ = from;
    to_ = to;
    show(0);
  }
  void show(double share) const {
    if (request_.on_progress) request_.on_progress(phase_, from_ + share * (to_ - from_));
  }

 private:
  const CollisionRequest& request_;
  std::string_view phase_ = "hierarchy";
  double from_ = 0, to_ = 0;
};

/// Pairs of one mesh in one pose.
void find_pairs(const CollisionRequest& request, Phases& phases, CollisionReport& report, Stopwatch& watch) {
  SelfCollisionOptions options = options_of(report, request, [&](double share) { phases.show(share); });
  options.filters = request.filters;
  const SelfCollisionFinder finder(report.surface, report.positions, std::move(options));
  watch.lap("hierarchy");
  phases.begin("looking for pairs", 0.3, request.segments || request.thickness > 0 ? 0.6 : 1);
  report.pairs = finder.find_pairs(&report.counters);
  watch.lap("pairs");
  if (!request.segments) return;
  phases.begin("segments", 0.6, request.thickness > 0 ? 0.7 : 1);
  report.segments = finder.find_segments(report.pairs);
  watch.lap("segments");
}

/// Pairs of two meshes in one pose.
void find_pairs_of_two(const CollisionRequest& request, Phases& phases, CollisionReport& report, Stopwatch& watch) {
  const auto finder_of = [&](const CheckedSurface& mesh) {
    return SelfCollisionFinder(mesh.surface, mesh.positions,
                               options_of(report, request, [&](double share) { phases.show(share); }));
  };
  const SelfCollisionFinder finder = finder_of(report.first), other = finder_of(*report.second);
  watch.lap("hierarchy");
  phases.begin("looking for pairs", 0.3, request.segments || request.thickness > 0 ? 0.6 : 1);
  report.pairs = finder.find_pairs_with(other, &report.counters);
  watch.lap("pairs");
  if (request.segments) {
    report.segments = finder.find_segments_with(other, report.pairs);
    watch.lap("segments");
  }
  for (TrianglePair& pair : report.pairs) pair.second += report.first_triangles();
}

/// Pairs nearer than the thickness in one pose.
void find_near_pairs(const CollisionRequest& request, Phases& phases, CollisionReport& report, Stopwatch& watch) {
  const ProximityFinder finder(report.surface, report.positions, request.thickness, filters_of(report, request),
                               [&](double share) { phases.show(share); });
  phases.begin("distances", 0.7, 1);
  report.near = finder.find_pairs(&report.moving_counters);
  for (const NearVertexFace& pair : report.near.vertex_face)
    report.moving_pairs.vertex_face.push_back({pair.vertex, pair.face});
  for (const NearEdges& pair : report.near.edge_edge)
    report.moving_pairs.edge_edge.push_back({pair.first, pair.second});
  watch.lap("distances");
}

void find_moving_pairs(const CollisionRequest& request, Phases& phases, CollisionReport& report, Stopwatch& watch) {
  SelfCollisionOptions options = options_of(report, request, [&](double share) { phases.show(share); });
  options.filters = filters_of(report, request);
  if (request.thickness > 0) options.thickness.assign(report.positions.size(), request.thickness / 2);
  const ContinuousCollisionFinder finder(report.surface, report.positions, report.end_positions, std::move(options));
  watch.lap("hierarchy");
  phases.begin("looking for pairs", 0.2, 0.8);
  report.moving_pairs = finder.find_pairs(&report.moving_counters);
  watch.lap("pairs");
  phases.begin("times of impact", 0.8, 1);
  report.free_step = finder.find_free_step(report.moving_pairs);
  if (request.thickness > 0) report.separated_step = finder.find_separated_step(report.moving_pairs);
  watch.lap("impact");
}

}  // namespace

Index CollisionReport::number_in_file(Index triangle) const {
  return is_of_second_mesh(triangle) ? second->number_of(triangle - first_triangles()) : first.number_of(triangle);
}

Index CollisionReport::face_in_file(Index triangle) const {
  return is_of_second_mesh(triangle) ? second->face_of(triangle - first_triangles()) : first.face_of(triangle);
}

CollisionReport find_collisions(CheckedSurface first, std::optional<CheckedSurface> second, std::string end_file,
                                CollisionRequest request, Stopwatch& watch) {
  CollisionReport report{.first = std::move(first), .second = std::move(second), .end_file = std::move(end_file)};
  report.method = request.method;
  report.thickness = request.thickness;
  report.has_segments = request.segments;
  join_surfaces(report);
  Phases phases(request);
  if (report.moves()) {
    find_moving_pairs(request, phases, report, watch);
    return report;
  }
  if (report.second) {
    find_pairs_of_two(request, phases, report, watch);
  } else {
    find_pairs(request, phases, report, watch);
  }
  if (request.thickness > 0) find_near_pairs(request, phases, report, watch);
  return report;
}

}  // namespace selvage::cli
