#include "untangling/solids/posed_rest.h"

#include "mesh/find_inverted.h"
#include "untangling/solids/relaxation.h"
#include "untangling/solids/tangle_finder.h"

#include <algorithm>

namespace selvage {

namespace {

/// Rings of elements around a tangle that are near it; doubled where that does not suffice.
constexpr int kRings = 2;
/// Relaxations of what is near: in all, and with inverted elements after which more is taken to be near.
constexpr int kRelaxations = 40;

/// Whether each vertex belongs to an element that collides or is inverted.
std::vector<std::uint8_t> find_tangled(const TetMesh& mesh, std::span<const Vec3> positions) {
  TangleFinder finder(mesh, positions);
  finder.measure(positions);
  std::vector<Index> elements = finder.find_elements();
  for (const Index e : find_inverted(mesh, positions)) elements.push_back(e);
  std::vector<std::uint8_t> tangled(positions.size(), 0);
  for (const Index e : elements)
    for (const Index v : mesh.elements()[e]) tangled[v] = 1;
  for (const Contact& contact : finder.contacts())
    for (int i = 0; i < contact.count; ++i) tangled[contact.vertices[i]] = 1;
  return tangled;
}

/// Adds the vertices of all elements that have one.
void grow(const TetMesh& mesh, std::vector<std::uint8_t>& near) {
  const std::vector<std::uint8_t> before = near;
  for (const auto& element : mesh.elements())
    if (std::any_of(element.begin(), element.end(), [&](Index v) { return before[v] != 0; }))
      for (const Index v : element) near[v] = 1;
}

/// The pose, in which what is near has relaxed towards the rest.
struct RelaxedPose {
  std::vector<Vec3> positions;
  bool is_positive;
};

RelaxedPose relax_near(const TetMesh& mesh, std::span<const Vec3> rest, std::span<const Vec3> positions,
                       std::span<const std::uint8_t> near) {
  ResolveOptions options;
  for (std::size_t v = 0; v < near.size(); ++v)
    if (near[v] == 0) options.pinned.push_back(static_cast<Index>(v));
  RelaxedPose pose{{positions.begin(), positions.end()}, false};
  const std::vector<Vec3> origin = pose.positions;
  Relaxation body(mesh, pose.positions, rest, origin, options);
  body.wake_all();
  for (int i = 0; i < kRelaxations; ++i) body.relax();
  pose.is_positive = body.inverted().empty();
  return pose;
}

}  // namespace

std::vector<Vec3> find_posed_rest(const TetMesh& mesh, std::span<const Vec3> rest, std::span<const Vec3> positions,
                                  const ResolveOptions& options) {
  std::vector<std::uint8_t> near = find_tangled(mesh, positions);
  // The same checks of the rest, also where nothing is near.
  std::vector<Vec3> unmoved(positions.begin(), positions.end());
  const Relaxation checked(mesh, unmoved, rest, positions, options);
  if (std::count(near.begin(), near.end(), 1) == 0) return unmoved;
  for (int rings = kRings, grown = 0;; rings *= 2) {
    for (; grown < rings; ++grown) grow(mesh, near);
    if (std::count(near.begin(), near.end(), 0) == 0) return {rest.begin(), rest.end()};
    RelaxedPose pose = relax_near(mesh, rest, positions, near);
    if (pose.is_positive) return std::move(pose.positions);
  }
}

}  // namespace selvage
