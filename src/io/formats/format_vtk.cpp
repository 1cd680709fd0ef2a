// VTK legacy files, versions 2 to 5, ASCII and binary: UNSTRUCTURED_GRID and POLYDATA.
#include "io/format_elements.h"
#include "io/format_printer.h"

#include <fmt/format.h>

#include <algorithm>

namespace selvage::format {

namespace {

class VtkReader {
 public:
  explicit VtkReader(const Source& source) : cursor_(source) {}

  IndexedMesh read() {
    read_header();
    for (std::string_view keyword = cursor_.token(); !keyword.empty(); keyword = cursor_.token()) {
      // Next are values on points and cells, behind the whole mesh.
      if (keyword == "POINT_DATA" || keyword == "CELL_DATA") break;
      read_section(keyword);
    }
    add_cells();
    return std::move(mesh_);
  }

 private:
  void read_header() {
    if (!cursor_.line().starts_with("# vtk DataFile Version")) {
      cursor_.fail("the file does not begin with '# vtk DataFile Version'",
                   "give a legacy VTK file, or rename the file");
    }
    cursor_.line();  // title
    const std::string_view encoding = cursor_.peek();
    if (encoding != "ASCII" && encoding != "BINARY") cursor_.fail_expected("ASCII or BINARY");
    cursor_.token();
    if (encoding == "BINARY") cursor_.enter_binary(std::endian::big);
    if (cursor_.peek() != "DATASET") cursor_.fail_expected("'DATASET'");
    cursor_.token();
    const std::string_view dataset = cursor_.token();
    if (dataset != "UNSTRUCTURED_GRID" && dataset != "POLYDATA") {
      cursor_.fail(fmt::format("the dataset {} is not read", quote(dataset)),
                   "save it as UNSTRUCTURED_GRID or POLYDATA");
    }
  }

  void read_section(std::string_view keyword) {
    if (keyword == "POINTS") return read_points();
    if (keyword == "CELLS") return read_connectivity(-1);
    if (keyword == "VERTICES") return read_connectivity(2);
    if (keyword == "LINES") return read_connectivity(4);
    if (keyword == "TRIANGLE_STRIPS") return read_connectivity(6);
    if (keyword == "POLYGONS") return read_connectivity(7);
    if (keyword == "CELL_TYPES") return read_types();
    if (keyword == "FIELD") return skip_field();
    if (keyword == "METADATA") return skip_metadata();
    cursor_.fail(fmt::format("unknown section {}", quote(keyword)),
                 "a count before it may be wrong; export the file again");
  }

  Scalar read_type() {
    constexpr std::pair<std::string_view, Scalar> kTypes[] = {{"float", Scalar::kFloat},
                                                              {"double", Scalar::kDouble},
                                                              {"int", Scalar::kInt32},
                                                              {"unsigned_int", Scalar::kUint32},
                                                              {"vtkIdType", Scalar::kInt32},
                                                              {"vtktypeint32", Scalar::kInt32},
                                                              {"vtktypeuint32", Scalar::kUint32},
                                                              {"long", Scalar::kInt64},
                                                              {"unsigned_long", Scalar::kUint64},
                                                              {"vtktypeint64", Scalar::kInt64},
                                                              {"vtktypeuint64", Scalar::kUint64},
                                                              {"short", Scalar::kInt16},
                                                              {"unsigned_short", Scalar::kUint16},
                                                              {"char", Scalar::kInt8},
                                                              {"signed_char", Scalar::kInt8},
                                                              {"unsigned_char", Scalar::kUint8}};
    const std::string_view token = cursor_.peek();
    for (const auto& [name, type] : kTypes) {
      if (token == name) {
        cursor_.token();
        return type;
      }
    }
    cursor_.fail_expected("a data type such as float, double, int or vtktypeint64");
  }

  /// In a binary file the values begin behind the end of the line.
  void begin_values() {
    if (cursor_.is_binary()) cursor_.next_line();
  }

  std::vector<std::int64_t> integers(std::int64_t count, Scalar type, std::string_view what) {
    cursor_.check_count(count, what, cursor_.is_binary() ? size_of(type) : 2);
    std::vector<std::int64_t> values(static_cast<std::size_t>(count));
    for (std::int64_t& value : values) value = cursor_.integer(type, what);
    return values;
  }

