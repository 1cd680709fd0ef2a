// Bad files: what the message says, and that it names the line or the byte.
#include "io/format_samples.h"

namespace selvage {
namespace {

struct BadFile {
  std::string_view extension;
  std::string bytes;
  std::string expected;  // the message begins with this
  std::string twin = {};
};

void expect_errors(const std::vector<BadFile>& files) {
  for (const BadFile& file : files) {
    const std::string error = error_of(file.extension, file.bytes, file.twin);
    EXPECT_TRUE(error.starts_with(file.expected))
        << file.extension << "\nfound:    " << error << "\nexpected: " << file.expected;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  }
}

const std::string kPly =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
const std::string kPlyBinary =
    "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
    "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
/// With one good face, and the length of another.
const std::string kPlyBinary2 =
    "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
    "property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n" +
    packed<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}) + "\3" + packed<std::int32_t>({0, 1, 2}) + "\3";
const std::string kGmsh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n";
const std::string kMedit = "MeshVersionFormatted 2\nDimension 3\nVertices\n3\n0 0 0 0\n1 0 0 0\n0 1 0 0\n";
const std::string kVtk =
    "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n"
    "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";

TEST(FormatErrors, TextSurfaces) {
  expect_errors({
      {".obj", "", "sample: the file has no triangle and no tetrahedron; give"},
      {".obj", "v 0 0 0\n", "sample: the file has no triangle and no tetrahedron"},
      {".obj", "v 0 0 0\nv 1 0 abc\n", "sample:2: expected 3 coordinates, found 'abc'; "},
      {".obj", "v 0 0\n", "sample:1: expected 3 coordinates, found the end of the line"},
      {".obj", "v 0 0", "sample:1: expected 3 coordinates, found the end of the file; the file is cut short"},
      {".obj", "v 0 0 nan\n", "sample:1: a coordinate is not finite"},
      {".obj", "v 0 0 -inf\n", "sample:1: a coordinate is not finite"},
      {".obj", "v 0 0 1e999\n", "sample:1: a coordinate is not finite"},
      {".obj", "v 0 0 1.5.2\n", "sample:1: expected 3 coordinates, found '1.5.2'"},
      {".obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "sample:4: a face uses vertex 4, but the file has 3 vertices"},
      {".obj", "v 0 0 0\nf 0 1 1\n", "sample:2: a face uses vertex 0"},
      {".obj", "v 0 0 0\nf -2 1 1\n", "sample:2: a face uses vertex -2, but 1 vertices come before it"},
      {".obj", "v 0 0 0\nf 1 x 1\n", "sample:2: expected a vertex number, found 'x'"},
      {".obj", "v 0 0 0\nv 1 0 0\nf 1 2\n", "sample:3: a face has 2 vertices"},
      {".obj", "v 0 0 0\nv 1 0 0\n\nf 1 2 2\n", "sample:4: a triangle uses one vertex twice (vertex 1 from 0)"},
      {".off", "3 1 0\n", "sample:1: expected OFF (or COFF, NOFF, STOFF), found '3'"},
      {".off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
       "sample:6: an element uses vertex 3, but vertices are numbered 0 to 2"},
      {".off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 1\n", "sample:6: a triangle uses one vertex twice"},
      {".off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n",
       "sample:6: expected the number of vertices of a face, found the end"},
      {".off", "OFF\n-3 1 0\n0 0 0\n", "sample:2: the number of vertices is negative: -3"},
      {".stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 inf 0\n",
       "sample:6: a coordinate is not"},
      {".stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n",
       "sample:6: expected 'vertex', found 'endloop'"},
      {".stl", "solid\nendsolid\n", "sample: the file has no triangle and no tetrahedron"},
  });
}

TEST(FormatErrors, Ply) {
  expect_errors({
      {".ply", "plx\n", "sample:1: the file does not begin with 'ply'"},
      {".ply", "ply\nformat ascii 1.0\nelement face 0\nend_header\n", "sample:4: the header lists no element 'vertex'"},
      {".ply", "ply\nformat text 1.0\n", "sample:2: expected ascii, binary_little_endian or binary_big_endian, found"},
      {".ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty half x\n", "sample:4: expected a property type"},
      {".ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n1 1\n",
       "sample:6: the element 'vertex' has no number 'z'"},
      {".ply", "ply\nformat ascii 1.0\nelement vertex 3\n",
       "sample:4: expected 'end_header', found the end of the file"},
      {".ply", kPly + "0 0 0\n1 0 abc\n", "sample:11: expected 3 coordinates, found 'abc'; "},
      {".ply", kPly + "0 0 0\n1 0 0\n0 nan 0\n3 0 1 2\n", "sample:12: a coordinate is not finite"},
      {".ply", kPly + "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
       "sample:13: an element uses vertex 3, but vertices are numbered 0 to 2"},
      {".ply", kPly + "0 0 0\n1 0 0\n0 1 0\n3 0 -1 2\n", "sample:13: an element uses vertex -1"},
      {".ply", kPly + "0 0 0\n1 0 0\n0 1 0\n3 0 2 2\n", "sample:13: a triangle uses one vertex twice"},
      {".ply", kPly + "0 0 0\n1 0 0\n0 1 0\n2 0 2\n", "sample:13: a face has 2 vertices"},
      {".ply", kPly + "0 0 0\n1 0 0\n0 1 0\n3 0 2\n", "sample:13: expected a vertex number, found the end of the line"},
      {".ply", kPly + "0 0 0\n1 0 0\n0 1 0\n", "sample:13: expected an element 'face', found the end of the file"},
      {".ply", kPlyBinary + packed<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}) + "\3" + packed<std::int32_t>({0, 1, 9}),
       "sample: byte 214: an element uses vertex 9"},
      {".ply", kPlyBinary + packed<float>({0, 0, 0, 1, 0, 0, 0, 1, INFINITY}),
       "sample: byte 201: a coordinate is not finite"},
      {".ply", kPlyBinary + packed<float>({0, 0, 0, 1, 0, 0, 0}),
       "sample: byte 158: 3 elements 'vertex' are announced, but only 28 bytes follow"},
      {".ply", kPlyBinary + packed<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}) + "\3\1\1",
       "sample: byte 205: 3 list entries are announced"},
      {".ply", kPlyBinary2 + packed<std::int32_t>({0, 1, -1}), "sample: byte 227: an element uses vertex -1"},
      {".ply", kPlyBinary2 + packed<std::int32_t>({1, 2, 1}),
       "sample: byte 227: a triangle uses one vertex twice (vertex 1 from 0)"},
      {".ply", kPlyBinary2 + packed<std::int32_t>({1, 2}), "sample: byte 218: 3 list entries are announced"},
  });
}

