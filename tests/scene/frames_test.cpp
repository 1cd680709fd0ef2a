#include "selvage/scene/frames.h"

#include "scene/files/statistics_table.h"
#include "selvage/core/error.h"
#include "selvage/shapes/shapes.h"
#include "temporary_folder.h"

#include <gtest/gtest.h>

#include <cstring>

namespace selvage {
namespace {

using test::read_text;
using test::TemporaryFolder;
using test::write_text;

Model make_box_model() {
  const IndexedMesh box = make_box({1, 1, 1}, 0.5);
  Body body{.name = "box",
            .first_vertex = 0,
            .vertex_count = static_cast<Index>(box.positions.size()),
            .first_element = 0,
            .element_count = static_cast<Index>(box.tetrahedra.size()),
            .material = {}};
  return make_model(TetMesh(static_cast<Index>(box.positions.size()), box.tetrahedra), box.positions, {body});
}

TEST(Frames, AreReadAsTheyWereWritten) {
  const TemporaryFolder folder;
  const Model model = make_box_model();
  State state = make_state(model, model.rest_positions);
  state.positions[3] = {1e-30, -0.1, 1.0 / 3};
  state.velocities[5] = {0.1, 0.2, 1e300};
  state.time = 0.7;
  state.steps = 12345678901;
  FrameHeader header;
  header.frame = 7;
  header.elements = model.mesh.element_count();
  header.fingerprint = 0xfedcba9876543210;

  write_checkpoint(folder.path() / "c", header, state);
  const CheckpointFile checkpoint = read_checkpoint(folder.path() / "c");
  EXPECT_EQ(checkpoint.state.positions, state.positions);
  EXPECT_EQ(checkpoint.state.velocities, state.velocities);
  EXPECT_EQ(checkpoint.state.time, 0.7);
  EXPECT_EQ(checkpoint.state.steps, 12345678901);
  EXPECT_EQ(checkpoint.header.frame, 7);
  EXPECT_EQ(checkpoint.header.fingerprint, 0xfedcba9876543210);

  write_frame(folder.path() / "f", header, state.positions);
  const FrameFile frame = read_frame(folder.path() / "f");
  ASSERT_EQ(frame.positions.size(), state.positions.size());
  for (std::size_t v = 0; v < frame.positions.size(); ++v)
    EXPECT_EQ(frame.positions[v], state.positions[v].cast<float>().cast<double>());

  write_frame(folder.path() / "e", header, state.positions, true);
  const FrameFile exact = read_frame(folder.path() / "e");
  EXPECT_EQ(exact.positions, state.positions);
  EXPECT_EQ(exact.header.kind, 4);

  write_topology(folder.path() / "t", model, 9);
  const TopologyFile topology = read_topology(folder.path() / "t");
  EXPECT_TRUE(std::ranges::equal(topology.elements, model.mesh.elements()));
  EXPECT_TRUE(std::ranges::equal(topology.boundary_faces, model.mesh.boundary_faces()));
  EXPECT_EQ(topology.vertex_bodies, std::vector<Index>(model.rest_positions.size(), 0));
}

/// Other programs read the files by these offsets.
TEST(Frames, HaveTheDocumentedLayout) {
  const TemporaryFolder folder;
  FrameHeader header;
  header.elements = 5;
  header.frame = 3;
  header.steps = 60;
  header.time = 0.25;
  header.fingerprint = 77;
  write_frame(folder.path() / "f", header, std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}});
  const std::string bytes = read_text(folder.path() / "f");
  ASSERT_EQ(bytes.size(), 64u + 24u);
  const auto at = [&]<typename T>(std::size_t offset, T) {
    T value;
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
  };
  EXPECT_EQ(bytes.substr(0, 8), std::string("selvage\0", 8));
  EXPECT_EQ(at(8, std::int32_t()), 1);
  EXPECT_EQ(at(12, std::int32_t()), 2);
  EXPECT_EQ(at(16, std::int64_t()), 2);
  EXPECT_EQ(at(24, std::int64_t()), 5);
  EXPECT_EQ(at(32, std::int64_t()), 3);
  EXPECT_EQ(at(40, std::int64_t()), 60);
  EXPECT_EQ(at(48, double()), 0.25);
  EXPECT_EQ(at(56, std::uint64_t()), 77u);
  EXPECT_EQ(at(64 + 12, float()), 4.0f);
}

TEST(Frames, DamagedFilesAreRefused) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "f";
  write_frame(path, {}, std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}});
  const std::string whole = read_text(path);
  EXPECT_THROW(read_checkpoint(path), Error);
  EXPECT_THROW(read_topology(path), Error);
  EXPECT_THROW(read_frame(folder.path() / "none"), Error);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    write_text(path, whole.substr(0, size));
    EXPECT_THROW(read_frame(path), Error) << size;
  }
  write_frame(path, {}, std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}}, true);
  const std::string exact = read_text(path);
  EXPECT_EQ(exact.size(), 64u + 48u);
  for (const std::string& other : {exact.substr(0, 100), exact + "x"}) {
    write_text(path, other);
    EXPECT_THROW(read_frame(path), Error);
  }
  write_text(path, whole + "x");
  EXPECT_THROW(read_frame(path), Error);
  for (const std::size_t offset : {0, 8, 12, 23}) {  // magic, schema, kind, a huge count
    std::string other = whole;
    other[offset] = 0x7f;
    write_text(path, other);
    EXPECT_THROW(read_frame(path), Error) << offset;
  }
}

TEST(StatisticsTable, RowsAreReadAsTheyWereWritten) {
  FrameStatistics first, second;
  second.frame = 1;
  second.time = 1.0 / 60;
  second.edge_edges = 123456789012;
  second.deepest_penetration = 1e-17;
  second.seconds_frame = 0.1;
  const std::string text = statistics_header() + statistics_row(first) + statistics_row(second);
  const auto rows = parse_statistics(text, "t", 1);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[1].time, second.time);
  EXPECT_EQ(rows[1].edge_edges, second.edge_edges);
  EXPECT_EQ(rows[1].deepest_penetration, second.deepest_penetration);
  EXPECT_EQ(statistics_header() + statistics_row(rows[0]) + statistics_row(rows[1]), text);
  // A row that was cut off is no row, and does no harm behind the last one asked for.
  for (std::size_t size = 1; size < statistics_row(second).size(); ++size) {
    const std::string cut = text.substr(0, text.size() - size);
    EXPECT_EQ(parse_statistics(cut, "t", 0).size(), 1u);
    EXPECT_THROW(parse_statistics(cut, "t", 1), Error);
  }
  EXPECT_THROW(parse_statistics("frame,other\n" + statistics_row(first), "t", 0), Error);
}

}  // namespace
}  // namespace selvage
