#pragma once

#include <array>

#include "selvage/core/types.h"

namespace selvage {

/// The exact stages behind `orient2d` and `orient3d`, each alone, so that tests can hold one against the other.

/// True when the stage of expansions is exact for these points: each coordinate is 0 or of moderate magnitude.
template <int D, int N>
bool expansions_are_exact(const std::array<Vec<D>, N>& points);

/// Sign by floating-point expansions; only for points for which `expansions_are_exact`.
int orient2d_by_expansions(const std::array<Vec2, 3>& points);
int orient3d_by_expansions(const std::array<Vec3, 4>& points);

/// Sign by integers of any size, for all finite doubles.
int orient2d_by_integers(const std::array<Vec2, 3>& points);
int orient3d_by_integers(const std::array<Vec3, 4>& points);

extern template bool expansions_are_exact<2, 3>(const std::array<Vec2, 3>&);
extern template bool expansions_are_exact<3, 4>(const std::array<Vec3, 4>&);

}  // namespace selvage
