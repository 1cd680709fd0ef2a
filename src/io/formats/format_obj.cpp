// Wavefront OBJ: v and f lines; texture, normal, material and group lines are passed over.
#include "io/format_elements.h"
#include "io/format_printer.h"

#include <fmt/format.h>

namespace selvage::format {

namespace {

/// Vertex of a face corner "v", "v/vt", "v//vn" or "v/vt/vn", counted from 0; faces may come before their vertices.
std::int64_t corner_vertex(const Cursor& cursor, std::string_view corner, std::int64_t vertex_count) {
  std::int64_t number = 0;
  const char* end = corner.data() + corner.size();
  const auto [stop, status] = std::from_chars(corner.data(), end, number);
  if (status != std::errc() || (stop != end && *stop != '/')) {
    cursor.fail(fmt::format("expected a vertex number, found {}", quote(corner)),
                "a face lists v, v/vt, v//vn or v/vt/vn");
  }
  if (number > std::numeric_limits<Index>::max() || number == 0 || number < -vertex_count) {
    cursor.fail(fmt::format("a face uses vertex {}, but {} vertices come before it", number, vertex_count),
                "vertices are counted from 1, or backwards from -1");
  }
  return number > 0 ? number - 1 : vertex_count + number;
}

}  // namespace

IndexedMesh parse_obj(const Source& source) {
  Cursor cursor(source, '#');
  cursor.bind_to_lines(true);
  cursor.join_lines_at_backslash();
  IndexedMesh mesh;
  const VertexNumbers unused;
  ElementCollector collector(cursor, mesh, unused);
  std::vector<Index> polygon;
  std::int64_t largest = -1;
  std::size_t largest_position = 0;
  for (; cursor.next_filled_line(); cursor.next_line()) {
    const std::string_view keyword = cursor.token();
    if (keyword == "v") {
      mesh.positions.push_back(cursor.point());
    } else if (keyword == "f") {
      polygon.clear();
      for (std::string_view corner = cursor.token(); !corner.empty(); corner = cursor.token()) {
        const std::int64_t vertex = corner_vertex(cursor, corner, std::ssize(mesh.positions));
        if (vertex > largest) {
          largest = vertex;
          largest_position = cursor.last_position();
        }
        polygon.push_back(static_cast<Index>(vertex));
      }
      collector.add_polygon(polygon);
    }
  }
  if (largest >= std::ssize(mesh.positions)) {
    cursor.move_to(largest_position);
    cursor.fail(fmt::format("a face uses vertex {}, but the file has {} vertices", largest + 1, mesh.positions.size()),
                "mend the face or add the vertex");
  }
  return mesh;
}

std::string print_obj(const IndexedMesh& mesh) {
  Printer out;
  for (const Vec3& p : mesh.positions) out.text("v ").numbers(p).text("\n");
  for (const auto& triangle : mesh.triangles) out.text("f ").element(triangle, 1).text("\n");
  return out.take();
}

}  // namespace selvage::format
