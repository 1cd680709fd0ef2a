#pragma once

#include "core/isa.h"
#include "self_collision/surface/continuous_input.h"

namespace selvage {

/// Up to eight edges that follow one another along a closed loop in the plane.
struct EdgeBlock {
  static constexpr int kWidth = 8;
  Index first;  ///< place of the tail of the first edge; edge i goes from place first + i to the next
  Index count;
  bool continues;  ///< the next block goes on where this one ends
  float lower[2];  ///< box over the whole step
  float upper[2];
};

/// Closed loops in the plane, at one instant or at both ends of a step during which vertices move on straight lines.
/// Coordinates lie in [-1, 1], each rounded once to float. Each loop ends with its first vertex again, so often that
/// whole blocks can be read.
///
/// @tparam kSteps  1 or 2 poses
template <int kSteps>
struct PlanarLoops {
  const float* coordinates[kSteps][2];
  const Index* vertices;
  std::span<EdgeBlock> blocks;
};

/// Bounds of triangles' area vectors: (x, y, z) rounded, and how far the dot product with a vector whose largest
/// component is at most 1 may be off. Over a step: of the three coefficients of the area vector in Bernstein form.
struct AreaVectors {
  const float* rows[4];
};

/// Consecutive triangles whose area vectors are summed once.
constexpr Index kAreaGroup = 32;

/// Where to put the area vectors of triangles during a step: the rows of each coefficient; how far any of them may be
/// off; and for each group the sum of those at both ends.
struct MovingAreaRows {
  float* rows[3][3];
  float* errors;
  Vec3* group_sums;
};

/// A plane to project on: u = (p - origin) . u_axis, v alike, in exact arithmetic; `normal` is the cross product of the
/// axes, rounded.
struct ProjectionPlane {
  float u_axis[3];
  float v_axis[3];
  float normal[3];
};

/// How the edges of a contour are compared.
enum class ContourTest : std::uint8_t {
  kAllEdges,      ///< each edge with all others near it
  kMonotoneRuns,  ///< not within runs that advance along one direction
};

// measure_moving_areas: area vectors of triangles [first, last) from positions in box units, and of the next ones up to
// a multiple of eight anything; sums of the groups. `first` begins a group, `last` ends one or all triangles.
// mark_contour: sets marks[i] to whether the edge opposite to edge first + i is none of [first, last).
// do_all_face: whether all area vectors [first, last) certainly have a positive dot product with u_axis x v_axis.
// fit_blocks: sets the boxes of the blocks.
// is_contour_simple: whether edges certainly meet nowhere (at no time) but where one follows the other. Sufficient,
// never wrong: what is closer than rounding gives false.
#define SELVAGE_CONTOUR_KERNEL                                                                                       \
  void measure_moving_areas(const MovingVertex* positions, const VertexTuple<3>* triangles, Index first, Index last, \
                            const MovingAreaRows& areas);                                                            \
  void mark_contour(const Index* opposite, Index first, Index last, char* marks);                                    \
  bool do_all_face(const AreaVectors& areas, std::size_t first, std::size_t last, const ProjectionPlane& plane);     \
  void fit_blocks(const PlanarLoops<1>& loops);                                                                      \
  void fit_blocks(const PlanarLoops<2>& loops);                                                                      \
  bool is_contour_simple(const PlanarLoops<1>& loops, ContourTest test);                                             \
  bool is_contour_simple(const PlanarLoops<2>& loops, ContourTest test);
namespace baseline {
SELVAGE_CONTOUR_KERNEL
}
namespace avx2 {
SELVAGE_CONTOUR_KERNEL
}
namespace avx512 {
SELVAGE_CONTOUR_KERNEL
}
#undef SELVAGE_CONTOUR_KERNEL

}  // namespace selvage
