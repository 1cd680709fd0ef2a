// STL, ASCII and binary. It has no shared vertices: each triangle brings three of its own.
#include "io/format_elements.h"
#include "io/format_printer.h"
#include "selvage/core/error.h"

#include <fmt/format.h>

namespace selvage::format {

namespace {

constexpr std::size_t kHeaderBytes = 80, kTriangleBytes = 50;

/// Binary files may begin with "solid" too: their size tells, or else the absence of facets in the text.
bool is_binary(std::string_view bytes) {
  if (bytes.size() >= kHeaderBytes + 4) {
    std::uint32_t count;
    std::memcpy(&count, bytes.data() + kHeaderBytes, 4);
    if constexpr (std::endian::native == std::endian::big) count = swap_bytes(count);
    if (bytes.size() == kHeaderBytes + 4 + kTriangleBytes * std::uint64_t{count}) return true;
  }
  const std::size_t text = bytes.find_first_not_of(" \t\r\n");
  if (text == std::string_view::npos || !bytes.substr(text).starts_with("solid")) return !bytes.empty();
  constexpr std::size_t kSearched = 4096;
  const std::string_view head = bytes.substr(text, kSearched);
  return head.find('\0') != std::string_view::npos && head.find("facet") == std::string_view::npos;
}

void add_own_triangle(IndexedMesh& mesh) {
  const auto first = static_cast<Index>(mesh.positions.size() - 3);
  mesh.triangles.push_back({first, first + 1, first + 2});
}

void check_room(const Cursor& cursor, std::size_t positions) {
  if (positions + 3 <= static_cast<std::size_t>(std::numeric_limits<Index>::max())) return;
  cursor.fail("the file has more triangles than 32-bit indices can number", "split the mesh into several files");
}

IndexedMesh parse_binary(const Source& source) {
  Cursor cursor(source);
  cursor.enter_binary(std::endian::little);
  cursor.bytes(kHeaderBytes, "the header");
  const std::int64_t count = cursor.binary<std::uint32_t>("the number of triangles");
  cursor.check_count(count, "triangles", kTriangleBytes);
  IndexedMesh mesh;
  mesh.triangles.reserve(static_cast<std::size_t>(count));
  mesh.positions.reserve(3 * static_cast<std::size_t>(count));
  for (std::int64_t i = 0; i < count; ++i) {
    check_room(cursor, mesh.positions.size());
    cursor.bytes(12, "a normal");
    for (int v = 0; v < 3; ++v) mesh.positions.push_back(cursor.binary_point<float>());
    cursor.bytes(2, "the attribute of a triangle");
    add_own_triangle(mesh);
  }
  return mesh;
}

void expect(Cursor& cursor, std::string_view word) {
  if (cursor.peek() != word) cursor.fail_expected(fmt::format("'{}'", word));
  cursor.token();
}

void parse_facet(Cursor& cursor, IndexedMesh& mesh) {
  expect(cursor, "normal");
  for (int d = 0; d < 3; ++d) cursor.real("a normal");
  expect(cursor, "outer");
  expect(cursor, "loop");
  check_room(cursor, mesh.positions.size());
  for (int v = 0; v < 3; ++v) {
    expect(cursor, "vertex");
    mesh.positions.push_back(cursor.point());
  }
  expect(cursor, "endloop");
  expect(cursor, "endfacet");
  add_own_triangle(mesh);
}

IndexedMesh parse_ascii(const Source& source) {
  Cursor cursor(source);
  IndexedMesh mesh;
  while (!cursor.peek().empty()) {
    expect(cursor, "solid");
    cursor.line();
    while (cursor.peek() == "facet") {
      cursor.token();
      parse_facet(cursor, mesh);
    }
    if (cursor.peek() != "endsolid") cursor.fail_expected("'facet' or 'endsolid'");
    cursor.line();
  }
  return mesh;
}

/// Unit normal, zero for a triangle without area.
Vec3 normal_of(const IndexedMesh& mesh, const VertexTuple<3>& t) {
  const Vec3& a = mesh.positions[t[0]];
  const Vec3 u = mesh.positions[t[1]] - a, v = mesh.positions[t[2]] - a;
  const Vec3 normal(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]);
  const double length = normal.norm();
  return length > 0 && std::isfinite(length) ? Vec3(normal / length) : Vec3(0, 0, 0);
}

std::string print_binary_stl(const IndexedMesh& mesh) {
  Printer out;
  out.reserve(kHeaderBytes + 4 + kTriangleBytes * mesh.triangles.size());
  std::string header = "binary STL";
  header.resize(kHeaderBytes, ' ');
  out.text(header).binary(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& triangle : mesh.triangles) {
    for (const double x : normal_of(mesh, triangle)) out.binary(static_cast<float>(x));
    for (const Index v : triangle) out.floats(mesh.positions[v], v);
    out.binary(std::uint16_t{0});
  }
  return out.take();
}

}  // namespace

IndexedMesh parse_stl(const Source& source) {
  return is_binary(source.bytes) ? parse_binary(source) : parse_ascii(source);
}

std::string print_stl(const IndexedMesh& mesh, FileEncoding encoding) {
  if (encoding == FileEncoding::kBinary) return print_binary_stl(mesh);
  Printer out;
  out.text("solid selvage\n");
  for (const auto& triangle : mesh.triangles) {
    out.text("facet normal ").numbers(normal_of(mesh, triangle)).text("\nouter loop\n");
    for (const Index v : triangle) out.text("vertex ").numbers(mesh.positions[v]).text("\n");
    out.text("endloop\nendfacet\n");
  }
  out.text("endsolid selvage\n");
  return out.take();
}

}  // namespace selvage::format
