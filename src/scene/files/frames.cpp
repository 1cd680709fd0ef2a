#include "selvage/scene/frames.h"

#include "io/whole_file.h"
#include "selvage/core/error.h"

#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <optional>

namespace selvage {

static_assert(std::endian::native == std::endian::little, "files of a run are written as they lie in memory");

namespace {

namespace fs = std::filesystem;

template <typename T>
void append(std::string& bytes, std::span<const T> items) {
  bytes.append(reinterpret_cast<const char*>(items.data()), items.size_bytes());
}

std::string begin_file(FrameHeader header, FrameFileKind kind, std::size_t body_bytes) {
  header.kind = static_cast<std::int32_t>(kind);
  std::string bytes;
  bytes.reserve(sizeof header + body_bytes);
  append(bytes, std::span<const FrameHeader>(&header, 1));
  return bytes;
}

/// A file that is taken apart from its front.
class Parts {
 public:
  /// @param other  a kind that will do, too
  Parts(const fs::path& path, FrameFileKind kind, std::optional<FrameFileKind> other = {})
      : name_(path.string()), bytes_(read_whole_file(path)) {
    if (bytes_.size() < sizeof header_) refuse("is too short for its header");
    std::memcpy(&header_, bytes_.data(), sizeof header_);
    if (header_.magic != FrameHeader().magic) refuse("is no file of a run");
    if (header_.schema != 1) refuse(fmt::format("has schema {}, and 1 is known", header_.schema));
    if (!is_of(kind) && !(other && is_of(*other))) refuse("is another kind of file of a run");
    constexpr std::int64_t kMaxCount = std::int64_t{1} << 31;
    for (const std::int64_t count : {header_.vertices, header_.elements, header_.frame})
      if (count < 0 || count >= kMaxCount) refuse("has an impossible count");
    next_ = sizeof header_;
  }

  const FrameHeader& header() const { return header_; }
  bool is_of(FrameFileKind kind) const { return header_.kind == static_cast<std::int32_t>(kind); }

  template <typename T>
  std::vector<T> take(std::size_t count) {
    if ((bytes_.size() - next_) / sizeof(T) < count) refuse("is shorter than its header says");
    std::vector<T> items(count);
    if (count > 0) std::memcpy(static_cast<void*>(items.data()), bytes_.data() + next_, count * sizeof(T));
    next_ += count * sizeof(T);
    return items;
  }

  std::size_t left() const { return bytes_.size() - next_; }
  void expect_end() const {
    if (left() != 0) refuse("is longer than its header says");
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const { throw Error(name_, what, "run the scene anew"); }

  std::string name_, bytes_;
  FrameHeader header_;
  std::size_t next_ = 0;
};

std::size_t vertices_of(const FrameHeader& header) {
  return static_cast<std::size_t>(header.vertices);
}

}  // namespace

fs::path topology_path(const fs::path& folder) {
  return folder / "topology.bin";
}

fs::path rest_path(const fs::path& folder) {
  return folder / "rest.bin";
}

fs::path scene_path(const fs::path& folder) {
  return folder / "scene.json";
}

fs::path checkpoint_path(const fs::path& folder) {
  return folder / "checkpoint.bin";
}

fs::path frame_path(const fs::path& folder, std::int64_t frame) {
  return folder / "frames" / fmt::format("frame_{:06}.bin", frame);
}

void write_topology(const fs::path& path, const Model& model, std::uint64_t fingerprint) {
  FrameHeader header;
  header.vertices = model.mesh.vertex_count();
  header.elements = model.mesh.element_count();
  header.fingerprint = fingerprint;
  const std::vector<Index> bodies = bodies_of_vertices(model);
  const auto elements = model.mesh.elements();
  const std::vector<VertexTuple<3>> faces = surface_triangles(model);
  const std::size_t size = elements.size_bytes() + bodies.size() * sizeof(Index) + std::span(faces).size_bytes();
  std::string bytes = begin_file(header, FrameFileKind::kTopology, size);
  append(bytes, elements);
  append(bytes, std::span<const Index>(bodies));
  append(bytes, std::span(faces));
  write_whole_files(std::array{FileContent{path, bytes}});
}

void write_frame(const fs::path& path, FrameHeader header, std::span<const Vec3> positions, bool is_exact) {
  header.vertices = std::ssize(positions);
  if (is_exact) {
    std::string exact = begin_file(header, FrameFileKind::kExactFrame, positions.size_bytes());
    append(exact, positions);
    return write_whole_files(std::array{FileContent{path, exact}});
  }
  using Float3 = std::array<float, 3>;
  std::string bytes = begin_file(header, FrameFileKind::kFrame, positions.size() * sizeof(Float3));
  for (const Vec3& p : positions) {
    const Float3 rounded{static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
    append(bytes, std::span<const float>(rounded));
  }
  write_whole_files(std::array{FileContent{path, bytes}});
}

void write_checkpoint(const fs::path& path, FrameHeader header, const State& state) {
  header.vertices = std::ssize(state.positions);
  header.time = state.time;
  header.steps = state.steps;
  const std::size_t size = 2 * state.positions.size() * sizeof(Vec3);
  std::string bytes = begin_file(header, FrameFileKind::kCheckpoint, size);
  append(bytes, std::span<const Vec3>(state.positions));
  append(bytes, std::span<const Vec3>(state.velocities));
  append(bytes, std::span<const double>(state.rest_times));
  write_whole_files(std::array{FileContent{path, bytes}});
}

TopologyFile read_topology(const fs::path& path) {
  Parts parts(path, FrameFileKind::kTopology);
  TopologyFile file;
  file.header = parts.header();
  file.elements = parts.take<VertexTuple<4>>(static_cast<std::size_t>(file.header.elements));
  file.vertex_bodies = parts.take<Index>(vertices_of(file.header));
  file.boundary_faces = parts.take<VertexTuple<3>>(parts.left() / sizeof(VertexTuple<3>));
  parts.expect_end();
  return file;
}

FrameFile read_frame(const fs::path& path) {
  Parts parts(path, FrameFileKind::kFrame, FrameFileKind::kExactFrame);
  FrameFile file{parts.header(), {}};
  if (parts.is_of(FrameFileKind::kExactFrame)) {
    file.positions = parts.take<Vec3>(vertices_of(file.header));
    parts.expect_end();
    return file;
  }
  for (const auto& p : parts.take<std::array<float, 3>>(vertices_of(file.header)))
    file.positions.emplace_back(p[0], p[1], p[2]);
  parts.expect_end();
  return file;
}

CheckpointFile read_checkpoint(const fs::path& path) {
  Parts parts(path, FrameFileKind::kCheckpoint);
  CheckpointFile file{parts.header(), {}};
  file.state.positions = parts.take<Vec3>(vertices_of(file.header));
  file.state.velocities = parts.take<Vec3>(vertices_of(file.header));
  file.state.rest_times = parts.take<double>(parts.left() / sizeof(double));
  parts.expect_end();
  file.state.time = file.header.time;
  file.state.steps = file.header.steps;
  return file;
}

}  // namespace selvage
