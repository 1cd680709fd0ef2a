#include "peer/collisions/cgal_collider.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>

namespace selvage::bench {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using FacePair = std::pair<Mesh::Face_index, Mesh::Face_index>;

}  // namespace

struct CgalCollider::State {
  Mesh mesh;
  bool is_whole = true;
};

CgalCollider::CgalCollider(const TriangleMesh& mesh) : state_(std::make_unique<State>()) {
  Mesh& own = state_->mesh;
  for (Index v = 0; v < mesh.vertex_count(); ++v) own.add_vertex(Kernel::Point_3(0, 0, 0));
  const auto vertex = [](Index v) { return Mesh::Vertex_index(static_cast<Mesh::size_type>(v)); };
  for (const auto& t : mesh.triangles())
    state_->is_whole &= own.add_face(vertex(t[0]), vertex(t[1]), vertex(t[2])) != Mesh::null_face();
}

CgalCollider::~CgalCollider() = default;

bool CgalCollider::takes_mesh() const {
  return state_->is_whole;
}

std::vector<IndexPair> CgalCollider::find_pairs(std::span<const Vec3> positions, bool in_parallel) {
  namespace pmp = CGAL::Polygon_mesh_processing;
  Mesh& mesh = state_->mesh;
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const Vec3& x = positions[v];
    mesh.point(Mesh::Vertex_index(static_cast<Mesh::size_type>(v))) = Kernel::Point_3(x[0], x[1], x[2]);
  }
  std::vector<FacePair> found;
  if (in_parallel)
    pmp::self_intersections<CGAL::Parallel_tag>(mesh, std::back_inserter(found));
  else
    pmp::self_intersections<CGAL::Sequential_tag>(mesh, std::back_inserter(found));
  std::vector<IndexPair> pairs;
  pairs.reserve(found.size());
  for (const auto& [f, g] : found) {
    const Index a = static_cast<Index>(f.idx()), b = static_cast<Index>(g.idx());
    pairs.emplace_back(std::min(a, b), std::max(a, b));
  }
  return pairs;
}

}  // namespace selvage::bench
