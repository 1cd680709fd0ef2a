#include "shapes/stuffing/bcc_lattice.h"

#include <limits>
#include <numeric>

#include "shapes/shape_arguments.h"

namespace selvage {

BccLattice::BccLattice(const ImplicitSolid& solid, double cell) : cell_(cell) {
  place_around(solid);
  std::vector<Index> all(solid.parts.size());
  std::iota(all.begin(), all.end(), 0);
  add_blocks(solid, {{0, 0, 0}, block_dims_}, all);
}

void BccLattice::place_around(const ImplicitSolid& solid) {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const RoundCone& part : solid.parts) {
    const double margin = std::max(part.begin_radius, part.end_radius) + solid.blend;
    low = low.cwiseMin((part.begin.cwiseMin(part.end).array() - margin).matrix());
    high = high.cwiseMax((part.begin.cwiseMax(part.end).array() + margin).matrix());
  }
  // A corner in the middle, so that a symmetric solid gets a symmetric mesh; two cubes of air all around.
  const Vec3 middle = (low + high) / 2;
  double table_size = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double cubes = std::ceil((high[axis] - low[axis]) / 2 / cell_) + 2;
    check_element_count(cubes);
    const double blocks = std::ceil(2 * cubes / kSide);
    origin_[axis] = middle[axis] - cubes * cell_;
    block_dims_[axis] = static_cast<Index>(blocks);
    table_size *= blocks;
  }
  check_element_count(table_size);
  block_table_.assign(static_cast<std::size_t>(table_size), kNone);
}

void BccLattice::add_blocks(const ImplicitSolid& solid, const BlockRange& range, std::span<const Index> parts) {
  Vec3 low, high;
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] = origin_[axis] + cell_ * kSide * range.low[axis];
    high[axis] = origin_[axis] + cell_ * kSide * range.high[axis];
  }
  const Vec3 middle = (low + high) / 2;
  // One cell more, so that neighbours of a vertex inside are here too; the seam adds less than `blend` to a depth.
  const double reach = (high - low).norm() / 2 + 1.001 * cell_ + solid.blend;
  std::vector<Index> nearby;
  for (Index part : parts) {
    if (solid.parts[part].depth(middle) > -reach) nearby.push_back(part);
  }
  if (nearby.empty()) return;
  Eigen::Vector3i size;
  for (int axis = 0; axis < 3; ++axis) size[axis] = range.high[axis] - range.low[axis];
  int longest = 0;
  if (size.maxCoeff(&longest) == 1) {
    check_element_count((block_count() + 2.0) * kBlockVertices / 4);
    block_table_[table_place(range.low)] = block_count();
    blocks_.push_back({{range.low[0] * kSide, range.low[1] * kSide, range.low[2] * kSide},
                       static_cast<Index>(nearby.size()),
                       parts_.size()});
    parts_.insert(parts_.end(), nearby.begin(), nearby.end());
    return;
  }
  BlockRange lower = range, upper = range;
  lower.high[longest] = upper.low[longest] = range.low[longest] + size[longest] / 2;
  add_blocks(solid, lower, nearby);
  add_blocks(solid, upper, nearby);
}

}  // namespace selvage
