// Small files written by hand, one for each thing that a format allows; and the corpus of the fuzzers.
#include "io/format_samples.h"

#include <filesystem>
#include <fstream>
#include <iterator>

namespace selvage {
namespace {

using Tets = std::vector<VertexTuple<4>>;
using Triangles = std::vector<VertexTuple<3>>;

std::string corpus_file(const std::string& name) {
  std::ifstream file(std::filesystem::path(SELVAGE_FUZZ_CORPUS) / name, std::ios::binary);
  EXPECT_TRUE(file) << name;
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

TEST(ObjSample, CornerFormsNegativeNumbersPolygonsAndJoinedLines) {
  const IndexedMesh mesh = parse(".obj",
                                 "# forms\nv 0 0 0\nv 1 0 0 1.0\r\nv 1 1 0 0.5 0.5 0.5\nv 0 1 0.5\nvt 0 0\nvn 0 0 1\n"
                                 "usemtl stone\nf 1/1/1 2//1 3/1 \\\n 4\nf -4 -3 -2 # back\nl 1 2\n");
  ASSERT_EQ(mesh.positions.size(), 4u);
  EXPECT_EQ(mesh.positions[3], Vec3(0, 1, 0.5));
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}, {0, 1, 2}}));
}

TEST(ObjSample, KeepsNumbersOfFaces) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\n";
  const IndexedMesh mixed = parse(".obj", vertices + "f 1 2 5\nf 1 2 3 4\nf 2 3 5\nf 1 2 3 4 5\n");
  EXPECT_EQ(mixed.triangles.size(), 7u);
  EXPECT_EQ(mixed.faces, (std::vector<Index>{0, 1, 1, 2, 3, 3, 3}));
  EXPECT_EQ(parse(".obj", vertices + "f 1 2 3 4\nf 1 2 5\n").faces, (std::vector<Index>{0, 0, 1}));
  EXPECT_TRUE(parse(".obj", vertices + "f 1 2 5\nf 2 3 5\n").faces.empty());
}

TEST(ObjSample, KeepsObjectsAndGroups) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  const IndexedMesh mesh = parse(".obj", vertices +
                                             "f 1 2 3\no the  shirt # blue\nf 1 2 3 4\ng sleeve\nf 1 2 4\n"
                                             "o trousers\nf 2 3 4\no the shirt\nf 1 3 4\n");
  EXPECT_EQ(mesh.group_names, (std::vector<std::string>{"the shirt", "the shirt/sleeve", "trousers"}));
  EXPECT_EQ(mesh.groups, (std::vector<Index>{kNone, 0, 0, 1, 2, 0}));
  const std::string text = format::print_obj(mesh);
  EXPECT_NE(text.find("o the_shirt/sleeve\nf 1 2 4\no trousers\nf 2 3 4\no the_shirt\n"), std::string::npos) << text;
  EXPECT_EQ(text.find("o "), text.find("o the_shirt\nf 1 2 3\nf 1 3 4\n"));
  EXPECT_EQ(parse(".obj", text).groups, mesh.groups);
  const IndexedMesh plain = parse(".obj", vertices + "f 1 2 3\n");
  EXPECT_TRUE(plain.groups.empty() && plain.group_names.empty());
}

TEST(PlySample, ColoursStandBehindVerticesAndFaces) {
  const std::vector<Colour8> vertices{{1, 2, 3}, {4, 5, 6}, {7, 8, 255}}, faces{{9, 10, 11}};
  const std::string text = format::print_ply(one_triangle(), FileEncoding::kAscii, vertices, faces);
  EXPECT_NE(text.find(" 7 8 255\n3 0 1 2 9 10 11\n"), std::string::npos) << text;
  expect_same_mesh(parse(".ply", text), one_triangle(), "coloured text");
  expect_same_mesh(parse(".ply", format::print_ply(one_triangle(), FileEncoding::kBinary, vertices, faces)),
                   one_triangle(), "coloured");
}

TEST(OffSample, KeepsNumbersOfFaces) {
  const IndexedMesh mesh = parse(".off", "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n3 0 1 2\n");
  EXPECT_EQ(mesh.faces, (std::vector<Index>{0, 0, 1}));
}

TEST(ObjSample, FacesBeforeTheirVertices) {
  expect_same_mesh(parse(".obj", "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0.5"), one_triangle(), "obj");
}

