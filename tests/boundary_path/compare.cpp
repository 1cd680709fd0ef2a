#include "boundary_path/compare.h"

#include "core/parallel.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <limits>
#include <mutex>

namespace selvage::families {

namespace {

constexpr double kUlp = std::numeric_limits<double>::epsilon();
constexpr std::size_t kComplaintsShown = 300;

template <int D>
std::string text_of(const Vec<D>& x) {
  std::string text;
  for (int k = 0; k < D; ++k) text += fmt::format("{}{}", k ? ", " : "", x[k]);
  return text;
}

// Largest coordinate of the face's corners seen from the point: rounding them moves the closest point this much.
template <int D>
double extent_from(const Subject<D>& subject, const Vec<D>& point, Index face) {
  double extent = 0;
  for (Index v : subject.judge.faces()[face].vertices) {
    extent = std::max(extent, (subject.judge.positions()[v] - point).cwiseAbs().maxCoeff());
  }
  return extent;
}

template <int D>
std::string judge_fields(const Subject<D>& subject, const Query<D>& query, const BoundaryPath<D>& path) {
  const auto& vertices = subject.judge.faces()[path.face].vertices;
  Vec<D> sum = Vec<D>::Zero();
  double total = 0, magnitude = 0;
  int spanning = 0;
  for (int i = 0; i < D; ++i) {
    const Vec<D>& x = subject.judge.positions()[vertices[i]];
    if (!(path.barycentric[i] >= 0)) return "a barycentric coordinate is negative";
    sum += path.barycentric[i] * x;
    total += path.barycentric[i];
    magnitude = std::max(magnitude, x.cwiseAbs().maxCoeff());
    spanning += path.barycentric[i] != 0;
  }
  if (std::abs(total - 1) > 8 * kUlp) return fmt::format("barycentric coordinates add up to {}", total);
  const double off = (sum - path.point).cwiseAbs().maxCoeff();
  if (off > 16 * kUlp * magnitude) return fmt::format("the point is {} off its barycentric coordinates", off);
  const int expected = path.feature == BoundaryFeature::kFace ? D : path.feature == BoundaryFeature::kEdge ? 2 : 1;
  if (spanning > expected) return fmt::format("{} vertices span a feature that has {}", spanning, expected);
  const double gap = std::abs((path.point - query.point).stableNorm() - path.distance);
  const double slack = 16 * kUlp * (magnitude + extent_from(subject, query.point, path.face));
  if (gap > slack) return fmt::format("the distance is {} off the point", gap);
  if (std::abs(path.normal.stableNorm() - 1) > 8 * kUlp) return "the normal is not of length 1";
  return {};
}

}  // namespace

template <int D>
Subject<D>::Subject(const Family<D>& of)
    : family(of),
      judge(of.mesh.positions, of.mesh.elements),
      mesh(static_cast<Index>(of.mesh.positions.size()), of.mesh.elements),
      maker(judge) {}

template <int D>
std::vector<PathQuery<D>> to_library(const std::vector<Query<D>>& queries) {
  std::vector<PathQuery<D>> result;
  for (const auto& q : queries) result.push_back({q.point, q.element, q.source});
  return result;
}

template <int D>
Verdict judge_path(const Subject<D>& subject, const Query<D>& query, const BoundaryPath<D>& path,
                   oracle::Workspace& workspace) {
  const auto& judge = subject.judge;
  const auto right = judge.shortest_path(query.point, query.element, query.source, workspace);
  if (right.in_element != (path.status != PathStatus::kNotInElement)) {
    return {fmt::format("in element: {}, not {}", right.in_element, !right.in_element)};
  }
  if (!right.in_element) return {};
  const bool found = path.status == PathStatus::kFound;
  const double infinite = std::numeric_limits<double>::infinity();
  auto grazing_below = [&](double distance) {
    return judge.only_grazing_below(distance, query.point, query.element, query.source, workspace);
  };
  if (!found) {
    if (!right.found) return {};
    if (grazing_below(infinite)) return {"", true};
    return {fmt::format("no path; right: {} to face {}", right.distance, right.face)};
  }
  if (path.face < 0 || path.face >= static_cast<Index>(judge.faces().size())) return {"a face out of range"};
  Verdict verdict{judge_fields(subject, query, path)};
  const double to_face = judge.face_distance(query.point, path.face);
  const double slack = 1e-12 * to_face + 8 * kUlp * extent_from(subject, query.point, path.face);
  if (!(std::abs(path.distance - to_face) <= slack)) {
    return {fmt::format("distance {}; face {} is {} away", path.distance, path.face, to_face)};
  }
  if (!right.found || path.face != right.face) {
    if (!judge.is_valid(query.point, query.element, path.face, workspace)) {
      verdict.is_grazing = judge.is_grazing(query.point, query.element, path.face, workspace);
      if (!verdict.is_grazing)
        return {fmt::format("the path to face {} is not valid; right: {}", path.face, right.face)};
    }
  }
  if (!right.found) return verdict;
  const double right_slack = 1e-12 * right.distance + 8 * kUlp * extent_from(subject, query.point, right.face);
  if (path.distance > right.distance + slack + right_slack) {
    verdict.is_grazing = grazing_below(path.distance - slack);
    if (!verdict.is_grazing) {
      return {fmt::format("distance {} to face {}; right: {} to face {}", path.distance, path.face, right.distance,
                          right.face)};
    }
  } else if (path.distance < right.distance - slack - right_slack && !verdict.is_grazing) {
    return {fmt::format("distance {} to face {}, which is no candidate", path.distance, path.face)};
  }
  return verdict;
}

template <int D>
std::int64_t expect_right_paths(const Subject<D>& subject, const std::vector<Query<D>>& queries,
                                const std::vector<BoundaryPath<D>>& paths) {
  EXPECT_EQ(paths.size(), queries.size());
  std::mutex mutex;
  std::vector<std::pair<std::int64_t, std::string>> complaints;
  std::int64_t found = 0, grazing = 0;
  parallel_ranges(static_cast<std::int64_t>(paths.size()), 64, [&](std::int64_t first, std::int64_t last) {
    oracle::Workspace workspace;
    std::int64_t here = 0, grazing_here = 0;
    for (std::int64_t i = first; i < last; ++i) {
      here += paths[i].status == PathStatus::kFound;
      const Verdict verdict = judge_path(subject, queries[i], paths[i], workspace);
      grazing_here += verdict.is_grazing;
      if (verdict.complaint.empty()) continue;
      std::scoped_lock lock(mutex);
      complaints.push_back({i, verdict.complaint});
    }
    std::scoped_lock lock(mutex);
    found += here;
    grazing += grazing_here;
  });
  std::sort(complaints.begin(), complaints.end());
  for (std::size_t k = 0; k < std::min(complaints.size(), kComplaintsShown); ++k) {
    const auto& [i, complaint] = complaints[k];
    const auto& q = queries[i];
    ADD_FAILURE() << subject.family.name << ", query " << i << " at (" << text_of<D>(q.point) << ") in element "
                  << q.element << ", source " << q.source[0] << " " << q.source[1] << ": " << complaint;
  }
  EXPECT_LE(grazing * 200, static_cast<std::int64_t>(queries.size())) << subject.family.name << ": " << grazing;
  EXPECT_EQ(complaints.size(), 0u) << subject.family.name << ", of " << queries.size() << " queries";
  return found;
}

template <int D>
bool is_identical(const BoundaryPath<D>& a, const BoundaryPath<D>& b) {
  if (a.status != b.status) return false;
  if (a.status != PathStatus::kFound) return true;
  bool same = a.feature == b.feature && a.face == b.face &&
              std::bit_cast<std::uint64_t>(a.distance) == std::bit_cast<std::uint64_t>(b.distance);
  for (int k = 0; k < D; ++k) {
    same = same && a.barycentric[k] == b.barycentric[k] && a.point[k] == b.point[k] && a.normal[k] == b.normal[k];
  }
  return same;
}

template struct Subject<2>;
template struct Subject<3>;
template std::vector<PathQuery<2>> to_library(const std::vector<Query<2>>&);
template std::vector<PathQuery<3>> to_library(const std::vector<Query<3>>&);
template std::int64_t expect_right_paths(const Subject<2>&, const std::vector<Query<2>>&,
                                         const std::vector<BoundaryPath<2>>&);
template std::int64_t expect_right_paths(const Subject<3>&, const std::vector<Query<3>>&,
                                         const std::vector<BoundaryPath<3>>&);
template Verdict judge_path(const Subject<2>&, const Query<2>&, const BoundaryPath<2>&, oracle::Workspace&);
template Verdict judge_path(const Subject<3>&, const Query<3>&, const BoundaryPath<3>&, oracle::Workspace&);
template bool is_identical(const BoundaryPath<2>&, const BoundaryPath<2>&);
template bool is_identical(const BoundaryPath<3>&, const BoundaryPath<3>&);

}  // namespace selvage::families
