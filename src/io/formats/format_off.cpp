// Geomview OFF: ASCII and BINARY; normals, colours and texture coordinates are passed over.
#include "io/format_elements.h"
#include "io/format_printer.h"

#include <fmt/format.h>

namespace selvage::format {

namespace {

/// Reads a header keyword such as OFF, COFF or STCNOFF; how many floats follow a binary vertex's coordinates.
int read_keyword(Cursor& cursor) {
  std::string_view keyword = cursor.token();
  int extra_floats = 0;
  const auto take = [&](std::string_view letters, int floats) {
    if (!keyword.starts_with(letters)) return;
    keyword.remove_prefix(letters.size());
    extra_floats += floats;
  };
  const std::string_view whole = keyword;
  take("ST", 2);
  take("C", 4);
  take("N", 3);
  if (keyword != "OFF") {
    cursor.fail(fmt::format("expected OFF (or COFF, NOFF, STOFF), found {}", quote(whole)),
                "give a three-dimensional OFF file");
  }
  return extra_floats;
}

void parse_ascii(Cursor& cursor, IndexedMesh& mesh) {
  const auto count = [&](std::string_view what) {
    // The counts may stand on the line of the keyword or on later ones.
    if (!cursor.next_filled_line()) cursor.fail_expected(fmt::format("the number of {}", what));
    return cursor.integer(fmt::format("the number of {}", what));
  };
  const std::int64_t vertices = count("vertices");
  const std::int64_t faces = count("faces");
  cursor.next_line();  // with the number of edges, which nobody needs
  cursor.check_count(vertices, "vertices", 6);
  mesh.positions.reserve(static_cast<std::size_t>(vertices));
  for (std::int64_t i = 0; i < vertices; ++i, cursor.next_line()) {
    cursor.next_filled_line();
    mesh.positions.push_back(cursor.point());
  }
  cursor.check_count(faces, "faces", 4);
  mesh.triangles.reserve(static_cast<std::size_t>(faces));
  const VertexNumbers numbers(0, vertices);
  ElementCollector collector(cursor, mesh, numbers);
  std::vector<Index> polygon;
  for (std::int64_t i = 0; i < faces; ++i, cursor.next_line()) {
    cursor.next_filled_line();
    polygon.resize(static_cast<std::size_t>(cursor.count("vertices of a face", 2)));
    for (Index& v : polygon) v = collector.vertex(cursor.integer("a vertex number"));
    collector.add_polygon(polygon);
  }
}

void parse_binary(Cursor& cursor, int extra_floats, IndexedMesh& mesh) {
  cursor.enter_binary(std::endian::big);
  const std::int64_t vertices = cursor.binary<std::int32_t>("the number of vertices");
  const std::int64_t faces = cursor.binary<std::int32_t>("the number of faces");
  cursor.binary<std::int32_t>("the number of edges");
  const auto extra = 4 * static_cast<std::size_t>(extra_floats);
  cursor.check_count(vertices, "vertices", 12 + extra);
  mesh.positions.reserve(static_cast<std::size_t>(vertices));
  for (std::int64_t i = 0; i < vertices; ++i) {
    mesh.positions.push_back(cursor.binary_point<float>());
    cursor.bytes(extra, "the rest of a vertex");
  }
  cursor.check_count(faces, "faces", 8);
  mesh.triangles.reserve(static_cast<std::size_t>(faces));
  const VertexNumbers numbers(0, vertices);
  ElementCollector collector(cursor, mesh, numbers);
  std::vector<Index> polygon;
  for (std::int64_t i = 0; i < faces; ++i) {
    const std::int64_t size = cursor.binary<std::int32_t>("the size of a face");
    cursor.check_count(size, "vertices of a face", 4);
    polygon.resize(static_cast<std::size_t>(size));
    for (Index& v : polygon) v = collector.vertex(cursor.binary<std::int32_t>("a vertex number"));
    collector.add_polygon(polygon);
    const std::int64_t colours = cursor.binary<std::int32_t>("the number of colour components");
    cursor.check_count(colours, "colour components", 4);
    cursor.bytes(4 * static_cast<std::size_t>(colours), "a colour");
  }
}

std::string print_binary_off(const IndexedMesh& mesh) {
  Printer out(std::endian::big);
  out.text("OFF BINARY\n");
  out.binary(static_cast<std::int32_t>(mesh.positions.size())).binary(static_cast<std::int32_t>(mesh.triangles.size()));
  out.binary(std::int32_t{0});  // edges
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) out.floats(mesh.positions[v], static_cast<Index>(v));
  for (const auto& triangle : mesh.triangles) {
    out.binary(std::int32_t{3});
    for (const Index v : triangle) out.binary(v);
    out.binary(std::int32_t{0});  // colour components
  }
  return out.take();
}

}  // namespace

IndexedMesh parse_off(const Source& source) {
  Cursor cursor(source, '#');
  cursor.bind_to_lines(true);
  cursor.next_filled_line();
  const int extra_floats = read_keyword(cursor);
  IndexedMesh mesh;
  if (cursor.peek() == "BINARY") {
    cursor.next_line();
    parse_binary(cursor, extra_floats, mesh);
  } else {
    parse_ascii(cursor, mesh);
  }
  return mesh;
}

std::string print_off(const IndexedMesh& mesh, FileEncoding encoding) {
  if (encoding == FileEncoding::kBinary) return print_binary_off(mesh);
  Printer out;
  out.text("OFF\n").number(mesh.positions.size()).text(" ").number(mesh.triangles.size()).text(" 0\n");
  for (const Vec3& p : mesh.positions) out.numbers(p).text("\n");
  for (const auto& triangle : mesh.triangles) out.text("3 ").element(triangle, 0).text("\n");
  return out.take();
}

}  // namespace selvage::format
