#pragma once

#include "boundary_path/queries.h"
#include "selvage/boundary_path/boundary_path.h"

#include <gtest/gtest.h>

namespace selvage::families {

/// One mesh with everything that judges the library's answers on it.
template <int D>
struct Subject {
  explicit Subject(const Family<D>& family);

  const Family<D>& family;
  oracle::Oracle<D> judge;
  SimplexMesh<D> mesh;
  QueryMaker<D> maker;
};

template <int D>
std::vector<PathQuery<D>> to_library(const std::vector<Query<D>>& queries);

/// The verdict on one answer.
struct Verdict {
  std::string complaint;    ///< the error, in words; empty when it is right
  bool is_grazing = false;  ///< right only because a path grazes something and closest points may be rounded
};

/// Judges the library's answer to a query: found or not, the distance to 1e-12 relative (and to the rounding of the
/// face's corners seen from the point), a face at this distance whose path is valid, and fields that agree.
template <int D>
Verdict judge_path(const Subject<D>& subject, const Query<D>& query, const BoundaryPath<D>& path,
                   oracle::Workspace& workspace);

/// Judges all answers, in parallel; fails the current test with the first few complaints, or when more than one answer
/// in 200 is grazing. Counts what was found.
template <int D>
std::int64_t expect_right_paths(const Subject<D>& subject, const std::vector<Query<D>>& queries,
                                const std::vector<BoundaryPath<D>>& paths);

/// Whether two answers are the same bit for bit.
template <int D>
bool is_identical(const BoundaryPath<D>& a, const BoundaryPath<D>& b);

extern template struct Subject<2>;
extern template struct Subject<3>;
extern template std::vector<PathQuery<2>> to_library(const std::vector<Query<2>>&);
extern template std::vector<PathQuery<3>> to_library(const std::vector<Query<3>>&);
extern template std::int64_t expect_right_paths(const Subject<2>&, const std::vector<Query<2>>&,
                                                const std::vector<BoundaryPath<2>>&);
extern template std::int64_t expect_right_paths(const Subject<3>&, const std::vector<Query<3>>&,
                                                const std::vector<BoundaryPath<3>>&);
extern template Verdict judge_path(const Subject<2>&, const Query<2>&, const BoundaryPath<2>&, oracle::Workspace&);
extern template Verdict judge_path(const Subject<3>&, const Query<3>&, const BoundaryPath<3>&, oracle::Workspace&);
extern template bool is_identical(const BoundaryPath<2>&, const BoundaryPath<2>&);
extern template bool is_identical(const BoundaryPath<3>&, const BoundaryPath<3>&);

/// Names a test after its family.
template <int D>
std::string family_name(const testing::TestParamInfo<std::size_t>& info) {
  return all_families<D>()[info.param].name;
}

}  // namespace selvage::families
