#pragma once

#include "contact/impacts/impact_contacts.h"
#include "selvage/self_collision/proximity.h"

namespace selvage {

/// Contacts of cloth with what is near to it at the start of a step: they hold it off by its thickness.
///
/// Pairs that are near at rest already, as those of one sheet across a vertex, are none.
class NearSearch {
 public:
  /// @param surface         must outlive this
  /// @param rest_positions  (n_vertices) of the surface; see separated_at_rest() [m]
  /// @param thickness       (n_vertices) half of the cloth's, 0 for all else, not 0 everywhere [m]
  NearSearch(const SurfaceStep& surface, std::vector<Vec3> rest_positions, std::vector<double> thickness);

  /// Appends contacts, those of vertices and faces first. Parallel; the same bits for any number of threads.
  /// @param positions  (n_vertices) at the start of the step [m]
  void append_contacts(std::span<const Vec3> positions, std::vector<Contact>& contacts);

 private:
  double thickness_of(std::span<const Index> vertices) const;
  std::optional<Contact> contact_of(const NearVertexFace& near, std::span<const Vec3> positions) const;
  std::optional<Contact> contact_of(const NearEdges& near, std::span<const Vec3> positions) const;

  const TriangleMesh& surface_;
  std::vector<double> thickness_;
  ProximityFinder finder_;
};

/// Rest positions with objects far from one another, so that only those of one object are near.
/// @param rest_positions  (n_vertices) of objects [m]
/// @param objects         (n_vertices) or empty: all are one
/// @param count           vertices in all: those that follow are of no object, and far from all
std::vector<Vec3> separated_at_rest(std::span<const Vec3> rest_positions, std::span<const Index> objects, Index count);

}  // namespace selvage
