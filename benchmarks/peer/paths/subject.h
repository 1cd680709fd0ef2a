#pragma once

#include "selvage/boundary_path/boundary_path.h"
#include "selvage/io/mesh_file.h"

namespace selvage::bench {

/// Queries of one kind, and the faces to start from: the answers for the same material points in the pose before.
struct QuerySet {
  std::string name;
  std::vector<PathQuery<3>> queries;
  std::vector<Index> warm_start;
};

/// A tangled mesh in its pose and, for refits and warm starts, in one a small step before.
class Subject {
 public:
  Subject(std::string name, const IndexedMesh& file, std::int64_t most_queries);

  const std::string& name() const { return name_; }
  const TetMesh& mesh() const { return mesh_; }
  std::span<const Vec3> pose() const { return pose_; }
  std::span<const Vec3> pose_before() const { return pose_before_; }
  double extent() const { return extent_; }
  const MeshDefects& defects() const { return defects_; }

  /// Penetrating vertices, then centroids of elements.
  std::span<const QuerySet> query_sets() const { return query_sets_; }

 private:
  void make_pose_before();
  void make_queries(std::int64_t most);
  Vec3 centroid(std::span<const Vec3> positions, Index element) const;

  std::string name_;
  TetMesh mesh_;
  std::vector<Vec3> pose_, pose_before_;
  double extent_ = 0;
  MeshDefects defects_;
  std::vector<QuerySet> query_sets_;
};

}  // namespace selvage::bench
