// Stanford PLY: ASCII and binary of both byte orders, any order and type of properties, other elements passed over.
#include "io/format_elements.h"
#include "io/format_printer.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <tuple>

namespace selvage::format {

namespace {

struct Property {
  std::string_view name;
  Scalar type;
  std::optional<Scalar> list_count;  // type of the number of entries, for a list
};

struct Element {
  std::string_view name;
  std::int64_t count;
  std::vector<Property> properties;

  int property(std::string_view wanted) const {
    for (std::size_t i = 0; i < properties.size(); ++i) {
      if (properties[i].name == wanted) return static_cast<int>(i);
    }
    return -1;
  }
};

Scalar read_type(Cursor& cursor) {
  constexpr std::tuple<std::string_view, std::string_view, Scalar> kTypes[] = {
      {"char", "int8", Scalar::kInt8},       {"uchar", "uint8", Scalar::kUint8},    {"short", "int16", Scalar::kInt16},
      {"ushort", "uint16", Scalar::kUint16}, {"int", "int32", Scalar::kInt32},      {"uint", "uint32", Scalar::kUint32},
      {"float", "float32", Scalar::kFloat},  {"double", "float64", Scalar::kDouble}};
  const std::string_view token = cursor.peek();
  for (const auto& [name, with_size, type] : kTypes) {
    if (token == name || token == with_size) {
      cursor.token();
      return type;
    }
  }
  cursor.fail_expected("a property type (char, uchar, short, ushort, int, uint, float or double)");
}

class PlyReader {
 public:
  explicit PlyReader(const Source& source) : cursor_(source) { cursor_.bind_to_lines(true); }

  IndexedMesh read() {
    read_header();
    const auto vertices =
        std::find_if(elements_.begin(), elements_.end(), [](const Element& e) { return e.name == "vertex"; });
    if (vertices == elements_.end()) cursor_.fail("the header lists no element 'vertex'", "export the file again");
    numbers_ = VertexNumbers(0, vertices->count);
    for (const Element& element : elements_) {
      cursor_.check_count(element.count, fmt::format("elements '{}'", element.name), least_size(element));
      if (element.name == "vertex") {
        read_vertices(element);
      } else if (element.name == "face") {
        read_faces(element);
      } else {
        skip(element);
      }
    }
    return std::move(mesh_);
  }

 private:
  void read_header() {
    if (cursor_.token() != "ply")
      cursor_.fail("the file does not begin with 'ply'", "give a PLY file, or rename the file");
    cursor_.next_line();
    std::endian order = std::endian::native;
    bool binary = false, has_format = false;
    while (true) {
      if (!cursor_.next_filled_line()) cursor_.fail_expected("'end_header'");
      const std::string_view keyword = cursor_.token();
      if (keyword == "format") {
        const std::string_view format = cursor_.peek();
        binary = format != "ascii";
        order = format == "binary_big_endian" ? std::endian::big : std::endian::little;
        if (binary && format != "binary_little_endian" && format != "binary_big_endian") {
          cursor_.fail_expected("ascii, binary_little_endian or binary_big_endian");
        }
        has_format = true;
      } else if (keyword == "element") {
        const std::string_view name = cursor_.token();
        elements_.push_back({name, cursor_.integer("the number of elements"), {}});
      } else if (keyword == "property") {
        read_property();
      } else if (keyword == "end_header") {
        break;
      } else if (keyword != "comment" && keyword != "obj_info") {
        cursor_.fail(fmt::format("unknown header line {}", quote(keyword)), "export the file again");
      }
      cursor_.next_line();
    }
    if (!has_format) cursor_.fail("the header has no 'format' line", "export the file again");
    cursor_.next_line();
    if (binary) cursor_.enter_binary(order);
  }

  void read_property() {
    if (elements_.empty()) cursor_.fail("a property comes before any element", "export the file again");
    std::optional<Scalar> list_count;
    if (cursor_.peek() == "list") {
      cursor_.token();
      list_count = read_type(cursor_);
    }
    const Scalar type = read_type(cursor_);
    elements_.back().properties.push_back({cursor_.token(), type, list_count});
  }

