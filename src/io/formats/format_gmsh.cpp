// Gmsh .msh, versions 2.2 and 4.1, ASCII and binary of both byte orders. Tags need not follow each other.
#include "io/format_elements.h"
#include "io/format_printer.h"

#include <fmt/format.h>

#include <algorithm>

namespace selvage::format {

namespace {

/// Vertices of an element type, 0 for those that are not read.
int vertices_of(std::int64_t type) {
  switch (type) {
    case 1:
      return 2;  // line
    case 2:
      return 3;  // triangle
    case 3:      // quadrilateral
    case 4:      // tetrahedron
      return 4;
    case 8:
      return 3;  // lines of higher order
    case 15:
      return 1;  // point
    case 26:
      return 4;
    case 27:
      return 5;
    case 28:
      return 6;
    default:
      return 0;
  }
}

std::string_view name_of(std::int64_t type) {
  switch (type) {
    case 5:
      return "hexahedron";
    case 6:
      return "prism";
    case 7:
      return "pyramid";
    case 9:
      return "second-order triangle";
    case 10:
    case 16:
      return "second-order quadrilateral";
    case 11:
      return "second-order tetrahedron";
    case 12:
    case 17:
      return "second-order hexahedron";
    case 21:
      return "third-order triangle";
    case 29:
      return "third-order tetrahedron";
    default:
      return "Gmsh element";
  }
}

class GmshReader {
 public:
  explicit GmshReader(const Source& source) : source_(source), cursor_(source) {}

  IndexedMesh read() {
    if (cursor_.token() != "$MeshFormat") {
      cursor_.fail("the file does not begin with '$MeshFormat'", "give a Gmsh file of version 2.2 or 4.1");
    }
    read_format();
    bool has_elements = false;
    for (std::string_view section = next_section(); !section.empty(); section = next_section()) {
      if (section == "$Nodes") {
        if (numbers_.count() > 0) cursor_.fail("there are two sections $Nodes", "save each mesh in a file of its own");
        enter_data();
        version4_ ? read_nodes4() : read_nodes2();
        end_section(section);
      } else if (section == "$Elements") {
        if (mesh_.positions.empty()) cursor_.fail("the elements come before any node", "export the file again");
        enter_data();
        version4_ ? read_elements4() : read_elements2();
        end_section(section);
        has_elements = true;
      } else if (section == "$ParametricNodes") {
        cursor_.fail("nodes with parameters are not read in version 2",
                     "save with Mesh.SaveParametric = 0, or as version 4.1");
      } else {
        skip_section(section);
      }
    }
    if (!has_elements) cursor_.fail("the file has no section $Elements", "the file is cut short; export it again");
    return std::move(mesh_);
  }

 private:
  void read_format() {
    const double version = cursor_.real("a version number");
    version4_ = version == 4.1;
    if (!version4_ && !(version >= 2 && version < 3)) {
      cursor_.fail(fmt::format("version {} is not read", version),
                   "save as version 4.1 or 2.2: gmsh -save -format msh41");
    }
    binary_ = cursor_.integer("the file type, 0 or 1") != 0;
    wide_ = cursor_.integer("the data size, 4 or 8") != 4;
    cursor_.next_line();
    if (binary_) {
      std::int32_t one = 0;
      const std::string_view bytes = cursor_.bytes(4, "the number 1 that tells the byte order");
      std::memcpy(&one, bytes.data(), 4);
      if (one != 1 && swap_bytes(one) != 1) cursor_.fail("the byte order mark is not 1", "export the file again");
      foreign_order_ = one != 1;
    }
    end_section("$MeshFormat");
  }

  /// Name of the next section, empty at the end of the file. Text between sections is passed over.
  std::string_view next_section() {
    while (true) {
      const std::string_view token = cursor_.token();
      if (token.empty() || token[0] == '$') return token;
      cursor_.next_line();
    }
  }

  void enter_data() {
    if (!binary_) return;
    cursor_.next_line();
    constexpr std::endian kForeign =
        std::endian::native == std::endian::little ? std::endian::big : std::endian::little;
    cursor_.enter_binary(foreign_order_ ? kForeign : std::endian::native);
  }

  void end_section(std::string_view section) {
    const std::string expected = fmt::format("$End{}", section.substr(1));
    const std::string_view found = cursor_.peek();
    if (found != expected) cursor_.fail_expected(fmt::format("'{}'", expected));
    cursor_.token();
  }

  void skip_section(std::string_view section) {
    const std::string end = fmt::format("$End{}", section.substr(1));
    const std::size_t found = source_.bytes.find(end, cursor_.position());
    if (found == std::string_view::npos)
      cursor_.fail(fmt::format("{} has no {}", quote(section), quote(end)), "export the file again");
    cursor_.move_to(found + end.size());
  }

  // Numbers of both encodings: `whole` is an int, `large` a size_t in version 4.1.
  std::int64_t whole(std::string_view what) {
    return binary_ ? cursor_.binary<std::int32_t>(what) : cursor_.integer(what);
  }

