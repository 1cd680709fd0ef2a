// TetGen .node and .ele (and Triangle's, in the plane): numbered from 0 or 1, with attributes, markers and comments.
#include "io/format_elements.h"
#include "io/format_printer.h"

#include <fmt/format.h>

namespace selvage::format {

namespace {

/// Goes to the next line that has a token.
void next_row(Cursor& cursor, std::string_view what) {
  if (!cursor.next_filled_line()) cursor.fail_expected(what);
}

/// First line: number of rows, and what stands in each.
std::pair<std::int64_t, std::int64_t> read_header(Cursor& cursor, std::string_view rows, std::string_view second) {
  next_row(cursor, fmt::format("the number of {}", rows));
  const std::int64_t count = cursor.integer(fmt::format("the number of {}", rows));
  const std::int64_t kind = cursor.integer(second);
  cursor.next_line();
  return {count, kind};
}

VertexNumbers read_nodes(const Source& source, IndexedMesh& mesh) {
  Cursor cursor(source, '#');
  cursor.bind_to_lines(true);
  const auto [count, dimension] = read_header(cursor, "nodes", "the dimension, 2 or 3");
  if (dimension != 2 && dimension != 3)
    cursor.fail(fmt::format("the dimension is {} instead of 2 or 3", dimension), "export the file again");
  cursor.check_count(count, "nodes", 6);
  mesh.positions.reserve(static_cast<std::size_t>(count));
  VertexNumbers numbers;
  for (std::int64_t i = 0; i < count; ++i, cursor.next_line()) {
    next_row(cursor, "a node");
    numbers.add(cursor.integer("a node number"));
    const double x = cursor.coordinate();
    const double y = cursor.coordinate();
    mesh.positions.push_back({x, y, dimension == 3 ? cursor.coordinate() : 0.0});
  }
  if (const auto [twice, number] = numbers.finish(); twice) {
    cursor.fail(fmt::format("node number {} is given twice", number), "give every node its own number");
  }
  return numbers;
}

}  // namespace

IndexedMesh parse_tetgen(const Source& nodes, const Source& elements) {
  IndexedMesh mesh;
  const VertexNumbers numbers = read_nodes(nodes, mesh);
  Cursor cursor(elements, '#');
  cursor.bind_to_lines(true);
  const auto [count, corners] = read_header(cursor, "elements", "the number of nodes of an element");
  if (corners != 3 && corners != 4) {
    cursor.fail(fmt::format("elements have {} nodes instead of 4 (or 3, triangles)", corners),
                "run TetGen without -o2");
  }
  cursor.check_count(count, "elements", 8);
  ElementCollector collector(cursor, mesh, numbers);
  for (std::int64_t i = 0; i < count; ++i, cursor.next_line()) {
    next_row(cursor, "an element");
    cursor.integer("an element number");
    std::array<Index, 4> v{};
    for (std::int64_t c = 0; c < corners; ++c) v[c] = collector.vertex(cursor.integer("a node number"));
    if (corners == 3) {
      collector.add_triangle(v[0], v[1], v[2]);
    } else {
      collector.add_tetrahedron(v[0], v[1], v[2], v[3]);
    }
  }
  return mesh;
}

std::string print_tetgen_nodes(const IndexedMesh& mesh) {
  Printer out;
  out.number(mesh.positions.size()).text(" 3 0 0\n");
  std::int64_t number = 0;
  for (const Vec3& p : mesh.positions) out.number(number++).text(" ").numbers(p).text("\n");
  return out.take();
}

std::string print_tetgen_elements(const IndexedMesh& mesh) {
  Printer out;
  out.number(mesh.tetrahedra.size()).text(" 4 0\n");
  std::int64_t number = 0;
  for (const auto& tet : mesh.tetrahedra) out.number(number++).text(" ").element(tet, 0).text("\n");
  return out.take();
}

}  // namespace selvage::format
