#pragma once

#include "selvage/simulation/model.h"

#include <filesystem>

namespace selvage {

/// Files of a run. All are little-endian and begin with a header of 64 bytes:
///
///   offset  type       meaning
///        0  char[8]    "selvage" and a zero byte
///        8  int32      schema: 1
///       12  int32      kind: 1 topology, 2 frame, 3 checkpoint, 4 exact frame
///       16  int64      vertices
///       24  int64      elements
///       32  int64      frame
///       40  int64      steps done
///       48  float64    time [s]
///       56  uint64     fingerprint of the scene
///
/// topology.bin: elements (n_elements x 4 int32), body of each vertex (n_vertices int32), boundary faces, outward, and
/// then cloth (rest x 3 int32). frames/frame_000000.bin: positions (n_vertices x 3 float32) [m]; rest.bin the same at
/// rest. checkpoint.bin: positions and velocities (twice n_vertices x 3 float64), then how long
/// each body has rested (n_bodies float64) [s], or nothing. Frames are for viewing, for which single
/// precision suffices. Runs are continued, and statistics measured, in double precision. run_scene() rounds so that
/// triangles that are apart stay apart, nearly always. Frames of a guaranteed run are exact (n_vertices x 3 float64).
struct FrameHeader {
  std::array<char, 8> magic{'s', 'e', 'l', 'v', 'a', 'g', 'e', 0};
  std::int32_t schema = 1;
  std::int32_t kind = 0;
  std::int64_t vertices = 0;
  std::int64_t elements = 0;
  std::int64_t frame = 0;
  std::int64_t steps = 0;
  double time = 0;
  std::uint64_t fingerprint = 0;
};
static_assert(sizeof(FrameHeader) == 64);

enum class FrameFileKind : std::int32_t { kTopology = 1, kFrame = 2, kCheckpoint = 3, kExactFrame = 4 };

/// Where the files of a run in a folder are.
std::filesystem::path topology_path(const std::filesystem::path& folder);
std::filesystem::path rest_path(const std::filesystem::path& folder);
std::filesystem::path scene_path(const std::filesystem::path& folder);
std::filesystem::path checkpoint_path(const std::filesystem::path& folder);
std::filesystem::path frame_path(const std::filesystem::path& folder, std::int64_t frame);

/// Write a file of a run, whole or not at all; of an exact frame positions are stored in double precision.
/// @throws SystemError  when it cannot be written
void write_topology(const std::filesystem::path& path, const Model& model, std::uint64_t fingerprint);
void write_frame(const std::filesystem::path& path, FrameHeader header, std::span<const Vec3> positions,
                 bool is_exact = false);
void write_checkpoint(const std::filesystem::path& path, FrameHeader header, const State& state);

struct TopologyFile {
  FrameHeader header;
  std::vector<VertexTuple<4>> elements;
  std::vector<Index> vertex_bodies;
  std::vector<VertexTuple<3>> boundary_faces;
};

struct FrameFile {
  FrameHeader header;
  std::vector<Vec3> positions;  ///< [m]
};

struct CheckpointFile {
  FrameHeader header;
  State state;
};

/// Read a file of a run; frames of both kinds.
/// @throws Error  when it cannot be read, is of another kind or schema, or has not the size that its header says
TopologyFile read_topology(const std::filesystem::path& path);
FrameFile read_frame(const std::filesystem::path& path);
CheckpointFile read_checkpoint(const std::filesystem::path& path);

}  // namespace selvage