TEST(FormatErrors, Tetrahedra) {
  const std::string vertices = "Vertex 0 0 0 0\nVertex 1 1 0 0\nVertex 2 0 1 0\nVertex 4 0 0 1\n";
  const std::string nodes = "4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n";
  expect_errors({
      {".t", vertices, "sample: the file has no triangle and no tetrahedron"},
      {".t", vertices + "Tet 0 0 1 2 3\n", "sample:5: an element uses vertex 3, but 4 other vertices are defined"},
      {".t", vertices + "Tet 0 0 1 2 1\n", "sample:5: a tetrahedron uses one vertex twice (vertex 1 from 0)"},
      {".t", vertices + "Tet 0 0 1 2\n", "sample:5: expected 4 vertex ids, found the end of the line"},
      {".t", vertices + "Hex 0 0 1 2\n", "sample:5: expected 'Vertex' or 'Tet', found 'Hex'"},
      {".t", vertices + "Vertex 2 5 5 5\nTet 0 0 1 2 4\n", "sample: vertex id 2 is given twice"},
      {".t", "Vertex x 0 0 0\n", "sample:1: expected a vertex id, found 'x'"},
      {".node", nodes, "twin:1: expected the number of elements, found the end of the file", ""},
      {".node", nodes, "twin:2: an element uses vertex 5, but vertices are numbered 1 to 4", "1 4 0\n1 1 2 3 5\n"},
      {".node", nodes, "twin:2: a tetrahedron uses one vertex twice", "1 4 0\n1 1 2 2 4\n"},
      {".node", nodes, "twin:1: elements have 10 nodes instead of 4", "1 10 0\n"},
      {".ele", "1 4 0\n1 1 2 3 4\n", "twin:3: a coordinate is not finite", "2 3 0 0\n1 0 0 0\n2 nan 0 0\n"},
      {".ele", "1 4 0\n1 1 2 3 4\n", "twin:1: the dimension is 4 instead of 2 or 3", "4 4 0 0\n"},
      {".node", nodes, "sample: the file has no triangle and no tetrahedron", "0 4 0\n"},
  });
}