  std::int64_t large(std::string_view what) {
    if (!binary_) return cursor_.integer(what);
    if (!wide_) return cursor_.binary<std::uint32_t>(what);
    return static_cast<std::int64_t>(cursor_.binary<std::uint64_t>(what));
  }

  Vec3 point() { return binary_ ? cursor_.binary_point<double>() : cursor_.point(); }

  std::int64_t checked(std::int64_t count, std::string_view what, std::size_t binary_bytes, std::size_t ascii_bytes) {
    cursor_.check_count(count, what, binary_ ? binary_bytes : ascii_bytes);
    return count;
  }

  void read_nodes2() {
    const std::int64_t count = checked(cursor_count("nodes"), "nodes", 28, 8);
    mesh_.positions.reserve(static_cast<std::size_t>(count));
    for (std::int64_t i = 0; i < count; ++i) {
      numbers_.add(whole("a node tag"));
      mesh_.positions.push_back(point());
    }
    finish_nodes();
  }

  void read_nodes4() {
    const std::int64_t blocks = checked(large("the number of blocks"), "blocks", 12, 8);
    const std::int64_t count = checked(large("the number of nodes"), "nodes", 24, 8);
    large("the smallest tag");
    large("the largest tag");
    mesh_.positions.reserve(static_cast<std::size_t>(count));
    for (std::int64_t b = 0; b < blocks; ++b) {
      const std::int64_t dimension = whole("a block's dimension");
      whole("a block's tag");
      const bool parametric = whole("a block's parametric flag") != 0;
      const std::int64_t n = checked(large("a block's number of nodes"), "nodes", 24, 8);
      for (std::int64_t i = 0; i < n; ++i) numbers_.add(large("a node tag"));
      for (std::int64_t i = 0; i < n; ++i) {
        mesh_.positions.push_back(point());
        for (std::int64_t d = 0; parametric && d < std::clamp<std::int64_t>(dimension, 0, 3); ++d) {
          binary_ ? cursor_.binary<double>("a parameter") : cursor_.real("a parameter");
        }
      }
    }
    if (std::ssize(mesh_.positions) != count) {
      cursor_.fail(fmt::format("the blocks hold {} nodes instead of {}", mesh_.positions.size(), count),
                   "export the file again");
    }
    finish_nodes();
  }

  void finish_nodes() {
    if (const auto [twice, tag] = numbers_.finish(); twice) {
      cursor_.fail(fmt::format("node tag {} is given twice", tag), "renumber the mesh in Gmsh and save it again");
    }
  }

  /// Version 2 writes the number of nodes and of elements as text, in binary files too.
  std::int64_t cursor_count(std::string_view what) {
    if (!binary_) return cursor_.integer(fmt::format("the number of {}", what));
    const std::string_view text = cursor_.line();
    std::int64_t count = 0;
    const auto [stop, status] = std::from_chars(text.data(), text.data() + text.size(), count);
    if (status != std::errc() || stop != text.data() + text.size())
      cursor_.fail(fmt::format("expected the number of {}, found {}", what, quote(text)));
    return count;
  }

  void read_elements2() {
    const std::int64_t count = checked(cursor_count("elements"), "elements", 8, 8);
    ElementCollector collector(cursor_, mesh_, numbers_);
    for (std::int64_t done = 0; done < count;) {
      if (!binary_) {
        cursor_.integer("an element tag");
        const std::int64_t type = cursor_.integer("an element type");
        require_known(type);
        const std::int64_t tags = checked(cursor_.integer("the number of tags"), "tags", 4, 2);
        for (std::int64_t i = 0; i < tags; ++i) cursor_.integer("a tag");
        read_element(collector, type);
        ++done;
        continue;
      }
      const std::int64_t type = whole("an element type");
      require_known(type);
      const std::int64_t n = checked(whole("a block's number of elements"), "elements", 8, 8);
      const std::int64_t tags = checked(whole("the number of tags"), "tags", 4, 2);
      if (n == 0 || n > count - done)
        cursor_.fail(fmt::format("a block of {} elements does not fit the total of {}", n, count),
                     "export the file again");
      for (std::int64_t i = 0; i < n; ++i) {
        cursor_.bytes(4 * (1 + static_cast<std::size_t>(tags)), "an element's tags");
        read_element(collector, type);
      }
      done += n;
    }
  }

  void read_elements4() {
    const std::int64_t blocks = checked(large("the number of blocks"), "blocks", 12, 8);
    const std::int64_t count = large("the number of elements");
    large("the smallest tag");
    large("the largest tag");
    ElementCollector collector(cursor_, mesh_, numbers_);
    std::int64_t total = 0;
    for (std::int64_t b = 0; b < blocks; ++b) {
      whole("a block's dimension");
      whole("a block's tag");
      const std::int64_t type = whole("an element type");
      require_known(type);
      const std::int64_t n = checked(large("a block's number of elements"), "elements", 8, 4);
      for (std::int64_t i = 0; i < n; ++i) {
        large("an element tag");
        read_element(collector, type);
      }
      total += n;
    }
    if (total != count)
      cursor_.fail(fmt::format("the blocks hold {} elements instead of {}", total, count), "export the file again");
  }

