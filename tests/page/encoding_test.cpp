#include "page/encoding.h"

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
std::vector<std::vector<Vec3>> poses_of(const std::string& page) {
  const auto head = test::head_of(page);
  const std::size_t count = head["vertices"], interval = head["key_interval"];
  std::vector<std::vector<Vec3>> poses;
  std::vector<std::int64_t> places(3 * count);
  for (std::size_t k = 0; k < head["times"].size(); ++k) {
    const std::string bytes = test::block_of(page, "pose" + std::to_string(k));
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
          head["box"]["lower"][axis].get<double>() +
          head["box"]["step"][axis].get<double>() * static_cast<double>(places[i]);
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
  const auto read = poses_of(page.print());
  ASSERT_EQ(read.size(), poses.size());
  const Vec3 half = (box.upper - box.lower) / 65535 / 2;
  for (std::size_t k = 0; k < poses.size(); ++k)
    for (std::size_t i = 0; i < 4; ++i)
      for (int axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(read[k][i][axis], poses[k][static_cast<std::size_t>(surface.vertices[i])][axis],
                    half[axis] * (1 + 1e-9) + 1e-15);
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
