// Point caches: what is written is read, and damage is named in one line.
#include "selvage/io/point_cache.h"

#include "selvage/core/error.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

namespace selvage {
namespace {

PointCache two_samples() {
  return {3, 0.5, {{{0, 0.25, -1}, {2, 3, 4}}, {{1, 0.5, -2}, {5, 6, 7}}}};
}

std::string refusal_of(const std::string& bytes) {
  try {
    parse_point_cache(bytes, "dancer.pc2");
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

template <typename T>
std::string with(std::size_t offset, T value) {
  std::string bytes = print_point_cache(two_samples());
  std::memcpy(bytes.data() + offset, &value, sizeof value);
  return bytes;
}

TEST(PointCache, ReadsWhatItWrites) {
  const PointCache written = two_samples(), read = parse_point_cache(print_point_cache(written), "a.pc2");
  EXPECT_EQ(read.first_frame, written.first_frame);
  EXPECT_EQ(read.frames_per_sample, written.frames_per_sample);
  EXPECT_EQ(read.samples, written.samples);
}

TEST(PointCache, NamesWhatIsWrongInOneLine) {
  const std::string whole = print_point_cache(two_samples());
  const auto expect = [](const std::string& bytes, const std::string& what) {
    const std::string refusal = refusal_of(bytes);
    EXPECT_EQ(refusal.find("dancer.pc2: "), 0u) << refusal;
    EXPECT_NE(refusal.find(what), std::string::npos) << refusal;
    EXPECT_EQ(refusal.find('\n'), std::string::npos);
  };
  for (std::size_t size = 0; size < whole.size(); ++size)
    expect(whole.substr(0, size), size < 32 ? "is no point cache" : "not 2 samples of 2 vertices");
  expect(whole + "x", "holds 49 bytes of positions");
  expect("POINTCACHE3" + whole.substr(11), "is no point cache");
  expect(with<std::int32_t>(12, 2), "version 2");
  expect(with<std::int32_t>(16, 0), "has 0 vertices");
  expect(with<std::int32_t>(16, -4), "has -4 vertices");
  expect(with<std::int32_t>(16, std::numeric_limits<std::int32_t>::max()), "not 2 samples of 2147483647 vertices");
  expect(with<std::int32_t>(28, std::numeric_limits<std::int32_t>::max()), "not 2147483647 samples of 2 vertices");
  expect(with<float>(24, 0), "has 0 frames a sample");
  expect(with<float>(20, std::numeric_limits<float>::infinity()), "begins at frame inf");
  expect(with<float>(32 + 12 * 3 + 4, std::numeric_limits<float>::quiet_NaN()), "vertex 1 of sample 1 is not finite");
}

}  // namespace
}  // namespace selvage