  void require_known(std::int64_t type) const {
    if (vertices_of(type) == 0) fail_unsupported(cursor_, name_of(type), static_cast<int>(type));
  }

  void read_element(ElementCollector& collector, std::int64_t type) {
    std::array<Index, 6> v{};
    for (int i = 0; i < vertices_of(type); ++i) {
      const std::int64_t tag = version4_ ? large("a node tag") : whole("a node tag");
      v[i] = collector.vertex(tag);
    }
    if (type == 2) collector.add_triangle(v[0], v[1], v[2]);
    if (type == 3) collector.add_polygon(std::span(v).first(4));
    if (type == 4) collector.add_tetrahedron(v[0], v[1], v[2], v[3]);
  }

  Source source_;
  Cursor cursor_;
  bool version4_ = false;
  bool binary_ = false;
  bool wide_ = true;
  bool foreign_order_ = false;
  VertexNumbers numbers_;
  IndexedMesh mesh_;
};

/// One block of elements of version 4.1.
template <std::size_t N>
void print_block(Printer& out, std::int32_t dimension, std::int32_t type, const std::vector<VertexTuple<N>>& elements,
                 std::uint64_t& tag, bool binary) {
  if (elements.empty()) return;
  if (!binary) {
    out.number(dimension).text(" 1 ").number(type).text(" ").number(elements.size()).text("\n");
    for (const auto& element : elements) out.number(tag++).text(" ").element(element, 1).text("\n");
    return;
  }
  out.binary(dimension).binary(std::int32_t{1}).binary(type).binary(std::uint64_t{elements.size()});
  for (const auto& element : elements) {
    out.binary(tag++);
    for (const Index v : element) out.binary(static_cast<std::uint64_t>(v) + 1);
  }
}

/// All nodes belong to the volume, or to the surface where there is none. A surface beside a volume gets an empty
/// block: Gmsh knows only entities that the nodes have named.
void print_nodes(Printer& out, const IndexedMesh& mesh, bool binary) {
  const std::uint64_t count = mesh.positions.size();
  const bool both = !mesh.triangles.empty() && !mesh.tetrahedra.empty();
  const std::int32_t dimension = mesh.tetrahedra.empty() ? 2 : 3;
  const std::uint64_t blocks = both ? 2 : 1;
  if (!binary) {
    out.number(blocks).text(" ").number(count).text(" 1 ").number(count).text(both ? "\n2 1 0 0\n" : "\n");
    out.number(dimension).text(" 1 0 ").number(count).text("\n");
    for (std::uint64_t i = 1; i <= count; ++i) out.number(i).text("\n");
    for (const Vec3& p : mesh.positions) out.numbers(p).text("\n");
    return;
  }
  const auto begin_block = [&](std::int32_t block_dimension, std::uint64_t size) {
    for (const std::int32_t value : {block_dimension, 1, 0}) out.binary(value);
    out.binary(size);
  };
  for (const std::uint64_t value : {blocks, count, std::uint64_t{1}, count}) out.binary(value);
  if (both) begin_block(2, 0);
  begin_block(dimension, count);
  for (std::uint64_t i = 1; i <= count; ++i) out.binary(i);
  for (const Vec3& p : mesh.positions) {
    for (const double x : p) out.binary(x);
  }
  out.text("\n");
}

}  // namespace

IndexedMesh parse_gmsh(const Source& source) {
  return GmshReader(source).read();
}

std::string print_gmsh(const IndexedMesh& mesh, FileEncoding encoding) {
  const bool binary = encoding == FileEncoding::kBinary;
  Printer out(std::endian::native);
  out.text("$MeshFormat\n4.1 ").text(binary ? "1" : "0").text(" 8\n");
  if (binary) out.binary(std::int32_t{1}).text("\n");
  out.text("$EndMeshFormat\n$Nodes\n");
  print_nodes(out, mesh, binary);
  out.text("$EndNodes\n$Elements\n");
  const std::uint64_t blocks = std::uint64_t{!mesh.triangles.empty()} + std::uint64_t{!mesh.tetrahedra.empty()};
  const std::uint64_t count = mesh.triangles.size() + mesh.tetrahedra.size();
  if (binary) {
    for (const std::uint64_t value : {blocks, count, std::uint64_t{1}, count}) out.binary(value);
  } else {
    out.number(blocks).text(" ").number(count).text(" 1 ").number(count).text("\n");
  }
  std::uint64_t tag = 1;
  print_block(out, 2, 2, mesh.triangles, tag, binary);
  print_block(out, 3, 4, mesh.tetrahedra, tag, binary);
  if (binary) out.text("\n");
  out.text("$EndElements\n");
  return out.take();
}

}  // namespace selvage::format