TEST(PlySample, AnyOrderOfPropertiesAndElements) {
  const IndexedMesh mesh = parse(".ply",
                                 "ply\r\nformat ascii 1.0\r\ncomment made by hand\r\nelement face 1\r\n"
                                 "property list uchar int vertex_indices\r\nproperty uchar red\r\nelement odd 2\r\n"
                                 "property list uchar float values\r\nelement vertex 4\r\nproperty uchar red\r\n"
                                 "property float z\r\nproperty double y\r\nproperty int x\r\nend_header\r\n"
                                 "4 0 1 2 3 255\r\n2 0.5 nan\r\n0\r\n1 0 0 0\r\n1 0 0 1\r\n1 0 1 1\r\n1 0.5 1 0\r\n");
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(mesh.positions[3], Vec3(0, 1, 0.5));
}

TEST(PlySample, BinaryOfBothByteOrders) {
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    std::string file = std::string("ply\nformat binary_") + (order == std::endian::big ? "big" : "little") +
                       "_endian 1.0\nelement vertex 3\nproperty short x\nproperty float y\nproperty double z\n"
                       "property list ushort uchar tags\nelement edge 1\nproperty uint a\nelement face 1\n"
                       "property ushort group\nproperty list uint short vertex_index\nend_header\n";
    const double points[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0.5}};
    for (const auto& p : points) {
      file += packed<std::int16_t>({static_cast<std::int16_t>(p[0])}, order);
      file += packed<float>({static_cast<float>(p[1])}, order) + packed<double>({p[2]}, order);
      file += packed<std::uint16_t>({2}, order) + "ab";
    }
    file += packed<std::uint32_t>({77}, order) + packed<std::uint16_t>({5}, order);
    file += packed<std::uint32_t>({3}, order) + packed<std::int16_t>({0, 1, 2}, order);
    expect_same_mesh(parse(".ply", file), one_triangle(), "binary ply");
  }
}

TEST(StlSample, AsciiWithSeveralSolidsAndBinaryThatBeginsWithSolid) {
  const std::string facet =
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 5e-1\nendloop\nendfacet\n";
  const IndexedMesh two =
      parse(".stl", "solid a b c\n" + facet + "endsolid a b c\nsolid\n" + facet + facet + "endsolid\n");
  EXPECT_EQ(two.triangles, (Triangles{{0, 1, 2}, {3, 4, 5}, {6, 7, 8}}));
  EXPECT_EQ(two.positions[8], Vec3(0, 1, 0.5));
  for (std::string header : {"solid facet", "made by hand"}) {
    header.resize(80, header[0] == 's' ? ' ' : '\0');
    const std::string file = header + packed<std::uint32_t>({1}) +
                             packed<float>({0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0.5}) + packed<std::uint16_t>({9});
    expect_same_mesh(parse(".stl", file), one_triangle(), header);
  }
}

TEST(OffSample, HeadersCommentsColoursAndNormals) {
  for (const char* head :
       {"OFF\n3 1 0\n", "OFF 3 1 3\n", "# first\nOFF # here\n\n3\n1 0\n", "COFF\n3 1 0\n", "STCNOFF\n3 1 0\n"}) {
    expect_same_mesh(
        parse(".off", std::string(head) + "0 0 0 0.1 0.2\n1 0 0\n# c\n\n0 1 0.5 1 1 1 1\n3 0 1 2 255 0 0\n"),
        one_triangle(), head);
  }
}

TEST(OffSample, Binary) {
  const auto big = std::endian::big;
  const std::string file = "NOFF BINARY\n" + packed<std::int32_t>({3, 1, 0}, big) +
                           packed<float>({0, 0, 0, 9, 9, 9, 1, 0, 0, 9, 9, 9, 0, 1, 0.5, 9, 9, 9}, big) +
                           packed<std::int32_t>({3, 0, 1, 2, 1}, big) + packed<float>({0.5f}, big);
  expect_same_mesh(parse(".off", file), one_triangle(), "binary off");
}

TEST(TSample, IdsWithGapsKeepTheOrderOfTheFile) {
  const std::string vertices = "Vertex 7 0 0 0\nVertex 3 1 0 0\nVertex 900000000000 0 1 0\nVertex -2 0 0 1\n";
  expect_same_mesh(parse(".t", vertices + "Tet 0 7 3 900000000000 -2\n"), one_tetrahedron(), "t");
  expect_same_mesh(parse(".t", "# first the tet\nTet 5 7 3 900000000000 -2\n\n" + vertices), one_tetrahedron(), "t");
}

