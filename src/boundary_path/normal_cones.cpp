#include "boundary_path/normal_cones.h"

#include "selvage/core/parallel.h"

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

/// Widens a cone by more than the rounding of the few operations that made it.
constexpr float kMargin = 4e-6f;
/// Wider cones skip too little to be worth their test.
constexpr float kSmallestCosine = 0.1f;
/// Above it a direction within the cone cannot be mistaken for one within its opposite: cos 45 degrees and a little.
constexpr float kOneSidedCosine = 0.7072f;

float dot(const std::array<float, 3>& a, const std::array<float, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

}  // namespace

NormalCone merge_cones(std::span<const NormalCone> cones) {
  NormalCone merged;
  for (const NormalCone& cone : cones) {
    if (!cone.is_bounded()) return NormalCone::everything();
    for (int i = 0; i < 3; ++i) merged.axis[i] += cone.axis[i];
  }
  const float length = std::sqrt(dot(merged.axis, merged.axis));
  if (!(length > 0.1f)) return NormalCone::everything();
  for (float& x : merged.axis) x /= length;
  float cosine = 1;
  for (const NormalCone& cone : cones) {
    const float between = std::min(dot(merged.axis, cone.axis), 1.0f);
    const float sines = std::sqrt(std::max(0.0f, (1 - between * between) * (1 - cone.cosine * cone.cosine)));
    if (between < 0) return NormalCone::everything();
    cosine = std::min(cosine, between * cone.cosine - sines);
  }
  merged.cosine = cosine - kMargin;
  return merged.cosine > kSmallestCosine ? merged : NormalCone::everything();
}

template <int D>
void fit_cones(const Bvh& faces, const SimplexMesh<D>& mesh, std::span<const NormalCone> vertex_cones,
               std::vector<ConeNode>& nodes) {
  const auto hierarchy = faces.nodes();
  nodes.resize(hierarchy.size());
  std::vector<NormalCone> whole(hierarchy.size());  // of each node
  const auto levels = faces.levels();
  for (std::size_t level = levels.size() - 1; level-- > 0;) {
    parallel_for(levels[level + 1] - levels[level], 256, [&](std::int64_t offset) {
      const std::size_t k = levels[level] + offset;
      const BvhNode& node = hierarchy[k];
      std::array<NormalCone, BvhNode::kWidth> cones;
      ConeNode& out = nodes[k];
      out = {};
      for (int lane = 0; lane < node.child_count; ++lane) {
        const Index child = node.children[lane];
        if (child < 0) {
          cones[lane] = whole[~child];
        } else {
          std::array<NormalCone, D> corners;
          for (int i = 0; i < D; ++i) corners[i] = vertex_cones[mesh.boundary_faces()[child][i]];
          cones[lane] = merge_cones(corners);
        }
        if (!cones[lane].is_bounded()) continue;
        for (int i = 0; i < 3; ++i) out.axis[i][lane] = cones[lane].axis[i];
        out.cosine[lane] = cones[lane].cosine;
        out.sine[lane] = std::sqrt(1 - cones[lane].cosine * cones[lane].cosine);
        if (cones[lane].cosine < kOneSidedCosine) out.two_sided |= 1u << lane;
      }
      whole[k] = merge_cones(std::span(cones).first(node.child_count));
    });
  }
}

template void fit_cones<2>(const Bvh&, const SimplexMesh<2>&, std::span<const NormalCone>, std::vector<ConeNode>&);
template void fit_cones<3>(const Bvh&, const SimplexMesh<3>&, std::span<const NormalCone>, std::vector<ConeNode>&);

}  // namespace selvage
