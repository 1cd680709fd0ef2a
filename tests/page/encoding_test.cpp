#include "page/encoding.h"

#include "page/form_blocks.h"
#include "page/page.h"
#include "page/page_template.h"
#include "page/pose_blocks.h"
#include "page_blocks.h"

#include <fstream>
#include <limits>
#include <random>

namespace selvage {
namespace {

using test::unpack;

std::vector<std::int64_t> wide(const std::vector<std::int32_t>& values) {
  return {values.begin(), values.end()};
}

TEST(Encoding, Base64OfKnownTexts) {
  // RFC 4648, section 10.
  EXPECT_EQ(print_base64(""), "");
  EXPECT_EQ(print_base64("f"), "Zg==");
  EXPECT_EQ(print_base64("fo"), "Zm8=");
  EXPECT_EQ(print_base64("foo"), "Zm9v");
  EXPECT_EQ(print_base64("foob"), "Zm9vYg==");
  EXPECT_EQ(print_base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(print_base64("foobar"), "Zm9vYmFy");
  std::string all;
  for (int i = 0; i < 256; ++i) all += static_cast<char>(i);
  EXPECT_EQ(test::decode_base64(print_base64(all)), all);
}

TEST(Encoding, IntegersComeBack) {
  constexpr auto kLeast = std::numeric_limits<std::int32_t>::min(), kMost = std::numeric_limits<std::int32_t>::max();
  std::mt19937 random(5);
  std::uniform_int_distribution<std::int32_t> any(kLeast, kMost), near(-3, 3);
  for (const std::size_t stride : {1u, 2u, 3u, 4u}) {
    EXPECT_EQ(pack_integers({}, stride), "");
    std::vector<std::int32_t> values{0, -1, kLeast, kMost, kLeast, 7, -8, kMost, 0};
    EXPECT_EQ(unpack(pack_integers(values, stride), 4, stride), wide(values));
    for (int i = 0; i < 500; ++i) values.push_back(i % 3 == 0 ? any(random) : near(random));
    EXPECT_EQ(unpack(pack_integers(values, stride), 4, stride), wide(values));
  }
}

TEST(Encoding, DeflatedBytesComeBack) {
  std::mt19937 random(5);
  std::string bytes;
  for (int i = 0; i < 10000; ++i) bytes += static_cast<char>(random() % (i < 5000 ? 3 : 256));
  EXPECT_EQ(test::inflate_bytes(deflate_bytes(bytes)), bytes);
  EXPECT_EQ(test::inflate_bytes(deflate_bytes("")), "");
}

/// Positions of all poses of a page, by the differences as src/page/pose_blocks.h describes them.
/// @param shown   has the count of vertices and the box: the page's head, or a collider
/// @param prefix  of the names of blocks
std::vector<std::vector<Vec3>> poses_of(const std::string& page, const nlohmann::json& shown,
                                        const std::string& prefix = {}) {
  const auto head = test::head_of(page);
  const std::size_t count = shown["vertices"], interval = head["key_interval"];
  std::vector<std::vector<Vec3>> poses;
  std::vector<std::int64_t> places(3 * count);
  for (std::size_t k = 0; k < head["times"].size(); ++k) {
    const std::string bytes = test::block_of(page, prefix + "pose" + std::to_string(k));
    EXPECT_EQ(bytes.size(), 6 * count);
    // A stride beyond the end leaves the differences as they are.
    const auto differences = unpack(bytes, 2, bytes.size());
    for (std::size_t i = 0; i < 3 * count; ++i) {
      const std::int64_t before = k % interval != 0 ? places[i] : i % count == 0 ? 0 : places[i - 1];
      places[i] = (before + differences[i] + 65536) % 65536;
    }
    std::vector<Vec3> pose(count);
    for (std::size_t i = 0; i < 3 * count; ++i) {
      const std::size_t axis = i / count;
      pose[i % count][static_cast<int>(axis)] =
          shown["box"]["lower"][axis].get<double>() +
          shown["box"]["step"][axis].get<double>() * static_cast<double>(places[i]);
    }
    poses.push_back(pose);
  }
  return poses;
}

TEST(PoseBlocks, PositionsComeBackToHalfAStep) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> place(-3, 5);
  // Vertex 1 is in no triangle, and so is not shown; all lie in a plane across y.
  const std::vector<VertexTuple<3>> triangles{{0, 2, 3}, {4, 3, 2}};
  const ShownSurface surface(5, triangles);
  EXPECT_EQ(surface.vertices, (std::vector<Index>{0, 2, 3, 4}));
  EXPECT_EQ(surface.triangles, (std::vector<VertexTuple<3>>{{0, 1, 2}, {3, 2, 1}}));
  std::vector<std::vector<Vec3>> poses(40, std::vector<Vec3>(5));
  PoseBox box;
  for (auto& pose : poses)
    for (Index v = 0; v < 5; ++v) {
      pose[static_cast<std::size_t>(v)] = {place(random), 0.25, 1e-6 * place(random)};
      if (v != 1) box.add(pose[static_cast<std::size_t>(v)]);
    }
  Page page("mesh", "poses");
  add_surface(page, surface);
  PoseBlocks blocks(page, surface, box);
  for (const auto& pose : poses) blocks.add(pose, 0);
  blocks.finish();
  const std::string text = page.print();
  const auto read = poses_of(text, test::head_of(text));
  ASSERT_EQ(read.size(), poses.size());
  const Vec3 half = (box.upper - box.lower) / 65535 / 2;
  for (std::size_t k = 0; k < poses.size(); ++k)
    for (std::size_t i = 0; i < 4; ++i)
      for (int axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(read[k][i][axis], poses[k][static_cast<std::size_t>(surface.vertices[i])][axis],
                    half[axis] * (1 + 1e-9) + 1e-15);
}

TEST(FormBlocks, CollidersHaveTheirFormInEveryPose) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-1, 2);
  // Vertex 0 is in no triangle.
  KeyframedShape shape{{{1, 3, 2}, {1, 2, 4}, {2, 3, 4}, {1, 4, 3}}, {0.1, 0.4, 0.45, 2}, {}};
  for (std::size_t k = 0; k < shape.times.size(); ++k) {
    auto& positions = shape.positions.emplace_back();
    for (int v = 0; v < 5; ++v) positions.emplace_back(place(random), place(random), 1e3 * place(random));
  }
  std::vector<Collider> colliders(3);
  colliders[1].shape = shape;
  shape.positions.pop_back();
  shape.times.pop_back();
  colliders[2].shape = shape;
  Page page("run", "forms");
  page.head()["scene"]["colliders"] = {
      {{"kind", "plane"}}, {{"kind", "keyframed"}, {"times", {1}}, {"pc2", "x"}, {"triangles", {1}}}, {{"kind", ""}}};
  const ShownSurface surface(3, std::vector<VertexTuple<3>>{{0, 1, 2}});
  add_surface(page, surface);
  PoseBlocks poses(page, surface, {Vec3::Zero(), Vec3::Ones()});
  FormBlocks forms(page, colliders);
  std::vector<double> times;
  for (int k = 0; k < 40; ++k) times.push_back(0.03 * k);
  for (const double time : times) {
    poses.add(std::vector<Vec3>(3, Vec3::Zero()), time);
    forms.add(time);
  }
  poses.finish();
  const std::string text = page.print();
  const auto scene = test::head_of(text)["scene"];
  EXPECT_EQ(scene["colliders"][0].size(), 1u);
  EXPECT_FALSE(test::has_block(text, "collider0pose0"));
  for (const std::size_t c : {1u, 2u}) {
    const auto& json = scene["colliders"][c];
    for (const char* stored : {"times", "pc2", "triangles"}) EXPECT_FALSE(json.contains(stored)) << stored;
    const std::string name = "collider" + std::to_string(c);
    EXPECT_EQ(unpack(test::block_of(text, name + "triangles"), 4, 3),
              (std::vector<std::int64_t>{0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2}));
    const auto read = poses_of(text, json, name);
    ASSERT_EQ(read.size(), times.size());
    for (std::size_t k = 0; k < times.size(); ++k) {
      const MeshShape there = std::get<KeyframedShape>(colliders[c].shape).at(times[k]);
      ASSERT_EQ(read[k].size(), 4u);
      for (std::size_t v = 0; v < 4; ++v)
        for (int axis = 0; axis < 3; ++axis)
          EXPECT_NEAR(read[k][v][axis], there.positions[v + 1][axis],
                      json["box"]["step"][static_cast<std::size_t>(axis)].get<double>() * 0.500001);
    }
  }
}

TEST(Page, TheTemplateIsTheBuiltFile) {
  std::ifstream file(SELVAGE_TEMPLATE, std::ios::binary);
  const std::string built((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  ASSERT_GT(built.size(), 100'000u);
  EXPECT_TRUE(page_template() == built);
  for (const char* once : {"<!--data-->", "<title>selvage</title>"}) {
    const std::size_t at = built.find(once);
    ASSERT_NE(at, std::string::npos) << once;
    EXPECT_EQ(built.find(once, at + 1), std::string::npos) << once;
  }
}

TEST(Page, NoTextEndsAnElement) {
  const std::string bad = "</script><!--data--><script>alert(1)</script>\xff&";
  Page page("mesh", bad);
  page.add_fact(bad, bad, bad);
  page.add_warning(bad);
  const std::string text = page.print();
  const auto head = test::head_of(text);
  const std::string kept = "</script><!--data--><script>alert(1)</script>\xef\xbf\xbd&";
  EXPECT_EQ(head["title"], kept);
  EXPECT_EQ(head["facts"][0][2], kept);
  EXPECT_EQ(text.find("<script>alert"), std::string::npos);
}

}  // namespace
}  // namespace selvage
