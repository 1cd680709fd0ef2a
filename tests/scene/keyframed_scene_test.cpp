// Scenes with colliders that follow key frames: read from files, refused, stored with a run, and read again.
#include "io/whole_file.h"
#include "scene/reading/stored_colliders.h"
#include "scene/reading/stored_run.h"
#include "selvage/core/error.h"
#include "selvage/io/mesh_file.h"
#include "selvage/io/point_cache.h"
#include "selvage/scene/frames.h"
#include "selvage/scene/run.h"
#include "temporary_folder.h"

#include <gtest/gtest.h>

#include <fstream>

namespace selvage {
namespace {

using test::TemporaryFolder;

constexpr const char* kTetrahedron = "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";

void write(const std::filesystem::path& path, std::string_view bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

std::string vertices(double height) {
  return "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 " + std::to_string(height) + "\n";
}

PointCache cache(std::size_t count = 4) {
  PointCache result{0, 2, {}};
  for (const double height : {1.0, 2.0, 1.5}) {
    auto& positions = result.samples.emplace_back();
    const std::vector<Vec3> all{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, height}};
    positions.assign(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count));
  }
  return result;
}

std::string scene_text(const std::string& source) {
  return R"({"selvage_scene": 1, "frames": 3, "frames_per_second": 30, "bodies": [
      {"mesh": {"shape": "cloth", "size": [1, 1, 0], "cell": 0.25}, "translate": [-0.5, -0.5, 2.5]}],
      "colliders": [{"plane": {"point": [0, 0, -3], "normal": [0, 0, 1]}},
                    {"keyframed": )" +
         source + R"(, "scale": 0.5, "translate": [0, 0, 1]}]})";
}

class KeyframedScene : public ::testing::Test {
 protected:
  KeyframedScene() {
    write(folder_.path() / "pose_9.obj", vertices(1) + kTetrahedron);
    write(folder_.path() / "pose_10.obj", vertices(2) + kTetrahedron);
    write(folder_.path() / "other.obj", vertices(1) + "f 1 3 2\nf 1 2 4\nf 3 4 2\nf 1 4 3\n");
    write(folder_.path() / "more.obj", vertices(1) + "v 5 5 5\n" + kTetrahedron);
    write(folder_.path() / "open.obj", vertices(1) + "f 1 3 2\nf 1 2 4\nf 2 3 4\n");
    write(folder_.path() / "dancer.pc2", print_point_cache(cache()));
    write(folder_.path() / "short.pc2", print_point_cache(cache(3)));
    write(folder_.path() / "cut.pc2", print_point_cache(cache()).substr(0, 100));
    PointCache broken = cache();
    broken.samples[1][2][0] = std::numeric_limits<double>::quiet_NaN();
    write(folder_.path() / "broken.pc2", print_point_cache(broken));
  }

  Scene parse(const std::string& source) const { return parse_scene(scene_text(source), folder_.path() / "s.json"); }
  std::string refusal(const std::string& source) const {
    try {
      parse(source);
    } catch (const Error& error) {
      return error.what();
    }
    return "accepted";
  }
  static const KeyframedShape& shape_of(const Scene& scene) {
    return std::get<KeyframedShape>(scene.colliders.at(1).shape);
  }

