#pragma once

#include "selvage/bvh/bvh.h"
#include "selvage/core/isa.h"

namespace selvage {

/// How boxes are measured for the quality of a tree: extents are multiplied by `scale`, so that nothing overflows.
struct BoxMeasure {
  float scale;
  bool flat;  ///< half perimeter instead of half area
};

/// Measures of children, summed over some nodes.
struct MeasureSums {
  double nodes = 0;
  double primitives = 0;
};

// Sets the bounds of all children of the nodes [first, last), whose own child nodes must be fitted already.
#define SELVAGE_FIT_NODES \
  MeasureSums fit_nodes_kernel(BvhNode* nodes, const Box* boxes, Index first, Index last, const BoxMeasure& measure);
namespace baseline {
SELVAGE_FIT_NODES
}
namespace avx2 {
SELVAGE_FIT_NODES
}
namespace avx512 {
SELVAGE_FIT_NODES
}
#undef SELVAGE_FIT_NODES

}  // namespace selvage
