#include "boundary_path/path_topology.h"

#include "selvage/core/parallel.h"

#include <algorithm>

namespace selvage {

namespace {

/// The ridges of an element, each followed by its complement, as even permutations of the element's vertices.
constexpr int kTetRidges[6][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 2, 0, 3}, {1, 3, 2, 0}, {2, 3, 0, 1}};
constexpr int kTriangleRidges[3][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}};

template <int D>
auto& ridges_of_element() {
  if constexpr (D == 3)
    return kTetRidges;
  else
    return kTriangleRidges;
}

template <int D>
Index neighbour_behind(const SimplexMesh<D>& mesh, Index element, Index vertex) {
  const auto& vertices = mesh.elements()[element];
  return mesh.neighbours()[element][std::find(vertices.begin(), vertices.end(), vertex) - vertices.begin()];
}

/// Turns around the ridge whose complement in `start` is (from, to). False on the boundary, or when an element with a
/// smaller index is met, which then is the one to list the ridge.
template <int D>
bool collect_interior_link(const SimplexMesh<D>& mesh, Index start, Index from, Index to, std::vector<Index>& link) {
  link.assign({from, to});
  Index element = start, behind = from, apex = to;
  for (;;) {
    const Index across = neighbour_behind(mesh, element, behind);
    if (across < 0) return false;
    element = HalfFace{across}.element();
    if (element == start) break;
    if (element < start) return false;
    behind = apex;
    apex = mesh.elements()[element][HalfFace{across}.face()];
    link.push_back(apex);
  }
  link.pop_back();  // the last element leads back to `from`
  return true;
}

/// Breadth first from the boundary inward.
template <int D>
std::vector<Index> nearest_boundary_faces(const SimplexMesh<D>& mesh) {
  std::vector<Index> nearest(mesh.element_count(), kNone);
  std::vector<Index> front;
  for (Index b = 0; b < mesh.boundary_face_count(); ++b) {
    const Index owner = mesh.boundary_owners()[b].element();
    if (nearest[owner] != kNone) continue;
    nearest[owner] = b;
    front.push_back(owner);
  }
  for (std::size_t i = 0; i < front.size(); ++i) {
    for (Index across : mesh.neighbours()[front[i]]) {
      if (across < 0 || nearest[HalfFace{across}.element()] != kNone) continue;
      nearest[HalfFace{across}.element()] = nearest[front[i]];
      front.push_back(HalfFace{across}.element());
    }
  }
  return nearest;
}

}  // namespace

template <int D>
PathTopology<D>::PathTopology(const SimplexMesh<D>& mesh)
    : component_of(mesh.element_components()), hints(nearest_boundary_faces(mesh)) {
  component_count = *std::max_element(component_of.begin(), component_of.end()) + 1;

  constexpr Index kElementsAtOnce = 1 << 14;
  constexpr std::size_t kFewest = 5;
  struct Piece {
    std::vector<Fan> fans;
    std::vector<Index> links;
  };
  std::vector<Piece> pieces((mesh.element_count() + kElementsAtOnce - 1) / kElementsAtOnce);
  parallel_for(std::ssize(pieces), 1, [&](std::int64_t k) {
    std::vector<Index> link;
    const Index first = static_cast<Index>(k) * kElementsAtOnce;
    for (Index e = first; e < std::min(first + kElementsAtOnce, mesh.element_count()); ++e) {
      const auto& v = mesh.elements()[e];
      for (const auto& r : ridges_of_element<D>()) {
        if (!collect_interior_link(mesh, e, v[r[D - 1]], v[r[D]], link) || link.size() < kFewest) continue;
        Fan fan;
        for (int i = 0; i < D - 1; ++i) fan.ridge[i] = v[r[i]];
        fan.element = e;
        fan.first_link = std::ssize(pieces[k].links);
        pieces[k].fans.push_back(fan);
        pieces[k].links.insert(pieces[k].links.end(), link.begin(), link.end());
      }
    }
  });
  for (Piece& piece : pieces) {
    for (Fan& fan : piece.fans) {
      fan.first_link += std::ssize(links);
      fans.push_back(fan);
    }
    links.insert(links.end(), piece.links.begin(), piece.links.end());
    piece = {};
  }
  fans.push_back({{}, kNone, std::ssize(links)});
}

template <int D>
void collect_boundary_link(const SimplexMesh<D>& mesh, Index face, int corner, std::vector<Index>& link) {
  Index element = mesh.boundary_owners()[face].element();
  Index apex = mesh.elements()[element][mesh.boundary_owners()[face].face()];
  Index behind = mesh.boundary_faces()[face][corner];
  link.assign({behind, apex});
  for (;;) {
    const Index across = neighbour_behind(mesh, element, behind);
    if (across < 0) return;
    behind = apex;
    element = HalfFace{across}.element();
    apex = mesh.elements()[element][HalfFace{across}.face()];
    link.push_back(apex);
  }
}

template struct PathTopology<2>;
template struct PathTopology<3>;
template void collect_boundary_link<2>(const SimplexMesh<2>&, Index, int, std::vector<Index>&);
template void collect_boundary_link<3>(const SimplexMesh<3>&, Index, int, std::vector<Index>&);

}  // namespace selvage
