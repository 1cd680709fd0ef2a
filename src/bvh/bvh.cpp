#include "bvh/bvh.h"

#include "bvh/bvh_build.h"
#include "bvh/refit.h"
#include "core/parallel.h"
#include "selvage/core/error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace selvage {

namespace {

constexpr Index kRefitChunk = 256;  ///< nodes summed together: fixed, so that sums do not depend on threads

/// Fits the nodes [first, last) of one level.
template <typename Fill>
MeasureSums fit_level(std::span<BvhNode> nodes, Index first, Index last, const BoxMeasure& measure, Fill&& fill) {
  const Index chunks = (last - first + kRefitChunk - 1) / kRefitChunk;
  const auto fit_chunk = [&](Index chunk) {
    const Index begin = first + chunk * kRefitChunk, end = std::min(begin + kRefitChunk, last);
    fill(nodes.data(), begin, end);
    return fit_nodes(nodes.data(), begin, end, measure);
  };
  if (chunks == 1) return fit_chunk(0);
  std::vector<MeasureSums> sums(chunks);
  parallel_for(chunks, 1, [&](std::int64_t chunk) { sums[chunk] = fit_chunk(static_cast<Index>(chunk)); });
  MeasureSums total;
  for (const MeasureSums& sum : sums) {
    total.nodes += sum.nodes;
    total.primitives += sum.primitives;
  }
  return total;
}

Box bounds_of(const BvhNode& node) {
  Box box = Box::empty();
  for (int child = 0; child < node.child_count; ++child) box.merge(node.box(child));
  return box;
}

double measure_box(const Box& box, const BoxMeasure& measure) {
  constexpr double kLargest = std::numeric_limits<float>::max();
  double e[3];
  for (int axis = 0; axis < 3; ++axis)
    e[axis] = std::clamp(double{box.upper[axis]} - double{box.lower[axis]}, 0.0, kLargest) * measure.scale;
  return measure.flat ? e[0] + e[1] + e[2] : e[0] * e[1] + e[1] * e[2] + e[2] * e[0];
}

float scale_for(float largest_extent) {
  const float scale = 1 / largest_extent;
  return std::isfinite(scale) ? scale : 1;
}

}  // namespace

Bvh::Bvh(std::span<const Box> boxes, BuildQuality quality) {
  if (boxes.size() > static_cast<std::size_t>(std::numeric_limits<Index>::max()))
    throw Error("hierarchy", "more than 2^31 - 1 primitives", "split the mesh");
  if (boxes.empty()) return;
  BvhTopology topology = build_topology(boxes, quality);
  primitive_count_ = static_cast<Index>(boxes.size());
  nodes_ = std::move(topology.nodes);
  levels_ = std::move(topology.levels);
  flat_ = topology.flat;
  measure_scale_ = scale_for(topology.largest_extent);
  refit(boxes);
  built_cost_ = cost_;
}

void Bvh::refit(std::span<const Box> boxes) {
  if (boxes.size() != static_cast<std::size_t>(primitive_count_))
    throw Error("hierarchy",
                std::to_string(boxes.size()) + " boxes for " + std::to_string(primitive_count_) + " primitives",
                "refit with one box per primitive, or build anew");
  refit_from([&](BvhNode* nodes, Index first, Index last) { fill_boxes(nodes, boxes.data(), first, last); });
}

void Bvh::refit_from(const BoxFiller& fill) {
  if (nodes_.empty()) return;
  const BoxMeasure measure{measure_scale_, flat_};
  MeasureSums sums;
  for (std::size_t level = levels_.size() - 1; level > 0; --level) {
    const MeasureSums level_sums = fit_level(nodes_, levels_[level - 1], levels_[level], measure, fill);
    sums.nodes += level_sums.nodes;
    sums.primitives += level_sums.primitives;
  }
  const double root = measure_box(bounds_of(nodes_[0]), measure);
  // Points have no surface: then, and only then, the little share of the root decides.
  const double cost = (sums.nodes + root) / (sums.primitives + 1e-6 * root);
  cost_ = cost > 0 && std::isfinite(cost) ? cost : 1;
}

std::vector<Index> Bvh::leaf_order() const {
  std::vector<Index> order;
  order.reserve(primitive_count_);
  std::vector<Index> waiting;
  if (!nodes_.empty()) waiting.push_back(~Index{0});
  while (!waiting.empty()) {
    const Index child = waiting.back();
    waiting.pop_back();
    if (child >= 0) {
      order.push_back(child);
      continue;
    }
    const BvhNode& node = nodes_[~child];
    for (int i = node.child_count - 1; i >= 0; --i) waiting.push_back(node.children[i]);
  }
  return order;
}

}  // namespace selvage
