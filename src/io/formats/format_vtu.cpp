// VTK XML unstructured grids: ASCII, inline base64, appended raw and base64, each plain or compressed by zlib.
#include "io/format_bytes.h"
#include "io/format_elements.h"

#include <fmt/format.h>
#include <pugixml.hpp>

namespace selvage::format {

namespace {

enum class Number { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kInt64, kUint64, kFloat32, kFloat64 };

template <typename From, typename T>
void convert(std::string_view bytes, bool swap, std::vector<T>& values) {
  values.resize(bytes.size() / sizeof(From));
  for (std::size_t i = 0; i < values.size(); ++i) {
    From value;
    std::memcpy(&value, bytes.data() + i * sizeof(From), sizeof(From));
    if (swap) value = swap_bytes(value);
    if constexpr (std::is_integral_v<T> && std::is_floating_point_v<From>) {
      // A float that is no number of 32 bits becomes one that no vertex has.
      values[i] = std::abs(value) < From(1e9) ? static_cast<T>(value) : T{-1};
    } else {
      values[i] = static_cast<T>(value);
    }
  }
}

class VtuReader {
 public:
  explicit VtuReader(const Source& source) : source_(source) {}

  IndexedMesh read() {
    load_xml();
    const pugi::xml_node root = document_.child("VTKFile");
    if (!root) fail_at(0, "the file has no element <VTKFile>", "give a VTK XML file, or rename the file");
    if (attribute(root, "type") != "UnstructuredGrid") {
      fail_at(root, fmt::format("the file holds {}", quote(attribute(root, "type"))), "save it as UnstructuredGrid");
    }
    const std::string_view compressor = attribute(root, "compressor");
    compressed_ = !compressor.empty();
    if (compressed_ && compressor != "vtkZLibDataCompressor") {
      fail_at(root, fmt::format("the compressor {} is not read", quote(compressor)),
              "save it with ZLib or without compression");
    }
    header_bytes_ = attribute(root, "header_type") == "UInt64" ? 8 : 4;
    swap_ = (attribute(root, "byte_order") == "BigEndian") != (std::endian::native == std::endian::big);
    appended_base64_ = attribute(root.child("AppendedData"), "encoding") != "raw";
    const pugi::xml_node grid = root.child("UnstructuredGrid");
    if (!grid) fail_at(root, "the file has no element <UnstructuredGrid>", "export the file again");
    for (const pugi::xml_node piece : grid.children("Piece")) read_piece(piece);
    return std::move(mesh_);
  }

 private:
  // Nothing is unescaped or normalized, so that text keeps its place in the file.
  static constexpr unsigned kParseOptions = pugi::parse_minimal;

  void load_xml() {
    const std::string_view bytes = source_.bytes;
    pugi::xml_parse_result result;
    const std::size_t tag = bytes.find("<AppendedData");
    const std::size_t tag_end = tag == std::string_view::npos ? tag : bytes.find('>', tag);
    if (tag_end == std::string_view::npos) {
      result = document_.load_buffer(bytes.data(), bytes.size(), kParseOptions, pugi::encoding_utf8);
    } else {
      // Appended bytes are no XML: what comes before them is parsed alone.
      const std::string head = std::string(bytes.substr(0, tag_end + 1)) + "</AppendedData></VTKFile>";
      result = document_.load_buffer(head.data(), head.size(), kParseOptions, pugi::encoding_utf8);
      const std::size_t mark = bytes.find_first_not_of(" \t\r\n", tag_end + 1);
      if (mark != std::string_view::npos && bytes[mark] == '_') appended_ = bytes.substr(mark + 1);
    }
    if (!result) {
      fail_at(static_cast<std::size_t>(result.offset),
              fmt::format("this is no well-formed XML: {}", result.description()), "export the file again");
    }
  }

  static std::string_view attribute(pugi::xml_node node, const char* name) { return node.attribute(name).value(); }

  [[noreturn]] void fail_at(std::size_t position, std::string_view what, std::string_view remedy) const {
    Cursor cursor(source_);
    cursor.move_to(position);
    cursor.fail(what, remedy);
  }
  [[noreturn]] void fail_at(pugi::xml_node node, std::string_view what, std::string_view remedy) const {
    fail_at(static_cast<std::size_t>(std::max<std::ptrdiff_t>(node.offset_debug(), 0)), what, remedy);
  }

