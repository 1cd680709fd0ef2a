// The scenes that a user would write first, at a small size, with their default settings.
#include "io/whole_file.h"
#include "scene/description/json_value.h"
#include "scene/frame_measures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace selvage {
namespace {

namespace fs = std::filesystem;

/// A place in a scene and what stands there instead, as JSON.
using Changes = std::vector<std::pair<const char*, const char*>>;

/// A run of a scene that stays in memory, and all that was ever wrong in it.
class FirstScene {
 public:
  explicit FirstScene(const std::string& name, const Changes& changes = {}) : scene_(load(name, changes)) {
    state_ = scene_.initial_state;
    measures_.emplace(scene_);
    solver_.emplace(scene_.model, state_, scene_.handles, scene_.colliders, scene_.options);
    look();
  }

  /// To the end of a frame, looking at each: none may show bodies in one another, or vertices in colliders.
  void run_to(int frame) {
    for (; frame_ < frame; look()) {
      for (int step = 0; step < scene_.substeps; ++step) solver_->step(state_);
      ++frame_;
    }
  }
  void run() { run_to(scene_.frames); }

  const FrameStatistics& row() const { return row_; }
  const State& state() const { return state_; }

  const Body& body(const std::string& name) const { return *std::ranges::find(scene_.model.bodies, name, &Body::name); }
  Vec3 middle_of(const std::string& name) const {
    const Body& b = body(name);
    Vec3 sum = Vec3::Zero();
    for (Index v = b.first_vertex; v < b.first_vertex + b.vertex_count; ++v) sum += state_.positions[v];
    return sum / b.vertex_count;
  }
  /// Of all vertices [m/s].
  double fastest_speed() const {
    return std::ranges::max(state_.velocities, {}, [](const Vec3& v) { return v.norm(); }).norm();
  }
  /// Angle by which a body that was at rest at the start has turned about z through a point [rad], in (-pi, pi].
  double turn_of(const std::string& name, const Vec3& centre) const {
    const Body& b = body(name);
    double along = 0, across = 0;
    for (Index v = b.first_vertex; v < b.first_vertex + b.vertex_count; ++v) {
      const Vec3 from = scene_.initial_state.positions[v] - centre, to = state_.positions[v] - centre;
      along += from[0] * to[0] + from[1] * to[1];
      across += from[0] * to[1] - from[1] * to[0];
    }
    return std::atan2(across, along);
  }

 private:
  static Scene load(const std::string& name, const Changes& changes) {
    const fs::path path = fs::path(SELVAGE_SCENES) / "first" / (name + ".json");
    Json json = parse_json(read_whole_file(path), path.string());
    for (const auto& [place, value] : changes) json[Json::json_pointer(place)] = Json::parse(value);
    return parse_scene(json.dump(), path);
  }
  void look() {
    row_ = {};
    measures_->measure(state_, frame_, row_);
    EXPECT_EQ(row_.triangle_pairs, 0) << "frame " << frame_;
    EXPECT_EQ(row_.penetrating_vertices, 0) << "frame " << frame_;
    EXPECT_EQ(row_.inverted_elements, 0) << "frame " << frame_;
    EXPECT_EQ(row_.vertices_in_colliders, 0) << "frame " << frame_;
  }

  Scene scene_;
  State state_;
  std::optional<FrameMeasures> measures_;
  std::optional<XpbdSolver> solver_;
  FrameStatistics row_;
  int frame_ = 0;
};

TEST(FirstScenes, OfThisTestAreAllThatThereAre) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(fs::path(SELVAGE_SCENES) / "first"))
    names.push_back(entry.path().stem().string());
  std::ranges::sort(names);
  EXPECT_EQ(names, (std::vector<std::string>{"funnel", "gears", "grip", "heap", "knotted_rope", "net", "pile", "slope",
                                             "squeeze", "stack"}));
}

TEST(FirstScenes, ACubeSlidesDownASlopeAndRestsOnTheFloor) {
  FirstScene scene("slope", {{"/bodies/0/mesh/cell", "0.2"}});
  const double start = scene.middle_of("cube")[0];
  scene.run_to(30);
  EXPECT_GT(scene.middle_of("cube")[0], start + 0.2);
  scene.run();
  EXPECT_GT(scene.middle_of("cube")[0], 0);
  EXPECT_NEAR(scene.middle_of("cube")[2], 0.2, 0.05);
  EXPECT_LT(scene.fastest_speed(), 0.1);
}

