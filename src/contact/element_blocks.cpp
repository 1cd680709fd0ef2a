#include "contact/element_blocks.h"

#include "selvage/core/parallel.h"

#include <algorithm>
#include <utility>

namespace selvage {

namespace {

constexpr std::int64_t kGrain = 4096;

/// Of some dozen operations on coordinates, relative to the largest.
constexpr double kRounding = 0x1p-44;

/// The same in single precision, within a block, and what underflow may add.
constexpr double kFloatRounding = 0x1p-19;
constexpr double kFloatUnderflow = 0x1p-120;

/// Lengths and maps beyond this might overflow: then nothing is said about a motion.
constexpr double kLargest = 0x1p50;

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
  part_boxes_.resize(count);
  arm_ranges_.resize(count);
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
    all.erase(std::unique(all.begin(), all.end()), all.end());
    while (all.size() % 8 != 0) all.push_back(all.front());
    vertices_.insert(vertices_.end(), all.begin(), all.end());
    vertices_first_.push_back(static_cast<Index>(vertices_.size()));
  }
  arms_.resize(6 * vertices_.size());
}

std::span<const Index> ElementBlocks::vertices_of(Index block) const {
  const Index first = vertices_first_[block], last = vertices_first_[block + 1];
  return std::span(vertices_).subspan(first, last - first);
}

void ElementBlocks::take_reference(std::span<const Vec3> positions) {
  reference_.assign(positions.begin(), positions.end());
  rounding_ = kRounding * largest_coordinate(reference_);
  parallel_for(count(), 4, [&](std::int64_t b) { refer(static_cast<Index>(b)); });
  hierarchy_ = {};
  fit_hierarchy();
}

/// Boxes, arms and weights of a block in the reference pose, which is the pose of now, too.
void ElementBlocks::refer(Index block) {
  Box part = Box::empty();
  for (Index i = 0; i < kSize; ++i) {
    Box box = Box::empty();
    if (const std::size_t place = static_cast<std::size_t>(block) * kSize + i; place < order_.size()) {
      Range range;
      for (const Index v : mesh_.elements()[order_[place]]) range.add(reference_[v]);
      box = range.box();
    }
    boxes_[block].set(i, box);
    part.merge(box);
    if ((i + 1) % kPart == 0) part_boxes_[block].set(i / kPart, std::exchange(part, Box::empty()));
  }
  const auto vertices = vertices_of(block);
  BlockMotion motion;
  motion.anchor = motion.reference_anchor = reference_[vertices.front()];
  motion.rest = motion.backward_rest = {Vec3::Zero(), Vec3::Zero()};
  Vec3 mean = Vec3::Zero();
  Range extent, arms;
  for (const Index v : vertices) {
    mean += reference_[v] / static_cast<double>(vertices.size());
    extent.add(reference_[v]);
    arms.add(reference_[v] - motion.anchor);
  }
  Matrix3 inertia = Matrix3::Zero();
  for (const Index v : vertices) inertia += (reference_[v] - mean) * (reference_[v] - mean).transpose();
  const Matrix3 inverse = inertia.inverse();
  float* const rows = arms_.data() + 6 * static_cast<std::size_t>(vertices_first_[block]);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Vec3 arm = reference_[vertices[i]] - motion.anchor, weight = inverse * (reference_[vertices[i]] - mean);
    for (int k = 0; k < 3; ++k) {
      rows[k * vertices.size() + i] = static_cast<float>(arm[k]);
      rows[(3 + k) * vertices.size() + i] = static_cast<float>(weight[k]);
    }
  }
  motions_[block] = motion;
  extents_[block] = extent;
  arm_ranges_[block] = arms;
}

void ElementBlocks::place(std::span<const Vec3> positions) {
  rounding_ = kRounding * std::max(largest_coordinate(positions), largest_coordinate(reference_));
  parallel_ranges(count(), 8, [&](std::int64_t first, std::int64_t last) {
    std::vector<float> scratch;
    for (std::int64_t b = first; b < last; ++b) move(static_cast<Index>(b), positions, scratch);
  });
  fit_hierarchy();
}

namespace {

float sum_of_lanes(const Float8& x) {
  float lanes[8];
  x.store(lanes);
  return ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) + ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]));
}

/// Rows of three coordinates each, `count` floats long.
struct Rows {
  const float* first;
  std::size_t count;
  Float8 at(int row, std::size_t i) const { return Float8::load(first + row * count + i); }
};

/// Sum over vertices of the product of every coordinate with every weight.
Matrix3 sum_of_products(const Rows& x, const Rows& weights) {
  Matrix3 sum;
  for (int j = 0; j < 3; ++j) {
    Float8 column[3] = {Float8::broadcast(0), Float8::broadcast(0), Float8::broadcast(0)};
    for (std::size_t i = 0; i < x.count; i += 8)
      for (int k = 0; k < 3; ++k) column[k] = column[k] + x.at(k, i) * weights.at(j, i);
    for (int k = 0; k < 3; ++k) sum(k, j) = sum_of_lanes(column[k]);
  }
  return sum;
}

struct WideRange {
  Float8 lower = Float8::broadcast(HUGE_VALF), upper = Float8::broadcast(-HUGE_VALF);
  void add(const Float8& x) {
    lower = min(x, lower);
    upper = max(x, upper);
  }
};