TEST(TetgenSample, FromZeroOrOneWithAttributesMarkersAndComments) {
  expect_same_mesh(parse(".node", "# nodes\n4 3 1 1\n1 0 0 0 5 1\n2 1 0 0 5 1\n\n3 0 1 0 5 1\n4 0 0 1 5 1 # end\n",
                         "1 4 1\n1 1 2 3 4 9\n"),
                   one_tetrahedron(), "from 1");
  expect_same_mesh(parse(".ele", "1 4 0\n0 0 1 2 3\n", "4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n"),
                   one_tetrahedron(), "from 0");
  EXPECT_EQ(parse(".node", "3 2 0 0\n0 0 0\n1 1 0\n2 0 1\n", "1 3 0\n0 0 1 2\n").triangles, (Triangles{{0, 1, 2}}));
}

TEST(MeditSample, SectionsThatAreReadAndPassedOver) {
  const IndexedMesh mesh =
      parse(".mesh",
            "MeshVersionFormatted 2\nDimension\n3\n# comment\nVertices 4\n0 0 0 1\n1 0 0 1\n0 1 0 1\n"
            "0 0 1 1\nCorners\n1\n1\nEdges 1\n1 2 0\nTriangles\n1\n1 2 3 0\nQuadrilaterals 1\n1 2 3 4 0\n"
            "Hexahedra 0\nTetrahedra 1\n1 2 3 4 0\nEnd\n");
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(mesh.tetrahedra, (Tets{{0, 1, 2, 3}}));
  const IndexedMesh flat =
      parse(".mesh", "MeshVersionFormatted 1 Dimension 2 Vertices 3 0 0 0 1 0 0 0 1 0 Triangles 1 1 2 3 0");
  EXPECT_EQ(flat.positions[2], Vec3(0, 1, 0));
}

TEST(GmshSample, Version2WithGapsInTagsPointsAndLines) {
  const IndexedMesh mesh =
      parse(".msh",
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"a\"\n$EndPhysicalNames\n"
            "$Nodes\n4\n10 0 0 0\n7 1 0 0\n3 0 1 0\n40000 0 0 1\n$EndNodes\n$Elements\n5\n1 15 2 0 1 10\n"
            "2 1 2 0 1 10 7\n3 2 2 0 1 10 7 3\n4 4 0 10 7 3 40000\n5 3 1 0 10 7 3 40000\n$EndElements\n");
  EXPECT_EQ(mesh.tetrahedra, (Tets{{0, 1, 2, 3}}));
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {0, 1, 2}, {0, 2, 3}}));
}

TEST(GmshSample, Version4WithBlocksAndParameters) {
  const IndexedMesh mesh =
      parse(".msh",
            "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Comments\nhello\n$EndComments\n$Nodes\n2 4 3 90\n"
            "0 1 0 1\n5\n0 0 0\n2 1 1 3\n3\n90\n8\n1 0 0 0.1 0.2\n0 1 0 0 0\n0 0 1 0 0\n$EndNodes\n"
            "$Elements\n3 3 1 3\n1 1 1 1\n1 5 3\n2 1 2 1\n2 5 3 90\n3 1 4 1\n3 5 3 90 8\n$EndElements\n");
  EXPECT_EQ(mesh.positions, one_tetrahedron().positions);
  EXPECT_EQ(mesh.tetrahedra, (Tets{{0, 1, 2, 3}}));
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}}));
}

