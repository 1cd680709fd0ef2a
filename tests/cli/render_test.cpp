#include "cli/arguments/picture_options.h"
#include "cli/program.h"
#include "selvage/core/error.h"

#include <nlohmann/json.hpp>

#include <cstdlib>

namespace selvage::testing {
namespace {

using Render = ProgramTest;

const char* const kDrawnScene = R"({"selvage_scene": 1, "frames": 3, "substeps": 2,
  "bodies": [{"mesh": {"shape": "box", "size": [1, 1, 1], "cell": 0.5}, "translate": [0, 0, 0.05]}],
  "colliders": [{"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}},
                {"sphere": {"centre": [3, 0, 1], "radius": 1}, "motion": {"keyframes": [{"time": 0}, {"time": 1, "translate": [0, 0, 1]}]}}]})";

/// Width and height in the head of a PNG file.
std::array<int, 2> size_of(const fs::path& path) {
  const std::string bytes = read_text(path);
  if (bytes.size() < 24 || bytes.substr(1, 3) != "PNG") return {0, 0};
  const auto number = [&](std::size_t at) {
    int value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value * 256 + static_cast<unsigned char>(bytes[at + i]);
    return value;
  };
  return {number(16), number(20)};
}

/// Lets the program find another `ffmpeg`, or none, while it lives.
class SearchPath {
 public:
  explicit SearchPath(const fs::path& folder) : before_(std::getenv("PATH")) { setenv("PATH", folder.c_str(), 1); }
  ~SearchPath() { setenv("PATH", before_.c_str(), 1); }
  SearchPath(const SearchPath&) = delete;
  SearchPath& operator=(const SearchPath&) = delete;