Range range_of(const std::array<WideRange, 3>& wide) {
  Range range;
  for (int k = 0; k < 3; ++k) {
    float lower[8], upper[8];
    wide[k].lower.store(lower);
    wide[k].upper.store(upper);
    range.lower[k] = *std::min_element(lower, lower + 8);
    range.upper[k] = *std::max_element(upper, upper + 8);
  }
  return range;
}

double reach_of(const Range& range) {
  return std::max(range.lower.cwiseAbs().maxCoeff(), range.upper.cwiseAbs().maxCoeff());
}

}  // namespace

/// The affine map is that of least squares; where there is none, the identity. Any will do: it decides only how much
/// there is left to each vertex.
void ElementBlocks::move(Index block, std::span<const Vec3> positions, std::vector<float>& scratch) {
  const auto vertices = vertices_of(block);
  const std::size_t count = vertices.size();
  const Rows arms{arms_.data() + 6 * static_cast<std::size_t>(vertices_first_[block]), count};
  BlockMotion motion;
  motion.reference_anchor = motions_[block].reference_anchor;
  motion.anchor = positions[vertices.front()];
  scratch.resize(3 * count);
  for (std::size_t i = 0; i < count; ++i)
    for (int k = 0; k < 3; ++k)
      scratch[k * count + i] = static_cast<float>(positions[vertices[i]][k] - motion.anchor[k]);
  const Rows now{scratch.data(), count};
  const Matrix3 forward = sum_of_products(now, {arms.first + 3 * count, count}), backward = forward.inverse();
  if (forward.norm() < kLargest && backward.norm() < kLargest) {
    motion.forward = forward;
    motion.backward = backward;
  }
  motion.size = 1 + motion.forward.norm() + motion.backward.norm();

  std::array<WideRange, 3> extents, rests;
  for (int k = 0; k < 3; ++k) {
    Float8 row[3];
    for (int j = 0; j < 3; ++j) row[j] = Float8::broadcast(static_cast<float>(motion.forward(k, j)));
    for (std::size_t i = 0; i < count; i += 8) {
      const Float8 x = now.at(k, i);
      extents[k].add(x);
      rests[k].add(x - (row[0] * arms.at(0, i) + row[1] * arms.at(1, i) + row[2] * arms.at(2, i)));
    }
  }
  const Range extent = range_of(extents);
  const double reach = reach_of(extent), reference_reach = reach_of(arm_ranges_[block]);
  const double rounding = kFloatRounding * (reach + motion.size * reference_reach) + kFloatUnderflow;
  motion.rest = range_of(rests).grown(rounding);
  const Range& range = arm_ranges_[block];
  const Matrix3 left = motion.backward * motion.forward - Matrix3::Identity();
  const Vec3 middle = left * range.middle() + motion.backward * motion.rest.middle();
  const Vec3 half = left.cwiseAbs() * range.half() + motion.backward.cwiseAbs() * motion.rest.half();
  motion.backward_rest = {middle - half, middle + half};
  if (!(reach < kLargest && reference_reach < kLargest)) motion.rest = motion.backward_rest = Range::everything();
  extents_[block] = Range{motion.anchor + extent.lower, motion.anchor + extent.upper}.grown(rounding + rounding_);
  motions_[block] = motion;
}

void ElementBlocks::fit_hierarchy() {
  std::vector<Box> boxes(count());
  parallel_for(count(), kGrain, [&](std::int64_t b) { boxes[b] = extents_[b].box(); });
  if (hierarchy_.primitive_count() == count()) {
    hierarchy_.refit(boxes);
    if (hierarchy_.quality_loss() <= Bvh::kRebuildAbove) return;
  }
  hierarchy_ = Bvh(boxes);
}

Range ElementBlocks::in_reference(Index block, const std::array<Vec3, 2>& segment) const {
  const BlockMotion& motion = motions_[block];
  Range range;
  for (const Vec3& x : segment) range.add(motion.to_reference(x));
  return Range{range.lower - motion.backward_rest.upper, range.upper - motion.backward_rest.lower}.grown(slack(block));
}

double ElementBlocks::difference_bound(Index block, Index other) const {
  const BlockMotion &motion = motions_[block], &seen_by = motions_[other];
  // What moved as the block has, seen by the other: a linear part over the block's extent, a constant, and the rest.
  const Matrix3 linear = seen_by.backward * motion.forward - Matrix3::Identity();
  const Vec3 constant = seen_by.to_reference(motion.anchor) - motion.reference_anchor;
  const Range& arms = arm_ranges_[block];
  const Vec3 middle = linear * arms.middle() + constant + seen_by.backward * motion.rest.middle();
  const Vec3 half = linear.cwiseAbs() * arms.half() + seen_by.backward.cwiseAbs() * motion.rest.half();
  const Vec3 apart = (middle - seen_by.backward_rest.middle()).cwiseAbs() + half + seen_by.backward_rest.half();
  return apart.norm() + slack(block) * seen_by.size;
}

double ElementBlocks::difference_bound(const std::array<Index, 2>& ends, std::span<const Vec3> positions,
                                       Index other) const {
  const BlockMotion& seen_by = motions_[other];
  Range motion;
  for (const Index v : ends) motion.add(seen_by.to_reference(positions[v]) - reference_[v]);
  const Vec3 apart =
      (motion.middle() - seen_by.backward_rest.middle()).cwiseAbs() + motion.half() + seen_by.backward_rest.half();
  return apart.norm() + slack(other);
}

}  // namespace selvage
