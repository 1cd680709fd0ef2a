#pragma once

#include "selvage/core/types.h"
#include "shapes/stuffing/implicit_solid.h"

namespace selvage {

/// A vertex of the body-centred cubic lattice: the low corner of cube (x, y, z), or its centre.
struct LatticeVertex {
  std::array<Index, 3> cube;
  int centre;  ///< 0 for a corner, 1 for a centre

  /// Coordinates in half cells: all even for a corner, all odd for a centre.
  std::array<Index, 3> half_cells() const { return {2 * cube[0] + centre, 2 * cube[1] + centre, 2 * cube[2] + centre}; }
  LatticeVertex moved(int axis, Index step) const {
    LatticeVertex other = *this;
    other.cube[axis] += step;
    return other;
  }
  /// One of the eight vertices of the other kind around it, `bits` from 0 to 7.
  LatticeVertex crossed(int bits) const {
    LatticeVertex other{cube, 1 - centre};
    const Index step = centre ? 1 : -1;
    for (int axis = 0; axis < 3; ++axis) other.cube[axis] += (bits >> axis & 1) * step;
    return other;
  }
};

/// The part of a body-centred cubic lattice near a solid, in blocks of 8 x 8 x 8 cubes: only blocks that the solid can
/// reach exist, and each knows the parts of the solid that reach it. Every lattice neighbour of a vertex in the solid
/// lies in a block that exists.
class BccLattice {
 public:
  static constexpr int kSide = 8;
  static constexpr Index kBlockVertices = 2 * kSide * kSide * kSide;

  /// @param cell  edge length of the cubes
  /// @throws Error  when the lattice cannot be indexed
  BccLattice(const ImplicitSolid& solid, double cell);

  double cell() const { return cell_; }
  Index block_count() const { return static_cast<Index>(blocks_.size()); }

  /// The first cube of a block.
  std::array<Index, 3> block_origin(Index block) const { return blocks_[block].origin; }

  /// The parts of the solid that reach a block.
  std::span<const Index> block_parts(Index block) const {
    return std::span(parts_).subspan(blocks_[block].first_part, blocks_[block].part_count);
  }

  /// Number of a vertex: block * kBlockVertices + place in the block; kNone where no block exists.
  Index number(const LatticeVertex& v) const {
    std::array<Index, 3> block;
    for (int axis = 0; axis < 3; ++axis) {
      block[axis] = v.cube[axis] >> 3;
      if (v.cube[axis] < 0 || block[axis] >= block_dims_[axis]) return kNone;
    }
    const Index found = block_table_[table_place(block)];
    if (found == kNone) return kNone;
    return found * kBlockVertices + (v.centre << 9 | (v.cube[0] & 7) << 6 | (v.cube[1] & 7) << 3 | (v.cube[2] & 7));
  }

  /// The vertex with a number.
  LatticeVertex vertex(Index number) const {
    const std::array<Index, 3>& origin = blocks_[number / kBlockVertices].origin;
    const Index place = number % kBlockVertices;
    return {{origin[0] + (place >> 6 & 7), origin[1] + (place >> 3 & 7), origin[2] + (place & 7)},
            static_cast<int>(place >> 9)};
  }

  Vec3 position(const LatticeVertex& v) const {
    const std::array<Index, 3> h = v.half_cells();
    return origin_ + cell_ / 2 * Vec3(h[0], h[1], h[2]);
  }

 private:
  struct Block {
    std::array<Index, 3> origin;
    Index part_count;
    std::size_t first_part;
  };
  struct BlockRange {
    std::array<Index, 3> low, high;  ///< blocks, high excluded
  };

  std::size_t table_place(const std::array<Index, 3>& block) const {
    return (static_cast<std::size_t>(block[0]) * block_dims_[1] + block[1]) * block_dims_[2] + block[2];
  }
  void place_around(const ImplicitSolid& solid);
  void add_blocks(const ImplicitSolid& solid, const BlockRange& range, std::span<const Index> parts);

  double cell_;
  Vec3 origin_;
  std::array<Index, 3> block_dims_;
  std::vector<Index> block_table_;
  std::vector<Block> blocks_;
  std::vector<Index> parts_;
};

}  // namespace selvage
