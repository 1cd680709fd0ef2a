#pragma once

#include "selvage/contact/contact_finder.h"
#include "selvage/self_collision/self_collision.h"
#include "selvage/untangling/resolve.h"

namespace selvage {

/// What of a mesh meets, and what is inside of what: all points, by DCD alone (SPB section 5.2).
class TangleFinder {
 public:
  TangleFinder(const TetMesh& mesh, std::span<const Vec3> positions);

  /// Takes a pose: counts and depths. Of inverted elements and displacements it says nothing.
  ResolveIteration measure(std::span<const Vec3> positions);

  /// The ways out in that pose, sorted by kind and point.
  std::span<const Contact> contacts() const { return contacts_; }

  /// Elements at pairs of faces that meet, at surfaces of contacts, and those that are inside by their centroids.
  std::vector<Index> find_elements() const;

 private:
  std::int64_t leave_out_turned_faces(std::span<const Vec3> positions);

  const TetMesh& mesh_;
  ContactFinder contact_finder_;
  SelfCollisionFinder pair_finder_;
  std::vector<Contact> contacts_;
  std::vector<TrianglePair> pairs_;
};

/// What a contact sends out.
inline std::pair<ContactKind, Index> point_of(const Contact& contact) {
  return {contact.kind, contact.point_feature};
}

}  // namespace selvage
