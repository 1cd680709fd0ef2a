// What is written is read back bit for bit, every format in both encodings; a failed write leaves nothing behind.
#include "io/format_samples.h"
#include "temporary_folder.h"

#include <filesystem>

namespace selvage {
namespace {

namespace fs = std::filesystem;

constexpr const char* kEncodingNames[] = {" usual", " ASCII", " binary"};

/// A folder of its own for each test, removed afterwards.
class RoundTrip : public testing::Test {
 protected:
  std::string error_of_writing(const fs::path& path, const IndexedMesh& mesh,
                               FileEncoding encoding = FileEncoding::kUsual) const {
    try {
      write_mesh(path, mesh, encoding);
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  }

  std::string error_of_reading(const char* name) const {
    try {
      read_mesh(folder_ / name);
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  }

  void expect_round_trips(std::initializer_list<std::string_view> extensions, int triangles, int tetrahedra) {
    for (const std::string_view extension : extensions) {
      for (const FileEncoding encoding : {FileEncoding::kUsual, FileEncoding::kAscii, FileEncoding::kBinary}) {
        if (extension == ".off" && encoding == FileEncoding::kBinary) continue;  // which holds floats
        for (unsigned seed = 1; seed <= 4; ++seed) {
          const IndexedMesh mesh = random_mesh(seed, 40 * static_cast<int>(seed), triangles, tetrahedra);
          const fs::path path = folder_ / ("mesh" + std::string(extension));
          write_mesh(path, mesh, encoding);
          expect_same_mesh(read_mesh(path), mesh, std::string(extension) + kEncodingNames[static_cast<int>(encoding)]);
        }
      }
    }
  }

  test::TemporaryFolder folder_;
};

TEST_F(RoundTrip, Surfaces) {
  expect_round_trips({".obj", ".ply", ".off", ".mesh", ".msh", ".vtk", ".vtu"}, 70, 0);
}

TEST_F(RoundTrip, Tetrahedra) {
  expect_round_trips({".t", ".node", ".ele", ".mesh", ".msh", ".vtk", ".vtu"}, 0, 90);
}

TEST_F(RoundTrip, BothKinds) {
  expect_round_trips({".mesh", ".msh", ".vtk", ".vtu"}, 30, 50);
}

TEST_F(RoundTrip, UpperCaseExtensions) {
  expect_round_trips({".OBJ", ".Ply", ".VTU"}, 20, 0);
  expect_round_trips({".NODE", ".ELE", ".T"}, 0, 20);
}

TEST_F(RoundTrip, SpecialCoordinates) {
  IndexedMesh mesh = one_triangle();
  constexpr double kTiny = std::numeric_limits<double>::denorm_min(), kHuge = std::numeric_limits<double>::max();
  mesh.positions = {{-0.0, kTiny, kHuge}, {0.1, 1.0 / 3.0, -1e-300}, {123456789.123456789, -kTiny, -kHuge}};
  for (const char* name : {"m.obj", "m.ply", "m.off", "m.mesh", "m.msh", "m.vtk", "m.vtu"}) {
    for (const FileEncoding encoding : {FileEncoding::kUsual, FileEncoding::kAscii, FileEncoding::kBinary}) {
      if (name == std::string("m.off") && encoding == FileEncoding::kBinary) continue;
      write_mesh(folder_ / name, mesh, encoding);
      expect_same_mesh(read_mesh(folder_ / name), mesh, name);
    }
  }
}

TEST_F(RoundTrip, StlKeepsCornersButNotSharing) {
  IndexedMesh mesh = random_mesh(7, 20, 15, 0);
  for (Vec3& p : mesh.positions) p = {std::sin(p[0]), std::cos(p[1]), std::sin(p[2])};
  for (const FileEncoding encoding : {FileEncoding::kAscii, FileEncoding::kBinary}) {
    write_mesh(folder_ / "m.stl", mesh, encoding);
    const IndexedMesh found = read_mesh(folder_ / "m.stl");
    ASSERT_EQ(found.triangles.size(), mesh.triangles.size());
    ASSERT_EQ(found.positions.size(), 3 * mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      for (int i = 0; i < 3; ++i) {
        const Vec3& exact = mesh.positions[mesh.triangles[t][i]];
        for (int d = 0; d < 3; ++d) {
          const double rounded = static_cast<double>(static_cast<float>(exact[d]));
          EXPECT_EQ(found.positions[found.triangles[t][i]][d], encoding == FileEncoding::kAscii ? exact[d] : rounded);
        }
      }
    }
  }
}

TEST_F(RoundTrip, BinaryOffHoldsFloatsInTheOrderOfTheSpecification) {
  IndexedMesh mesh = random_mesh(8, 50, 60, 0);
  for (Vec3& p : mesh.positions) p = Vec3{std::sin(p[0]), std::cos(p[1]), std::sin(p[2])}.cast<float>().cast<double>();
  write_mesh(folder_ / "m.off", mesh, FileEncoding::kBinary);
  expect_same_mesh(read_mesh(folder_ / "m.off"), mesh, "binary OFF");

  constexpr auto kBig = std::endian::big;
  const std::string expected = "OFF BINARY\n" + packed<std::int32_t>({3, 1, 0}, kBig) +
                               packed<float>({0, 0, 0, 1, 0, 0, 0, 1, 0.5}, kBig) +
                               packed<std::int32_t>({3, 0, 1, 2, 0}, kBig);
  EXPECT_EQ(format::print_off(one_triangle(), FileEncoding::kBinary), expected);
}

TEST_F(RoundTrip, BinaryFormatsOfFloatsRefuseWhatNoFloatHolds) {
  IndexedMesh mesh = one_triangle();
  mesh.positions[1][0] = 1e39;
  for (const char* name : {"m.stl", "m.off"}) {
    EXPECT_NE(error_of_writing(folder_ / name, mesh, FileEncoding::kBinary).find("does not fit"), std::string::npos);
  }
  EXPECT_EQ(folder_.file_count(), 0u);
}

TEST_F(RoundTrip, GridWithFieldsAndLines) {
  VtkGrid grid;
  grid.points = one_tetrahedron().positions;
  grid.lines = {{0, 1}, {1, 2}};
  grid.triangles = {{0, 1, 2}};
  grid.tetrahedra = {{0, 1, 2, 3}};
  grid.point_fields = {{"depth <m>", 1, {0, 1, std::nan(""), 3}}, {"velocity", 3, std::vector<double>(12, 0.5)}};
  grid.cell_fields = {{"hit", 1, {1, 0, 1, 0}}};
  for (const FileEncoding encoding : {FileEncoding::kAscii, FileEncoding::kBinary}) {
    write_vtu(folder_ / "g.vtu", grid, encoding);
    const IndexedMesh found = read_mesh(folder_ / "g.vtu");
    EXPECT_EQ(found.triangles, grid.triangles);
    EXPECT_EQ(found.tetrahedra, grid.tetrahedra);
  }
  grid.cell_fields[0].values.pop_back();
  EXPECT_THROW(write_vtu(folder_ / "bad.vtu", grid), Error);
  EXPECT_FALSE(fs::exists(folder_ / "bad.vtu"));
}

TEST_F(RoundTrip, ElementsThatAFormatCannotHold) {
  for (const char* name : {"m.obj", "m.ply", "m.stl", "m.off"}) {
    EXPECT_NE(error_of_writing(folder_ / name, one_tetrahedron()).find("holds no tetrahedra"), std::string::npos)
        << name;
  }
  for (const char* name : {"m.t", "m.node", "m.ele"}) {
    EXPECT_NE(error_of_writing(folder_ / name, one_triangle()).find("holds no triangles"), std::string::npos) << name;
  }
  EXPECT_THROW(check_format_holds("m.off", one_tetrahedron()), Error);
  EXPECT_THROW(check_format_holds("m.t", one_triangle()), Error);
  EXPECT_THROW(check_format_holds("m.xyz", one_triangle()), Error);
  EXPECT_NO_THROW(check_format_holds("m.off", one_triangle()));
  EXPECT_NO_THROW(check_format_holds("m.t", one_tetrahedron()));
  EXPECT_EQ(folder_.file_count(), 0u);
}

TEST_F(RoundTrip, MeshesThatNoFileMayHold) {
  const fs::path path = folder_ / "m.msh";
  EXPECT_NE(error_of_writing(path, {}).find("no element"), std::string::npos);
  IndexedMesh mesh = one_triangle();
  mesh.triangles[0][2] = 3;
  EXPECT_NE(error_of_writing(path, mesh).find("triangle 0 uses vertex 3, but there are 3"), std::string::npos);
  mesh.triangles[0][2] = -1;
  EXPECT_NE(error_of_writing(path, mesh).find("uses vertex -1"), std::string::npos);
  mesh = one_triangle();
  mesh.positions[2][1] = std::nan("");
  EXPECT_NE(error_of_writing(path, mesh).find("vertex 2 is not finite"), std::string::npos);
  EXPECT_NE(error_of_writing(folder_ / "m.xyz", one_triangle()).find("extension '.xyz' is unknown"), std::string::npos);
  EXPECT_NE(error_of_writing(folder_ / "m", one_triangle()).find("no extension"), std::string::npos);
  EXPECT_EQ(folder_.file_count(), 0u);
}

TEST_F(RoundTrip, FailedWriteLeavesTheOldFile) {
  EXPECT_NE(error_of_writing(folder_ / "missing" / "m.ply", one_triangle()).find("No such file"), std::string::npos);
  EXPECT_EQ(folder_.file_count(), 0u);
  // A folder in the place of the file: the content is written beside it, but cannot be moved there.
  fs::create_directories(folder_ / "taken.ply" / "inside");
  EXPECT_NE(error_of_writing(folder_ / "taken.ply", one_triangle()).find("cannot be written"), std::string::npos);
  EXPECT_EQ(folder_.file_count(), 1u);
  write_mesh(folder_ / "old.ply", one_triangle());
  IndexedMesh bad = one_triangle();
  bad.triangles[0][0] = 9;
  EXPECT_FALSE(error_of_writing(folder_ / "old.ply", bad).empty());
  expect_same_mesh(read_mesh(folder_ / "old.ply"), one_triangle(), "old.ply");
  EXPECT_EQ(folder_.file_count(), 2u);
}

TEST_F(RoundTrip, SecondFileOfAPairFails) {
  // The element file's place is taken by a folder: the node file must not appear either.
  fs::create_directories(folder_ / "m.ele" / "inside");
  EXPECT_FALSE(error_of_writing(folder_ / "m.node", one_tetrahedron()).empty());
  EXPECT_EQ(folder_.file_count(), 1u);
}

TEST_F(RoundTrip, WritesThroughSymbolicLinks) {
  write_mesh(folder_ / "real.ply", one_triangle());
  fs::create_symlink("real.ply", folder_ / "link.ply");
  const IndexedMesh mesh = random_mesh(3, 10, 4, 0);
  write_mesh(folder_ / "link.ply", mesh);
  EXPECT_TRUE(fs::is_symlink(folder_ / "link.ply"));
  expect_same_mesh(read_mesh(folder_ / "real.ply"), mesh, "real.ply");
}

TEST_F(RoundTrip, MissingFilesAndTwins) {
  EXPECT_NE(error_of_reading("none.ply").find("none.ply: cannot be read: No such file"), std::string::npos);
  EXPECT_NE(error_of_reading("none.step").find("extension '.step' is unknown"), std::string::npos);
  EXPECT_NE(error_of_reading("none").find("no extension"), std::string::npos);
  fs::create_directory(folder_ / "folder.ply");
  EXPECT_NE(error_of_reading("folder.ply").find("directory"), std::string::npos);
  write_mesh(folder_ / "alone.node", one_tetrahedron());
  fs::remove(folder_ / "alone.ele");
  EXPECT_NE(error_of_reading("alone.node").find("alone.ele is missing"), std::string::npos);
}

}  // namespace
}  // namespace selvage
