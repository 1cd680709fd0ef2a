// Lines "Vertex ID X Y Z" and "Tet ID A B C D", in any order; vertices keep the order of the file whatever their ids.
#include "io/format_elements.h"
#include "io/format_printer.h"
#include "selvage/core/error.h"

#include <fmt/format.h>

namespace selvage::format {

namespace {

VertexNumbers read_vertices(const Source& source, IndexedMesh& mesh) {
  Cursor cursor(source, '#');
  cursor.bind_to_lines(true);
  VertexNumbers numbers;
  for (; cursor.next_filled_line(); cursor.next_line()) {
    const std::string_view keyword = cursor.token();
    if (keyword == "Vertex") {
      numbers.add(cursor.integer("a vertex id"));
      mesh.positions.push_back(cursor.point());
    } else if (keyword != "Tet") {
      cursor.fail(fmt::format("expected 'Vertex' or 'Tet', found {}", quote(keyword)),
                  "lines are 'Vertex ID X Y Z' or 'Tet ID A B C D'");
    }
  }
  if (const auto [twice, number] = numbers.finish(); twice) {
    throw Error(source.name, fmt::format("vertex id {} is given twice", number), "give every vertex its own id");
  }
  return numbers;
}

}  // namespace

IndexedMesh parse_t(const Source& source) {
  IndexedMesh mesh;
  const VertexNumbers numbers = read_vertices(source, mesh);
  Cursor cursor(source, '#');
  cursor.bind_to_lines(true);
  ElementCollector collector(cursor, mesh, numbers);
  for (; cursor.next_filled_line(); cursor.next_line()) {
    if (cursor.token() != "Tet") continue;
    cursor.integer("a tetrahedron id");
    std::array<Index, 4> v;
    for (Index& vertex : v) vertex = collector.vertex(cursor.integer("4 vertex ids"));
    collector.add_tetrahedron(v[0], v[1], v[2], v[3]);
  }
  return mesh;
}

std::string print_t(const IndexedMesh& mesh) {
  Printer out;
  std::int64_t id = 0;
  for (const Vec3& p : mesh.positions) out.text("Vertex ").number(id++).text(" ").numbers(p).text("\n");
  id = 0;
  for (const auto& tet : mesh.tetrahedra) out.text("Tet ").number(id++).text(" ").element(tet, 0).text("\n");
  return out.take();
}

}  // namespace selvage::format
