#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "selvage/core/error.h"
#include "selvage/shapes/poses.h"

namespace selvage {

namespace {

/// Disjoint sets of vertices; the smallest vertex of a set stands for it.
class VertexSets {
 public:
  explicit VertexSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
  Index root(Index v) {
    while (parent_[v] != v) v = parent_[v] = parent_[parent_[v]];
    return v;
  }
  void join(Index a, Index b) {
    a = root(a);
    b = root(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<Index> parent_;
};

template <int N>
void join_outside(std::span<const VertexTuple<N>> elements, std::span<const double> distance, double core,
                  VertexSets& sets) {
  for (const VertexTuple<N>& element : elements) {
    for (int i = 0; i < N; ++i) {
      for (int j = 0; j < i; ++j) {
        if (distance[element[i]] > core && distance[element[j]] > core) sets.join(element[i], element[j]);
      }
    }
  }
}

/// +1 or -1 for every vertex outside the core: alternating from arm to arm in the order of their angle around z.
std::vector<double> arm_senses(const IndexedMesh& mesh, const Vec3& middle, std::span<const double> distance,
                               double core) {
  VertexSets sets(mesh.positions.size());
  join_outside<4>(mesh.tetrahedra, distance, core, sets);
  join_outside<3>(mesh.triangles, distance, core, sets);
  std::vector<Vec2> sum(mesh.positions.size(), Vec2::Zero());
  std::vector<Index> arms;
  for (Index v = 0; v < static_cast<Index>(mesh.positions.size()); ++v) {
    if (!(distance[v] > core)) continue;
    const Index root = sets.root(v);
    if (root == v) arms.push_back(v);
    sum[root] += (mesh.positions[v] - middle).head<2>();
  }
  std::stable_sort(arms.begin(), arms.end(), [&](Index a, Index b) {
    return std::atan2(sum[a][1], sum[a][0]) < std::atan2(sum[b][1], sum[b][0]);
  });
  std::vector<double> sense(mesh.positions.size(), 0.0);
  for (std::size_t i = 0; i < arms.size(); ++i) sense[arms[i]] = i % 2 == 0 ? 1 : -1;
  for (Index v = 0; v < static_cast<Index>(sense.size()); ++v) sense[v] = sense[sets.root(v)];
  return sense;
}

}  // namespace

void pose_swirl(IndexedMesh& mesh, double core, double turns) {
  if (!(core >= 0 && core < 1)) {
    throw Error("core", fmt::format("{} is not a fraction of the largest distance", core), "use a number in [0, 1)");
  }
  if (!std::isfinite(turns)) throw Error("turns", fmt::format("{} is not finite", turns), "use a finite number");
  if (mesh.positions.empty()) throw Error("", "there are no vertices to pose", "give a mesh with vertices");
  Vec3 low = mesh.positions[0], high = low;
  for (const Vec3& p : mesh.positions) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Vec3 middle = (low + high) / 2;
  std::vector<double> distance(mesh.positions.size());
  for (std::size_t v = 0; v < distance.size(); ++v) distance[v] = (mesh.positions[v] - middle).norm();
  const double largest = *std::max_element(distance.begin(), distance.end()), inner = core * largest;
  const std::vector<double> sense = arm_senses(mesh, middle, distance, inner);
  for (std::size_t v = 0; v < distance.size(); ++v) {
    if (!(distance[v] > inner)) continue;
    const double reach = (distance[v] - inner) / (largest - inner);
    const double angle = 2 * std::numbers::pi * turns * sense[v] * reach;
    const Vec3 p = mesh.positions[v] - middle;
    mesh.positions[v] = middle + Vec3(std::cos(angle) * p[0] - std::sin(angle) * p[1],
                                      std::sin(angle) * p[0] + std::cos(angle) * p[1], p[2]);
  }
}

}  // namespace selvage
