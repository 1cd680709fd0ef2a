#pragma once

#include "bvh/bvh.h"

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

/// Sets the boxes of the primitives among the children of nodes [first, last), and empty ones for all other children.
void fill_boxes(BvhNode* nodes, const Box* boxes, Index first, Index last);

/// Sets the bounds of all child nodes of the nodes [first, last), which must be fitted already, where fill_boxes() left
/// empty ones. Bound by memory: wider instructions than every x86-64 has do not make it faster.
MeasureSums fit_nodes(BvhNode* nodes, Index first, Index last, const BoxMeasure& measure);

}  // namespace selvage
