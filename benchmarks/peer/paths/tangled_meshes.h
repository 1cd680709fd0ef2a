#pragma once

#include "selvage/io/mesh_file.h"

#include <functional>

namespace selvage::bench {

/// A mesh that runs into itself without inverting, by formula.
struct TangledShape {
  std::string_view name;
  std::function<IndexedMesh(double cell)> make;  ///< at rest
  std::function<void(IndexedMesh&)> tangle;
  double coarsest_cell;  ///< the largest that the shape takes
};

/// octopus, squishy-balls (two that meet head-on), rod, beam: as in the figures of SPB; aligned-rod: full of exact
/// coincidences.
std::span<const TangledShape> tangled_shapes();

/// The shape with about `elements` tetrahedra, or the fewest that it can be made of; tangled.
IndexedMesh make_tangled(const TangledShape& shape, std::int64_t elements);

}  // namespace selvage::bench