 private:
  std::string before_;
};

void write_encoder(const fs::path& folder, const std::string& script) {
  fs::create_directories(folder);
  write_text(folder / "ffmpeg", "#!/bin/sh\n" + script);
  fs::permissions(folder / "ffmpeg", fs::perms::owner_all);
}

TEST_F(Render, DrawsRunsMeshesAndResults) {
  write_text(file("blocks.json"), kDrawnScene);
  run_well("simulate blocks.json -o run -q --no-report");
  EXPECT_NE(run_well("render run -o a.png --size 120 90").out.find("a.png: 1 frame in"), std::string::npos);
  EXPECT_EQ(size_of(file("a.png")), (std::array<int, 2>{120, 90}));
  run_well("render run -o b.png --size 100 80 --frames 0,last --camera top --cut x:0.3 --edges -q");
  EXPECT_EQ(size_of(file("b.png")), (std::array<int, 2>{200, 80}));
  const auto said = nlohmann::json::parse(run_well("render run -o c.png --size 64 64 --frames 0::2 --json -").out);
  EXPECT_EQ(said["frames"], (std::vector<int>{0, 2}));
  run_well("make rod --length 8 --radius 0.2 --pose self-crossing -o rod.vtu -q");
  EXPECT_EQ(run("check rod.vtu --json pairs.json -q").status, 1);
  run_well("paths rod.vtu --json paths.json -q");
  run_well("resolve rod.vtu -o free.vtu --json report.json -q");
  for (const char* what : {"rod.vtu", "pairs.json", "paths.json"}) {
    run_well(std::string("render ") + what + " -o d.png --size 96 64 --camera=-1,-1,0.5 -q");
    EXPECT_EQ(size_of(file("d.png")), (std::array<int, 2>{96, 64})) << what;
  }
  run_well("render report.json -o e.png --size 96 64 -q");
  EXPECT_EQ(size_of(file("e.png")), (std::array<int, 2>{192, 64})) << "before and after";
}

TEST_F(Render, ColoursRunsByValuesAndMovesTheCamera) {
  write_text(file("blocks.json"), kDrawnScene);
  run_well("simulate blocks.json -o run -q --no-report");
  run_well("render run -o body.png --size 160 120 -q");
  for (const std::string by : {"depth", "speed", "strain", "contact"}) {
    run_well("render run -o " + by + ".png --size 160 120 --colour " + by + " -q");
    EXPECT_NE(read_text(file(by + ".png")), read_text(file("body.png"))) << by;
  }
  EXPECT_NE(read_text(file("speed.png")), read_text(file("strain.png")));
  // The camera turns: from picture to picture of the same frame.
  run_well("render run -o still.png --size 80 66 --frames 3,3 -q");
  run_well("render run -o turned.png --size 80 66 --frames 3,3 --orbit 90 -q");
  EXPECT_EQ(size_of(file("turned.png")), (std::array<int, 2>{160, 66}));
  EXPECT_NE(read_text(file("still.png")), read_text(file("turned.png")));
  // A file of cameras says the same as its first line in the first frame.
  write_text(file("way.csv"), "frame,x,y,z,x,y,z\n\n# from the right\n0, 5,0,1, 0,0,0.5\n3, 0,-5,1, 0,0,0.5, 40\n");
  run_well("render run -o way.png --size 80 66 --frames 0 --camera way.csv -q");
  run_well("render run -o fixed.png --size 80 66 --frames 0 --camera 5,0,1,0,0,0.5 -q");
  EXPECT_EQ(read_text(file("way.png")), read_text(file("fixed.png")));
  // A mesh has one pose, but turns.
  write_encoder(file("tools"), "for last; do :; done\nexec /bin/cat > \"$last\"\n");
  run_well("make ball -o ball.vtu -q");
  const SearchPath path(file("tools"));
  run_well("render ball.vtu -o ball.mp4 --orbit 360 --size 64 64 --frames 0,0,0 -q");
  EXPECT_EQ(fs::file_size(file("ball.mp4")), 3u * 3 * 64 * 64);
}

TEST_F(Render, RefusesCamerasAndColoursThatMeanNothing) {
  write_text(file("blocks.json"), kDrawnScene);
  run_well("simulate blocks.json -o run -q --no-report");
  run_well("make ball -o ball.vtu -q");
  expect_refused("render run -o a.png --colour red", 2, {"--colour", "red"});
  expect_refused("render ball.vtu -o a.png --colour speed", 2, {"--colour", "ball.vtu", "folder of a run"});
  expect_refused("render run -o a.png --orbit 90 --fit-each", 2, {"--fit-each"});
  expect_refused("render run -o a.png --camera none.csv", 2, {"none.csv"});
  const auto refused = [&](const std::string& text, const std::vector<std::string>& words) {
    write_text(file("way.csv"), text);
    expect_refused("render run -o a.png --camera way.csv", 2, words);
  };
  refused("", {"way.csv", "no line with a camera"});
  refused("0,1,2,3,0,0,0\n0,1,2,3,0,0,0\n", {"way.csv, line 2", "does not come after 0"});
  refused("0,1,2,3\n", {"way.csv, line 1", "no eye and target"});
  refused("0,1,2,3,0,0,0\nx,1,2,3,0,0,0\n", {"way.csv, line 2", "no number of a frame"});
  fs::remove(file("run/rest.bin"));
  expect_refused("render run -o a.png --colour strain", 2, {"rest.bin", "missing"});
  expect_refused("render ball.vtu -o a.mp4", 2, {"one pose", "--orbit 360"});
  EXPECT_FALSE(fs::exists(file("a.png")));
}

TEST_F(Render, ThePictureOfPathsIsTheOneThatPathsDraws) {
  run_well("make rod --length 8 --radius 0.2 --pose self-crossing -o rod.vtu -q");
  run_well("paths rod.vtu --json paths.json --picture a.png --picture-size 200 150 -q");
  run_well("render paths.json -o b.png --size 200 150 -q");
  EXPECT_NEAR(static_cast<double>(fs::file_size(file("a.png"))), static_cast<double>(fs::file_size(file("b.png"))),
              0.2 * static_cast<double>(fs::file_size(file("a.png"))))
      << "alike but for the caption";
}

TEST_F(Render, SameBytesForAnyNumberOfThreads) {
  write_text(file("blocks.json"), kDrawnScene);
  run_well("simulate blocks.json -o run -q --no-report");
  run_well("render run -o a.png --size 200 150 -q --threads 1");
  run_well("render run -o b.png --size 200 150 -q --threads 3");
  EXPECT_EQ(read_text(file("a.png")), read_text(file("b.png")));
}

TEST_F(Render, SendsVideosToTheEncoder) {
  write_text(file("blocks.json"), kDrawnScene);
  run_well("simulate blocks.json -o run -q --no-report");
  write_encoder(file("tools"), "for last; do :; done\nexec /bin/cat > \"$last\"\n");
  const SearchPath path(file("tools"));
  run_well("render run -o a.mp4 --size 70 66 -q");
  EXPECT_EQ(fs::file_size(file("a.mp4")), 4u * 3 * 70 * 66) << "all frames";
  run_well("render run -o a.gif --size 70 66 -q");
  EXPECT_EQ(fs::file_size(file("a.gif")), 2u * 3 * 70 * 66) << "every third of 60 a second";
  run_well("render run -o a.gif --size 70 66 -q --frames 0:last --rate 10");
  EXPECT_EQ(fs::file_size(file("a.gif")), 4u * 3 * 70 * 66);
}

TEST_F(Render, EncodersThatFailOrAreMissingAreOneLine) {
  write_text(file("blocks.json"), kDrawnScene);
  run_well("simulate blocks.json -o run -q --no-report");
  write_encoder(file("broken"), "echo 'no such codec' >&2\nexit 1\n");
  fs::create_directory(file("nothing"));
  {
    const SearchPath path(file("broken"));
    expect_refused("render run -o a.mp4 --size 800 600", 3, {"a.mp4", "no such codec"});
  }
  const SearchPath path(file("nothing"));
  expect_refused("render run -o a.mp4", 2, {"ffmpeg", "not installed"});
  EXPECT_FALSE(fs::exists(file("a.mp4")));
}

TEST_F(Render, RefusesWithOneLine) {
  write_text(file("blocks.json"), kDrawnScene);
  run_well("simulate blocks.json -o run -q --no-report");
  expect_refused("render none -o a.png", 2, {"none"});
  expect_refused("render run -o a.bmp", 2, {"a.bmp", ".png, .mp4 or .gif"});
  expect_refused("render run -o a.png --frames 7", 2, {"--frames", "no frame 7", "0 to 3"});
  expect_refused("render run -o a.png --frames 2:1", 2, {"--frames", "2:1"});
  expect_refused("render run -o a.png --camera above", 2, {"--camera", "above", "top"});
  expect_refused("render run -o a.png --camera 1,2", 2, {"--camera"});
  expect_refused("render run -o a.png --camera 1,1,1,1,1,1", 2, {"--camera"});
  expect_refused("render run -o a.png --cut 0.5", 2, {"--cut", "y:0.5"});
  expect_refused("render run -o a.png --size 10 10", 2, {"--size"});
  expect_refused("render run -o a.png --rate 10", 2, {"--rate"});
  expect_refused("render run -o a.png --after b.vtu", 2, {"--after", "no meaning"});
  run_well("make ball -o ball.vtu -q");
  expect_refused("render ball.vtu -o ball.vtu", 2, {"ball.vtu"});
  expect_refused("render blocks.json -o a.png", 2, {"blocks.json", "no result of selvage"});
  std::string scene = read_text(file("run/scene.json"));
  scene.replace(scene.find("\"radius\":1.0"), 12, "\"radius\":[]");
  write_text(file("run/scene.json"), scene);
  expect_refused("render run -o a.png", 2, {"scene.json", "colliders[1].radius is no number", "run the scene anew"});
  EXPECT_FALSE(fs::exists(file("a.png")));
}

TEST(PictureOptions, FramesAreNumbersAndRanges) {
  using cli::read_frames;
  using Frames = std::vector<std::int64_t>;
  EXPECT_EQ(read_frames("12", 20), Frames{12});
  EXPECT_EQ(read_frames("0, last,3", 20), (Frames{0, 20, 3}));
  EXPECT_EQ(read_frames(":", 2), (Frames{0, 1, 2}));
  EXPECT_EQ(read_frames("4:last:3", 11), (Frames{4, 7, 10}));
  EXPECT_EQ(read_frames("1:2,:1", 5), (Frames{1, 2, 0, 1}));
  for (const char* wrong : {"", "x", "1,,2", "-1", "21", "1:2:0", "1:2:3:4", "5:1", "1.5", "last:0"})
    EXPECT_THROW(read_frames(wrong, 20), Error) << wrong;
}

TEST(PictureOptions, CamerasByNameAndNumbers) {
  EXPECT_EQ(*cli::read_camera("left", Vec3::UnitZ()).towards, Vec3(-1, 0, 0));
  EXPECT_LT((*cli::read_camera("top", Vec3::UnitY()).towards - Vec3::UnitY()).norm(), 1e-12) << "turned with `up`";
  EXPECT_LT((*cli::read_camera("1e300,0,1e300", Vec3::UnitZ()).towards - Vec3(1, 0, 1).normalized()).norm(), 1e-12);
  const View view = cli::read_camera("1,2,3,0,0,0,60", Vec3::UnitZ());
  EXPECT_EQ(*view.eye, Vec3(1, 2, 3));
  EXPECT_EQ(view.angle, 60);
  for (const char* wrong : {"0,0,0", "nan,0,1", "1,2,3,4", "1,2,3,0,0,0,170", "", "Top"})
    EXPECT_THROW(cli::read_camera(wrong, Vec3::UnitZ()), Error) << wrong;
  EXPECT_EQ(cli::read_cut("z:-2e-1").axis, 2);
  EXPECT_EQ(cli::read_cut("z:-2e-1").position, -0.2);
  for (const char* wrong : {"", "z", "z:", "w:1", "x:inf", "1:x"}) EXPECT_THROW(cli::read_cut(wrong), Error) << wrong;
}

}  // namespace
}  // namespace selvage::testing
