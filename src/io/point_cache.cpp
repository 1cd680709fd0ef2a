// PC2: a header of 32 bytes, little-endian as the machines that this runs on, then the positions of all vertices,
// sample by sample.
#include "selvage/io/point_cache.h"

#include "io/whole_file.h"
#include "selvage/core/error.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace selvage {

namespace {

constexpr std::string_view kSignature("POINTCACHE2\0", 12);
constexpr std::size_t kHeaderBytes = 32, kBytesPerPoint = 12;

template <typename T>
T value_at(std::string_view bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

template <typename T>
void append(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void check_header(std::string_view bytes, const std::string& name) {
  if (bytes.size() < kHeaderBytes || bytes.substr(0, kSignature.size()) != kSignature)
    throw Error(name, "is no point cache", "give a .pc2, as Blender's export writes it");
  const auto version = value_at<std::int32_t>(bytes, 12);
  if (version != 1) throw Error(name, fmt::format("is of the version {} of point caches", version), "give version 1");
  const auto points = value_at<std::int32_t>(bytes, 16), samples = value_at<std::int32_t>(bytes, 28);
  if (points < 1 || samples < 1)
    throw Error(name, fmt::format("has {} vertices and {} samples", points, samples), "both must be at least 1");
  const auto first = value_at<float>(bytes, 20), rate = value_at<float>(bytes, 24);
  if (!std::isfinite(first) || !std::isfinite(rate) || !(rate > 0))
    throw Error(name, fmt::format("begins at frame {} and has {} frames a sample", first, rate),
                "the second must be above 0, and both finite");
  // Less than 2^66 in all: counted in parts, which do not overflow.
  const std::uint64_t per_sample = kBytesPerPoint * static_cast<std::uint64_t>(points);
  const std::uint64_t whole = (bytes.size() - kHeaderBytes) / per_sample,
                      rest = (bytes.size() - kHeaderBytes) % per_sample;
  if (whole != static_cast<std::uint64_t>(samples) || rest != 0)
    throw Error(name,
                fmt::format("holds {} bytes of positions, which is not {} samples of {} vertices",
                            bytes.size() - kHeaderBytes, samples, points),
                "it is cut short or damaged; write it anew");
}

}  // namespace

PointCache parse_point_cache(std::string_view bytes, const std::string& name) {
  check_header(bytes, name);
  const auto points = static_cast<std::size_t>(value_at<std::int32_t>(bytes, 16));
  const auto samples = static_cast<std::size_t>(value_at<std::int32_t>(bytes, 28));
  PointCache cache{value_at<float>(bytes, 20), value_at<float>(bytes, 24), {}};
  std::size_t offset = kHeaderBytes;
  for (std::size_t s = 0; s < samples; ++s) {
    auto& positions = cache.samples.emplace_back();
    positions.reserve(points);
    for (std::size_t v = 0; v < points; ++v, offset += kBytesPerPoint) {
      const auto p = value_at<std::array<float, 3>>(bytes, offset);
      positions.emplace_back(p[0], p[1], p[2]);
      if (!positions.back().allFinite())
        throw Error(name, fmt::format("vertex {} of sample {} is not finite", v, s), "write the file anew");
    }
  }
  return cache;
}

PointCache read_point_cache(const std::filesystem::path& path) {
  return parse_point_cache(read_whole_file(path), path.string());
}

std::string print_point_cache(const PointCache& cache) {
  std::string bytes(kSignature);
  append(bytes, std::int32_t{1});  // version
  append(bytes, static_cast<std::int32_t>(cache.samples.front().size()));
  append(bytes, static_cast<float>(cache.first_frame));
  append(bytes, static_cast<float>(cache.frames_per_sample));
  append(bytes, static_cast<std::int32_t>(cache.samples.size()));
  for (const auto& positions : cache.samples)
    for (const Vec3& p : positions) append(bytes, std::array{float(p[0]), float(p[1]), float(p[2])});
  return bytes;
}

}  // namespace selvage
