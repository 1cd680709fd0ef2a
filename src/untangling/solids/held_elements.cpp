#include "untangling/solids/held_elements.h"

#include "mesh/find_inverted.h"
#include "selvage/self_collision/self_collision.h"
#include "untangling/solids/tangle_finder.h"

#include <algorithm>

namespace selvage {

namespace {

/// Elements and faces whose vertices are all pinned, and the elements that they belong to.
struct PinnedParts {
  std::vector<VertexTuple<4>> elements;
  std::vector<VertexTuple<3>> faces;  ///< of any elements, inner ones twice
  std::vector<Index> element_numbers, face_owners;

  PinnedParts(const TetMesh& mesh, std::span<const Index> pinned) {
    std::vector<std::uint8_t> is_pinned(mesh.vertex_count());
    for (const Index v : pinned) is_pinned[v] = true;
    for (Index e = 0; e < mesh.element_count(); ++e) {
      const auto& v = mesh.elements()[e];
      const auto count = std::count_if(v.begin(), v.end(), [&](Index i) { return is_pinned[i] != 0; });
      if (count == 4) {
        elements.push_back(v);
        element_numbers.push_back(e);
      }
      for (int k = 0; k < 4 && count >= 3; ++k) {
        if (count == 3 && is_pinned[v[k]] != 0) continue;
        faces.push_back({v[(k + 1) % 4], v[(k + 2) % 4], v[(k + 3) % 4]});
        face_owners.push_back(e);
      }
    }
  }
};

}  // namespace

std::vector<Index> find_held_elements(const TetMesh& mesh, std::span<const Vec3> positions,
                                      std::span<const Index> pinned) {
  const PinnedParts parts(mesh, pinned);
  std::vector<Index> held;
  // In a mesh that is not tangled, inner faces, too, meet only where they have a vertex in common.
  if (!parts.faces.empty()) {
    const TriangleMesh faces(mesh.vertex_count(), parts.faces);
    for (const TrianglePair& pair : SelfCollisionFinder(faces, positions).find_pairs())
      for (const Index face : {pair.first, pair.second}) held.push_back(parts.face_owners[face]);
  }
  if (!parts.elements.empty()) {
    const TetMesh elements(mesh.vertex_count(), parts.elements);
    TangleFinder tangle(elements, positions);
    tangle.measure(positions);
    for (const Index e : tangle.find_elements()) held.push_back(parts.element_numbers[e]);
    for (const Index e : find_inverted(elements, positions)) held.push_back(parts.element_numbers[e]);
  }
  std::sort(held.begin(), held.end());
  held.erase(std::unique(held.begin(), held.end()), held.end());
  return held;
}

}  // namespace selvage
