#include "page/run_page.h"

#include "core/json.h"
#include "page/encoding.h"
#include "page/form_blocks.h"
#include "page/marks.h"
#include "page/page.h"
#include "page/page_surface.h"
#include "page/pose_blocks.h"
#include "scene/files/statistics_table.h"
#include "scene/reading/stored_colliders.h"
#include "scene/reading/stored_run.h"
#include "scene/reading/touches.h"
#include "selvage/core/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace selvage {

namespace {

namespace fs = std::filesystem;

std::string count_of(std::int64_t count, std::string_view one, std::string_view many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

void add_warnings(Page& page, const StoredRun& run) {
  const FrameStatistics &first = run.rows.front(), &last = run.rows.back();
  if (run.summary.is_object() && run.summary.contains("message"))
    page.add_warning(fmt::format("The run stopped: {}", run.summary["message"].get<std::string>()));
  if (run.scene.is_null()) page.add_warning("The folder has no scene.json: colliders are not shown.");
  if (first.penetrating_vertices > 0)
    page.add_warning(fmt::format("Before the first frame {} inside, at most {:.3g} m deep.",
                                 count_of(first.penetrating_vertices, "vertex was", "vertices were"),
                                 first.deepest_penetration));
  if (last.frame == 0) return;
  if (last.penetrating_vertices > 0)
    page.add_warning(fmt::format("At the end {} inside, at most {:.3g} m deep.",
                                 count_of(last.penetrating_vertices, "vertex is", "vertices are"),
                                 last.deepest_penetration));
  if (last.triangle_pairs > 0)
    page.add_warning(fmt::format(
        "At the end {}.", count_of(last.triangle_pairs, "pair of triangles crosses", "pairs of triangles cross")));
  if (last.inverted_elements + last.flat_elements > 0)
    page.add_warning(fmt::format("At the end {} inverted and {} flat.",
                                 count_of(last.inverted_elements, "element is", "elements are"), last.flat_elements));
}

void add_statistics(Page& page, const StoredRun& run) {
  Json columns = Json::array(), rows = Json::array();
  const std::string header = statistics_header();
  for (std::size_t at = 0; at < header.size();) {
    const std::size_t end = header.find_first_of(",\n", at);
    columns.push_back(header.substr(at, end - at));
    at = end + 1;
  }
  for (const FrameStatistics& row : run.rows) {
    Json numbers = Json::array();
    const std::string line = statistics_row(row);
    for (std::size_t at = 0; at < line.size();) {
      const std::size_t end = line.find_first_of(",\n", at);
      // Infinite numbers, as of a run that explodes, are none in JSON: null.
      numbers.push_back(Json::parse(line.substr(at, end - at), nullptr, false));
      if (numbers.back().is_discarded()) numbers.back() = nullptr;
      at = end + 1;
    }
    rows.push_back(std::move(numbers));
  }
  page.head()["statistics"] = {{"columns", std::move(columns)}, {"rows", std::move(rows)}};
}

void add_bodies(Page& page, const StoredRun& run, const ShownSurface& surface) {
  std::vector<std::int32_t> bodies;
  for (const Index v : surface.vertices) bodies.push_back(run.topology.vertex_bodies[static_cast<std::size_t>(v)]);
  page.add_block("bodies", pack_integers(bodies, 1));
  if (!fs::exists(rest_path(run.folder))) return;
  const auto rest = run.read_positions(rest_path(run.folder));
  std::vector<float> numbers;
  for (const Index v : surface.vertices)
    for (int axis = 0; axis < 3; ++axis) numbers.push_back(static_cast<float>(rest[static_cast<std::size_t>(v)][axis]));
  page.add_block("rest", {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(float)});
}

/// Poses and what is marked in them.
class RunPoses {
 public:
  RunPoses(const StoredRun& run, const ShownSurface& surface, const RunPageOptions& options)
      : run_(run),
        surface_(surface),
        options_(options),
        frames_(run.frames(options.every)),
        colliders_(read_stored_colliders(run.scene, scene_path(run.folder).string())) {}

  void add_to(Page& page) {
    PoseBox box;
    for (const std::int64_t frame : frames_) {
      const auto positions = run_.read_frame_positions(frame);
      for (const Index v : surface_.vertices) box.add(positions[static_cast<std::size_t>(v)]);
    }
    PoseBlocks poses(page, surface_, box);
    FormBlocks forms(page, colliders_);
    std::int64_t most_pairs = 0;
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      const auto& row = run_.rows[static_cast<std::size_t>(frames_[i])];
      const auto positions = run_.read_frame_positions(frames_[i]);
      poses.add(positions, row.time);
      forms.add(row.time);
      if (options_.marks) add_marks_of(row, positions, i, page);
      most_pairs = std::max(most_pairs, row.triangle_pairs);
      if (page.block_length() > kMaxPageLength)
        throw Error(run_.folder.string(),
                    fmt::format("the page would be larger than {} MB, with {} of {} frames in it",
                                kMaxPageLength / 1'000'000, i + 1, frames_.size()),
                    "show fewer frames: --every N");
      if (options_.on_progress) options_.on_progress(static_cast<double>(i + 1) / static_cast<double>(frames_.size()));
    }
    poses.finish();
    if (touches_) page.head()["touching_distance"] = touches_->distance();
    if (options_.marks && most_pairs > static_cast<std::int64_t>(MarkFinder::kMaxPairs))
      page.add_warning(fmt::format("Of each frame only the first {} pairs of triangles that cross are marked.",
                                   MarkFinder::kMaxPairs));
    page.head()["frames"] = frames_;
  }

 private:
  void add_marks_of(const FrameStatistics& row, std::span<const Vec3> positions, std::size_t pose, Page& page) {
    if (!mesh_) {
      const auto vertices = static_cast<Index>(run_.topology.header.vertices);
      mesh_.emplace(run_.topology.elements.empty() ? TetMesh::without_elements(vertices)
                                                   : TetMesh(vertices, run_.topology.elements));
      touches_.emplace(TriangleMesh(vertices, run_.topology.boundary_faces), positions, colliders_);
    }
    Marks marks;
    if (row.penetrating_vertices + row.triangle_pairs > 0) {
      if (!finder_) finder_.emplace(*mesh_, run_.topology.boundary_faces, positions);
      marks = finder_->find(positions);
    }
    add_marks(page, surface_, pose, marks, touches_->find(positions, row.time));
  }

  const StoredRun& run_;
  const ShownSurface& surface_;
  const RunPageOptions& options_;
  std::vector<std::int64_t> frames_;
  std::vector<Collider> colliders_;
  std::optional<TetMesh> mesh_;
  std::optional<MarkFinder> finder_;
  std::optional<TouchFinder> touches_;
};

}  // namespace

std::string print_run_page(const fs::path& folder, const RunPageOptions& options) {
  const StoredRun run(folder);
  const ShownSurface surface(static_cast<std::size_t>(run.topology.header.vertices), run.topology.boundary_faces);
  Page page("run", run.name());
  for (const auto& [group, fact, value] : options.facts) page.add_fact(group, fact, value);
  add_warnings(page, run);
  add_surface(page, surface);
  add_bodies(page, run, surface);
  add_statistics(page, run);
  page.head()["marked"] = Json::array();
  if (run.scene.is_object()) page.head()["scene"] = run.scene;
  if (run.summary.is_object()) page.head()["summary"] = run.summary;
  RunPoses(run, surface, options).add_to(page);
  return page.print();
}

}  // namespace selvage
