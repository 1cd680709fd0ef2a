#include "cli/reports/path_search.h"

#include "cli/arguments/mesh_input.h"
#include "selvage/core/error.h"

#include <fmt/format.h>

namespace selvage::cli {

namespace {

// Queries between two looks of the progress bar; the same without a bar, since what a query costs (its counters)
// depends on the queries that it is asked with.
constexpr std::size_t kBatch = 1 << 13;

template <int D>
Vec3 in_space(const Vec<D>& v) {
  Vec3 result = Vec3::Zero();
  result.template head<D>() = v;
  return result;
}

/// Queries, and for each the number that the user knows it by; points in no element stand among the rows only.
template <int D>
struct Questions {
  std::vector<PathQuery<D>> queries;
  std::vector<std::size_t> row_of;  // of each query
  std::vector<PathRow> rows;        // query, point and element filled in

  void ask(std::int64_t number, const PathQuery<D>& query) {
    row_of.push_back(rows.size());
    queries.push_back(query);
    leave_open(number, query.point, query.element);
  }
  void leave_open(std::int64_t number, const Vec<D>& point, Index element = kNone) {
    PathRow row;
    row.query = number;
    row.point = in_space<D>(point);
    row.element = element;
    rows.push_back(row);
  }
};

template <int D>
Questions<D> ask_vertices(const BoundaryPathFinder<D>& finder) {
  Questions<D> questions;
  for (const PathQuery<D>& query : finder.find_penetrating_vertices()) questions.ask(query.source[0], query);
  return questions;
}

template <int D>
Vec<D> point_of(const AskedPoint& asked, const std::string& file) {
  if (D == 2 && asked.point[2] != 0) {
    throw Error(fmt::format("{}:{}", file, asked.line), "z is not 0, but the mesh lies in the plane", "write 0 for z");
  }
  return asked.point.head<D>();
}

template <int D>
Questions<D> ask_points(const BoundaryPathFinder<D>& finder, const std::string& file, Index element_count) {
  const std::vector<AskedPoint> asked = read_points(file, element_count);
  std::vector<Vec<D>> unlocated;
  for (const AskedPoint& a : asked) {
    const Vec<D> point = point_of<D>(a, file);
    if (a.element == kNone) unlocated.push_back(point);
  }
  const auto located = finder.locate(unlocated);
  Questions<D> questions;
  std::size_t next = 0;
  for (std::size_t i = 0; i < asked.size(); ++i) {
    const auto number = static_cast<std::int64_t>(i);
    const Vec<D> point = asked[i].point.head<D>();
    if (asked[i].element != kNone) {
      questions.ask(number, {point, asked[i].element});
      continue;
    }
    const std::int64_t first = located.first[next], last = located.first[next + 1];
    for (std::int64_t q = first; q < last; ++q) questions.ask(number, located.queries[q]);
    if (first == last) questions.leave_open(number, point);
    ++next;
  }
  return questions;
}

template <int D>
void fill_row(const SimplexMesh<D>& mesh, const BoundaryPath<D>& path, PathRow& row) {
  row.status = path.status;
  if (!row.found()) return;
  const auto& face = mesh.boundary_faces()[path.face];
  std::copy(face.begin(), face.end(), row.face.begin());
  row.face_id = path.face;
  row.barycentric = in_space<D>(path.barycentric);
  row.closest = in_space<D>(path.point);
  row.distance = path.distance;
  row.feature = path.feature;
  row.normal = in_space<D>(path.normal);
}

template <int D>
void answer(const BoundaryPathFinder<D>& finder, const SimplexMesh<D>& mesh, const SearchRequest& request,
            Questions<D>& questions) {
  const std::size_t count = questions.queries.size();
  ProgressBar bar("shortest paths", request.quiet);
  for (std::size_t first = 0; first < count; first += kBatch) {
    const std::size_t size = std::min(kBatch, count - first);
    std::vector<PathCounters> counters(request.count ? size : 0);
    const auto paths = finder.find_paths(std::span(questions.queries).subspan(first, size), {}, counters);
    for (std::size_t i = 0; i < size; ++i) {
      PathRow& row = questions.rows[questions.row_of[first + i]];
      fill_row<D>(mesh, paths[i], row);
      if (request.count) row.counters = counters[i];
    }
    bar.show(static_cast<double>(first + size) / static_cast<double>(count));
  }
}

template <int D>
auto take_input(const IndexedMesh& file) {
  if constexpr (D == 3) {
    return std::pair(file.tetrahedra, file.positions);
  } else {
    return std::pair(file.triangles, drop_z(file.positions));
  }
}

}  // namespace

template <int D>
SearchResult search_paths(const IndexedMesh& file, const SearchRequest& request, Stopwatch& watch) {
  auto [elements, positions] = take_input<D>(file);
  const SimplexMesh<D> mesh(static_cast<Index>(positions.size()), std::move(elements));
  watch.lap("topology");
  const BoundaryPathFinder<D> finder(mesh, positions, request.options);
  watch.lap("hierarchy");
  Questions<D> questions =
      request.points_file ? ask_points<D>(finder, *request.points_file, mesh.element_count()) : ask_vertices<D>(finder);
  watch.lap(request.points_file ? "locate" : "detect");
  answer<D>(finder, mesh, request, questions);
  watch.lap("paths");

  SearchResult result;
  result.table = {D == 2, std::move(questions.rows)};
  result.defects = finder.defects();
  result.element_count = mesh.element_count();
  if constexpr (D == 3) {
    result.surface.assign(mesh.boundary_faces().begin(), mesh.boundary_faces().end());
  } else {
    result.surface = file.triangles;
    result.outline.assign(mesh.boundary_faces().begin(), mesh.boundary_faces().end());
  }
  return result;
}

template SearchResult search_paths<2>(const IndexedMesh&, const SearchRequest&, Stopwatch&);
template SearchResult search_paths<3>(const IndexedMesh&, const SearchRequest&, Stopwatch&);

}  // namespace selvage::cli