TEST(VtkSample, PolygonsStripsAndFieldsOfBothGenerations) {
  const std::string points = "POINTS 4 double\n0 0 0 1 0 0\n0 1 0 0 0 1\n";
  const IndexedMesh old =
      parse(".vtk", "# vtk DataFile Version 2.0\ntitle\nASCII\nDATASET POLYDATA\n" + points +
                        "LINES 1 3\n2 0 1\nPOLYGONS 1 5\n4 0 1 2 3\nTRIANGLE_STRIPS 1 5\n4 0 1 2 3\n");
  EXPECT_EQ(old.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}, {0, 1, 2}, {2, 1, 3}}));
  const IndexedMesh grid = parse(".vtk",
                                 "# vtk DataFile Version 5.1\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\n"
                                 "FIELD FieldData 2\nTIME 1 1 double\n0.5\nwho 1 2 string\nyou\nand me\n" +
                                     points +
                                     "METADATA\nINFORMATION 0\n\nCELLS 3 7\nOFFSETS vtktypeint64\n0 3 7\n"
                                     "CONNECTIVITY vtktypeint64\n0 1 2 0 1 2 3\nCELL_TYPES 2\n5 10\nPOINT_DATA 4\n"
                                     "SCALARS a float\nLOOKUP_TABLE default\n1 2 3 4\n");
  EXPECT_EQ(grid.triangles, (Triangles{{0, 1, 2}}));
  EXPECT_EQ(grid.tetrahedra, (Tets{{0, 1, 2, 3}}));
}

TEST(VtuSample, SeveralPieces) {
  const std::string piece =
      "<Piece NumberOfPoints='3' NumberOfCells='1'><Points><DataArray type='Float32' NumberOfComponents='3' "
      "format='ascii'>0 0 0 1 0 0 0 1 0.5</DataArray></Points><Cells><DataArray type='Int32' Name='connectivity' "
      "format='ascii'>0 1 2</DataArray><DataArray type='Int32' Name='offsets' format='ascii'>3</DataArray>"
      "<DataArray type='UInt8' Name='types' format='ascii'>5</DataArray></Cells></Piece>";
  const IndexedMesh mesh =
      parse(".vtu", "<VTKFile type='UnstructuredGrid'><UnstructuredGrid>" + piece + piece +
                        "<Piece NumberOfPoints='0' NumberOfCells='0'/></UnstructuredGrid></VTKFile>");
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {3, 4, 5}}));
  EXPECT_EQ(mesh.positions.size(), 6u);
}

TEST(CorpusSample, EveryBinaryVariantHoldsTheSameMesh) {
  IndexedMesh both = one_tetrahedron();
  both.triangles = {{0, 1, 2}};
  for (const char* name : {"ascii", "inline", "raw", "base64", "inline_zlib", "raw_zlib", "base64_zlib"}) {
    expect_same_mesh(parse(".vtu", corpus_file(std::string("vtu/") + name + ".vtu")), both, name);
  }
  for (const char* name : {"b22le.msh", "b22be.msh", "a22.msh"}) {
    expect_same_mesh(parse(".msh", corpus_file(std::string("msh/") + name)), both, name);
  }
  for (const char* name : {"b3.vtk", "b51.vtk"}) {
    expect_same_mesh(parse(".vtk", corpus_file(std::string("vtk/") + name)), both, name);
  }
  for (const char* name : {"b41le.msh", "b41be.msh"}) {
    expect_same_mesh(parse(".msh", corpus_file(std::string("msh/") + name)), one_tetrahedron(), name);
  }
}

/// Every file of the corpus with its end cut off at every byte, and with every byte changed: a mesh or an Error.
TEST(CorpusSample, CutAndDamagedFilesNeverCrash) {
  namespace fs = std::filesystem;
  int read = 0, refused = 0;
  const auto attempt = [&](const std::string& extension, std::string_view bytes) {
    const std::size_t split = extension == ".node" ? std::min(bytes.find('\0'), bytes.size()) : bytes.size();
    try {
      parse(extension, bytes.substr(0, split), split < bytes.size() ? bytes.substr(split + 1) : std::string_view());
      ++read;
    } catch (const Error&) {
      ++refused;
    }
  };
  for (const auto& folder : fs::directory_iterator(SELVAGE_FUZZ_CORPUS)) {
    const std::string format = folder.path().filename().string();
    for (const auto& entry : fs::directory_iterator(folder.path())) {
      const std::string bytes = corpus_file(format + "/" + entry.path().filename().string());
      for (std::size_t size = 0; size < bytes.size(); ++size)
        attempt("." + format, std::string_view(bytes).substr(0, size));
      for (std::size_t at = 0; at < bytes.size(); ++at) {
        for (const char c : {'\0', '\xff', '9', '-', '\n'}) {
          std::string damaged = bytes;
          damaged[at] = c;
          attempt("." + format, damaged);
        }
      }
    }
  }
  EXPECT_GT(read, 1000);
  EXPECT_GT(refused, 10000);
}

}  // namespace
}  // namespace selvage
