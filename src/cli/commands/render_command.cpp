#include "cli/arguments/camera_file.h"
#include "cli/arguments/picture_options.h"
#include "cli/program/command.h"
#include "cli/program/console.h"
#include "cli/program/json_text.h"
#include "cli/program/output.h"
#include "picture/shown_result.h"
#include "picture/vertex_values.h"
#include "picture/video.h"
#include "selvage/core/error.h"
#include "selvage/scene/frames.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>

namespace selvage::cli {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxStills = 12;  // side by side in one picture
constexpr int kMaxWidth = 32768;        // of such a picture [pixels]

struct RenderOptions {
  CommonOptions common;
  std::string result, output, after, camera, cut, frames, colour{"body"};
  double orbit = 0;
  std::vector<int> size{1200, 800};
  double rate = 0;
  bool edges = false, fit_each = false;
};

constexpr std::int64_t kTurntable = 120;  // images of a video of one pose

constexpr const char* kRenderExample =
    "  selvage simulate scenes/octopi_8_hybrid.json -o octopi\n"
    "  selvage render octopi -o octopi.png\n"
    "  selvage render octopi -o course.png --frames 0,60,last --size 480 360\n"
    "  selvage render octopi -o inside.png --cut y:0 --camera front\n"
    "  selvage render octopi -o octopi.mp4 --orbit 360 --colour speed\n"
    "  selvage render bunny.obj -o bunny.png\n"
    "\n"
    "RESULT is the folder of a run, a mesh, or what check, paths or resolve wrote with --json. Needs no display. "
    "Videos "
    "(.mp4, .gif) are encoded by ffmpeg, which must be installed. See docs/guides/render.md.";

ShownResult show(const RenderOptions& options) {
  const fs::path result = options.result;
  const bool is_report = !fs::is_directory(result) && result.extension() == ".json";
  if (!options.after.empty() && !is_report)
    throw Error("--after", fmt::format("has no meaning for {}", options.result), "it is for what resolve wrote");
  if (fs::is_directory(result)) return show_run(result);
  return is_report ? show_result(result, options.after) : show_mesh(result);
}

bool is_camera_file(const RenderOptions& options) {
  return fs::path(options.camera).extension() == ".csv";
}

/// Files that the picture must not replace.
std::vector<fs::path> inputs_of(const RenderOptions& options) {
  const fs::path result = options.result;
  std::vector<fs::path> inputs;
  if (fs::is_directory(result)) {
    inputs = {topology_path(result), rest_path(result), scene_path(result), checkpoint_path(result)};
  } else {
    inputs = result.extension() == ".json" ? std::vector{result} : files_of_mesh(result);
  }
  if (!options.after.empty()) inputs.emplace_back(options.after);
  if (is_camera_file(options)) inputs.emplace_back(options.camera);
  return inputs;
}

bool is_video(const RenderOptions& options) {
  const fs::path extension = fs::path(options.output).extension();
  if (extension == ".png") return false;
  if (extension == ".mp4" || extension == ".gif") return true;
  throw Error(options.output, "is no file that render writes", "name a .png, .mp4 or .gif");
}

/// Draws frames of what is shown, one after the other.
class Renderer {
 public:
  Renderer(const ShownResult& shown, const RenderOptions& options)
      : shown_(shown), fit_each_(options.fit_each), orbit_(options.orbit * M_PI / 180) {
    view_.width = options.size[0];
    view_.height = options.size[1];
    view_.edges = options.edges;
    view_.view.towards = shown.towards;
    if (is_camera_file(options)) {
      path_ = read_camera_file(options.camera, shown.scene.up);
    } else if (!options.camera.empty()) {
      view_.view = read_camera(options.camera, shown.scene.up);
    }
    if (!options.cut.empty()) view_.cut = read_cut(options.cut);
    const bool moves = orbit_ != 0 || !path_.empty();
    if (shown.paths && (view_.cut || view_.view.eye || moves))
      throw Error(view_.cut     ? "--cut"
                  : orbit_ != 0 ? "--orbit"
                                : "--camera",
                  "has no meaning for paths, which are seen through the surface",
                  "name a side or a direction as --camera, and render the mesh to cut it open");
    if (moves && (fit_each_ || (orbit_ != 0 && !path_.empty())))
      throw Error(fit_each_ ? "--fit-each" : "--orbit", "has no meaning with a camera that moves otherwise",
                  "leave one of them out");
    choose_colours(options);
    if (!shown.paths) pictures_.emplace(shown.scene, view_);
  }

