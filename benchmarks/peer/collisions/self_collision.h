#pragma once

#include "peer/collisions/collision_report.h"
#include "peer/collisions/collision_subject.h"

#include <vector>

namespace selvage::bench {

struct SelfCollisionPlan {
  std::vector<int> threads;          ///< thread counts to measure with
  std::vector<std::string> methods;  ///< of the library; empty: all
  bool with_peers = true;
  bool with_steps = true;  ///< continuous queries, too, from each frame to the next
};

/// Measures every culling method of the finders, and their peers, over the frames of one surface: what is found, and
/// the time from a pose or a step to all its pairs. Prints as it goes.
void measure_self_collision(const CollisionSubject& subject, const SelfCollisionPlan& plan, CollisionReport& report);

/// Measures how the time of the default method grows with a crumpled sheet.
void measure_growth(std::span<const std::int64_t> triangles, int frames, CollisionReport& report);

}  // namespace selvage::bench
