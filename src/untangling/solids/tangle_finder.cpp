#include "untangling/solids/tangle_finder.h"

#include "contact/input/inverted_vertices.h"

#include <algorithm>

namespace selvage {

namespace {

ContactOptions all_points() {
  ContactOptions options;
  options.mode = DetectionMode::kDcd;
  options.interior_points = true;
  options.wait_for_inverted = true;  // at an inverted element no side is outside
  return options;
}

}  // namespace

TangleFinder::TangleFinder(const TetMesh& mesh, std::span<const Vec3> positions)
    : mesh_(mesh),
      contact_finder_(mesh, {}, positions, {}, all_points()),
      pair_finder_(contact_finder_.surface(), positions) {}

ResolveIteration TangleFinder::measure(std::span<const Vec3> positions) {
  contact_finder_.begin_step(positions);
  contact_finder_.find_contacts(positions, contacts_);
  const std::int64_t left_out = remove_contacts_at_inverted(positions);
  pair_finder_.update(positions);
  pairs_ = pair_finder_.find_pairs();
  ResolveIteration now;
  now.triangle_pairs = std::ssize(pairs_);
  now.blocked_points = contact_finder_.statistics().blocked_paths;
  now.waiting_points = contact_finder_.statistics().waiting_points + left_out;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const double depth = std::max(0.0, -gap_of(contacts_[i], positions));
    now.deepest = std::max(now.deepest, depth);
    now.total_depth += depth;
    if (i > 0 && point_of(contacts_[i]) == point_of(contacts_[i - 1])) continue;
    switch (contacts_[i].kind) {
      case ContactKind::kVertexPath:
        ++now.penetrating_vertices;
        break;
      case ContactKind::kEdgePath:
        ++now.penetrating_edges;
        break;
      default:
        ++now.penetrating_centroids;
    }
  }
  return now;
}

/// A way out never ends at an inverted element. In a simulation it may: there bodies move meanwhile.
std::int64_t TangleFinder::remove_contacts_at_inverted(std::span<const Vec3> positions) {
  const InvertedVertices inverted(mesh_, positions);
  return std::erase_if(contacts_, [&](const Contact& contact) {
    return inverted.has_any(std::span(contact.vertices).first(contact.count), contact.weights);
  });
}

std::vector<Index> TangleFinder::find_elements() const {
  std::vector<Index> elements;
  const auto add_face = [&](Index face) { elements.push_back(mesh_.boundary_owners()[face].element()); };
  for (const TrianglePair& pair : pairs_) {
    add_face(pair.first);
    add_face(pair.second);
  }
  for (const Contact& contact : contacts_) {
    add_face(contact.surface_feature);
    if (contact.kind == ContactKind::kCentroidPath) elements.push_back(contact.point_feature);
  }
  return elements;
}

}  // namespace selvage