  std::size_t least_size(const Element& element) const {
    std::size_t size = 0;
    for (const Property& p : element.properties) {
      size += cursor_.is_binary() ? size_of(p.list_count.value_or(p.type)) : 2;
    }
    return size;
  }

  std::int64_t read_list_count(const Property& p) {
    const std::int64_t count = cursor_.integer(*p.list_count, "the length of a list");
    cursor_.check_count(count, "list entries", cursor_.is_binary() ? size_of(p.type) : 2);
    return count;
  }

  void skip(const Property& p) {
    const std::int64_t count = p.list_count ? read_list_count(p) : 1;
    if (cursor_.is_binary()) {
      cursor_.bytes(static_cast<std::size_t>(count) * size_of(p.type), p.name);
    } else {
      for (std::int64_t i = 0; i < count; ++i) cursor_.real(p.name);
    }
  }

  void skip(const Element& element) {
    if (element.properties.empty()) return;
    for (std::int64_t i = 0; i < element.count; ++i) {
      begin_element(element);
      for (const Property& p : element.properties) skip(p);
      end_element();
    }
  }

  void begin_element(const Element& element) {
    if (!cursor_.is_binary() && !cursor_.next_filled_line())
      cursor_.fail_expected(fmt::format("an element '{}'", element.name));
  }

  void end_element() {
    if (!cursor_.is_binary()) cursor_.next_line();
  }

  void read_vertices(const Element& element) {
    std::vector<int> axes(element.properties.size(), -1);
    const std::string_view names[] = {"x", "y", "z"};
    for (int d = 0; d < 3; ++d) {
      const int at = element.property(names[d]);
      if (at < 0 || element.properties[at].list_count) {
        cursor_.fail(fmt::format("the element 'vertex' has no number '{}'", names[d]),
                     "export the file again with x, y and z");
      }
      axes[at] = d;
    }
    mesh_.positions.reserve(static_cast<std::size_t>(element.count));
    for (std::int64_t i = read_plain_vertices(element, axes); i < element.count; ++i) {
      begin_element(element);
      Vec3 point;
      for (std::size_t p = 0; p < axes.size(); ++p) {
        if (axes[p] < 0) {
          skip(element.properties[p]);
          continue;
        }
        point[axes[p]] = cursor_.real(element.properties[p].type, "3 coordinates");
        if (!std::isfinite(point[axes[p]])) cursor_.fail_not_finite();
      }
      mesh_.positions.push_back(point);
      end_element();
    }
  }

  /// Reads vertices that are rows of equal length, until one is not as it should be. Returns how many.
  std::int64_t read_plain_vertices(const Element& element, std::span<const int> axes) {
    std::size_t row = 0, offsets[3] = {};
    std::optional<Scalar> type;
    for (std::size_t p = 0; p < axes.size(); ++p) {
      const Property& property = element.properties[p];
      if (property.list_count || (axes[p] >= 0 && type.value_or(property.type) != property.type)) return 0;
      if (axes[p] >= 0) {
        type = property.type;
        offsets[axes[p]] = row;
      }
      row += size_of(property.type);
    }
    if (!cursor_.is_native() || cursor_.rest().size() / row < static_cast<std::size_t>(element.count)) return 0;
    if (type == Scalar::kDouble) return read_rows<double>(element.count, row, offsets);
    return type == Scalar::kFloat ? read_rows<float>(element.count, row, offsets) : 0;
  }

  template <typename T>
  std::int64_t read_rows(std::int64_t count, std::size_t row, const std::size_t (&offsets)[3]) {
    const char* const rows = cursor_.rest().data();
    std::int64_t done = 0;
    for (; done < count; ++done) {
      T x[3];
      for (int d = 0; d < 3; ++d)
        std::memcpy(x + d, rows + static_cast<std::size_t>(done) * row + offsets[d], sizeof(T));
      const Vec3 point(x[0], x[1], x[2]);
      if (!point.allFinite()) break;
      mesh_.positions.push_back(point);
    }
    cursor_.bytes(static_cast<std::size_t>(done) * row, "vertices");
    return done;
  }