  void read_points() {
    if (!mesh_.positions.empty()) cursor_.fail("there are two sections POINTS", "save each mesh in a file of its own");
    const std::int64_t count = cursor_.integer("the number of points");
    const Scalar type = read_type();
    begin_values();
    cursor_.check_count(count, "points", cursor_.is_binary() ? 3 * size_of(type) : 6);
    mesh_.positions.reserve(static_cast<std::size_t>(count));
    for (std::int64_t i = 0; i < count; ++i) {
      Vec3 point;
      for (int d = 0; d < 3; ++d) {
        point[d] = cursor_.real(type, "3 coordinates");
        if (!std::isfinite(point[d])) cursor_.fail_not_finite();
      }
      mesh_.positions.push_back(point);
    }
    numbers_ = VertexNumbers(0, count);
  }

  /// Cells of one section; `type` -1: CELL_TYPES will tell.
  void read_connectivity(int type) {
    const std::int64_t first = cursor_.integer("the number of cells");
    const std::int64_t second = cursor_.integer("the size of the cells");
    const std::size_t section_position = cursor_.last_position();
    const std::string_view next = peek_line();
    std::vector<std::int64_t> offsets, vertices;
    if (next.starts_with("OFFSETS")) {
      cursor_.token();
      Scalar scalar = read_type();
      begin_values();
      offsets = integers(first, scalar, "offsets");
      if (cursor_.peek() != "CONNECTIVITY") cursor_.fail_expected("'CONNECTIVITY'");
      cursor_.token();
      scalar = read_type();
      begin_values();
      vertices = integers(second, scalar, "connectivity");
    } else {
      begin_values();
      split_counted(integers(second, Scalar::kInt32, "cell entries"), first, offsets, vertices);
    }
    const bool of_grid = type < 0;
    if (of_grid) {
      if (!grid_offsets_.empty()) cursor_.fail("there are two sections CELLS", "save each mesh in a file of its own");
      grid_offsets_ = std::move(offsets);
      grid_vertices_ = std::move(vertices);
      grid_position_ = section_position;
      return;
    }
    add(offsets, vertices, [&](std::size_t) { return type; });
  }

  /// The next line without consuming it, where text follows; binary values are no text.
  std::string_view peek_line() {
    Cursor ahead = cursor_;
    ahead.next_line();
    return ahead.peek();
  }

  /// Version 4 and before: each cell's vertices behind their number.
  void split_counted(const std::vector<std::int64_t>& entries, std::int64_t cells, std::vector<std::int64_t>& offsets,
                     std::vector<std::int64_t>& vertices) {
    cursor_.check_count(cells, "cells", 0);
    offsets.push_back(0);
    std::size_t at = 0;
    for (std::int64_t c = 0; c < cells; ++c) {
      const std::int64_t size = at < entries.size() ? entries[at++] : -1;
      if (size < 0 || static_cast<std::size_t>(size) > entries.size() - at) {
        cursor_.fail(fmt::format("cell {} does not fit in the {} entries of its section", c, entries.size()),
                     "export the file again");
      }
      vertices.insert(vertices.end(), entries.begin() + at, entries.begin() + at + size);
      at += static_cast<std::size_t>(size);
      offsets.push_back(std::ssize(vertices));
    }
  }

  void read_types() {
    const std::int64_t count = cursor_.integer("the number of cell types");
    begin_values();
    types_ = integers(count, Scalar::kInt32, "cell types");
  }

  void add_cells() {
    if (grid_offsets_.empty()) return;
    const std::size_t cells = grid_offsets_.size() - 1;
    if (types_.size() != cells) {
      cursor_.fail(fmt::format("{} cells have {} types", cells, types_.size()),
                   "the file is cut short; export it again");
    }
    cursor_.move_to(grid_position_);
    add(grid_offsets_, grid_vertices_,
        [&](std::size_t c) { return static_cast<int>(std::clamp<std::int64_t>(types_[c], -1, 1000)); });
  }

  template <typename TypeOf>
  void add(const std::vector<std::int64_t>& offsets, const std::vector<std::int64_t>& vertices, TypeOf type_of) {
    ElementCollector collector(cursor_, mesh_, numbers_);
    std::vector<Index> cell;
    for (std::size_t c = 0; c + 1 < offsets.size(); ++c) {
      if (offsets[c] < 0 || offsets[c + 1] < offsets[c] || offsets[c + 1] > std::ssize(vertices)) {
        cursor_.fail(fmt::format("the offsets of cell {} are out of order or range", c), "export the file again");
      }
      cell.clear();
      for (std::int64_t i = offsets[c]; i < offsets[c + 1]; ++i) cell.push_back(collector.vertex(vertices[i]));
      add_vtk_cell(collector, type_of(c), cell);
    }
  }

