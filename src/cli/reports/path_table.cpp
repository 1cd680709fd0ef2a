#include "cli/reports/path_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace selvage::cli {

namespace {

constexpr std::string_view kHeader =
    "query,x,y,z,element,found,face,face_id,b0,b1,b2,sx,sy,sz,distance,feature,nx,ny,nz,"
    "volumes,faces,culled,traversals,elements\n";

std::string_view feature_name(BoundaryFeature feature) {
  switch (feature) {
    case BoundaryFeature::kFace:
      return "face";
    case BoundaryFeature::kEdge:
      return "edge";
    default:
      return "vertex";
  }
}

/// Vertices of the face in the table's dimension.
std::span<const Index> face_of(const PathRow& row, bool planar) {
  return std::span<const Index>(row.face).first(planar ? 2 : 3);
}

using Buffer = fmt::memory_buffer;

template <typename... Values>
void put(Buffer& out, fmt::format_string<Values...> text, Values&&... values) {
  fmt::format_to(std::back_inserter(out), text, std::forward<Values>(values)...);
}

void put_csv_answer(Buffer& out, const PathRow& row, bool planar) {
  const auto face = face_of(row, planar);
  for (std::size_t i = 0; i < face.size(); ++i) put(out, "{}{}", i ? " " : "", face[i]);
  put(out, ",{},{},{},", row.face_id, row.barycentric[0], row.barycentric[1]);
  if (!planar) put(out, "{}", row.barycentric[2]);
  put(out, ",{},{},{},{},{}", row.closest[0], row.closest[1], row.closest[2], row.distance, feature_name(row.feature));
  put(out, ",{},{},{}", row.normal[0], row.normal[1], row.normal[2]);
}

void put_json_answer(Buffer& out, const PathRow& row, bool planar) {
  const auto face = face_of(row, planar);
  for (std::size_t i = 0; i < face.size(); ++i) put(out, "{}{}", i ? "," : "\"face\":[", face[i]);
  put(out, "],\"face_id\":{},\"b0\":{},\"b1\":{},", row.face_id, row.barycentric[0], row.barycentric[1]);
  if (planar) {
    put(out, "\"b2\":null,");
  } else {
    put(out, "\"b2\":{},", row.barycentric[2]);
  }
  put(out, "\"sx\":{},\"sy\":{},\"sz\":{},", row.closest[0], row.closest[1], row.closest[2]);
  put(out, "\"distance\":{},\"feature\":\"{}\",", row.distance, feature_name(row.feature));
  put(out, "\"nx\":{},\"ny\":{},\"nz\":{}", row.normal[0], row.normal[1], row.normal[2]);
}

constexpr std::string_view kNoJsonAnswer =
    R"("face":null,"face_id":null,"b0":null,"b1":null,"b2":null,"sx":null,"sy":null,"sz":null,)"
    R"("distance":null,"feature":null,"nx":null,"ny":null,"nz":null)";

void put_json_row(Buffer& out, const PathRow& row, bool planar) {
  put(out, "{{\"query\":{},\"x\":{},\"y\":{},\"z\":{},", row.query, row.point[0], row.point[1], row.point[2]);
  if (row.element == kNone) {
    put(out, "\"element\":null,");
  } else {
    put(out, "\"element\":{},", row.element);
  }
  put(out, "\"found\":{},", row.found() ? 1 : 0);
  if (row.found()) {
    put_json_answer(out, row, planar);
  } else {
    put(out, "{}", kNoJsonAnswer);
  }
  const PathCounters& c = row.counters;
  put(out, ",\"volumes\":{},\"faces\":{},\"culled\":{},\"traversals\":{},\"elements\":{}}}", c.volumes_visited,
      c.faces_visited, c.culled, c.traversals, c.elements_visited);
}

}  // namespace

PathTotals total_paths(const PathTable& table) {
  PathTotals totals;
  std::vector<double> lengths;
  for (const PathRow& row : table.rows) {
    totals.found += row.found();
    totals.no_path += row.status == PathStatus::kNoPath;
    totals.not_in_element += row.status == PathStatus::kNotInElement;
    totals.counters += row.counters;
    if (!row.found()) continue;
    lengths.push_back(row.distance);
    if (totals.deepest == nullptr || row.distance > totals.deepest->distance) totals.deepest = &row;
  }
  if (!lengths.empty()) {
    const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
    std::nth_element(lengths.begin(), middle, lengths.end());
    totals.median = *middle;
  }
  return totals;
}

std::string print_csv(const PathTable& table) {
  Buffer out;
  put(out, "{}", kHeader);
  for (const PathRow& row : table.rows) {
    put(out, "{},{},{},{},", row.query, row.point[0], row.point[1], row.point[2]);
    if (row.element != kNone) put(out, "{}", row.element);
    put(out, ",{},", row.found() ? 1 : 0);
    if (row.found()) {
      put_csv_answer(out, row, table.planar);
    } else {
      put(out, "{:,>12}", "");
    }
    const PathCounters& c = row.counters;
    put(out, ",{},{},{},{},{}\n", c.volumes_visited, c.faces_visited, c.culled, c.traversals, c.elements_visited);
  }
  return fmt::to_string(out);
}

std::string print_json_rows(const PathTable& table) {
  Buffer out;
  put(out, "[");
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    put(out, "{}\n  ", i ? "," : "");
    put_json_row(out, table.rows[i], table.planar);
  }
  put(out, "{}]", table.rows.empty() ? "" : "\n ");
  return fmt::to_string(out);
}

VtkGrid path_lines(const PathTable& table) {
  VtkGrid grid;
  VtkField depth_of_points{"depth", 1, {}}, depth{"depth", 1, {}}, query{"query", 1, {}}, element{"element", 1, {}};
  VtkField face{"face_id", 1, {}};
  for (const PathRow& row : table.rows) {
    if (!row.found()) continue;
    const auto first = static_cast<Index>(grid.points.size());
    grid.points.insert(grid.points.end(), {row.point, row.closest});
    grid.lines.push_back({first, first + 1});
    depth_of_points.values.insert(depth_of_points.values.end(), {row.distance, 0.0});
    depth.values.push_back(row.distance);
    query.values.push_back(static_cast<double>(row.query));
    element.values.push_back(row.element);
    face.values.push_back(row.face_id);
  }
  grid.point_fields = {depth_of_points};
  grid.cell_fields = {depth, query, element, face};
  return grid;
}

}  // namespace selvage::cli
