// Variants of the formats that the project reads but does not write: random meshes encoded here, plainly and slowly.
#include "io/format_encoders.h"

#include <fmt/format.h>

namespace selvage {
namespace {

constexpr std::endian kOrders[] = {std::endian::little, std::endian::big};

template <typename Tuples>
std::vector<Index> flat(const Tuples& tuples) {
  std::vector<Index> all;
  for (const auto& tuple : tuples) all.insert(all.end(), tuple.begin(), tuple.end());
  return all;
}

std::string coordinates(const IndexedMesh& mesh, std::endian order) {
  std::string bytes;
  for (const Vec3& p : mesh.positions) bytes += packed<double>({p[0], p[1], p[2]}, order);
  return bytes;
}

template <typename T>
std::string packed_list(const std::vector<Index>& values, std::endian order) {
  std::string bytes;
  for (const Index value : values) bytes += packed<T>({static_cast<T>(value)}, order);
  return bytes;
}

/// Offsets behind each cell: triangles, then tetrahedra.
std::vector<Index> cell_offsets(const IndexedMesh& mesh) {
  std::vector<Index> offsets;
  Index at = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) offsets.push_back(at += 3);
  for (std::size_t i = 0; i < mesh.tetrahedra.size(); ++i) offsets.push_back(at += 4);
  return offsets;
}

std::vector<Index> cell_types(const IndexedMesh& mesh) {
  std::vector<Index> types(mesh.triangles.size(), 5);
  types.resize(mesh.triangles.size() + mesh.tetrahedra.size(), 10);
  return types;
}

std::vector<Index> cell_vertices(const IndexedMesh& mesh) {
  std::vector<Index> all = flat(mesh.triangles);
  const std::vector<Index> tetrahedra = flat(mesh.tetrahedra);
  all.insert(all.end(), tetrahedra.begin(), tetrahedra.end());
  return all;
}

enum class Place { kInline, kAppendedRaw, kAppendedBase64 };

std::string encode_vtu(const IndexedMesh& mesh, Place place, const ArrayCode& code, std::size_t block_size) {
  std::string appended;
  const auto array = [&](std::string_view type, std::string_view name, const std::string& bytes) {
    const std::string stored = block_size == 0 ? encode_plain(bytes, code) : encode_compressed(bytes, code, block_size);
    const std::string head = fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=", type,
                                         name, name == "P" ? 3 : 1);
    if (place == Place::kInline) return head + "\"binary\">\n  " + stored + "\n</DataArray>\n";
    appended += stored;
    return head + fmt::format("\"appended\" offset=\"{}\"/>\n", appended.size() - stored.size());
  };
  std::string xml = fmt::format(
      "<?xml version=\"1.0\"?>\n<!-- by hand --><VTKFile type=\"UnstructuredGrid\" byte_order=\"{}\" "
      "header_type=\"{}\"{}>\n<UnstructuredGrid><Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">",
      code.order == std::endian::little ? "LittleEndian" : "BigEndian", code.header_bytes == 8 ? "UInt64" : "UInt32",
      block_size == 0 ? "" : " compressor=\"vtkZLibDataCompressor\"", mesh.positions.size(),
      mesh.triangles.size() + mesh.tetrahedra.size());
  xml += "<Points>" + array("Float64", "P", coordinates(mesh, code.order)) + "</Points><Cells>";
  xml += array("UInt16", "connectivity", packed_list<std::uint16_t>(cell_vertices(mesh), code.order));
  xml += array("UInt32", "offsets", packed_list<std::uint32_t>(cell_offsets(mesh), code.order));
  xml += array("Int8", "types", packed_list<std::int8_t>(cell_types(mesh), code.order)) +
         "</Cells></Piece></UnstructuredGrid>";
  if (place != Place::kInline) {
    xml += fmt::format("<AppendedData encoding=\"{}\">\n  _", place == Place::kAppendedRaw ? "raw" : "base64") +
           appended + "\n</AppendedData>";
  }
  return xml + "</VTKFile>\n";
}

