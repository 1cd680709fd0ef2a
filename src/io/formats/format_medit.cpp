// MEDIT .mesh, ASCII: vertices, triangles, quadrilaterals and tetrahedra; other sections are passed over.
#include "io/format_elements.h"
#include "io/format_printer.h"

#include <fmt/format.h>

#include <algorithm>

namespace selvage::format {

namespace {

class MeditReader {
 public:
  explicit MeditReader(const Source& source) : cursor_(source, '#'), collector_(cursor_, mesh_, numbers_) {}

  IndexedMesh read() {
    if (cursor_.peek() != "MeshVersionFormatted") cursor_.fail_expected("'MeshVersionFormatted'");
    cursor_.token();
    cursor_.integer("a version");
    for (std::string_view keyword = cursor_.token(); !keyword.empty() && keyword != "End"; keyword = cursor_.token()) {
      read_section(keyword);
    }
    return std::move(mesh_);
  }

 private:
  void read_section(std::string_view keyword) {
    if (keyword == "Dimension") {
      dimension_ = cursor_.integer("the dimension, 2 or 3");
      if (dimension_ != 2 && dimension_ != 3)
        cursor_.fail(fmt::format("the dimension is {} instead of 2 or 3", dimension_), "export the file again");
    } else if (keyword == "Vertices") {
      read_vertices();
    } else if (keyword == "Triangles") {
      read_elements<3>("triangles", [&](const auto& v) { collector_.add_triangle(v[0], v[1], v[2]); });
    } else if (keyword == "Quadrilaterals") {
      read_elements<4>("quadrilaterals", [&](const auto& v) { collector_.add_polygon(v); });
    } else if (keyword == "Tetrahedra") {
      read_elements<4>("tetrahedra", [&](const auto& v) { collector_.add_tetrahedron(v[0], v[1], v[2], v[3]); });
    } else {
      skip_section(keyword);
    }
  }

  void read_vertices() {
    if (numbers_.count() > 0) cursor_.fail("there are two sections Vertices", "save each mesh in a file of its own");
    const std::int64_t count = cursor_.count("vertices", 6);
    mesh_.positions.reserve(static_cast<std::size_t>(count));
    for (std::int64_t i = 0; i < count; ++i) {
      const double x = cursor_.coordinate();
      const double y = cursor_.coordinate();
      mesh_.positions.push_back({x, y, dimension_ == 3 ? cursor_.coordinate() : 0.0});
      cursor_.real("a vertex's reference");
    }
    numbers_ = VertexNumbers(1, count);
  }

  template <std::size_t N, typename Add>
  void read_elements(std::string_view what, Add add) {
    const std::int64_t count = cursor_.count(what, 2 * N + 2);
    for (std::int64_t i = 0; i < count; ++i) {
      std::array<Index, N> v;
      for (Index& vertex : v) vertex = collector_.vertex(cursor_.integer("a vertex number"));
      add(v);
      cursor_.integer("an element's reference");
    }
  }

  /// A section that is not needed: its numbers are passed over, up to the next keyword.
  void skip_section(std::string_view keyword) {
    constexpr std::string_view kVolumes[] = {"Hexahedra",    "Prisms",      "Pyramids",
                                             "TetrahedraP2", "TrianglesP2", "HexahedraQ2"};
    const auto is_word = [](std::string_view token) {
      return !token.empty() && ((token[0] >= 'A' && token[0] <= 'Z') || (token[0] >= 'a' && token[0] <= 'z'));
    };
    if (!is_word(keyword))
      cursor_.fail(fmt::format("expected a section's name, found {}", quote(keyword)), "its count may be too small");
    if (std::find(std::begin(kVolumes), std::end(kVolumes), keyword) != std::end(kVolumes)) {
      if (cursor_.integer("a number of elements") == 0) return;
      cursor_.fail(fmt::format("the section {} is not read", keyword),
                   "split its elements into tetrahedra of four vertices");
    }
    while (true) {
      const std::string_view token = cursor_.peek();
      if (token.empty() || is_word(token)) return;
      cursor_.token();
    }
  }

  Cursor cursor_;
  IndexedMesh mesh_;
  VertexNumbers numbers_;
  ElementCollector collector_;
  std::int64_t dimension_ = 3;
};

}  // namespace

IndexedMesh parse_medit(const Source& source) {
  return MeditReader(source).read();
}

std::string print_medit(const IndexedMesh& mesh) {
  Printer out;
  out.text("MeshVersionFormatted 2\nDimension 3\nVertices\n").number(mesh.positions.size()).text("\n");
  for (const Vec3& p : mesh.positions) out.numbers(p).text(" 0\n");
  const auto print = [&](std::string_view keyword, const auto& elements) {
    if (elements.empty()) return;
    out.text(keyword).text("\n").number(elements.size()).text("\n");
    for (const auto& element : elements) out.element(element, 1).text(" 0\n");
  };
  print("Triangles", mesh.triangles);
  print("Tetrahedra", mesh.tetrahedra);
  out.text("End\n");
  return out.take();
}

}  // namespace selvage::format
