#include "peer/paths/subject.h"

#include <cmath>
#include <numbers>

namespace selvage::bench {

namespace {

/// Every k-th of the queries, so that at most `most` are left.
std::vector<PathQuery<3>> thin_out(const std::vector<PathQuery<3>>& queries, std::int64_t most) {
  const std::int64_t step = (std::ssize(queries) + most - 1) / most;
  std::vector<PathQuery<3>> thinned;
  for (std::int64_t i = 0; i < std::ssize(queries); i += step) thinned.push_back(queries[i]);
  return thinned;
}

}  // namespace

Subject::Subject(std::string name, const IndexedMesh& file, std::int64_t most_queries)
    : name_(std::move(name)), mesh_(static_cast<Index>(file.positions.size()), file.tetrahedra), pose_(file.positions) {
  make_pose_before();
  make_queries(most_queries);
}

/// Long waves of a tenth of an edge.
void Subject::make_pose_before() {
  Vec3 lower = pose_[0], upper = pose_[0];
  for (const Vec3& x : pose_) {
    lower = lower.cwiseMin(x);
    upper = upper.cwiseMax(x);
  }
  extent_ = (upper - lower).maxCoeff();
  double edge = 0;
  for (const auto& e : mesh_.elements()) edge += (pose_[e[1]] - pose_[e[0]]).norm() / mesh_.element_count();
  const double frequency = 6 * std::numbers::pi / extent_;
  for (const Vec3& x : pose_) {
    const Vec3 wave(std::sin(frequency * x[1]), std::sin(frequency * x[2]), std::sin(frequency * x[0]));
    pose_before_.push_back(x + 0.1 * edge * wave);
  }
}

Vec3 Subject::centroid(std::span<const Vec3> positions, Index element) const {
  Vec3 sum = Vec3::Zero();
  for (Index v : mesh_.elements()[element]) sum += positions[v];
  return 0.25 * sum;
}

void Subject::make_queries(std::int64_t most) {
  BoundaryPathFinder<3> finder(mesh_, pose_);
  defects_ = finder.defects();
  std::vector<PathQuery<3>> deep;
  const Index step = std::max<Index>(1, static_cast<Index>(mesh_.element_count() / most));
  for (Index t = 0; t < mesh_.element_count(); t += step) deep.push_back({centroid(pose_, t), t});
  query_sets_.push_back({"vertices", thin_out(finder.find_penetrating_vertices(), most), {}});
  query_sets_.push_back({"centroids", std::move(deep), {}});

  finder.rebuild(pose_before_);
  for (QuerySet& set : query_sets_) {
    std::vector<PathQuery<3>> before = set.queries;
    for (PathQuery<3>& q : before)
      q.point = q.source[0] == kNone ? centroid(pose_before_, q.element) : pose_before_[q.source[0]];
    for (const auto& path : finder.find_paths(before))
      set.warm_start.push_back(path.status == PathStatus::kFound ? path.face : kNone);
  }
}

}  // namespace selvage::bench