TEST(Variants, VtuInEveryPlaceLayoutAndCompression) {
  const IndexedMesh mesh = random_mesh(11, 30, 9, 13);
  for (const Place place : {Place::kInline, Place::kAppendedRaw, Place::kAppendedBase64}) {
    for (const std::size_t header : {4u, 8u}) {
      for (const std::endian order : kOrders) {
        for (const std::size_t block_size : {0u, 64u, 100000u}) {
          const ArrayCode code{header, order, place != Place::kAppendedRaw};
          expect_same_mesh(parse(".vtu", encode_vtu(mesh, place, code, block_size)), mesh,
                           fmt::format("place {}, header {}, block {}", static_cast<int>(place), header, block_size));
        }
      }
    }
  }
}

TEST(Variants, VtuDamagedAnywhereIsRefusedOrRead) {
  const std::string whole = encode_vtu(one_tetrahedron(), Place::kInline, {8, std::endian::little, true}, 32);
  for (std::size_t size = 0; size + 12 < whole.size(); ++size) {
    EXPECT_NE(error_of(".vtu", std::string_view(whole).substr(0, size)), "") << size;
  }
}

TEST(Variants, GmshVersion2BinaryOfBothByteOrders) {
  const IndexedMesh mesh = random_mesh(12, 25, 8, 7);
  for (const std::endian order : kOrders) {
    std::string file = "$MeshFormat\n2.2 1 8\n" + packed<std::int32_t>({1}, order) + "\n$EndMeshFormat\n$Nodes\n25\n";
    for (Index i = 0; i < 25; ++i) {
      const Vec3& p = mesh.positions[i];
      file += packed<std::int32_t>({1000 - 7 * i}, order) + packed<double>({p[0], p[1], p[2]}, order);
    }
    file += fmt::format("\n$EndNodes\n$Elements\n{}\n", 1 + mesh.triangles.size() + mesh.tetrahedra.size());
    file += packed<std::int32_t>({15, 1, 1, 1, 99, 1000}, order);  // a point
    const auto block = [&](std::int32_t type, const auto& elements) {
      file += packed<std::int32_t>({type, static_cast<std::int32_t>(elements.size()), 2}, order);
      for (const auto& element : elements) {
        file += packed<std::int32_t>({5, 6, 7}, order);
        for (const Index v : element) file += packed<std::int32_t>({1000 - 7 * v}, order);
      }
    };
    block(2, mesh.triangles);
    block(4, mesh.tetrahedra);
    expect_same_mesh(parse(".msh", file + "\n$EndElements\n"), mesh, "msh 2.2 binary");
  }
}

TEST(Variants, GmshVersion4BinaryOfBothByteOrdersAndSizes) {
  const IndexedMesh mesh = random_mesh(13, 20, 0, 11);
  for (const std::endian order : kOrders) {
    for (const int width : {4, 8}) {
      const auto sizes = [&](std::initializer_list<std::uint64_t> values) {
        return encode_header(values, {static_cast<std::size_t>(width), order, false});
      };
      std::string file =
          fmt::format("$MeshFormat\n4.1 1 {}\n", width) + packed<std::int32_t>({1}, order) + "\n$EndMeshFormat\n";
      file += "$Entities\n" + std::string("\1\2$x\0\n", 6) + "\n$EndEntities\n$Nodes\n" + sizes({2, 20, 10, 67});
      for (const Index first : {0, 8}) {
        const Index last = first == 0 ? 8 : 20;
        file += packed<std::int32_t>({3, 1, 0}, order) + sizes({static_cast<std::uint64_t>(last - first)});
        for (Index i = first; i < last; ++i) file += sizes({static_cast<std::uint64_t>(10 + 3 * i)});
        for (Index i = first; i < last; ++i)
          file += packed<double>({mesh.positions[i][0], mesh.positions[i][1], mesh.positions[i][2]}, order);
      }
      file += "\n$EndNodes\n$Elements\n" + sizes({1, 11, 1, 11}) + packed<std::int32_t>({3, 1, 4}, order) + sizes({11});
      for (const auto& tet : mesh.tetrahedra) {
        file += sizes({1});
        for (const Index v : tet) file += sizes({static_cast<std::uint64_t>(10 + 3 * v)});
      }
      expect_same_mesh(parse(".msh", file + "\n$EndElements\n"), mesh, "msh 4.1 binary");
    }
  }
}

