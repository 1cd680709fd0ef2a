#include "scene/description/scene_description.h"
#include "selvage/core/error.h"
#include "simulation/colliders/prepared_collider.h"
#include "simulation/crossings/collider_crossings.h"

#include <fmt/format.h>

#include <algorithm>

namespace selvage {

namespace {

/// Part of a body's extent by which a vertex may start inside a collider: bodies are put down with rounded numbers.
constexpr double kHair = 1e-4;

constexpr const char* kLift = R"("start_outside": "allow" lets it start there)";

bool is_container(const Collider& collider) {
  return std::holds_alternative<BoxContainer>(collider.shape) || std::holds_alternative<Bowl>(collider.shape);
}

double extent_of(std::span<const Vec3> positions) {
  Eigen::AlignedBox3d box;
  for (const Vec3& p : positions) box.extend(p);
  return box.sizes().maxCoeff();
}

/// The vertices of a body that no handle holds: handles may lead through colliders, as pins in a floor do.
std::vector<Vec3> free_positions(const Scene& scene, const Body& body, const std::vector<bool>& is_held) {
  std::vector<Vec3> positions;
  for (Index v = body.first_vertex; v < body.first_vertex + body.vertex_count; ++v)
    if (!is_held[static_cast<std::size_t>(v)]) positions.push_back(scene.initial_state.positions[v]);
  return positions;
}

/// Whether a point is inside one of the parts of a collider by more than a depth [m].
bool is_inside(std::span<const PreparedCollider> parts, const RigidTransform& place, const Vec3& p, double depth) {
  const Vec3 own = place.invert(p);
  return std::ranges::any_of(parts, [&](const PreparedCollider& part) {
    const std::optional<Hit> hit = std::visit([&](const auto& shape) { return find_hit(shape, own); }, part.shape);
    return hit && hit->depth > depth;
  });
}

[[noreturn]] void refuse_vertices(const std::string& file, const Body& body, std::ptrdiff_t count, std::size_t number,
                                  const Collider& collider) {
  const std::string where = fmt::format("{}: body '{}'", file, body.name);
  const std::string start = fmt::format("{} of {} vertices start", count, body.vertex_count);
  if (!is_container(collider))
    throw Error(where, fmt::format("{} inside colliders[{}]", start, number),
                std::string("move one of the two, or ") + kLift);
  std::string remedy = std::string("move one of the two, or ") + kLift;
  if (std::holds_alternative<BoxContainer>(collider.shape))
    remedy = R"(a solid box is {"mesh": {"shape": "box"}}, and )" + std::string(kLift);
  throw Error(where, fmt::format("{} outside colliders[{}], a container", start, number), remedy);
}

/// Vertices of bodies that start on the wrong side.
void check_vertices(const Scene& scene, const std::string& file) {
  std::vector<bool> is_held(scene.initial_state.positions.size());
  for (const Handle& handle : scene.handles)
    for (const Index v : handle.vertices) is_held[static_cast<std::size_t>(v)] = true;
  for (std::size_t c = 0; c < scene.colliders.size(); ++c) {
    const Collider& collider = scene.colliders[c];
    const std::vector<PreparedCollider> parts = prepare_colliders({&collider, 1});
    const RigidTransform place = collider.motion.at(scene.initial_state.time);
    for (const Body& body : scene.model.bodies) {
      const std::vector<Vec3> positions = free_positions(scene, body, is_held);
      if (positions.empty()) continue;
      const double depth = kHair * extent_of(positions);
      const auto count =
          std::ranges::count_if(positions, [&](const Vec3& p) { return is_inside(parts, place, p, depth); });
      if (count > 0) refuse_vertices(file, body, count, c, collider);
    }
  }
}

/// Colliders that stand in bodies between their vertices: walls, plates, needles.
void check_between_vertices(const Scene& scene, const std::string& file) {
  ColliderCrossingFinder finder(scene.model, scene.colliders, scene.handles);
  const std::vector<ColliderCrossings> found = finder.measure(scene.initial_state);
  for (std::size_t c = 0; c < found.size(); ++c)
    if (found[c].points > 0)
      throw Error(fmt::format("{}: body '{}'", file, scene.model.bodies[static_cast<std::size_t>(found[c].body)].name),
                  fmt::format("colliders[{}] starts in it, {:.3g} m deep", c, found[c].deepest_point),
                  std::string("move one of the two, or ") + kLift);
}

}  // namespace

void check_start(const Scene& scene, const std::string& file) {
  check_vertices(scene, file);
  check_between_vertices(scene, file);
}

}  // namespace selvage
