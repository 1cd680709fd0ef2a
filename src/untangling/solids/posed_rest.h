#pragma once

#include "selvage/untangling/resolve.h"

namespace selvage {

/// A shape at rest that keeps a mesh's pose: far from any tangle that which the mesh has now, and near one that which
/// the given rest takes where its surroundings stay where they are. Every element is positive.
///
/// Near are the elements that collide or are inverted, and two rings around them; more rings, where elements stay
/// inverted otherwise, and at last the whole mesh: the given rest itself.
///
/// @param rest       (n_vertices x 3) without stress [m]
/// @param positions  (n_vertices x 3) the pose [m]
/// @throws Error     when sizes differ, or an element is not positive at rest
std::vector<Vec3> find_posed_rest(const TetMesh& mesh, std::span<const Vec3> rest, std::span<const Vec3> positions,
                                  const ResolveOptions& options);

}  // namespace selvage