  void prepare(std::span<const std::int64_t> frames) {
    images_ = frames.size();
    if (!pictures_ || fit_each_) return;
    for (const std::int64_t frame : frames) pictures_->add_frame(shown_.read_positions(frame), shown_.time(frame));
  }

  Image draw(std::int64_t frame) {
    const std::vector<Vec3> positions = shown_.read_positions(frame);
    if (fit_each_ && pictures_) pictures_.emplace(shown_.scene, view_);
    if (pictures_) {
      const double share = static_cast<double>(drawn_++) / static_cast<double>(images_);
      if (orbit_ != 0) pictures_->look(pictures_->turned_view(orbit_ * share));
      if (!path_.empty()) pictures_->look(view_at(path_, static_cast<double>(frame)));
      return pictures_->draw(positions, shown_.time(frame), values_ ? values_->at(frame) : std::vector<double>());
    }
    PictureOptions picture;
    picture.width = view_.width;
    picture.height = view_.height;
    picture.towards = view_.view.towards;
    return draw_paths({positions, shown_.scene.surface, {}, shown_.vertex_depth, *shown_.paths, ""}, picture);
  }

 private:
  void choose_colours(const RenderOptions& options) {
    const auto names = colour_names();
    const auto by = static_cast<ColourBy>(std::ranges::find(names, options.colour) - names.begin());
    if (by == ColourBy::kBody) return;
    if (!shown_.run)
      throw Error("--colour", fmt::format("has no meaning for {}", options.result), "it is for the folder of a run");
    values_.emplace(shown_.run, by);
    view_.scale = &values_->scale();
  }

  const ShownResult& shown_;
  bool fit_each_;
  double orbit_;
  std::vector<CameraKey> path_;
  SceneView view_;
  std::optional<VertexValues> values_;
  std::optional<ScenePictures> pictures_;
  std::size_t images_ = 1, drawn_ = 0;
};

std::vector<std::int64_t> choose_frames(const RenderOptions& options, const ShownResult& shown, bool video) {
  if (!options.frames.empty()) return read_frames(options.frames, shown.last_frame);
  if (video && shown.last_frame == 0) return std::vector<std::int64_t>(kTurntable, 0);
  return video ? read_frames(":", shown.last_frame) : shown.usual_frames;
}

/// Images a second: those of the run, or in a GIF, which cannot show more, at most 25.
double choose_rate(const RenderOptions& options, const ShownResult& shown, std::vector<std::int64_t>& frames) {
  if (options.rate > 0) return options.rate;
  double rate = shown.frames_per_second;
  if (!options.frames.empty() || fs::path(options.output).extension() != ".gif" || rate <= 25) return rate;
  const auto step = static_cast<std::size_t>(std::ceil(rate / 25));
  std::vector<std::int64_t> fewer;
  for (std::size_t i = 0; i < frames.size(); i += step) fewer.push_back(frames[i]);
  frames = std::move(fewer);
  return rate / static_cast<double>(step);
}

void draw_stills(const RenderOptions& options, Renderer& renderer, std::span<const std::int64_t> frames,
                 OutputFiles& outputs) {
  if (frames.size() > kMaxStills || static_cast<int>(frames.size()) * options.size[0] > kMaxWidth)
    throw Error("--frames", fmt::format("names {} frames, too many for one picture", frames.size()),
                fmt::format("give at most {}, or write a video", kMaxStills));
  std::vector<Image> images;
  for (const std::int64_t frame : frames) images.push_back(renderer.draw(frame));
  outputs.write_file(options.output,
                     [&](const auto& path) { write_png(path, images.size() == 1 ? images[0] : join_images(images)); });
}

void draw_video(const RenderOptions& options, Renderer& renderer, std::span<const std::int64_t> frames, double rate,
                const fs::path& encoder, OutputFiles& outputs) {
  ProgressBar progress("frames", options.common.quiet);
  outputs.write_file(options.output, [&](const auto& path) {
    VideoWriter video(encoder, path, options.size[0], options.size[1], rate);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      video.add(renderer.draw(frames[i]));
      progress.show(static_cast<double>(i + 1) / static_cast<double>(frames.size()));
    }
    video.finish();
  });
}

