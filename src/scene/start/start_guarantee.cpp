#include "scene/description/scene_description.h"
#include "selvage/core/error.h"
#include "selvage/self_collision/self_collision.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

/// What holds each vertex for ever: kNone nothing, 0 a pin, h + 1 the handle h, which moves. Vertices of one holder do
/// not move against one another.
std::vector<Index> holders_of(const Scene& scene) {
  std::vector<Index> holders(scene.initial_state.positions.size(), kNone);
  for (std::size_t h = 0; h < scene.handles.size(); ++h) {
    const Handle& handle = scene.handles[h];
    if (!std::isinf(handle.release_time)) continue;
    const bool moves = std::ranges::any_of(
        handle.motion.keyframes, [](const Keyframe& key) { return !key.translation.isZero(0) || key.angle != 0; });
    for (const Index v : handle.vertices) holders[v] = moves ? static_cast<Index>(h) + 1 : 0;
  }
  return holders;
}

}  // namespace

void check_guarantee(const Scene& scene, const std::string& file) {
  if (!scene.options.contact.guarantee) return;
  const std::vector<Index> holders = holders_of(scene);
  const std::vector<Index> body_of = bodies_of_vertices(scene.model);
  const auto name_of = [&](Index v) { return scene.model.bodies[static_cast<std::size_t>(body_of[v])].name; };
  const TriangleMesh surface = surface_of(scene.model);
  const std::vector<TrianglePair> pairs = SelfCollisionFinder(surface, scene.initial_state.positions).find_pairs();
  for (const TrianglePair& pair : pairs) {
    const auto &a = surface.triangles()[pair.first], &b = surface.triangles()[pair.second];
    const Index holder = holders[a[0]];
    const auto is_held = [&](Index v) { return holders[v] == holder; };
    if (holder == kNone || !std::ranges::all_of(a, is_held) || !std::ranges::all_of(b, is_held)) continue;
    const Vec3& place = scene.initial_state.positions[a[0]];
    throw Error(
        fmt::format("{}: contact.guarantee", file),
        fmt::format("bodies '{}' and '{}' start in one another near [{:.4g}, {:.4g}, {:.4g}], where handles hold "
                    "both for ever",
                    name_of(a[0]), name_of(b[0]), place[0], place[1], place[2]),
        "hold them apart, release one, or give no guarantee");
  }
}

}  // namespace selvage
