#pragma once

#include "bvh/bvh.h"
#include "self_collision/continuous/continuous_kernel.h"
#include "self_collision/continuous/near_features.h"
#include "self_collision/continuous/star_separation.h"
#include "selvage/self_collision/self_collision.h"

namespace selvage {

// Parallel searches over a step. Each gives results of its pieces, for bring_together().
//
// stop:      null, or set when a pair is found, where one is enough
// reporting: whose progress is reported

/// All that the input does not leave out, by the hierarchy.
std::vector<ContinuousResult> search_all(const Bvh& bvh, const ContinuousInput& input, std::atomic<bool>* stop,
                                         const SelfCollisionOptions& reporting);

/// Triangles without a common vertex by the hierarchy, others where their stars are open.
/// @param strayed  null, or those of which a pair must have one, which the input knows
std::vector<ContinuousResult> search_beside_stars(const Bvh& bvh, const ContinuousInput& input,
                                                  const StarSeparation& stars, const MarkedVertices* strayed,
                                                  std::atomic<bool>* stop, const SelfCollisionOptions& reporting);

/// Only what came near in a step from which this one hardly differs.
std::vector<ContinuousResult> search_near(const ContinuousInput& input, const NearFeatures& near,
                                          std::atomic<bool>* stop, const SelfCollisionOptions& reporting);

}  // namespace selvage
