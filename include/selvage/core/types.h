#pragma once

#if defined(__FAST_MATH__) && !defined(SELVAGE_ALLOW_FAST_MATH)
#error \
    "-ffast-math lets the whole program take denormal numbers for 0, where selvage is then no longer exact. Build \
without it, or define SELVAGE_ALLOW_FAST_MATH where no coordinate, and no difference of two, is that small."
#endif

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace selvage {

/// Index of a vertex, an element, a face: 32-bit signed; counts that can exceed it are std::int64_t.
using Index = std::int32_t;

/// "No such thing", where an index may be missing.
inline constexpr Index kNone = -1;

/// A point or vector of D coordinates [m]. Unaligned, so that a row of an (n x D) array of doubles is one in place.
template <int D>
using Vec = Eigen::Matrix<double, D, 1, Eigen::DontAlign>;

using Vec2 = Vec<2>;
using Vec3 = Vec<3>;

/// Two indices: a pair of triangles, a vertex and a face.
using IndexPair = std::pair<Index, Index>;

/// N vertex indices: an element, a face, an edge.
template <int N>
using VertexTuple = std::array<Index, N>;

}  // namespace selvage