void run_render(const RenderOptions& options) {
  Stopwatch watch;
  const bool video = is_video(options);
  if (options.rate > 0 && !video)
    throw Error("--rate", "has no meaning for a still picture", "name a .mp4 or a .gif, or leave it out");
  OutputFiles outputs;
  const std::vector<fs::path> inputs = inputs_of(options);
  outputs.expect(options.output, inputs);
  outputs.expect(options.common.json, inputs);
  const ShownResult shown = show(options);
  if (video && shown.last_frame == 0 && options.orbit == 0)
    throw Error(options.result, "has one pose, of which there is no video", "write a .png, or turn it: --orbit 360");
  std::vector<std::int64_t> frames = choose_frames(options, shown, video);
  const double rate = video ? choose_rate(options, shown, frames) : 0;
  const fs::path encoder = video ? find_video_encoder() : fs::path();
  Renderer renderer(shown, options);
  renderer.prepare(frames);
  watch.lap("read");
  if (video) {
    draw_video(options, renderer, frames, rate, encoder, outputs);
  } else {
    draw_stills(options, renderer, frames, outputs);
  }
  watch.lap("draw");
  if (!options.common.json.empty()) {
    nlohmann::ordered_json json{{"schema", 1}, {"kind", "render"}, {"width", options.size[0]}};
    json["height"] = options.size[1];
    json["frames"] = frames;
    for (const auto& [phase, seconds] : watch.laps()) json["seconds"][phase] = seconds;
    json["seconds"]["total"] = watch.total();
    outputs.write_text(options.common.json, json_text(json));
  }
  outputs.commit();
  if (!options.common.quiet && !outputs.uses_standard_output())
    fmt::print("{}: {} {} in {}\n", options.output, frames.size(), frames.size() == 1 ? "frame" : "frames",
               readable_seconds(watch.total()));
}

}  // namespace

Command add_render(CLI::App& app) {
  auto options = std::make_shared<RenderOptions>();
  CLI::App* sub = add_subcommand(app, "render",
                                 "Draws a run, a mesh or a result: pictures and videos with colliders, shadows and "
                                 "bodies in colours, without a display.",
                                 kRenderExample);
  sub->add_option("result", options->result, "Folder of a run, JSON of check, paths or resolve, or a mesh")
      ->required()
      ->type_name("RESULT");
  sub->add_option("-o,--output", options->output, "Picture (.png) or video (.mp4, .gif)")
      ->required()
      ->type_name("FILE");
  sub->add_option(
         "--frames", options->frames,
         "Frames: 12, last, 0,60,last or 0:last:10; several in a .png stand side by side (the last; of a video "
         "all)")
      ->type_name("LIST");
  sub->add_option("--camera", options->camera,
                  "corner, front, back, left, right, top or bottom; X,Y,Z: direction to the eye; X,Y,Z,X,Y,Z: the eye "
                  "and what it looks at, and in a seventh number the angle of view [degrees]; or a .csv of such "
                  "cameras, each after a frame, between which it moves (corner)")
      ->type_name("CAMERA");
  sub->add_option("--orbit", options->orbit,
                  "Turn about the vertical by so much in the course of the pictures, from --camera on [degrees]")
      ->check(CLI::Range(-36000.0, 36000.0))
      ->type_name("DEGREES");
  std::vector<std::string> colours(colour_names().begin(), colour_names().end());
  sub->add_option("--colour", options->colour,
                  "Of a run, colour by body, depth inside, speed, strain or contact, with a legend (body)")
      ->check(CLI::IsMember(colours))
      ->type_name("VALUE");
  sub->add_flag("--fit-each", options->fit_each, "Fit the camera to each frame by itself, not to all that are drawn");
  sub->add_option("--cut", options->cut, "Cut bodies open across an axis, as y:0.5; the nearer half is left out")
      ->type_name("AXIS:PLACE");
  sub->add_option("--size", options->size, "Width and height, from 64 to 8192 [pixels] (1200 800)")
      ->expected(2)
      ->check(CLI::Range(64, 8192))
      ->type_name("W H");
  sub->add_flag("--edges", options->edges, "Draw the edges of the triangles");
  sub->add_option("--rate", options->rate, "Of a video, images a second (those of the run; of a .gif at most 25)")
      ->check(CLI::Range(0.1, 240.0))
      ->type_name("N");
  sub->add_option("--after", options->after, "Of resolve, the mesh that it wrote, where it is no longer at its place")
      ->type_name("MESH");
  return {sub, &options->common, [options] {
            run_render(*options);
            return kDone;
          }};
}

}  // namespace selvage::cli
