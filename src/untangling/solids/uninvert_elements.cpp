#include "untangling/solids/uninvert_elements.h"

#include "core/parallel.h"
#include "elasticity/deformation_gradient.h"
#include "elasticity/foldover.h"
#include "mesh/find_inverted.h"
#include "mesh/vertex_regions.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

constexpr int kSweeps = 20;
constexpr int kHalvings = 12;
/// Least thickness of a target, as a part of its longest direction, where a regular element has 1.
constexpr double kMinThickness = 0.1;
/// FoldoverEnergy::squared_epsilon, as a part of the squared relative volume of the most inverted element, and at
/// least.
constexpr double kEpsilonShare = 0.04;
constexpr double kMinSquaredEpsilon = 1e-8;

/// Edges of a regular element, as columns.
Eigen::Matrix3d regular_edges() {
  Eigen::Matrix3d edges;
  edges << 1, 0.5, 0.5, 0, std::sqrt(3.0) / 2, std::sqrt(3.0) / 6, 0, 0, std::sqrt(2.0 / 3);
  return edges;
}

/// Inverse edges of the element's target: of its rest shape, or the closest one that is not nearly flat. Up to a
/// rotation, which changes no energy.
Eigen::Matrix3d inverse_target(const VertexTuple<4>& element, std::span<const Vec3> rest) {
  static const Eigen::Matrix3d inverse_regular = regular_edges().inverse();
  const Eigen::Matrix3d shape = element_edges(element, rest) * inverse_regular;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> stretches(shape.transpose() * shape);
  const double largest = stretches.eigenvalues()[2];
  Eigen::Matrix3d directions = stretches.eigenvectors();
  if (directions.determinant() < 0) directions.col(0) *= -1;
  const Eigen::Vector3d squared = stretches.eigenvalues().cwiseMax(kMinThickness * kMinThickness * largest);
  return inverse_regular * directions * squared.cwiseSqrt().cwiseInverse().asDiagonal();
}

/// Vertices connected by elements: they move one after the other, and separate clusters in parallel.
using Cluster = std::vector<Index>;

/// The elements around the vertices that move.
class Patch {
 public:
  Patch(const TetMesh& mesh, std::span<const Vec3> rest, std::span<const Index> inverted, std::span<Vec3> positions)
      : mesh_(mesh), positions_(positions) {
    std::vector<Index> core;
    for (const Index e : inverted) core.insert(core.end(), mesh.elements()[e].begin(), mesh.elements()[e].end());
    make_set(core);
    for (const Index v : core)
      for (const Index e : mesh.vertex_elements(v))
        vertices_.insert(vertices_.end(), mesh.elements()[e].begin(), mesh.elements()[e].end());
    make_set(vertices_);
    for (const Index v : vertices_)
      elements_.insert(elements_.end(), mesh.vertex_elements(v).begin(), mesh.vertex_elements(v).end());
    make_set(elements_);
    inverse_targets_.resize(elements_.size());
    parallel_for(std::ssize(elements_), kElementsAtOnce,
                 [&](std::int64_t i) { inverse_targets_[i] = inverse_target(mesh.elements()[elements_[i]], rest); });
  }

  /// In ascending order, as are the vertices of each.
  std::vector<Cluster> list_clusters() const {
    VertexRegions regions(mesh_, vertices_);
    std::vector<Cluster> clusters;
    std::vector<std::size_t> numbers(mesh_.vertex_count());
    for (const Index v : vertices_) {
      const Index region = regions.find(v);
      if (region == v) {
        numbers[v] = clusters.size();
        clusters.emplace_back();
      }
      clusters[numbers[region]].push_back(v);
    }
    return clusters;
  }

  /// The least volume of an element, relative to its target's.
  double least_volume() const {
    struct Least {
      double volume = 1;
      void add(const Least& other) { volume = std::min(volume, other.volume); }
    };
    return parallel_reduce<Least>(std::ssize(elements_), kElementsAtOnce,
                                  [&](std::int64_t first, std::int64_t last, Least& least) {
                                    for (std::int64_t i = first; i < last; ++i) least.add({gradient(i).determinant()});
                                  })
        .volume;
  }

  void set_energy(const FoldoverEnergy& energy) { energy_ = energy; }

  /// Moves a vertex down the energy of its elements.
  void move(Index vertex, const Freedom& freedom) const {
    Vec3& position = positions_[vertex];
    if (!freedom.allows(vertex, position)) return;
    const Descent at = descend(vertex, true);
    const Vec3 start = position, way = -at.curvature.ldlt().solve(at.slope);
    double part = 1;
    for (int i = 0; i < kHalvings; ++i, part /= 2) {
      position = start + part * way;
      if (freedom.allows(vertex, position) && descend(vertex, false).energy < at.energy) return;
    }
    position = start;
  }

 private:
  static constexpr std::int64_t kElementsAtOnce = 128;

  /// The energy of the elements of a vertex, and its derivatives by the position.
  struct Descent {
    double energy = 0;
    Vec3 slope = Vec3::Zero();
    Eigen::Matrix3d curvature = Eigen::Matrix3d::Zero();
  };

  static void make_set(std::vector<Index>& list) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }

  Eigen::Matrix3d gradient(std::int64_t i) const {
    return element_edges(mesh_.elements()[elements_[i]], positions_) * inverse_targets_[i];
  }

  Descent descend(Index vertex, bool with_slope) const {
    Descent sum;
    auto place = elements_.begin();
    for (const Index e : mesh_.vertex_elements(vertex)) {
      place = std::lower_bound(place, elements_.end(), e);
      add_element(place - elements_.begin(), vertex, with_slope, sum);
    }
    return sum;
  }

  void add_element(std::int64_t i, Index vertex, bool with_slope, Descent& sum) const {
    const Eigen::Matrix3d f = gradient(i);
    if (!with_slope) {
      sum.energy += energy_.energy_density(f);
      return;
    }
    const auto& corners = mesh_.elements()[elements_[i]];
    const auto k = std::find(corners.begin(), corners.end(), vertex) - corners.begin();
    const auto at = energy_.by_vertex(f, vertex_gradient(inverse_targets_[i], k));
    sum.energy += at.energy;
    sum.slope += at.gradient;
    sum.curvature += at.hessian;
  }

  const TetMesh& mesh_;
  std::span<Vec3> positions_;
  std::vector<Index> vertices_, elements_;
  std::vector<Eigen::Matrix3d> inverse_targets_;
  FoldoverEnergy energy_;
};

}  // namespace

std::vector<Index> uninvert_elements(const TetMesh& mesh, std::span<const Vec3> rest, std::span<const Index> inverted,
                                     const Freedom& freedom, std::span<Vec3> positions) {
  Patch patch(mesh, rest, inverted, positions);
  const std::vector<Cluster> clusters = patch.list_clusters();
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    const double least = patch.least_volume();
    if (least > 0) break;
    patch.set_energy({.squared_epsilon = kMinSquaredEpsilon + kEpsilonShare * least * least});
    parallel_for(std::ssize(clusters), 1, [&](std::int64_t c) {
      for (const Index v : clusters[c]) patch.move(v, freedom);
    });
  }
  return find_inverted(mesh, positions);
}

}  // namespace selvage
