#include "page/marks.h"

#include "page/encoding.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

std::string pack_touches(const ShownSurface& surface, std::span<const Touch> touches) {
  std::vector<std::int32_t> vertices;
  std::string kinds, places;
  std::array<std::string, 3> normals;
  for (const Touch& touch : touches) {
    for (const Index v : touch.vertices) vertices.push_back(surface.place[static_cast<std::size_t>(v)]);
    kinds += static_cast<char>(touch.kind);
    places += static_cast<char>(static_cast<std::uint8_t>(std::lround(255 * touch.place)));
    for (int axis = 0; axis < 3; ++axis)
      normals[static_cast<std::size_t>(axis)] +=
          static_cast<char>(static_cast<std::int8_t>(std::lround(127 * touch.normal[axis])));
  }
  return pack_integers(vertices, 2) + kinds + places + normals[0] + normals[1] + normals[2];
}

}  // namespace

void add_marks(Page& page, const ShownSurface& surface, std::size_t pose, const Marks& marks,
               std::span<const Touch> touches) {
  if (marks.empty() && touches.empty()) return;
  const bool has_features = std::any_of(marks.pairs.begin(), marks.pairs.end(),
                                        [](const MarkedPair& pair) { return pair.features[0] != kNone; });
  std::vector<std::int32_t> vertices, triangles, features;
  std::vector<float> numbers;
  std::string kinds;
  const auto put = [&](const Vec3& p) {
    for (int axis = 0; axis < 3; ++axis) numbers.push_back(static_cast<float>(p[axis]));
  };
  for (const MarkedPath& path : marks.paths) {
    vertices.push_back(path.vertex == kNone ? kNone : surface.place[static_cast<std::size_t>(path.vertex)]);
    numbers.push_back(static_cast<float>(path.depth));
    put(path.from);
    put(path.to);
  }
  for (const MarkedPair& pair : marks.pairs) {
    triangles.insert(triangles.end(), pair.triangles.begin(), pair.triangles.end());
    kinds += static_cast<char>(pair.kind);
    if (has_features) features.insert(features.end(), pair.features.begin(), pair.features.end());
  }
  const std::array<std::int32_t, 4> counts{static_cast<std::int32_t>(vertices.size()),
                                           static_cast<std::int32_t>(marks.pairs.size()), has_features ? 1 : 0,
                                           static_cast<std::int32_t>(touches.size())};
  std::string bytes(reinterpret_cast<const char*>(counts.data()), sizeof counts);
  bytes += pack_integers(vertices, 1);
  bytes.append(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(float));
  bytes += pack_integers(triangles, 2) + pack_integers(features, 4) + kinds + pack_touches(surface, touches);
  page.add_block(fmt::format("marks{}", pose), bytes);
  page.head()["marked"].push_back(pose);
}

}  // namespace selvage