  /// Arrays of the whole data set, such as its time.
  void skip_field() {
    cursor_.token();
    const std::int64_t arrays = cursor_.count("field arrays", 4);
    for (std::int64_t a = 0; a < arrays; ++a) {
      if (cursor_.peek() == "METADATA") {
        cursor_.token();
        skip_metadata();
      }
      if (cursor_.token().empty()) cursor_.fail_expected("a field's name");
      const std::int64_t components = cursor_.count("components", 0);
      const std::int64_t tuples = cursor_.count("tuples", 0);
      if (cursor_.peek() == "string") {
        skip_strings(components, tuples);
        continue;
      }
      const Scalar type = read_type();
      begin_values();
      const std::size_t each = static_cast<std::size_t>(components) * (cursor_.is_binary() ? size_of(type) : 2);
      cursor_.check_count(tuples, "tuples", each);
      if (cursor_.is_binary()) {
        cursor_.bytes(static_cast<std::size_t>(tuples) * each, "a field");
      } else {
        for (std::int64_t i = 0; components > 0 && i < tuples * components; ++i) cursor_.real("a field's value");
      }
    }
  }

  /// Strings, one a line; in a binary file each behind its length, whose first two bits tell how many bytes it takes.
  void skip_strings(std::int64_t components, std::int64_t tuples) {
    cursor_.next_line();
    if (components > 0) cursor_.check_count(tuples, "strings", static_cast<std::size_t>(components));
    for (std::int64_t i = 0; components > 0 && i < tuples * components; ++i) {
      if (!cursor_.is_binary()) {
        if (cursor_.remaining() == 0) cursor_.fail_expected("a string");
        cursor_.line();
        continue;
      }
      const std::string_view rest = cursor_.bytes(0, "a string");
      const int width = cursor_.remaining() == 0 ? 1 : 8 >> (static_cast<unsigned char>(*rest.data()) >> 6);
      std::uint64_t length = 0;
      for (const char c : cursor_.bytes(static_cast<std::size_t>(width), "a string's length")) {
        length = length << 8 | static_cast<unsigned char>(c);
      }
      cursor_.bytes(length & (~std::uint64_t{0} >> (66 - 8 * width)), "a string");
    }
  }

  /// Lines up to an empty one.
  void skip_metadata() {
    cursor_.line();
    while (cursor_.remaining() > 0 && !cursor_.line().empty()) {
    }
  }

  Cursor cursor_;
  IndexedMesh mesh_;
  VertexNumbers numbers_;
  std::vector<std::int64_t> grid_offsets_, grid_vertices_, types_;
  std::size_t grid_position_ = 0;
};

template <std::size_t N>
void print_cells(Printer& out, const std::vector<VertexTuple<N>>& elements, bool binary) {
  for (const auto& element : elements) {
    if (binary) {
      out.binary(static_cast<std::int32_t>(N));
      for (const Index v : element) out.binary(v);
    } else {
      out.number(N).text(" ").element(element, 0).text("\n");
    }
  }
}

void print_types(Printer& out, std::int32_t type, std::size_t count, bool binary) {
  for (std::size_t i = 0; i < count; ++i) {
    if (binary) {
      out.binary(type);
    } else {
      out.number(type).text("\n");
    }
  }
}

}  // namespace

IndexedMesh parse_vtk(const Source& source) {
  return VtkReader(source).read();
}

std::string print_vtk(const IndexedMesh& mesh, FileEncoding encoding) {
  const bool binary = encoding == FileEncoding::kBinary;
  Printer out(std::endian::big);
  // Version 3, which every reader knows.
  out.text("# vtk DataFile Version 3.0\nselvage\n")
      .text(binary ? "BINARY" : "ASCII")
      .text("\nDATASET UNSTRUCTURED_GRID\nPOINTS ");
  out.number(mesh.positions.size()).text(" double\n");
  for (const Vec3& p : mesh.positions) {
    if (!binary) out.numbers(p).text("\n");
    for (int d = 0; binary && d < 3; ++d) out.binary(p[d]);
  }
  const std::size_t triangles = mesh.triangles.size(), tetrahedra = mesh.tetrahedra.size();
  out.text(binary ? "\nCELLS " : "CELLS ")
      .number(triangles + tetrahedra)
      .text(" ")
      .number(4 * triangles + 5 * tetrahedra)
      .text("\n");
  print_cells(out, mesh.triangles, binary);
  print_cells(out, mesh.tetrahedra, binary);
  out.text(binary ? "\nCELL_TYPES " : "CELL_TYPES ").number(triangles + tetrahedra).text("\n");
  print_types(out, 5, triangles, binary);
  print_types(out, 10, tetrahedra, binary);
  if (binary) out.text("\n");
  return out.take();
}

}  // namespace selvage::format
