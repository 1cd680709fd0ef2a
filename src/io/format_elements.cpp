#include "io/format_elements.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace selvage::format {

namespace {

/// first + place, wrapping around at the end of the range.
std::int64_t number_at(std::int64_t first, std::int64_t place) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(first) + static_cast<std::uint64_t>(place));
}

}  // namespace

void VertexNumbers::add_out_of_order(std::int64_t number) {
  if (sorted_.empty()) {
    for (std::int64_t i = 0; i < count_; ++i) sorted_.push_back({number_at(first_, i), static_cast<Index>(i)});
  }
  sorted_.push_back({number, static_cast<Index>(count_++)});
}

std::pair<bool, std::int64_t> VertexNumbers::finish() {
  if (sorted_.empty()) return {false, 0};
  std::sort(sorted_.begin(), sorted_.end());
  const auto same_number = [](const auto& a, const auto& b) { return a.first == b.first; };
  const auto twice = std::adjacent_find(sorted_.begin(), sorted_.end(), same_number);
  if (twice != sorted_.end()) return {true, twice->first};
  first_ = sorted_.front().first;
  const std::uint64_t range = static_cast<std::uint64_t>(sorted_.back().first) - static_cast<std::uint64_t>(first_);
  if (range / 8 <= sorted_.size()) {
    table_.assign(range + 1, kNone);
    for (const auto& [number, place] : sorted_) table_[static_cast<std::size_t>(number - first_)] = place;
  }
  return {false, 0};
}

Index VertexNumbers::find_out_of_order(std::int64_t number) const {
  if (!table_.empty()) {
    const std::uint64_t at = static_cast<std::uint64_t>(number) - static_cast<std::uint64_t>(first_);
    return at < table_.size() ? table_[at] : kNone;
  }
  const auto found = std::lower_bound(sorted_.begin(), sorted_.end(), std::pair(number, Index{0}));
  return found != sorted_.end() && found->first == number ? found->second : kNone;
}

std::string VertexNumbers::describe() const {
  if (count_ == 0) return "the file has no vertices before it";
  if (!sorted_.empty()) return fmt::format("{} other vertices are defined", count_);
  return fmt::format("vertices are numbered {} to {}", first_, number_at(first_, count_ - 1));
}

void ElementCollector::add_polygon(std::span<const Index> polygon) {
  if (polygon.size() < 3) {
    cursor_.fail(fmt::format("a face has {} vertices", polygon.size()), "a face needs at least 3: remove it");
  }
  for (std::size_t i = 2; i < polygon.size(); ++i) add_part(polygon[0], polygon[i - 1], polygon[i]);
  end_face(polygon.size() - 2);
}

void ElementCollector::add_strip(std::span<const Index> strip) {
  for (std::size_t i = 2; i < strip.size(); ++i) {
    const bool reversed = i % 2 == 1;
    add_part(strip[i - (reversed ? 1 : 2)], strip[i - (reversed ? 2 : 1)], strip[i]);
  }
  if (strip.size() > 2) end_face(strip.size() - 2);
}

void ElementCollector::end_face(std::size_t parts) {
  std::vector<Index>& faces = mesh_.faces;
  if (faces.empty()) {
    if (parts == 1) return;  // until now every face is a triangle
    faces.resize(mesh_.triangles.size() - parts);
    std::iota(faces.begin(), faces.end(), 0);
  }
  faces.resize(mesh_.triangles.size(), faces.empty() ? 0 : faces.back() + 1);
}

void ElementCollector::fail_unknown(std::int64_t number) const {
  cursor_.fail(fmt::format("an element uses vertex {}, but {}", number, numbers_.describe()),
               "mend the element or add the vertex");
}

void ElementCollector::fail_repeated(std::string_view element, Index vertex) const {
  cursor_.fail(fmt::format("a {} uses one vertex twice (vertex {} from 0)", element, vertex), "remove the element");
}

void fail_unsupported(const Cursor& cursor, std::string_view element, int type) {
  cursor.fail(
      fmt::format("the element is a {} (type {}): only triangles, polygons and tetrahedra are read", element, type),
      "split it into tetrahedra of four vertices in your mesher");
}

void add_vtk_cell(ElementCollector& collector, int type, std::span<const Index> vertices) {
  const auto expect = [&](std::size_t count) {
    if (vertices.size() == count) return;
    collector.cursor().fail(
        fmt::format("a cell of type {} has {} vertices instead of {}", type, vertices.size(), count),
        "export the file again");
  };
  switch (type) {
    case 0:
    case 1:
    case 2:
    case 3:
    case 4:
    case 21:
      return;  // empty, vertices, lines
    case 5:
      expect(3);
      return collector.add_triangle(vertices[0], vertices[1], vertices[2]);
    case 6:
      return collector.add_strip(vertices);
    case 7:
      return collector.add_polygon(vertices);
    case 8: {
      expect(4);
      const std::array<Index, 4> quad = {vertices[0], vertices[1], vertices[3], vertices[2]};
      return collector.add_polygon(quad);
    }
    case 9:
      expect(4);
      return collector.add_polygon(vertices);
    case 10:
      expect(4);
      return collector.add_tetrahedron(vertices[0], vertices[1], vertices[2], vertices[3]);
    case 11:
      fail_unsupported(collector.cursor(), "voxel", type);
    case 12:
      fail_unsupported(collector.cursor(), "hexahedron", type);
    case 13:
      fail_unsupported(collector.cursor(), "wedge", type);
    case 14:
      fail_unsupported(collector.cursor(), "pyramid", type);
    case 22:
      fail_unsupported(collector.cursor(), "quadratic triangle", type);
    case 23:
      fail_unsupported(collector.cursor(), "quadratic quadrilateral", type);
    case 24:
      fail_unsupported(collector.cursor(), "quadratic tetrahedron", type);
    case 25:
      fail_unsupported(collector.cursor(), "quadratic hexahedron", type);
    case 42:
      fail_unsupported(collector.cursor(), "polyhedron", type);
    case 69:
      fail_unsupported(collector.cursor(), "Lagrange triangle", type);
    case 71:
      fail_unsupported(collector.cursor(), "Lagrange tetrahedron", type);
    default:
      fail_unsupported(collector.cursor(), "VTK cell", type);
  }
}

}  // namespace selvage::format
