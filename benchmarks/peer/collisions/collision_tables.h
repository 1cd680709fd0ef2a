#pragma once

#include "peer/collisions/collision_report.h"

#include <span>

namespace selvage::bench {

/// Prints the tables of EDC's section 6, of whatever was measured: pairs and false negatives (Fig. 10), speed-up over
/// normal cones and the hierarchy alone (Fig. 11), time of the dual-cone methods (Fig. 12), and the tests that a simple
/// traversal makes besides (Fig. 13). Times are those of one thread.
void print_collision_tables(std::FILE* table, std::span<const CollisionCount> counts,
                            std::span<const CollisionTime> times);

}  // namespace selvage::bench
