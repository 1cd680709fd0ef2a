#include "scene/run_folder.h"

#include "io/whole_file.h"
#include "scene/files/scene_json.h"
#include "scene/files/statistics_table.h"
#include "selvage/core/error.h"
#include "selvage/io/mesh_file.h"
#include "selvage/io/point_cache.h"
#include "selvage/io/vtu.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>

namespace selvage {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail_to_write(const fs::path& path, const std::string& why) {
  throw SystemError(path.string(), fmt::format("cannot be written: {}", why),
                    "check that the folder may be written and has space");
}

void write_text(const fs::path& path, std::string_view text) {
  write_whole_files(std::array{FileContent{path, text}});
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) fail_to_write(folder, error.message());
}

/// Whether the name is that of a file, or of one on its way there (write_whole_files()).
bool is_file_or_part(std::string_view name, std::string_view file) {
  return name == file || (name.starts_with(fmt::format("{}.", file)) && name.ends_with(".part"));
}

/// The number in a name as frame_000012.bin, also of a part of such a file; -1 if it is no such name.
std::int64_t frame_number(const std::string& name, std::string_view extension) {
  long long number = -1;
  if (std::sscanf(name.c_str(), "frame_%lld.", &number) != 1 || number < 0) return -1;
  return is_file_or_part(name, fmt::format("frame_{:06}{}", number, extension)) ? number : -1;
}

bool has_frame_beyond_first(const fs::path& folder) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(".bin") && frame_number(name, ".bin") > 0) return true;
  }
  return false;
}

fs::path vtu_path(const fs::path& folder, std::int64_t frame) {
  return folder / "vtu" / fmt::format("frame_{:06}.vtu", frame);
}

void write_vtu_frame(const fs::path& path, const Model& model, const State& state) {
  VtkGrid grid;
  grid.points = state.positions;
  grid.tetrahedra.assign(model.mesh.elements().begin(), model.mesh.elements().end());
  grid.triangles = model.triangles;
  VtkField velocity{"velocity", 3, {}}, body{"body", 1, {}};
  for (const Vec3& v : state.velocities) velocity.values.insert(velocity.values.end(), v.data(), v.data() + 3);
  for (const Index b : bodies_of_vertices(model)) body.values.push_back(b);
  grid.point_fields = {std::move(velocity), std::move(body)};
  write_vtu(path, grid);
}

/// The boundary and cloth with their own vertices only, and each body as a group.
void write_surface_frame(const fs::path& path, const Model& model, const State& state) {
  IndexedMesh surface;
  std::vector<Index> number(state.positions.size(), kNone);
  const std::vector<Index> body_of = bodies_of_vertices(model);
  for (const Body& body : model.bodies) surface.group_names.push_back(body.name);
  const std::vector<VertexTuple<3>> triangles = surface_triangles(model);
  for (const auto& triangle : triangles)
    for (const Index v : triangle) number[v] = 0;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] == kNone) continue;
    number[v] = static_cast<Index>(surface.positions.size());
    surface.positions.push_back(state.positions[v]);
  }
  for (const auto& [a, b, c] : triangles) {
    surface.triangles.push_back({number[a], number[b], number[c]});
    surface.groups.push_back(body_of[a]);
  }
  write_mesh(path, surface);
}

}  // namespace

RunFolder::RunFolder(const Scene& scene, const RunOptions& options) : scene_(scene), options_(options) {
  make_folder(options.folder);
  const fs::path place = options.folder / "lock";
  lock_ = open(place.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (lock_ < 0) fail_to_write(place, std::strerror(errno));
  try {
    if (flock(lock_, LOCK_EX | LOCK_NB) != 0)
      throw Error(options.folder.string(), "another process runs a scene here", "wait for it, or name another folder");
    refuse_other_run();
  } catch (...) {
    close(lock_);
    throw;
  }
}

RunFolder::~RunFolder() {
  close(lock_);
}

void RunFolder::refuse_other_run() const {
  // A kill leaves no more than the first frame without a checkpoint.
  const fs::path checkpoint = checkpoint_path(options_.folder);
  const bool has_checkpoint = fs::exists(checkpoint), has_frame = has_frame_beyond_first(options_.folder / "frames");
  if (options_.resume && has_frame && !has_checkpoint)
    throw Error(checkpoint.string(), "is missing, though there are frames of a run", "name another folder");
  if (!options_.resume && (has_frame || has_checkpoint || fs::exists(topology_path(options_.folder))))
    throw Error(options_.folder.string(), "holds a run already", "continue it with --resume, or name another folder");
}

std::optional<RunFolder::Stop> RunFolder::find_stop() const {
  if (!fs::exists(checkpoint_path(options_.folder))) return std::nullopt;
  CheckpointFile file = read_checkpoint(checkpoint_path(options_.folder));
  if (file.header.fingerprint != scene_.fingerprint)
    throw Error(options_.folder.string(), "holds a run of another scene, or of this one before it was changed",
                "name another folder, or undo the change");
  const std::int64_t frame = file.header.frame;
  auto rows = parse_statistics(read_whole_file(statistics_path()), statistics_path().string(), frame);
  clear_unfinished(frame);
  std::string table = statistics_header();
  for (const FrameStatistics& row : rows) table += statistics_row(row);
  write_text(statistics_path(), table);
  return Stop{frame, std::move(file.state), std::move(rows)};
}

void RunFolder::clear_unfinished(std::int64_t last_frame) const {
  // Only files that a run writes: others may have put pictures of the frames beside them.
  const auto remove_if = [](const fs::path& folder, const auto& is_unfinished) {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error))
      if (is_unfinished(entry.path().filename().string())) fs::remove(entry.path(), error);
  };
  constexpr std::array<std::pair<const char*, const char*>, 5> kFrames{
      {{"frames", ".bin"}, {"vtu", ".vtu"}, {"surface", ".ply"}, {"surface", ".obj"}, {"checks", ".json"}}};
  for (const auto& [name, extension] : kFrames)
    remove_if(options_.folder / name, [&, extension = extension](const std::string& file) {
      return frame_number(file, extension) > last_frame ||
             (file.ends_with(".part") && frame_number(file, extension) >= 0);
    });
  remove_if(options_.folder, [](const std::string& file) {
    constexpr std::array kOthers{"topology.bin",   "rest.bin",   "scene.json",   "checkpoint.bin",
                                 "statistics.csv", "frames.pvd", "summary.json", "report.html"};
    return file.ends_with(".part") &&
           std::any_of(kOthers.begin(), kOthers.end(), [&](const char* name) { return is_file_or_part(file, name); });
  });
}

