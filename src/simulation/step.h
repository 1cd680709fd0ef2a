#pragma once

#include "selvage/contact/contact.h"
#include "selvage/simulation/model.h"

namespace selvage {

/// One time step: its ends, and the state at its start.
struct Step {
  std::int64_t number;                          ///< counted from the first step of the solver
  double start_time, end_time;                  ///< [s]
  std::span<const Vec3> positions, velocities;  ///< (n_vertices) at the start [m], [m/s]

  double length() const { return end_time - start_time; }
};

/// Largest distance by which one projection sends each vertex out of a body: a fraction of its shortest edge at rest
/// [m]; 0 without an element or triangle. O(n).
std::vector<double> max_corrections_of(const Model& model);

/// Fraction of a vertex's largest correction by which a contact keeps it in front of a surface.
inline constexpr double kContactGap = 0.01;

/// Part of a vertex's largest correction by which a body moves off a collider that stands in it, in a step: it is to
/// come free gently, and not to be torn.
inline constexpr double kOffCollider = 0.2;

/// Whether a contact is that of a collider's point inside an element.
inline bool moves_off_collider(const Contact& contact) {
  const bool is_path = contact.kind == ContactKind::kVertexPath || contact.kind == ContactKind::kEdgePath;
  return is_path && contact.distance > 0;
}

}  // namespace selvage
