#pragma once

#include "selvage/boundary_path/boundary_path.h"
#include "selvage/io/vtu.h"

#include <string>

namespace selvage::cli {

/// One answer, in space or in the plane (where z, the third vertex and the third coordinate are left out).
struct PathRow {
  std::int64_t query = 0;  ///< vertex, or number of the point in the points file, from 0
  Vec3 point = Vec3::Zero();
  Index element = kNone;  ///< kNone: the point lies in no element
  PathStatus status = PathStatus::kNotInElement;
  std::array<Index, 3> face{kNone, kNone, kNone};
  Index face_id = kNone;
  Vec3 barycentric = Vec3::Zero();
  Vec3 closest = Vec3::Zero();
  double distance = 0;
  BoundaryFeature feature = BoundaryFeature::kFace;
  Vec3 normal = Vec3::Zero();
  PathCounters counters;

  bool found() const { return status == PathStatus::kFound; }
};

/// All answers for one mesh.
struct PathTable {
  bool planar = false;
  std::vector<PathRow> rows;
};

/// A summary of all answers.
struct PathTotals {
  std::int64_t found = 0, no_path = 0, not_in_element = 0;
  const PathRow* deepest = nullptr;  ///< the first of the longest; null when none was found
  double median = 0;                 ///< length of the paths found [m]
  PathCounters counters;
};

PathTotals total_paths(const PathTable& table);

/// The table as comma-separated values with a header line; what is unknown is left empty. Numbers have the shortest
/// digits that give the same double.
std::string print_csv(const PathTable& table);

/// The table as a JSON array, one row a line; what is unknown is null.
std::string print_json_rows(const PathTable& table);

/// The paths found as lines from point to boundary, with `depth` as a field of points and lines.
VtkGrid path_lines(const PathTable& table);

}  // namespace selvage::cli