  TemporaryFolder folder_;
};

TEST_F(KeyframedScene, ReadsFilesInTheOrderOfTheirNumbers) {
  for (const char* files : {R"("pose_*.obj")", R"(["pose_9.obj", "pose_10.obj"])"}) {
    const Scene scene = parse(R"({"start": 0.5, "files": )" + std::string(files) + "}");
    const KeyframedShape& shape = shape_of(scene);
    ASSERT_EQ(shape.times.size(), 2u);
    EXPECT_EQ(shape.times[0], 0.5);
    EXPECT_NEAR(shape.times[1], 0.5 + 1.0 / 30, 1e-15);
    EXPECT_EQ(shape.positions[0][3], Vec3(0, 0, 1.5));
    EXPECT_EQ(shape.positions[1][3], Vec3(0, 0, 2));
    EXPECT_EQ(shape.triangles.size(), 4u);
  }
}

TEST_F(KeyframedScene, ReadsAPointCacheWithItsMesh) {
  const Scene scene = parse(R"({"mesh": "pose_9.obj", "pc2": "dancer.pc2", "frames_per_second": 10})");
  const KeyframedShape& shape = shape_of(scene);
  ASSERT_EQ(shape.times.size(), 3u);
  EXPECT_NEAR(shape.times[2], 0.4, 1e-15);  // two frames a sample
  EXPECT_EQ(shape.positions[1][3], Vec3(0, 0, 2));
  const Scene slower = parse(R"({"mesh": "pose_9.obj", "pc2": "dancer.pc2", "frames_per_second": 5})");
  EXPECT_NE(scene.fingerprint, slower.fingerprint);
  write(folder_.path() / "dancer.pc2", print_point_cache({0, 2, {cache().samples[0], cache().samples[0]}}));
  EXPECT_NE(parse(R"({"mesh": "pose_9.obj", "pc2": "dancer.pc2", "frames_per_second": 10})").fingerprint,
            scene.fingerprint);
}

TEST_F(KeyframedScene, ReadsTimesOfItsOwn) {
  const std::vector<double> times{-0.5, 0.125, 3};
  const Scene cached = parse(R"({"mesh": "pose_9.obj", "pc2": "dancer.pc2", "times": [-0.5, 0.125, 3]})");
  EXPECT_EQ(shape_of(cached).times, times);
  EXPECT_EQ(shape_of(cached).positions[1][3], Vec3(0, 0, 2));
  const Scene files = parse(R"({"files": "pose_*.obj", "times": [0, 0.25]})");
  EXPECT_EQ(shape_of(files).times, (std::vector<double>{0, 0.25}));
}

TEST_F(KeyframedScene, FilesCountByTheirContents) {
  const auto fingerprint = [&](const std::string& mesh, const std::string& cache) {
    return parse(R"({"mesh": ")" + mesh + R"(", "pc2": ")" + cache + R"("})").fingerprint;
  };
  const std::uint64_t here = fingerprint("pose_9.obj", "dancer.pc2");
  const std::filesystem::path elsewhere = folder_.path() / "elsewhere";
  std::filesystem::create_directory(elsewhere);
  for (const char* name : {"pose_9.obj", "dancer.pc2"})
    std::filesystem::copy_file(folder_.path() / name, elsewhere / name);
  EXPECT_EQ(fingerprint("elsewhere/pose_9.obj", (elsewhere / "dancer.pc2").string()), here);
  PointCache faster = cache();
  faster.samples[1][3][2] = 2.25;
  write(elsewhere / "dancer.pc2", print_point_cache(faster));
  EXPECT_NE(fingerprint("pose_9.obj", "elsewhere/dancer.pc2"), here);
}

TEST_F(KeyframedScene, RefusesBadFilesInOneLine) {
  const auto expect = [&](const std::string& source, const std::vector<std::string>& parts) {
    const std::string text = refusal(source);
    EXPECT_EQ(text.find('\n'), std::string::npos);
    for (const std::string& part : parts) EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  expect(R"({"files": ["pose_9.obj", "more.obj"]})",
         {"colliders[1].keyframed", "more.obj: has 5 vertices, the first key frame 4"});
  expect(R"({"files": ["pose_9.obj", "other.obj"]})", {"other.obj: has other triangles than the first key frame"});
  expect(R"({"files": ["open.obj"]})", {"colliders[1].keyframed", "has 1 triangles", "closed surface"});
  expect(R"({"files": "nothing_*.obj"})", {"nothing_*.obj: no file has such a name"});
  expect(R"({"files": ["nothing.obj"]})", {"nothing.obj", "cannot be read"});
  expect(R"({"files": []})", {"colliders[1].keyframed.files: is empty"});
  expect(R"({"mesh": "pose_9.obj", "pc2": "short.pc2"})", {"short.pc2: moves 3 vertices, but", "pose_9.obj has 4"});
  expect(R"({"mesh": "pose_9.obj", "pc2": "cut.pc2"})", {"cut.pc2: holds 68 bytes", "not 3 samples of 4 vertices"});
  expect(R"({"mesh": "pose_9.obj", "pc2": "broken.pc2"})", {"broken.pc2: vertex 2 of sample 1 is not finite"});
  expect(R"({"mesh": "pose_9.obj", "pc2": "pose_9.obj"})", {"pose_9.obj: is no point cache"});
  expect(R"({"mesh": "pose_9.obj"})", {"colliders[1].keyframed", "pc2"});
  expect(R"({"mesh": "pose_9.obj", "pc2": "dancer.pc2", "files": "a"})", {"has both 'mesh' and 'files'"});
  expect(R"({"mesh": "pose_9.obj", "pc2": "dancer.pc2", "frames_per_second": 0})", {"frames_per_second"});
  expect(R"({"files": "pose_*.obj", "times": [0, 1, 2]})", {"colliders[1].keyframed", "3 numbers for 2 key frames"});
  expect(R"({"files": "pose_*.obj", "times": [0, 0]})", {"key frame 1 is not later", "let times ascend"});
  expect(R"({"files": "pose_*.obj", "times": []})", {"colliders[1].keyframed.times: is empty"});
  expect(R"({"files": "pose_*.obj", "times": [0, "1"]})", {"colliders[1].keyframed.times[1]"});
  expect(R"({"files": "pose_*.obj", "times": [0, 1], "start": 1})", {"keyframed.times", "beside"});
  expect(R"({"files": "pose_*.obj", "speed": 1})", {"speed", "is not known here"});
}

TEST_F(KeyframedScene, IsStoredWithARunAndReadAgain) {
  const Scene scene = parse(R"({"mesh": "pose_9.obj", "pc2": "dancer.pc2"})");
  RunOptions options;
  options.folder = folder_.path() / "run";
  const RunReport report = run_scene(scene, options);
  ASSERT_EQ(report.outcome, RunOutcome::kFinished) << report.message;
  const std::string file = scene_path(options.folder).string();
  const auto json = nlohmann::ordered_json::parse(read_whole_file(file));
  const std::vector<Collider> colliders = read_stored_colliders(json, file);
  ASSERT_EQ(colliders.size(), 2u);
  const auto& stored = std::get<KeyframedShape>(colliders[1].shape);
  EXPECT_EQ(stored.times, shape_of(scene).times);
  EXPECT_EQ(stored.triangles, shape_of(scene).triangles);
  EXPECT_EQ(stored.positions, shape_of(scene).positions);
  write(options.folder / "collider_1.pc2", "POINTCACHE2");
  EXPECT_THROW(read_stored_colliders(json, file), Error);
}

}  // namespace
}  // namespace selvage
