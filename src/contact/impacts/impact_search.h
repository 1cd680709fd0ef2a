#pragma once

#include "contact/impacts/impact_contacts.h"
#include "selvage/contact/contact_finder.h"

#include <optional>

namespace selvage {

/// CCD over a surface of bodies and colliders, from step to step.
class ImpactSearch {
 public:
  /// @param surface     must outlive this
  /// @param body_faces  those before the colliders'
  ImpactSearch(const TriangleMesh& surface, Index body_faces) : surface_(surface), body_faces_(body_faces) {}

  /// All that meet on the way.
  ContinuousPairs find_pairs(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1,
                             ContinuousCounters& counters);

  /// Pairs of the last find_pairs().
  StepImpacts with_times(ContinuousPairs pairs) const;

 private:
  const TriangleMesh& surface_;
  Index body_faces_;
  std::optional<ContinuousCollisionFinder> finder_;  ///< made when first needed
};

/// Builds the contacts of all pairs that are a first impact, leaving out those without a normal.
void append_impact_contacts(const SurfaceStep& step, const StepImpacts& found, std::vector<Contact>& contacts);

}  // namespace selvage
