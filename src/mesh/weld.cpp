#include "selvage/mesh/weld.h"

#include "selvage/core/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace selvage {

std::vector<Index> find_first_in_place(std::span<const Vec3> positions, std::span<const Vec3> end_positions) {
  if (!end_positions.empty() && end_positions.size() != positions.size())
    throw Error("weld", fmt::format("{} and {} positions", positions.size(), end_positions.size()),
                "give two poses of one mesh");
  std::vector<Index> order(positions.size());
  std::iota(order.begin(), order.end(), 0);
  const auto differ_in = [&](std::span<const Vec3> pose, Index a, Index b) {
    const Vec3 &p = pose[static_cast<std::size_t>(a)], &q = pose[static_cast<std::size_t>(b)];
    int axis = 0;
    while (axis < 3 && p[axis] == q[axis]) ++axis;
    return axis;
  };
  const auto is_same = [&](Index a, Index b) {
    return differ_in(positions, a, b) == 3 && (end_positions.empty() || differ_in(end_positions, a, b) == 3);
  };
  std::sort(order.begin(), order.end(), [&](Index a, Index b) {
    for (const std::span<const Vec3> pose : {positions, end_positions}) {
      if (pose.empty()) continue;
      const int axis = differ_in(pose, a, b);
      if (axis < 3) return pose[static_cast<std::size_t>(a)][axis] < pose[static_cast<std::size_t>(b)][axis];
    }
    return a < b;
  });
  std::vector<Index> first(positions.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Index v = order[i];
    const bool follows = i > 0 && is_same(order[i - 1], v);
    first[static_cast<std::size_t>(v)] = follows ? first[static_cast<std::size_t>(order[i - 1])] : v;
  }
  return first;
}

std::vector<Index> weld_triangles(IndexedMesh& mesh, std::span<const Index> first) {
  if (first.size() != mesh.positions.size())
    throw Error("weld", fmt::format("{} vertices for {}", first.size(), mesh.positions.size()), "give one per vertex");
  if (!mesh.tetrahedra.empty()) throw Error("weld", "the mesh has tetrahedra", "give a surface");
  std::vector<Index> kept;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    auto& [a, b, c] = mesh.triangles[t];
    for (Index* v : {&a, &b, &c}) *v = first[static_cast<std::size_t>(*v)];
    if (a != b && b != c && c != a) kept.push_back(static_cast<Index>(t));
  }
  if (kept.size() == mesh.triangles.size()) return {};
  const auto keep = [&](auto& labels) {
    if (labels.empty()) return;
    for (std::size_t i = 0; i < kept.size(); ++i) labels[i] = labels[static_cast<std::size_t>(kept[i])];
    labels.resize(kept.size());
  };
  keep(mesh.triangles);
  keep(mesh.faces);
  keep(mesh.groups);
  return kept;
}

}  // namespace selvage
