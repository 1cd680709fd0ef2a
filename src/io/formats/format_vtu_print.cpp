// Writes VTK XML unstructured grids: inline ASCII, or one appended raw section.
#include "io/format_printer.h"

namespace selvage::format {

namespace {

std::string escape(std::string_view name) {
  std::string escaped;
  for (const char c : name) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

/// Collects arrays: in ASCII their values go inline, in binary to the appended section.
class ArrayPrinter {
 public:
  explicit ArrayPrinter(FileEncoding encoding) : binary_(encoding == FileEncoding::kBinary) {}

  /// `visit(put)` calls put(value) for every value, `count` times in all.
  template <typename T, typename Visit>
  void array(std::string_view type, std::string_view name, int components, std::size_t count, Visit visit) {
    xml_.text("        <DataArray type=\"").text(type).text("\" Name=\"").text(escape(name));
    xml_.text("\" NumberOfComponents=\"").number(components);
    if (binary_) {
      xml_.text("\" format=\"appended\" offset=\"").number(appended_.size()).text("\"/>\n");
      appended_.binary(static_cast<std::uint64_t>(count * sizeof(T)));
      visit([&](T value) { appended_.binary(value); });
      return;
    }
    xml_.text("\" format=\"ascii\">\n");
    std::int64_t in_line = 0;
    visit([&](T value) {
      if constexpr (sizeof(T) == 1) {
        xml_.number(static_cast<int>(value));
      } else {
        xml_.number(value);
      }
      in_line = (in_line + 1) % (components > 1 ? components : 12);
      xml_.text(in_line == 0 ? "\n" : " ");
    });
    xml_.text("\n        </DataArray>\n");
  }

  void fields(std::string_view section, const std::vector<VtkField>& fields) {
    xml_.text("      <").text(section).text(">\n");
    for (const VtkField& field : fields) {
      array<double>("Float64", field.name, field.components, field.values.size(), [&](auto put) {
        for (const double value : field.values) put(value);
      });
    }
    xml_.text("      </").text(section).text(">\n");
  }

  Printer& xml() { return xml_; }

  std::string finish() {
    if (binary_) {
      xml_.text("  <AppendedData encoding=\"raw\">\n_");
      xml_.text(appended_.take());
      xml_.text("\n  </AppendedData>\n");
    }
    xml_.text("</VTKFile>\n");
    return xml_.take();
  }

 private:
  bool binary_;
  Printer xml_;
  Printer appended_;
};

template <typename Put>
void put_offsets(const VtkGrid& grid, Put put) {
  std::int64_t offset = 0;
  for (std::size_t i = 0; i < grid.lines.size(); ++i) put(offset += 2);
  for (std::size_t i = 0; i < grid.triangles.size(); ++i) put(offset += 3);
  for (std::size_t i = 0; i < grid.tetrahedra.size(); ++i) put(offset += 4);
}

template <typename Put>
void put_types(const VtkGrid& grid, Put put) {
  constexpr std::uint8_t kLine = 3, kTriangle = 5, kTetrahedron = 10;
  for (std::size_t i = 0; i < grid.lines.size(); ++i) put(kLine);
  for (std::size_t i = 0; i < grid.triangles.size(); ++i) put(kTriangle);
  for (std::size_t i = 0; i < grid.tetrahedra.size(); ++i) put(kTetrahedron);
}

template <typename Put>
void put_connectivity(const VtkGrid& grid, Put put) {
  const auto put_all = [&](const auto& elements) {
    for (const auto& element : elements) {
      for (const Index v : element) put(v);
    }
  };
  put_all(grid.lines);
  put_all(grid.triangles);
  put_all(grid.tetrahedra);
}

}  // namespace

std::string print_vtu(const VtkGrid& grid, FileEncoding encoding) {
  ArrayPrinter out(encoding);
  const std::size_t cells = grid.lines.size() + grid.triangles.size() + grid.tetrahedra.size();
  const std::size_t corners = 2 * grid.lines.size() + 3 * grid.triangles.size() + 4 * grid.tetrahedra.size();
  out.xml().text(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" ");
  out.xml()
      .text("header_type=\"UInt64\">\n  <UnstructuredGrid>\n    <Piece NumberOfPoints=\"")
      .number(grid.points.size());
  out.xml().text("\" NumberOfCells=\"").number(cells).text("\">\n");
  out.fields("PointData", grid.point_fields);
  out.fields("CellData", grid.cell_fields);
  out.xml().text("      <Points>\n");
  out.array<double>("Float64", "Points", 3, 3 * grid.points.size(), [&](auto put) {
    for (const Vec3& p : grid.points) {
      for (const double x : p) put(x);
    }
  });
  out.xml().text("      </Points>\n      <Cells>\n");
  out.array<Index>("Int32", "connectivity", 1, corners, [&](auto put) { put_connectivity(grid, put); });
  out.array<std::int64_t>("Int64", "offsets", 1, cells, [&](auto put) { put_offsets(grid, put); });
  out.array<std::uint8_t>("UInt8", "types", 1, cells, [&](auto put) { put_types(grid, put); });
  out.xml().text("      </Cells>\n    </Piece>\n  </UnstructuredGrid>\n");
  return out.finish();
}

}  // namespace selvage::format