TEST(FormatErrors, MeditAndGmsh) {
  expect_errors({
      {".mesh", "Vertices 3\n", "sample:1: expected 'MeshVersionFormatted', found 'Vertices'"},
      {".mesh", kMedit + "Triangles\n1\n1 2 4 0\n",
       "sample:10: an element uses vertex 4, but vertices are numbered 1 to 3"},
      {".mesh", kMedit + "Triangles\n1\n0 1 2 0\n", "sample:10: an element uses vertex 0"},
      {".mesh", kMedit + "Triangles\n1\n1 2 2 0\n", "sample:10: a triangle uses one vertex twice"},
      {".mesh", kMedit + "Hexahedra\n1\n1 2 3 4 5 6 7 8 0\n", "sample:9: the section Hexahedra is not read; split"},
      {".mesh", kMedit + "Triangles\n2\n1 2 3 0\nEnd\n", "sample:11: expected a vertex number, found 'End'"},
      {".mesh", "MeshVersionFormatted 2\nTriangles 1\n1 2 3 0\nVertices 3\n",
       "sample:3: an element uses vertex 1, but the file has no vertices"},
      {".msh", "hello\n", "sample:1: the file does not begin with '$MeshFormat'"},
      {".msh", "$MeshFormat\n4 0 8\n$EndMeshFormat\n", "sample:2: version 4 is not read; save as version 4.1 or 2.2"},
      {".msh", kGmsh, "sample:10: the file has no section $Elements"},
      {".msh", kGmsh + "$Elements\n1\n1 2 0 1 2 4\n$EndElements\n", "sample:12: an element uses vertex 4"},
      {".msh", kGmsh + "$Elements\n1\n1 2 0 1 2 2\n$EndElements\n", "sample:12: a triangle uses one vertex twice"},
      {".msh", kGmsh + "$Elements\n1\n1 5 0 1 2 3 1 2 3 1 2\n$EndElements\n",
       "sample:12: the element is a hexahedron (type 5): only triangles"},
      {".msh", kGmsh + "$Elements\n1\n1 11 0 1 2 3\n$EndElements\n",
       "sample:12: the element is a second-order tetrahedron (type 11)"},
      {".msh", kGmsh + "$Elements\n1\n1 2 0 1 2 3\n1 2 0 1 2 3\n$EndElements\n",
       "sample:13: expected '$EndElements', found '1'"},
      {".msh", kGmsh + "$Elements\n1\n1 15 0 1\n$EndElements\n", "sample: the file has no triangle and no tetrahedron"},
      {".msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n2\n1 0 0 0\n1 0 nan 0\n",
       "sample:7: a coordinate is not finite"},
      {".msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n2\n1 0 0 0\n1 0 1 0\n$EndNodes\n",
       "sample:7: node tag 1 is given twice"},
  });
}

TEST(FormatErrors, Vtk) {
  expect_errors({
      {".vtk", "vtk\n", "sample:1: the file does not begin with '# vtk DataFile Version'"},
      {".vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_GRID\n",
       "sample:4: the dataset 'STRUCTURED_GRID' is not read; save it as"},
      {".vtk", kVtk + "CELLS 1 5\n4 0 1 2 4\nCELL_TYPES 1\n10\n",
       "sample:10: an element uses vertex 4, but vertices are numbered 0 to 3"},
      {".vtk", kVtk + "CELLS 1 5\n4 0 1 2 2\nCELL_TYPES 1\n10\n", "sample:10: a tetrahedron uses one vertex twice"},
      {".vtk", kVtk + "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n12\n", "sample:10: the element is a hexahedron (type 12)"},
      {".vtk", kVtk + "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n5\n",
       "sample:10: a cell of type 5 has 4 vertices instead of 3"},
      {".vtk", kVtk + "CELLS 2 5\n4 0 1 2 3\nCELL_TYPES 1\n5\n", "sample:11: cell 1 does not fit in the 5 entries"},
      {".vtk", kVtk + "CELLS 1 5\n4 0 1 2 3\n", "sample:12: 1 cells have 0 types"},
      {".vtk", kVtk + "CELLS 1 5\n4 0 1 2 x\n", "sample:11: expected cell entries, found 'x'"},
      {".vtk",
       kVtk + "CELLS 3 7\nOFFSETS vtktypeint64\n2 5 3\nCONNECTIVITY vtktypeint64\n0 1 2 0 1 2 3\nCELL_TYPES 2\n5 10\n",
       "sample:10: the offsets of cell 1 are out of order or range"},
      {".vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 1 double\n0 0 inf\n",
       "sample:6: a coordinate is not finite"},
      {".vtk", "# vtk DataFile Version 3.0\nt\nBINARY\nDATASET POLYDATA\nPOINTS 1 float\n" + packed<float>({0, 0}),
       "sample: byte 62: 1 points are announced"},
  });
}

