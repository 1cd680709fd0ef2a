#include "cli/arguments/mesh_input.h"
#include "cli/program.h"
#include "cli/reports/components.h"
#include "cli/reports/path_table.h"
#include "cli/reports/quality.h"

#include <nlohmann/json.hpp>

namespace selvage::cli {
namespace {

PathRow found_row() {
  PathRow row;
  row.query = 7;
  row.point = {0.1, -2, 3e-300};
  row.element = 4;
  row.status = PathStatus::kFound;
  row.face = {3, 1, 2};
  row.face_id = 9;
  row.barycentric = {0.5, 0.5, 0};
  row.closest = {1, 2, 3};
  row.distance = 1.0 / 3;
  row.feature = BoundaryFeature::kEdge;
  row.normal = {0, 0, -1};
  row.counters = {1, 2, 3, 4, 5, 6};
  return row;
}

TEST(PathTable, CsvInSpace) {
  PathRow missing = found_row();
  missing.status = PathStatus::kNoPath;
  EXPECT_EQ(print_csv({false, {found_row(), missing}}),
            "query,x,y,z,element,found,face,face_id,b0,b1,b2,sx,sy,sz,distance,feature,nx,ny,nz,"
            "volumes,faces,culled,traversals,elements\n"
            "7,0.1,-2,3e-300,4,1,3 1 2,9,0.5,0.5,0,1,2,3,0.3333333333333333,edge,0,0,-1,1,2,3,4,5\n"
            "7,0.1,-2,3e-300,4,0,,,,,,,,,,,,,,1,2,3,4,5\n");
}

TEST(PathTable, CsvInThePlaneHasNoThirdVertex) {
  const std::string text = print_csv({true, {found_row()}});
  EXPECT_NE(text.find(",3 1,9,0.5,0.5,,1,2,3,"), std::string::npos) << text;
}

TEST(PathTable, JsonRowsAreAnArray) {
  PathRow outside;
  outside.query = 1;
  const auto rows = nlohmann::json::parse(print_json_rows({false, {found_row(), outside}}));
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0]["face"], nlohmann::json({3, 1, 2}));
  EXPECT_EQ(rows[0]["distance"].get<double>(), 1.0 / 3);
  EXPECT_EQ(rows[0]["feature"], "edge");
  EXPECT_EQ(rows[0]["elements"], 5);
  EXPECT_TRUE(rows[1]["element"].is_null());
  EXPECT_TRUE(rows[1]["face"].is_null());
  EXPECT_EQ(rows[1].size(), rows[0].size());
  EXPECT_EQ(nlohmann::json::parse(print_json_rows({})), nlohmann::json::array());
}

TEST(PathTable, TotalsTellTheStatesApart) {
  PathRow longer = found_row(), no_path = found_row(), outside = found_row();
  longer.distance = 2;
  no_path.status = PathStatus::kNoPath;
  outside.status = PathStatus::kNotInElement;
  const PathTable table{false, {found_row(), no_path, longer, outside, longer}};
  const PathTotals totals = total_paths(table);
  EXPECT_EQ(totals.found, 3);
  EXPECT_EQ(totals.no_path, 1);
  EXPECT_EQ(totals.not_in_element, 1);
  EXPECT_EQ(totals.deepest, &table.rows[2]);
  EXPECT_EQ(totals.median, 2);
  EXPECT_EQ(totals.counters.traversals, 20);
  EXPECT_EQ(total_paths({}).deepest, nullptr);
}

TEST(PathTable, LinesAreThePathsFound) {
  PathRow no_path = found_row();
  no_path.status = PathStatus::kNoPath;
  const VtkGrid grid = path_lines({false, {no_path, found_row()}});
  ASSERT_EQ(grid.lines.size(), 1u);
  ASSERT_EQ(grid.points.size(), 2u);
  EXPECT_EQ(grid.points[1], Vec3(1, 2, 3));
  EXPECT_EQ(grid.point_fields[0].values, (std::vector<double>{1.0 / 3, 0}));
  EXPECT_EQ(grid.cell_fields[0].name, "depth");
  EXPECT_EQ(grid.cell_fields[0].values, std::vector<double>{1.0 / 3});
}

