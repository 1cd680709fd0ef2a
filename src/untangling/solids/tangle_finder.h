#pragma once

#include "selvage/contact/contact_finder.h"
#include "selvage/self_collision/self_collision.h"
#include "selvage/untangling/resolve.h"

namespace selvage {

/// Collisions of a mesh with itself: faces that meet, and all points inside elements, by DCD alone (SPB section 5.2).
class TangleFinder {
 public:
  TangleFinder(const TetMesh& mesh, std::span<const Vec3> positions);

  /// Counts and depths in a pose. Numbers of inverted elements and displacements are left at 0.
  ResolveIteration measure(std::span<const Vec3> positions);

  /// The ways out in that pose, sorted by kind and point.
  std::span<const Contact> contacts() const { return contacts_; }

  /// Elements of faces that meet, of surfaces of contacts, and those whose centroids are inside; with repetitions.
  std::vector<Index> find_elements() const;

 private:
  std::int64_t remove_contacts_at_inverted(std::span<const Vec3> positions);

  const TetMesh& mesh_;
  ContactFinder contact_finder_;
  SelfCollisionFinder pair_finder_;
  std::vector<Contact> contacts_;
  std::vector<TrianglePair> pairs_;
};

/// The point that a contact sends out.
inline std::pair<ContactKind, Index> point_of(const Contact& contact) {
  return {contact.kind, contact.point_feature};
}

}  // namespace selvage