std::string vtu(std::string_view points, std::string_view connectivity, std::string_view types,
                std::string_view count = "3") {
  std::string text = "<VTKFile type='UnstructuredGrid'>\n<UnstructuredGrid>\n<Piece NumberOfPoints='";
  text.append(count).append("' NumberOfCells='1'>\n<Points>\n<DataArray type='Float64' Name='p' format='ascii'>\n");
  text.append(points).append(
      "\n</DataArray></Points>\n<Cells>\n<DataArray type='Int32' Name='connectivity' format='ascii'>");
  text.append(connectivity)
      .append("</DataArray>\n<DataArray type='Int32' Name='offsets' format='ascii'>3</DataArray>\n");
  text.append("<DataArray type='UInt8' Name='types' format='ascii'>").append(types);
  return text.append("</DataArray>\n</Cells></Piece></UnstructuredGrid></VTKFile>\n");
}

TEST(FormatErrors, Vtu) {
  const std::string points = "0 0 0\n1 0 0\n0 1 0";
  ASSERT_EQ(error_of(".vtu", vtu(points, "0 1 2", "5")), "");
  expect_errors({
      {".vtu", "", "sample:1: this is no well-formed XML"},
      {".vtu", "<VTKFile type='UnstructuredGrid'>\n<UnstructuredGrid>\n</VTKFile>",
       "sample:3: this is no well-formed XML"},
      {".vtu", "<a/>", "sample:1: the file has no element <VTKFile>"},
      {".vtu", "<VTKFile type='PolyData'/>", "sample:1: the file holds 'PolyData'; save it as UnstructuredGrid"},
      {".vtu", "<VTKFile type='UnstructuredGrid' compressor='vtkLZ4DataCompressor'/>",
       "sample:1: the compressor 'vtkLZ4DataCompressor' is not read"},
      {".vtu", vtu("0 0 0\n1 0 0\n0 1 x", "0 1 2", "5"), "sample:8: expected a number, found 'x'"},
      {".vtu", vtu("0 0 0\n1 0 0\n0 1", "0 1 2", "5"), "sample:5: the array 'p' holds 8 values instead of 9"},
      {".vtu", vtu("0 0 0\n1 nan 0\n0 1 0", "0 1 2", "5"), "sample:5: a coordinate of point 1 is not finite"},
      {".vtu", vtu(points, "0 1 3", "5"), "sample:11: an element uses vertex 3"},
      {".vtu", vtu(points, "0 1 1", "5"), "sample:11: a triangle uses one vertex twice"},
      {".vtu", vtu(points, "0 1", "5"), "sample:12: offset 3 of cell 0 is out of order or range"},
      {".vtu", vtu(points, "0 1 2", "10"), "sample:11: a cell of type 10 has 3 vertices instead of 4"},
      {".vtu", vtu(points, "0 1 2", "3"), "sample: the file has no triangle and no tetrahedron"},
      {".vtu", vtu(points, "0 1 2", "5", "10000000000"), "sample:3: NumberOfPoints 10000000000 are too many"},
      {".vtu", vtu(points, "0 1 2", "5", "1000000000"), "sample:5: the array 'p' holds 9 values instead of 3000000000"},
      {".vtu", vtu(points, "0 1 2", "5", "x"), "sample:3: expected NumberOfPoints=\"a count\", found 'x'"},
  });
}