TEST(FirstScenes, AStackStands) {
  FirstScene scene("stack", {{"/bodies/0/mesh/cell", "0.17"}});
  const Vec3 start = scene.middle_of("box[4]");
  scene.run();
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(scene.middle_of("box[" + std::to_string(i) + "]")[2], 0.16 + 0.3 * i, 0.08);
  EXPECT_LT((scene.middle_of("box[4]") - start).head<2>().norm(), 0.03);
  EXPECT_LT(scene.fastest_speed(), 0.1);
}

TEST(FirstScenes, AKnotIsPulledTight) {
  FirstScene scene("knotted_rope", {{"/bodies/0/mesh/cell", "0.03"}});
  // The part of the rope that lies farther than three radii from the line between its ends.
  const auto knotted = [&] {
    const auto& positions = scene.state().positions;
    return std::ranges::count_if(positions, [](const Vec3& p) { return std::hypot(p[1], p[2]) > 0.15; });
  };
  const auto loose = knotted();
  EXPECT_GT(loose, std::ssize(scene.state().positions) / 4);
  scene.run();
  EXPECT_LT(knotted(), loose / 20);
  // Still a knot: the rope is 4 m long, its ends are 3.6 m apart.
  double most = 0, least = 0;
  for (const Vec3& p : scene.state().positions) {
    most = std::max(most, p[0]);
    least = std::min(least, p[0]);
  }
  EXPECT_NEAR(most - least, 3.55, 0.1);
}

TEST(FirstScenes, ANetCatchesABall) {
  FirstScene scene("net", {{"/bodies/0/mesh/cell", "0.06"}, {"/bodies/1/mesh/cell", "0.06"}});
  scene.run();
  EXPECT_GT(scene.middle_of("ball")[2], 0.3);
  EXPECT_LT(scene.fastest_speed(), 0.1);
}

TEST(FirstScenes, TwoFingersLiftABall) {
  FirstScene scene("grip",
                   {{"/bodies/0/mesh/cell", "0.1"}, {"/bodies/1/mesh/cell", "0.1"}, {"/bodies/2/mesh/cell", "0.1"}});
  scene.run_to(48);
  EXPECT_NEAR(scene.middle_of("ball")[2], 0.2, 0.02);
  scene.run();
  EXPECT_NEAR(scene.middle_of("ball")[2], 0.7, 0.1);
}

TEST(FirstScenes, AHeapComesToRest) {
  FirstScene scene("heap", {{"/bodies/0/mesh/cell", "0.2"}, {"/bodies/1/mesh/elements", "300"}});
  scene.run();
  EXPECT_LT(scene.fastest_speed(), 0.1);
}

TEST(FirstScenes, ASqueezedToyReturnsToItsShape) {
  FirstScene scene("squeeze", {{"/bodies/0/mesh", R"({"shape": "ball", "radius": 0.3, "cell": 0.1})"},
                               {"/bodies/0/translate", "[0, 0, 0.1]"}});
  const std::vector<Vec3> rest = scene.state().positions;
  scene.run_to(48);
  double height = 0;
  for (const Vec3& p : scene.state().positions) height = std::max(height, p[2]);
  EXPECT_LT(height, 0.2 + 1e-9);  // the upper plate
  scene.run();
  double changes = 0, lengths = 0;
  for (std::size_t v = 1; v < rest.size(); ++v) {
    const double now = (scene.state().positions[v] - scene.state().positions[0]).norm();
    const double before = (rest[v] - rest[0]).norm();
    changes += (now - before) * (now - before);
    lengths += before * before;
  }
  EXPECT_LT(std::sqrt(changes / lengths), 0.05);
}

TEST(FirstScenes, ABallIsPushedThroughAFunnelNarrowerThanIt) {
  FirstScene scene("funnel");
  scene.run_to(36);
  EXPECT_GT(scene.middle_of("ball")[2], 0.3);  // it does not fall through by its weight
  scene.run();
  EXPECT_LT(scene.middle_of("ball")[2], 0);
}

TEST(FirstScenes, AGearTurnsAnother) {
  FirstScene scene("gears", {{"/bodies/0/mesh/length", "0.05"}, {"/bodies/1/mesh/length", "0.05"}});
  scene.run_to(45);  // an eighth of a turn
  EXPECT_NEAR(scene.turn_of("driver", Vec3(-0.435, 0, 0)), std::numbers::pi / 4, 0.05);
  EXPECT_NEAR(scene.turn_of("follower", Vec3(0.435, 0, 0)), -std::numbers::pi / 4, 0.1);
}

TEST(FirstScenes, ABallScattersAPile) {
  FirstScene scene("pile");
  const double start = scene.middle_of("block[7]")[0];
  scene.run_to(60);
  EXPECT_GT(scene.middle_of("block[7]")[0], start + 0.1);
  EXPECT_LT(scene.middle_of("block[7]")[2], 0.9);
}

}  // namespace
}  // namespace selvage