void RunFolder::begin() const {
  make_folder(options_.folder / "frames");
  if (options_.vtu) make_folder(options_.folder / "vtu");
  if (options_.surface != SurfaceFormat::kNoSurface) make_folder(options_.folder / "surface");
  if (options_.check_every > 0) make_folder(options_.folder / "checks");
  const bool is_new = !fs::exists(checkpoint_path(options_.folder));
  if (is_new) {
    clear_unfinished(-1);
    write_text(statistics_path(), statistics_header());
  }
  const auto is_missing = [&](const fs::path& path) { return is_new || !fs::exists(path); };
  if (is_missing(topology_path(options_.folder)))
    write_topology(topology_path(options_.folder), scene_.model, scene_.fingerprint);
  if (is_missing(rest_path(options_.folder))) {
    FrameHeader header;
    header.elements = scene_.model.mesh.element_count();
    header.fingerprint = scene_.fingerprint;
    write_frame(rest_path(options_.folder), header, scene_.model.rest_positions);
  }
  for (std::size_t c = 0; c < scene_.colliders.size(); ++c)
    if (const auto* keyframed = std::get_if<KeyframedShape>(&scene_.colliders[c].shape))
      if (const fs::path path = options_.folder / keyframes_name(c); is_missing(path))
        write_text(path, print_point_cache({0, 1, keyframed->positions}));
  if (is_missing(scene_path(options_.folder))) write_text(scene_path(options_.folder), print_scene(scene_));
}

void RunFolder::store_frame(const State& state, std::span<const Vec3> positions, const FrameStatistics& row) const {
  FrameHeader header;
  header.elements = scene_.model.mesh.element_count();
  header.frame = row.frame;
  header.steps = state.steps;
  header.time = state.time;
  header.fingerprint = scene_.fingerprint;
  export_frame(row.frame, state);
  write_frame(frame_path(options_.folder, row.frame), header, positions, scene_.options.contact.guarantee);
  append_row(row);
  write_checkpoint(checkpoint_path(options_.folder), header, state);
}

void RunFolder::store_check(std::int64_t frame, std::string_view json) const {
  write_text(options_.folder / "checks" / fmt::format("frame_{:06}.json", frame), json);
}

void RunFolder::store_summary(std::string_view json) const {
  write_text(options_.folder / "summary.json", json);
}

void RunFolder::export_frame(std::int64_t frame, const State& state) const {
  if (options_.vtu) {
    write_vtu_frame(vtu_path(options_.folder, frame), scene_.model, state);
    list_vtu_files(frame);
  }
  if (options_.surface == SurfaceFormat::kNoSurface) return;
  const char* extension = options_.surface == SurfaceFormat::kPly ? "ply" : "obj";
  write_surface_frame(options_.folder / "surface" / fmt::format("frame_{:06}.{}", frame, extension), scene_.model,
                      state);
}

void RunFolder::list_vtu_files(std::int64_t last_frame) const {
  std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n <Collection>\n";
  for (std::int64_t frame = 0; frame <= last_frame; ++frame) {
    const fs::path path = vtu_path(options_.folder, frame);
    if (!fs::exists(path)) continue;
    text += fmt::format("  <DataSet timestep=\"{}\" file=\"vtu/{}\"/>\n",
                        static_cast<double>(frame) / scene_.frames_per_second, path.filename().string());
  }
  write_text(options_.folder / "frames.pvd", text + " </Collection>\n</VTKFile>\n");
}

void RunFolder::append_row(const FrameStatistics& row) const {
  const fs::path path = statistics_path();
  std::error_code ignored;
  const auto size = fs::file_size(path, ignored);
  const std::string line = statistics_row(row);
  std::FILE* file = std::fopen(path.c_str(), "ab");
  if (file == nullptr) fail_to_write(path, std::strerror(errno));
  const bool written = std::fwrite(line.data(), 1, line.size(), file) == line.size() && std::fflush(file) == 0;
  const int code = errno;
  const bool closed = std::fclose(file) == 0;
  if (written && closed) return;
  fs::resize_file(path, size, ignored);  // so that the table stays whole
  fail_to_write(path, std::strerror(written ? errno : code));
}

}  // namespace selvage
