#include "self_collision/culling/surface_cones.h"

#include "core/parallel.h"

namespace selvage {

namespace {

template <std::size_t kCount>
DirectionCone cone_around(const std::array<Vec3, kCount>& directions) {
  DirectionCone cone;
  for (const Vec3& direction : directions) cone.merge(DirectionCone::of(direction));
  return cone;
}

}  // namespace

template <int kSteps>
SurfaceCones<kSteps>::SurfaceCones(const Bvh& bvh, const SurfacePieces& pieces, const Poses& poses)
    : pieces_(&pieces), poses_(poses), normals_(bvh.nodes().size()), border_binormals_(bvh.nodes().size()) {
  const auto levels = bvh.levels();
  for (std::size_t level = levels.size() - 1; level-- > 0;)
    parallel_for(levels[level + 1] - levels[level], 64, [&](std::int64_t i) {
      const Index n = levels[level] + static_cast<Index>(i);
      fit(bvh.nodes()[n], n);
    });
}

template <int kSteps>
void SurfaceCones<kSteps>::fit(const BvhNode& node, Index n) {
  for (int i = 0; i < node.child_count; ++i) {
    if (node.children[i] < 0) {
      normals_[n].merge(normals_[~node.children[i]]);
      border_binormals_[n].merge(border_binormals_[~node.children[i]]);
      continue;
    }
    const Index place = pieces_->ranges()[n].last - node.child_count + i;
    normals_[n].merge(triangle_normals(place));
    for (Index edge = 3 * place; edge < 3 * place + 3; ++edge)
      if (pieces_->opposite(edge) == kNone) border_binormals_[n].merge(binormals(edge));
  }
}

/// Twice the area vector, as a polynomial of time in Bernstein form.
template <int kSteps>
std::array<Vec3, 2 * kSteps - 1> SurfaceCones<kSteps>::area_coefficients(Index place) const {
  const auto& t = pieces_->triangles()[place];
  std::array<Vec3, kSteps> e, f;
  for (int s = 0; s < kSteps; ++s) {
    e[s] = poses_[s][t[1]] - poses_[s][t[0]];
    f[s] = poses_[s][t[2]] - poses_[s][t[0]];
  }
  if constexpr (kSteps == 1) {
    return {e[0].cross(f[0])};
  } else {
    return {e[0].cross(f[0]), (e[0].cross(f[1]) + e[1].cross(f[0])) / 2, e[1].cross(f[1])};
  }
}

template <int kSteps>
DirectionCone SurfaceCones<kSteps>::triangle_normals(Index place) const {
  return cone_around(area_coefficients(place));
}

template <int kSteps>
DirectionCone SurfaceCones<kSteps>::binormals(Index edge) const {
  const auto n = area_coefficients(edge / 3);
  std::array<Vec3, kSteps> e;
  for (int s = 0; s < kSteps; ++s) e[s] = poses_[s][pieces_->head(edge)] - poses_[s][pieces_->tail(edge)];
  if constexpr (kSteps == 1) {
    return DirectionCone::of(n[0].cross(e[0]));
  } else {
    return cone_around(std::array<Vec3, 4>{n[0].cross(e[0]), (2 * n[1].cross(e[0]) + n[0].cross(e[1])) / 3,
                                           (n[2].cross(e[0]) + 2 * n[1].cross(e[1])) / 3, n[2].cross(e[1])});
  }
}

template class SurfaceCones<1>;
template class SurfaceCones<2>;

}  // namespace selvage