TEST(Quality, RegularTetrahedronIsPerfectInAnyOrder) {
  const std::vector<Vec3> x{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  std::array<Index, 4> order{0, 1, 2, 3};
  do {
    const Quality q = measure_quality(x, std::vector<VertexTuple<4>>{order});
    EXPECT_NEAR(q.smallest_angle, 70.528779365509308, 1e-9);
    EXPECT_NEAR(q.largest_angle, 70.528779365509308, 1e-9);
    EXPECT_NEAR(q.worst_ratio, 1, 1e-12);
    EXPECT_NEAR(std::abs(q.measure), 8.0 / 3, 1e-12);
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST(Quality, IsThatOfTheShapeWhateverItsSize) {
  const std::vector<Vec3> x{{0, 0, 0}, {1, 0, 0}, {0.2, 1, 0}, {0.3, 0.1, 1}};
  const std::vector<VertexTuple<4>> tet{{0, 1, 2, 3}};
  const std::vector<VertexTuple<3>> triangle{{0, 1, 3}};
  for (const int exponent : {-1020, -500, 300, 340, 1000}) {
    std::vector<Vec3> scaled = x;
    for (Vec3& p : scaled)
      for (double& coordinate : p) coordinate = std::ldexp(coordinate, exponent);
    EXPECT_EQ(measure_quality(scaled, tet).mean_ratio, measure_quality(x, tet).mean_ratio) << exponent;
    EXPECT_EQ(measure_quality(scaled, tet).largest_angle, measure_quality(x, tet).largest_angle) << exponent;
    EXPECT_EQ(measure_quality(scaled, triangle).mean_ratio, measure_quality(x, triangle).mean_ratio) << exponent;
    EXPECT_EQ(measure_quality(scaled, triangle).measure,
              std::ldexp(measure_quality(x, triangle).measure, 2 * exponent));
  }
}

TEST(Quality, FlatElementsHaveNone) {
  const std::vector<Vec3> x{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 5, 0}};
  const Quality line = measure_quality(x, std::vector<VertexTuple<3>>{{0, 1, 2}});
  EXPECT_EQ(line.smallest_angle, 0);
  EXPECT_EQ(line.worst_ratio, 0);
  EXPECT_EQ(line.measure, 0);
  EXPECT_EQ(measure_quality(x, std::vector<VertexTuple<4>>{{0, 1, 2, 3}}).worst_ratio, 0);
}

TEST(Quality, RightTriangle) {
  const std::vector<Vec3> x{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  const Quality q = measure_quality(x, std::vector<VertexTuple<3>>{{0, 1, 2}});
  EXPECT_NEAR(q.smallest_angle, 45, 1e-9);
  EXPECT_NEAR(q.largest_angle, 90, 1e-9);
  EXPECT_NEAR(q.worst_ratio, 0.8284271247461901, 1e-12);
  EXPECT_NEAR(q.measure, 0.5, 1e-15);
}

TEST(Quality, MeansAreOverAllBlocks) {
  const std::vector<Vec3> x{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}};
  std::vector<VertexTuple<3>> many(20000, {0, 1, 2});
  std::fill(many.begin() + 10000, many.end(), VertexTuple<3>{0, 1, 3});  // flat
  const Quality q = measure_quality(x, many);
  EXPECT_NEAR(q.measure, 5000, 1e-9);
  EXPECT_NEAR(q.mean_smallest_angle, 22.5, 1e-9);
  EXPECT_EQ(q.smallest_angle, 0);
}

TEST(Components, OfSolidsBoundariesAndSurfaces) {
  const TetMesh two(8, {{0, 1, 2, 3}, {4, 5, 6, 7}});
  EXPECT_EQ(count_components(two), 2);
  EXPECT_EQ(count_boundary_components(two), 2);
  const TetMesh touching(7, {{0, 1, 2, 3}, {3, 4, 5, 6}});  // one vertex shared: not across a face
  EXPECT_EQ(count_components(touching), 2);
  const PlanarMesh strip(4, {{0, 1, 2}, {1, 3, 2}});
  EXPECT_EQ(count_components(strip), 1);
  EXPECT_EQ(count_boundary_components(strip), 1);
  EXPECT_EQ(count_components(TriangleMesh(6, {{0, 1, 2}, {2, 1, 3}, {3, 4, 5}})), 2);
}

TEST(MeshInput, PlanarMeansTrianglesAtZeroHeight) {
  IndexedMesh mesh{{{0, 0, 0}, {1, 0, -0.0}, {0, 1, 0}}, {}, {{0, 1, 2}}};
  EXPECT_TRUE(is_planar(mesh));
  EXPECT_EQ(drop_z(mesh.positions)[2], Vec2(0, 1));
  mesh.positions[1][2] = 1e-300;
  EXPECT_FALSE(is_planar(mesh));
  mesh.positions[1][2] = 0;
  mesh.tetrahedra = {{0, 1, 2, 2}};
  EXPECT_FALSE(is_planar(mesh));
}

}  // namespace
}  // namespace selvage::cli