TEST(Variants, VtkVersion5Binary) {
  const IndexedMesh mesh = random_mesh(14, 40, 12, 10);
  const auto big = std::endian::big;
  std::vector<Index> offsets = cell_offsets(mesh);
  offsets.insert(offsets.begin(), 0);
  const std::vector<Index> vertices = cell_vertices(mesh), types = cell_types(mesh);
  const std::string file =
      "# vtk DataFile Version 5.1\ntitle\nBINARY\nDATASET UNSTRUCTURED_GRID\nFIELD FieldData 1\n"
      "TIME 1 2 double\n" +
      packed<double>({1, 2}, big) + "\nMETADATA\nINFORMATION 0\n\nPOINTS 40 double\n" + coordinates(mesh, big) +
      fmt::format("\nCELLS {} {}\nOFFSETS vtktypeint64\n", offsets.size(), vertices.size()) +
      packed_list<std::int64_t>(offsets, big) + "\nCONNECTIVITY vtktypeint32\n" +
      packed_list<std::int32_t>(vertices, big) + fmt::format("\nCELL_TYPES {}\n", types.size()) +
      packed_list<std::int32_t>(types, big) +
      "\nCELL_DATA 22\nSCALARS a char 1\nLOOKUP_TABLE default\nxxxxxxxxxxxxxxxxxxxxxx\n";
  expect_same_mesh(parse(".vtk", file), mesh, "vtk 5.1 binary");
}

TEST(Variants, PlyRowsOfBothByteOrdersWithOtherPropertiesAndPolygons) {
  IndexedMesh mesh = random_mesh(17, 30, 40, 0);
  for (int i = 0; i < 30; ++i) mesh.positions[i] = Vec3(i, -0.5 * i, 1e30f * static_cast<float>(i));
  for (const std::endian order : kOrders)
    for (const bool is_float : {false, true})
      for (const std::size_t quad : {0u, 7u, 1000u}) {  // which face is a polygon, if any
        const std::string type = is_float ? "float" : "double";
        std::string file = fmt::format(
            "ply\nformat binary_{}_endian 1.0\nelement vertex 30\nproperty uchar a\nproperty {} z\nproperty {} x\n"
            "property short b\nproperty {} y\nelement face {}\nproperty list uchar {} vertex_indices\nend_header\n",
            order == std::endian::big ? "big" : "little", type, type, type, mesh.triangles.size() - (quad < 40),
            is_float ? "uint" : "int");
        for (const Vec3& p : mesh.positions) {
          const auto number = [&](double x) {
            return is_float ? packed<float>({static_cast<float>(x)}, order) : packed<double>({x}, order);
          };
          file += "a" + number(p[2]) + number(p[0]) + "bb" + number(p[1]);
        }
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
          const auto& [a, b, c] = mesh.triangles[i];
          if (i == quad + 1) continue;  // the other half of the polygon
          if (i == quad) {
            Index d = 0;
            while (d == a || d == b || d == c) ++d;
            mesh.triangles[i + 1] = {a, c, d};
            file += "\4" + packed<std::int32_t>({a, b, c, d}, order);
          } else {
            file += "\3" + packed<std::int32_t>({a, b, c}, order);
          }
        }
        expect_same_mesh(parse(".ply", file), mesh, "binary ply");
      }
}

TEST(Variants, TextWithWindowsLineEnds) {
  const IndexedMesh surface = random_mesh(15, 12, 9, 0), solid = random_mesh(16, 12, 0, 9);
  const auto with_returns = [](const std::string& text) {
    std::string result;
    for (const char c : text) result += c == '\n' ? std::string("\r\n") : std::string(1, c);
    return result;
  };
  constexpr FileEncoding kAscii = FileEncoding::kAscii;
  expect_same_mesh(parse(".obj", with_returns(format::print_obj(surface))), surface, "obj");
  expect_same_mesh(parse(".ply", with_returns(format::print_ply(surface, kAscii))), surface, "ply");
  expect_same_mesh(parse(".off", with_returns(format::print_off(surface, kAscii))), surface, "off");
  expect_same_mesh(parse(".mesh", with_returns(format::print_medit(solid))), solid, "mesh");
  expect_same_mesh(parse(".t", with_returns(format::print_t(solid))), solid, "t");
  expect_same_mesh(parse(".msh", with_returns(format::print_gmsh(solid, kAscii))), solid, "msh");
  expect_same_mesh(parse(".vtk", with_returns(format::print_vtk(solid, kAscii))), solid, "vtk");
  expect_same_mesh(parse(".node", with_returns(format::print_tetgen_nodes(solid)),
                         with_returns(format::print_tetgen_elements(solid))),
                   solid, "node");
}

}  // namespace
}  // namespace selvage