/// Headers that claim far more than the file holds: refused at once, with nothing of that size allocated.
TEST(FormatErrors, HugeClaims) {
  const auto big = std::endian::big;
  const std::string binary_stl = std::string(80, 'x') + packed<std::uint32_t>({4000000000u}) + std::string(100, '\0');
  const std::string gmsh4 = "$MeshFormat\n4.1 1 8\n" + packed<std::int32_t>({1}) + "\n$EndMeshFormat\n$Nodes\n";
  const std::string vtu_head = "<VTKFile type='UnstructuredGrid' header_type='UInt64'";
  const std::string vtu_tail =
      "><UnstructuredGrid><Piece NumberOfPoints='3' NumberOfCells='1'><Points><DataArray type='Float64' "
      "format='appended' offset='0'/></Points></Piece></UnstructuredGrid><AppendedData encoding='raw'>_";
  const std::string claim = "are announced";
  const std::vector<BadFile> files = {
      {".ply",
       "ply\nformat ascii 1.0\nelement vertex 2000000000\nproperty float x\nproperty float y\nproperty float "
       "z\nend_header\n0 0 0\n",
       claim},
      {".ply",
       "ply\nformat binary_big_endian 1.0\nelement vertex 2000000000\nproperty float x\nproperty float y\nproperty "
       "float z\nend_header\n0 0 0\n",
       claim},
      {".ply", kPlyBinary + packed<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}) + "\xff", claim},
      {".off", "OFF\n2000000000 1 0\n0 0 0\n", claim},
      {".off", "OFF\n1 1 0\n0 0 0\n2000000000 0 1 2\n", claim},
      {".off", "OFF BINARY\n" + packed<std::int32_t>({2000000000, 1, 0}, big), claim},
      {".stl", binary_stl, claim},
      {".node", "2000000000 3 0 0\n1 0 0 0\n", claim},
      {".ele", "2000000000 4 0\n1 1 2 3 4\n", claim, "1 3 0 0\n1 0 0 0\n"},
      {".mesh", "MeshVersionFormatted 2\nDimension 3\nVertices\n2000000000\n0 0 0 0\n", claim},
      {".mesh", kMedit + "Tetrahedra\n2000000000\n1 2 3 4 0\n", claim},
      {".msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n2000000000\n1 0 0 0\n", claim},
      {".msh", kGmsh + "$Elements\n99999999999\n1 2 0 1 2 3\n", claim},
      {".msh", gmsh4 + packed<std::uint64_t>({1, 1u << 31, 1, 4}), claim},
      {".msh", gmsh4 + packed<std::uint64_t>({1, ~0ull, 1, 4}), "is negative"},
      {".msh",
       gmsh4 + packed<std::uint64_t>({1, 2, 1, 4}) + packed<std::int32_t>({3, 1, 0}) +
           packed<std::uint64_t>({1ull << 40}) + std::string(60, 'x'),
       claim},
      {".vtk", "# vtk DataFile Version 3.0\nt\nBINARY\nDATASET POLYDATA\nPOINTS 2000000000 double\n0", claim},
      {".vtk", kVtk + "CELLS 1 2000000000\n4 0 1 2 3\n", claim},
      {".vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nFIELD f 1\na 2000000000 2000000000 int\n0",
       claim},
      {".vtu", vtu_head + vtu_tail + packed<std::uint64_t>({10ull << 30}) + "abc", claim},
      {".vtu",
       vtu_head + " compressor='vtkZLibDataCompressor'" + vtu_tail + packed<std::uint64_t>({1, 10ull << 30, 0, 3}) +
           "abc",
       "cannot be decompressed"},
      {".vtu",
       vtu_head + " compressor='vtkZLibDataCompressor'" + vtu_tail + packed<std::uint64_t>({1ull << 60, 8, 0, 3}) +
           "abc",
       "header is cut short"},
  };
  for (const BadFile& file : files) {
    const std::string error = error_of(file.extension, file.bytes, file.twin);
    EXPECT_NE(error.find(file.expected), std::string::npos)
        << file.extension << " " << file.bytes.substr(0, 60) << "\nfound: " << error;
  }
}

}  // namespace
}  // namespace selvage