  /// Reads faces that are three 32-bit numbers behind a byte, until one is something else. Returns how many.
  std::int64_t read_plain_triangles(const Element& element) {
    const Property& list = element.properties[0];
    if (element.properties.size() != 1 || list.list_count != Scalar::kUint8 || !cursor_.is_native()) return 0;
    if (list.type != Scalar::kInt32 && list.type != Scalar::kUint32) return 0;
    constexpr std::size_t kRow = 1 + 3 * sizeof(Index);
    const std::string_view rest = cursor_.rest();
    const auto vertex_count = static_cast<std::uint64_t>(numbers_.count());
    std::int64_t done = 0;
    for (; done < element.count && (static_cast<std::size_t>(done) + 1) * kRow <= rest.size(); ++done) {
      const char* const row = rest.data() + static_cast<std::size_t>(done) * kRow;
      std::uint32_t v[3];
      std::memcpy(v, row + 1, sizeof(v));
      if (row[0] != 3 || v[0] >= vertex_count || v[1] >= vertex_count || v[2] >= vertex_count) break;
      if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) break;
      mesh_.triangles.push_back({static_cast<Index>(v[0]), static_cast<Index>(v[1]), static_cast<Index>(v[2])});
    }
    cursor_.bytes(static_cast<std::size_t>(done) * kRow, "faces");
    return done;
  }

  void read_faces(const Element& element) {
    int list = element.property("vertex_indices");
    if (list < 0) list = element.property("vertex_index");
    if (list < 0 || !element.properties[list].list_count) {
      cursor_.fail("the element 'face' has no list 'vertex_indices'", "export the file again");
    }
    ElementCollector collector(cursor_, mesh_, numbers_);
    std::vector<Index> polygon;
    mesh_.triangles.reserve(static_cast<std::size_t>(element.count));
    for (std::int64_t i = read_plain_triangles(element); i < element.count; ++i) {
      begin_element(element);
      for (int p = 0; p < std::ssize(element.properties); ++p) {
        const Property& property = element.properties[p];
        if (p != list) {
          skip(property);
          continue;
        }
        polygon.resize(static_cast<std::size_t>(read_list_count(property)));
        for (Index& v : polygon) v = collector.vertex(cursor_.integer(property.type, "a vertex number"));
        collector.add_polygon(polygon);
      }
      end_element();
    }
  }

  Cursor cursor_;
  std::vector<Element> elements_;
  VertexNumbers numbers_;
  IndexedMesh mesh_;
};

}  // namespace

IndexedMesh parse_ply(const Source& source) {
  return PlyReader(source).read();
}

std::string print_ply(const IndexedMesh& mesh, FileEncoding encoding) {
  return print_ply(mesh, encoding, {}, {});
}

std::string print_ply(const IndexedMesh& mesh, FileEncoding encoding, std::span<const Colour8> vertex_colours,
                      std::span<const Colour8> triangle_colours) {
  constexpr std::string_view kColour = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  const bool binary = encoding == FileEncoding::kBinary;
  Printer out;
  if (binary) out.reserve(500 + 27 * mesh.positions.size() + 16 * mesh.triangles.size());
  out.text("ply\nformat ").text(binary ? "binary_little_endian" : "ascii").text(" 1.0\nelement vertex ");
  out.number(mesh.positions.size()).text("\nproperty double x\nproperty double y\nproperty double z\n");
  if (!vertex_colours.empty()) out.text(kColour);
  out.text("element face ").number(mesh.triangles.size()).text("\nproperty list uchar int vertex_indices\n");
  if (!triangle_colours.empty()) out.text(kColour);
  out.text("end_header\n");
  const auto end_row = [&](std::span<const Colour8> colours, std::size_t row) {
    if (!colours.empty()) {
      for (const std::uint8_t c : colours[row]) {
        if (binary) {
          out.binary(c);
        } else {
          out.text(" ").number(c);
        }
      }
    }
    if (!binary) out.text("\n");
  };
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    if (binary) {
      for (const double x : mesh.positions[v]) out.binary(x);
    } else {
      out.numbers(mesh.positions[v]);
    }
    end_row(vertex_colours, v);
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (binary) {
      out.binary(std::uint8_t{3});
      for (const Index v : mesh.triangles[t]) out.binary(v);
    } else {
      out.text("3 ").element(mesh.triangles[t], 0);
    }
    end_row(triangle_colours, t);
  }
  return out.take();
}

}  // namespace selvage::format
