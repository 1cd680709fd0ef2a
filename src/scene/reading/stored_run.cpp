#include "scene/reading/stored_run.h"

#include "core/json.h"
#include "io/whole_file.h"
#include "scene/files/statistics_table.h"
#include "selvage/core/error.h"

#include <algorithm>

namespace selvage {

namespace {

namespace fs = std::filesystem;
constexpr const char* kRemedy = "run the scene anew";

void check_surface(const fs::path& path, const TopologyFile& topology) {
  const auto in_range = [&](Index v) { return v >= 0 && v < topology.header.vertices; };
  for (const auto& face : topology.boundary_faces)
    if (!std::all_of(face.begin(), face.end(), in_range))
      throw Error(path.string(), "has a face of no vertex", kRemedy);
  for (const auto& element : topology.elements)
    if (!std::all_of(element.begin(), element.end(), in_range))
      throw Error(path.string(), "has an element of no vertex", kRemedy);
}

/// A JSON file of the run; null where there is none.
Json read_json(const fs::path& path) {
  if (!fs::exists(path)) return nullptr;
  Json json = Json::parse(read_whole_file(path), nullptr, false);
  if (!json.is_object()) throw Error(path.string(), "is no JSON of a run", kRemedy);
  return json;
}

}  // namespace

StoredRun::StoredRun(const fs::path& path) : folder(path) {
  if (!fs::exists(topology_path(folder)))
    throw Error(folder.string(), "holds no run: there is no topology.bin", "name the folder given to simulate -o");
  topology = read_topology(topology_path(folder));
  check_surface(topology_path(folder), topology);
  if (!fs::exists(checkpoint_path(folder)))
    throw Error(checkpoint_path(folder).string(), "is missing: the run has no whole frame", "run the scene further");
  last_frame = read_checkpoint(checkpoint_path(folder)).header.frame;
  const fs::path statistics = folder / "statistics.csv";
  rows = parse_statistics(read_whole_file(statistics), statistics.string(), last_frame);
  scene = read_json(scene_path(folder));
  summary = read_json(folder / "summary.json");
}

std::vector<Vec3> StoredRun::read_positions(const fs::path& path) const {
  FrameFile frame = read_frame(path);
  if (frame.header.fingerprint != topology.header.fingerprint || frame.header.vertices != topology.header.vertices)
    throw Error(path.string(), "is of another run than topology.bin", kRemedy);
  for (const Vec3& p : frame.positions)
    if (!p.allFinite()) throw Error(path.string(), "has a position that is not finite", kRemedy);
  return std::move(frame.positions);
}

std::string StoredRun::name() const {
  const std::string name = scene.is_object() ? scene.value("scene", std::string()) : std::string();
  return name.empty() ? folder.lexically_normal().filename().string() : name;
}

std::vector<std::int64_t> StoredRun::frames(std::int64_t every) const {
  std::vector<std::int64_t> frames;
  for (std::int64_t frame = 0; frame <= last_frame; frame += every) frames.push_back(frame);
  if (frames.back() != last_frame) frames.push_back(last_frame);
  return frames;
}

}  // namespace selvage