  std::int64_t count(pugi::xml_node node, const char* name) const {
    const std::string_view text = attribute(node, name);
    std::int64_t value = -1;
    const auto [stop, status] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (status != std::errc() || stop != text.data() + text.size() || value < 0) {
      fail_at(node, fmt::format("expected {}=\"a count\", found {}", name, quote(text)), "export the file again");
    }
    if (value > std::numeric_limits<Index>::max()) {
      fail_at(node, fmt::format("{} {} are too many for 32-bit indices or for this file", name, value),
              "export the file again");
    }
    return value;
  }

  pugi::xml_node cell_array(pugi::xml_node piece, const char* name) const {
    const pugi::xml_node cells = piece.child("Cells");
    const pugi::xml_node array = cells.find_child_by_attribute("DataArray", "Name", name);
    if (!array) fail_at(cells ? cells : piece, fmt::format("<Cells> has no array '{}'", name), "export the file again");
    return array;
  }

  void read_piece(pugi::xml_node piece) {
    const std::int64_t points = count(piece, "NumberOfPoints");
    const std::int64_t cells = count(piece, "NumberOfCells");
    if (points == 0) return;
    const pugi::xml_node point_array = piece.child("Points").child("DataArray");
    if (!point_array) fail_at(piece, "the piece has no <Points>", "export the file again");
    const std::vector<double> coordinates = read_array<double>(point_array);
    expect_size(point_array, coordinates.size(), 3 * points);
    const std::size_t base = mesh_.positions.size();
    if (base + coordinates.size() / 3 > static_cast<std::size_t>(std::numeric_limits<Index>::max())) {
      fail_at(piece, "the pieces have too many points together", "split the mesh into several files");
    }
    for (std::size_t i = 0; i < coordinates.size(); i += 3) {
      const Vec3 p(coordinates[i], coordinates[i + 1], coordinates[i + 2]);
      if (!p.allFinite()) {
        fail_at(point_array, fmt::format("a coordinate of point {} is not finite", i / 3),
                "give every point three finite coordinates");
      }
      mesh_.positions.push_back(p);
    }
    if (cells > 0) read_cells(piece, points, cells, static_cast<Index>(base));
  }

  void read_cells(pugi::xml_node piece, std::int64_t points, std::int64_t cells, Index base) {
    const pugi::xml_node connectivity_array = cell_array(piece, "connectivity");
    const pugi::xml_node offsets_array = cell_array(piece, "offsets");
    const pugi::xml_node types_array = cell_array(piece, "types");
    const auto connectivity = read_array<std::int64_t>(connectivity_array);
    const auto offsets = read_array<std::int64_t>(offsets_array);
    const auto types = read_array<std::int64_t>(types_array);
    expect_size(offsets_array, offsets.size(), cells);
    expect_size(types_array, types.size(), cells);
    Cursor cursor(source_);
    cursor.move_to(static_cast<std::size_t>(std::max<std::ptrdiff_t>(connectivity_array.offset_debug(), 0)));
    const VertexNumbers numbers(0, points);
    ElementCollector collector(cursor, mesh_, numbers);
    std::vector<Index> vertices;
    std::int64_t first = 0;
    for (std::size_t c = 0; c < offsets.size(); ++c) {
      if (offsets[c] < first || offsets[c] > std::ssize(connectivity)) {
        fail_at(offsets_array, fmt::format("offset {} of cell {} is out of order or range", offsets[c], c),
                "export the file again");
      }
      vertices.clear();
      for (; first < offsets[c]; ++first) vertices.push_back(base + collector.vertex(connectivity[first]));
      add_vtk_cell(collector, static_cast<int>(std::clamp<std::int64_t>(types[c], -1, 1000)), vertices);
    }
  }

  void expect_size(pugi::xml_node array, std::size_t found, std::int64_t expected) const {
    if (found == static_cast<std::size_t>(expected)) return;
    fail_at(array,
            fmt::format("the array {} holds {} values instead of {}", quote(attribute(array, "Name")), found, expected),
            "the file is cut short or its counts are wrong; export it again");
  }

