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

  /// Begins a step: find_pairs() starts elsewhere than before.
  void begin_step() { is_known_ = false; }

  /// All that meet on the way. Within a step only what has moved since the last call is searched, where that is little.
  ContinuousPairs find_pairs(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1,
                             ContinuousCounters& counters);

  /// Pairs of the last find_pairs().
  StepImpacts with_times(ContinuousPairs pairs) const;

 private:
  bool have_most_moved(std::span<const Vec3> positions_t1) const;
  std::vector<Index> list_moved(std::span<const Vec3> positions_t1) const;
  void keep_unmoved(std::span<const Index> moved);

  const TriangleMesh& surface_;
  Index body_faces_;
  std::optional<ContinuousCollisionFinder> finder_;  ///< made when first needed
  bool is_known_ = false;                            ///< what the last call found, in this step
  std::vector<Vec3> last_ends_;                      ///< its positions_t1
  ContinuousPairs last_pairs_;
  std::vector<std::uint8_t> has_moved_;  ///< (n_vertices) 0 between calls
};

/// Builds the contacts of all pairs that are a first impact, leaving out those without a normal.
void append_impact_contacts(const SurfaceStep& step, const StepImpacts& found, std::vector<Contact>& contacts);

}  // namespace selvage
