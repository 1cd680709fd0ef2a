#include "contact/element_blocks.h"

#include "selvage/core/parallel.h"

#include <algorithm>

namespace selvage {

namespace {

constexpr std::int64_t kGrain = 4096;

/// Largest absolute value of a coordinate.
struct Largest {
  double value = 0;
  void add(const Largest& other) { value = std::max(value, other.value); }
};

double largest_coordinate(std::span<const Vec3> positions) {
  const auto largest = [&](std::int64_t first, std::int64_t last, Largest& result) {
    for (std::int64_t v = first; v < last; ++v) result.add({positions[v].cwiseAbs().maxCoeff()});
  };
  return parallel_reduce<Largest>(std::ssize(positions), kGrain, largest).value;
}

}  // namespace

ElementBlocks::ElementBlocks(const TetMesh& mesh, std::span<const Vec3> positions) : mesh_(mesh) {
  std::vector<Box> boxes(mesh.element_count());
  parallel_for(mesh.element_count(), kGrain, [&](std::int64_t e) {
    Range range;
    for (const Index v : mesh.elements()[e]) range.add(positions[v]);
    boxes[e] = range.box();
  });
  order_ = Bvh(boxes).leaf_order();
  block_of_.resize(order_.size());
  for (std::size_t i = 0; i < order_.size(); ++i) block_of_[order_[i]] = static_cast<Index>(i / kSize);
  const std::size_t count = (order_.size() + kSize - 1) / kSize;
  boxes_.resize(count);
  extents_.resize(count);
  motions_.resize(count);
  list_vertices();
  take_reference(positions);
}

void ElementBlocks::list_vertices() {
  vertices_first_.push_back(0);
  std::vector<Index> all;
  for (std::size_t first = 0; first < order_.size(); first += kSize) {
    all.clear();
    for (std::size_t i = first; i < std::min(first + kSize, order_.size()); ++i)
      for (const Index v : mesh_.elements()[order_[i]]) all.push_back(v);
    std::sort(all.begin(), all.end());
    vertices_.insert(vertices_.end(), all.begin(), std::unique(all.begin(), all.end()));
    vertices_first_.push_back(static_cast<Index>(vertices_.size()));
  }
}

void ElementBlocks::take_reference(std::span<const Vec3> positions) {
  reference_.assign(positions.begin(), positions.end());
  parallel_for(count(), 16, [&](std::int64_t b) {
    Boxes& boxes = boxes_[b];
    for (Index i = 0; i < kSize; ++i) {
      Box box = Box::empty();
      if (const std::size_t place = b * kSize + i; place < order_.size()) {
        Range range;
        for (const Index v : mesh_.elements()[order_[place]]) range.add(positions[v]);
        box = range.box();
      }
      for (int axis = 0; axis < 3; ++axis) {
        boxes.lower[axis][i] = box.lower[axis];
        boxes.upper[axis][i] = box.upper[axis];
      }
    }
  });
  hierarchy_ = {};
  place(positions);
}

void ElementBlocks::place(std::span<const Vec3> positions) {
  slack_ = 0x1p-46 * std::max(largest_coordinate(positions), largest_coordinate(reference_));
  std::vector<Box> boxes(count());
  parallel_for(count(), 64, [&](std::int64_t b) {
    Range extent, motion;
    for (Index i = vertices_first_[b]; i < vertices_first_[b + 1]; ++i) {
      const Index v = vertices_[i];
      extent.add(positions[v]);
      motion.add(positions[v] - reference_[v]);
    }
    extents_[b] = extent;
    motions_[b] = motion;
    boxes[b] = extent.box();
  });
  if (hierarchy_.primitive_count() == count()) {
    hierarchy_.refit(boxes);
    if (hierarchy_.quality_loss() <= Bvh::kRebuildAbove) return;
  }
  hierarchy_ = Bvh(boxes);
}

}  // namespace selvage
