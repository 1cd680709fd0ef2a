// PC2, the point cache of 3ds Max and Blender: a header of 32 bytes, then the positions of all vertices, frame by
// frame.
#include "export/poses.h"

#include <fmt/format.h>

#include <cstring>
#include <iterator>

namespace selvage {

namespace {

template <typename T>
void append(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace

std::string print_pc2(const ExportedPoses& poses) {
  std::string bytes("POINTCACHE2\0", 12);
  append(bytes, std::int32_t{1});  // version
  append(bytes, static_cast<std::int32_t>(poses.surface.vertices.size()));
  append(bytes, 0.f);  // first frame
  append(bytes, 1.f);  // frames between samples
  append(bytes, static_cast<std::int32_t>(poses.frames.size()));
  for (std::size_t i = 0; i < poses.frames.size(); ++i)
    for (const Float3& p : poses.pose(i)) append(bytes, p);
  return bytes;
}

std::string print_pc2_mesh(const ExportedPoses& poses) {
  fmt::memory_buffer out;
  const auto to = std::back_inserter(out);
  fmt::format_to(to, "# The first frame of {}; its .pc2 moves the vertices.\n", poses.name);
  for (const Float3& p : poses.pose(0)) fmt::format_to(to, "v {} {} {}\n", p[0], p[1], p[2]);
  for (const auto& t : poses.surface.triangles) fmt::format_to(to, "f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  return fmt::to_string(out);
}

}  // namespace selvage
