#include "export/export_run.h"

#include "selvage/core/error.h"
#include "selvage/scene/frames.h"
#include "selvage/scene/run.h"
#include "temporary_folder.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstring>
#include <sstream>

namespace selvage {
namespace {

namespace fs = std::filesystem;
using test::read_text;
using test::TemporaryFolder;
using test::write_text;
using Floats = std::vector<float>;

constexpr const char* kScene = R"({"selvage_scene": 1, "frames": 4, "substeps": 2,
  "bodies": [
    {"mesh": {"shape": "box", "size": [1, 1, 1], "cell": 0.5}, "translate": [0, 0, 0.1], "velocity": [0.1, 0, -3]},
    {"mesh": {"shape": "box", "size": [1, 1, 1], "cell": 0.5}, "translate": [0.3, 0.2, 1.2], "velocity": [0, 0.3, 1]}],
  "colliders": [{"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}]})";

/// A run of two blocks of 26 boundary vertices each, and what its frames hold.
class Export : public ::testing::Test {
 protected:
  void SetUp() override {
    RunOptions options;
    options.folder = run_;
    run_scene(parse_scene(kScene, "blocks.json"), options);
    const TopologyFile topology = read_topology(topology_path(run_));
    for (const auto& face : topology.boundary_faces) shown_.insert(shown_.end(), face.begin(), face.end());
    std::sort(shown_.begin(), shown_.end());
    shown_.erase(std::unique(shown_.begin(), shown_.end()), shown_.end());
    for (const auto& face : topology.boundary_faces)
      for (const Index v : face) corners_.push_back(std::lower_bound(shown_.begin(), shown_.end(), v) - shown_.begin());
    ASSERT_EQ(shown_.size(), 52u);
  }

  /// The bytes of a frame's file, apart from the vertices inside.
  Floats frame(std::int64_t number) const {
    const std::string bytes = read_text(frame_path(run_, number));
    Floats floats;
    for (const Index v : shown_) {
      floats.resize(floats.size() + 3);
      std::memcpy(floats.data() + floats.size() - 3, bytes.data() + 64 + 12 * v, 12);
    }
    return floats;
  }

  std::vector<ExportedFile> exported(const char* name, std::int64_t every = 1) const {
    return export_run(run_, folder_.path() / name, every);
  }

  TemporaryFolder folder_;
  fs::path run_ = folder_.path() / "run";
  std::vector<Index> shown_;
  std::vector<std::int64_t> corners_;
};

template <typename T>
T number_at(const std::string& bytes, std::size_t at) {
  T value{};
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

Floats floats_at(const std::string& bytes, std::size_t at, std::size_t count) {
  Floats floats(count);
  std::memcpy(floats.data(), bytes.data() + at, count * sizeof(float));
  return floats;
}

TEST_F(Export, Pc2HoldsTheFramesBitForBit) {
  const auto files = exported("a.pc2");
  ASSERT_EQ(files.size(), 2u);
  const std::string& bytes = files[0].bytes;
  EXPECT_EQ(bytes.substr(0, 12), std::string("POINTCACHE2\0", 12));
  EXPECT_EQ(number_at<std::int32_t>(bytes, 12), 1);
  EXPECT_EQ(number_at<std::int32_t>(bytes, 16), 52);
  EXPECT_EQ(number_at<float>(bytes, 20), 0);
  EXPECT_EQ(number_at<float>(bytes, 24), 1);
  EXPECT_EQ(number_at<std::int32_t>(bytes, 28), 5);
  ASSERT_EQ(bytes.size(), 32u + 5 * 52 * 12);
  for (std::size_t k = 0; k < 5; ++k)
    EXPECT_EQ(floats_at(bytes, 32 + k * 52 * 12, 156), frame(static_cast<std::int64_t>(k))) << k;

  EXPECT_EQ(files[1].path.filename(), "a.obj");
  std::istringstream lines(files[1].bytes);
  Floats vertices;
  std::vector<std::int64_t> corners;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    while (words >> word && line[0] != '#') {
      if (line[0] == 'v') vertices.push_back(std::stof(word));
      if (line[0] == 'f') corners.push_back(std::stoll(word) - 1);
    }
  }
  EXPECT_EQ(vertices, frame(0));
  EXPECT_EQ(corners, corners_);
}

/// Numbers between brackets behind a word.
template <typename T>
std::vector<T> list_behind(const std::string& text, const std::string& word) {
  const std::size_t begin = text.find('[', text.find(word) + word.size()), end = text.find(']', begin);
  EXPECT_NE(text.find(word), std::string::npos) << word;
  std::string list = text.substr(begin + 1, end - begin - 1);
  for (char& c : list)
    if (c == '(' || c == ')' || c == ',') c = ' ';
  std::istringstream words(list);
  std::vector<T> numbers;
  for (std::string number; words >> number;) {
    if constexpr (std::is_same_v<T, float>) {
      numbers.push_back(std::stof(number));
    } else {
      numbers.push_back(std::stoll(number));
    }
  }
  return numbers;
}

TEST_F(Export, UsdHoldsTheFramesBitForBit) {
  const std::string text = exported("a.usda")[0].bytes;
  EXPECT_EQ(text.find("#usda 1.0\n"), 0u);
  for (const char* line : {"timeCodesPerSecond = 60", "endTimeCode = 4", "upAxis = \"Z\"", "metersPerUnit = 1"})
    EXPECT_NE(text.find(line), std::string::npos) << line;
  EXPECT_EQ(list_behind<std::int64_t>(text, "int[] faceVertexCounts ="), std::vector<std::int64_t>(96, 3));
  EXPECT_EQ(list_behind<std::int64_t>(text, "int[] faceVertexIndices ="), corners_);
  const std::string samples = text.substr(text.find("points.timeSamples"));
  for (int k = 0; k <= 4; ++k)
    EXPECT_EQ(list_behind<float>(samples, "            " + std::to_string(k) + ":"), frame(k)) << k;
  const std::string extents = text.substr(text.find("extent.timeSamples"));
  const Floats last = frame(4), extent = list_behind<float>(extents, "            4:");
  ASSERT_EQ(extent.size(), 6u);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    float lower = last[axis], upper = last[axis];
    for (std::size_t i = axis; i < last.size(); i += 3) {
      lower = std::min(lower, last[i]);
      upper = std::max(upper, last[i]);
    }
    EXPECT_EQ(extent[axis], lower);
    EXPECT_EQ(extent[axis + 3], upper);
  }
}

TEST_F(Export, GltfMovesTheFirstFrameToTheOthers) {
  const std::string bytes = exported("a.glb")[0].bytes;
  EXPECT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(number_at<std::uint32_t>(bytes, 4), 2u);
  EXPECT_EQ(number_at<std::uint32_t>(bytes, 8), bytes.size());
  const std::size_t length = number_at<std::uint32_t>(bytes, 12);
  EXPECT_EQ(bytes.substr(16, 4), "JSON");
  const nlohmann::json json = nlohmann::json::parse(bytes.substr(20, length));
  const std::size_t binary = 20 + length + 8;
  EXPECT_EQ(bytes.substr(binary - 4, 4), std::string("BIN\0", 4));
  EXPECT_EQ(number_at<std::uint32_t>(bytes, binary - 8) + binary, bytes.size());
  EXPECT_EQ(length % 4, 0u);
  const auto offset = [&](const nlohmann::json& accessor) {
    const nlohmann::json& view =
        json["bufferViews"][json["accessors"][accessor.get<std::size_t>()]["bufferView"].get<std::size_t>()];
    EXPECT_LE(view["byteOffset"].get<std::size_t>() + view["byteLength"].get<std::size_t>(),
              json["buffers"][0]["byteLength"].get<std::size_t>());
    return binary + view["byteOffset"].get<std::size_t>();
  };
  EXPECT_EQ(json["scenes"][0]["nodes"], nlohmann::json::array({0}));
  EXPECT_EQ(json["nodes"][0]["mesh"], 0);
  EXPECT_EQ(json["nodes"][0]["rotation"].size(), 4u);
  const nlohmann::json& primitive = json["meshes"][0]["primitives"][0];
  const Floats first = frame(0);
  EXPECT_EQ(floats_at(bytes, offset(primitive["attributes"]["POSITION"]), 156), first);
  ASSERT_EQ(primitive["targets"].size(), 4u);
  for (int k = 1; k <= 4; ++k) {
    const Floats moves =
        floats_at(bytes, offset(primitive["targets"][static_cast<std::size_t>(k - 1)]["POSITION"]), 156);
    const Floats expected = frame(k);
    for (std::size_t i = 0; i < moves.size(); ++i) EXPECT_NEAR(first[i] + moves[i], expected[i], 2e-7 * 3);
  }
  for (std::size_t i = 0; i < corners_.size(); ++i)
    EXPECT_EQ(number_at<std::uint32_t>(bytes, offset(primitive["indices"]) + 4 * i), corners_[i]);

  const nlohmann::json& animation = json["animations"][0];
  EXPECT_EQ(animation["channels"][0]["target"]["path"], "weights");
  const nlohmann::json& sampler = animation["samplers"][0];
  const Floats times = floats_at(bytes, offset(sampler["input"]), 5),
               weights = floats_at(bytes, offset(sampler["output"]), 20);
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_FLOAT_EQ(times[k], static_cast<float>(k) / 60);
    for (std::size_t target = 0; target < 4; ++target) EXPECT_EQ(weights[4 * k + target], k == target + 1 ? 1 : 0);
  }
}

TEST_F(Export, LeavesOutFramesButNotTheLast) {
  const std::string bytes = exported("a.pc2", 3)[0].bytes;
  EXPECT_EQ(number_at<std::int32_t>(bytes, 28), 3);
  EXPECT_EQ(floats_at(bytes, 32 + 2 * 52 * 12, 156), frame(4));
  EXPECT_NE(exported("a.usda", 3)[0].bytes.find("            3: ["), std::string::npos);
}

TEST_F(Export, RefusesOtherFormatsAndBrokenRuns) {
  const auto refusal = [&](const char* name) -> std::string {
    try {
      exported(name);
    } catch (const Error& error) {
      return error.what();
    }
    return "not refused";
  };
  EXPECT_NE(refusal("a.fbx").find(".pc2, .glb or .usda"), std::string::npos);
  fs::resize_file(frame_path(run_, 2), 70);
  EXPECT_NE(refusal("a.pc2").find("frame_000002.bin"), std::string::npos);
}

/// Reads a format in Blender, where there is one that can.
class ExportToBlender : public Export, public ::testing::WithParamInterface<const char*> {};

TEST_P(ExportToBlender, VerticesAreTheFloatsOfTheFrames) {
  if (std::system("command -v blender >/dev/null") != 0) GTEST_SKIP() << "there is no Blender here to read the files";
  const fs::path path = folder_.path() / GetParam(), log = folder_.path() / "log";
  for (const ExportedFile& file : exported(GetParam())) write_text(file.path, file.bytes);
  const std::string command = "blender -b --factory-startup --python-exit-code 9 --python '" SELVAGE_READ_IN_BLENDER
                              "' -- '" +
                              run_.string() + "' '" + path.string() + "' >'" + log.string() + "' 2>&1";
  const int status = std::system(command.c_str());
  ASSERT_TRUE(WIFEXITED(status));
  if (WEXITSTATUS(status) == 77) GTEST_SKIP() << "this Blender was built without the format of " << GetParam();
  EXPECT_EQ(WEXITSTATUS(status), 0) << read_text(log);
  EXPECT_NE(read_text(log).find("EQUAL: 5 frames of 52 vertices"), std::string::npos) << read_text(log);
}

INSTANTIATE_TEST_SUITE_P(Formats, ExportToBlender, ::testing::Values("a.pc2", "a.glb", "a.usda"));

}  // namespace
}  // namespace selvage