  template <typename T>
  std::vector<T> read_array(pugi::xml_node array) const {
    const std::string_view format = attribute(array, "format");
    const pugi::xml_node text = array.first_child();
    const std::size_t start = text ? static_cast<std::size_t>(text.offset_debug()) : 0;
    const std::string_view content = text ? source_.bytes.substr(start, std::strlen(text.value())) : std::string_view();
    if (format == "ascii") return read_ascii<T>({source_.bytes.substr(0, start + content.size()), source_.name}, start);
    std::string bytes;
    if (format == "binary") {
      bytes = decode(array, ByteStream(content, true));
    } else if (format == "appended") {
      const auto offset = static_cast<std::size_t>(count_offset(array));
      if (offset >= appended_.size())
        fail_at(array, "the array's offset lies behind the end of the file", "the file is cut short; export it again");
      bytes = decode(array, ByteStream(appended_.substr(offset), appended_base64_));
    } else {
      fail_at(array, fmt::format("the array's format {} is unknown", quote(format)), "use ascii, binary or appended");
    }
    std::vector<T> values;
    convert_from(number_type(array), bytes, values);
    return values;
  }

  std::int64_t count_offset(pugi::xml_node array) const {
    const std::string_view text = attribute(array, "offset");
    std::int64_t value = 0;
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    if (result.ec != std::errc() || value < 0)
      fail_at(array, fmt::format("the array's offset {} is no number", quote(text)), "export the file again");
    return value;
  }

  template <typename T>
  static std::vector<T> read_ascii(const Source& source, std::size_t start) {
    Cursor cursor(source);
    cursor.move_to(start);
    std::vector<T> values;
    values.reserve(cursor.remaining() / 4);
    while (!cursor.peek().empty()) {
      if constexpr (std::is_integral_v<T>) {
        values.push_back(cursor.integer("a whole number"));
      } else {
        values.push_back(cursor.real("a number"));
      }
    }
    return values;
  }

  Number number_type(pugi::xml_node array) const {
    constexpr std::string_view kNames[] = {"Int8",   "UInt8", "Int16",  "UInt16",  "Int32",
                                           "UInt32", "Int64", "UInt64", "Float32", "Float64"};
    const std::string_view name = attribute(array, "type");
    for (std::size_t i = 0; i < std::size(kNames); ++i) {
      if (name == kNames[i]) return static_cast<Number>(i);
    }
    fail_at(array, fmt::format("the array's type {} is unknown", quote(name)),
            "use Int32, Int64, Float32, Float64 or alike");
  }

  template <typename T>
  void convert_from(Number type, std::string_view bytes, std::vector<T>& values) const {
    switch (type) {
      case Number::kInt8:
        return convert<std::int8_t>(bytes, swap_, values);
      case Number::kUint8:
        return convert<std::uint8_t>(bytes, swap_, values);
      case Number::kInt16:
        return convert<std::int16_t>(bytes, swap_, values);
      case Number::kUint16:
        return convert<std::uint16_t>(bytes, swap_, values);
      case Number::kInt32:
        return convert<std::int32_t>(bytes, swap_, values);
      case Number::kUint32:
        return convert<std::uint32_t>(bytes, swap_, values);
      case Number::kInt64:
        return convert<std::int64_t>(bytes, swap_, values);
      case Number::kUint64:
        return convert<std::uint64_t>(bytes, swap_, values);
      case Number::kFloat32:
        return convert<float>(bytes, swap_, values);
      case Number::kFloat64:
        return convert<double>(bytes, swap_, values);
    }
  }

  std::string decode(pugi::xml_node array, ByteStream stream) const {
    const BlockLayout layout{header_bytes_, swap_, compressed_};
    std::string bytes, problem;
    if (!read_blocks(stream, layout, bytes, problem)) {
      fail_at(array, fmt::format("the array {}: {}", quote(attribute(array, "Name")), problem),
              "the file is cut short or damaged; export it again");
    }
    return bytes;
  }

  Source source_;
  pugi::xml_document document_;
  std::string_view appended_;
  bool appended_base64_ = true;
  bool compressed_ = false;
  bool swap_ = false;
  std::size_t header_bytes_ = 4;
  IndexedMesh mesh_;
};

}  // namespace

IndexedMesh parse_vtu(const Source& source) {
  return VtuReader(source).read();
}

}  // namespace selvage::format
