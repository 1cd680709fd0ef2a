#pragma once

#include "boundary_path/injectivity/deformed_mesh.h"
#include "boundary_path/input/path_topology.h"
#include "boundary_path/location/containment.h"
#include "bvh/traverse.h"
#include "core/parallel.h"
#include "selvage/boundary_path/point_locator.h"

#include <cmath>
#include <numeric>

namespace selvage {

/// Multiplies by a power of two: by two factors, since the power itself may overflow.
class Scaling {
 public:
  Scaling() = default;
  explicit Scaling(int exponent)
      : half_(std::ldexp(1.0, exponent / 2)), rest_(std::ldexp(1.0, exponent - exponent / 2)) {}

  template <typename T>
  T operator()(const T& x) const {
    return x * half_ * rest_;
  }

 private:
  double half_ = 1, rest_ = 1;
};

/// The contents of a PointLocator, and of the BoundaryPathFinder that stands on it. The hierarchy over the faces serves
/// the finder alone: the locator never builds or refits it.
template <int D>
struct LocatorImpl {
  const SimplexMesh<D>& mesh;
  PathTopology<D> topology;
  DeformedMesh<D> pose;
  ContainmentSearch<D> containment;
  Scaling to_internal, from_internal;

  /// @throws Error  when the mesh has no element, which one made by default has not
  LocatorImpl(const SimplexMesh<D>& m, std::span<const Vec<D>> positions);

  void update(std::span<const Vec<D>> positions);
  void rebuild(std::span<const Vec<D>> positions);

  Box box_around(const std::array<Vec<D>, 2>& corners) const {
    return pose.box_around(to_internal(corners[0]), to_internal(corners[1]));
  }
  /// Whether DCD leaves the element out: inverted, and on the boundary (SPB section 3.5).
  bool is_skipped(Index element) const;
  /// A vertex and an element that holds it.
  PathQuery<D> query_of(PointInElement pair) const {
    return PathQuery<D>::of_vertex(pair.point, from_internal(pose.positions()[pair.point]), pair.element);
  }

 private:
  void take_scale();
};

extern template struct LocatorImpl<2>;
extern template struct LocatorImpl<3>;

/// Primitives of a hierarchy whose boxes meet each of some boxes.
/// @param box_of  `Box box_of(std::int64_t i)`, the i-th box
template <typename BoxOf>
NearbyItems find_near(const Bvh& bvh, std::int64_t count, BoxOf&& box_of) {
  constexpr std::int64_t kAtOnce = 64;
  std::vector<std::vector<Index>> pieces((count + kAtOnce - 1) / kAtOnce);
  NearbyItems nearby;
  nearby.first.assign(count + 1, 0);
  parallel_for(std::ssize(pieces), 1, [&](std::int64_t k) {
    for (std::int64_t i = k * kAtOnce; i < std::min((k + 1) * kAtOnce, count); ++i) {
      const std::size_t before = pieces[k].size();
      visit_overlaps(bvh.nodes(), box_of(i), [&](Index primitive) { pieces[k].push_back(primitive); });
      nearby.first[i + 1] = static_cast<std::int64_t>(pieces[k].size() - before);
    }
  });
  std::partial_sum(nearby.first.begin(), nearby.first.end(), nearby.first.begin());
  nearby.found.reserve(nearby.first.back());
  for (const auto& piece : pieces) nearby.found.insert(nearby.found.end(), piece.begin(), piece.end());
  return nearby;
}

}  // namespace selvage
