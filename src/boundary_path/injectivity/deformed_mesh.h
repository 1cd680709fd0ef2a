#pragma once

#include "boundary_path/injectivity/injectivity_kernel.h"
#include "boundary_path/input/path_input.h"
#include "boundary_path/input/path_topology.h"
#include "selvage/geometry/predicates.h"
#include "selvage/mesh/simplex_mesh.h"

namespace selvage {

/// A pose of a mesh: scaled positions, the hierarchies over them, and where it is not locally injective.
///
/// A new pose is examined while the hierarchies are refitted: most of it in single precision with a bound of all
/// rounding, eight elements, faces or vertices at a time; what that leaves open is decided one by one, exactly.
template <int D>
class DeformedMesh {
 public:
  /// Without positions: call rebuild() first.
  DeformedMesh(const SimplexMesh<D>& mesh, const PathTopology<D>& topology);

  /// Takes new positions, builds the hierarchies anew and examines the pose. O(n log n), parallel.
  /// @throws Error  when the number of positions is not that of the vertices, or one is not finite
  void rebuild(std::span<const Vec<D>> positions) {
    rebuild_elements(positions);
    update_faces();
  }
  /// The same without the hierarchy over the faces, which update_faces() builds when it is needed.
  void rebuild_elements(std::span<const Vec<D>> positions);

  /// Takes new positions and refits the hierarchy over the elements, or rebuilds it when its quality has become poor;
  /// examines the pose. O(n), parallel.
  /// @return  whether the hierarchy over the elements is a new one
  bool update_elements(std::span<const Vec<D>> positions);
  /// The same for the hierarchy over the faces, unless it is of this pose already.
  void update_faces();
  /// Whether the hierarchy over the faces is of this pose.
  bool has_faces() const { return has_faces_; }

  /// All that a search for paths reads; valid until the next update.
  PathInput<D> path_input(const PathOptions& options) const;

  std::span<const Vec<D>> positions() const { return positions_; }
  /// positions() are the given ones times 2^-exponent(), so that the largest coordinate is about 1.
  int exponent() const { return exponent_; }
  const BoxOrigin<D>& box_origin() const { return box_origin_; }

  /// positions() from the box origin, each coordinate to the nearest float (the third 0 in the plane), and a bound of
  /// the error. Last come the bits of the vertex's number, and a sign where it is cullable(): so they arrive together.
  std::span<const std::array<float, 4>> rounded_positions() const { return rounded_; }
  float rounding() const { return rounding_; }

  const Bvh& elements() const { return elements_; }
  const Bvh& faces() const { return faces_; }
  /// On the nodes of faces().
  std::span<const ConeNode> cones() const { return cones_; }
  std::span<const LeafNode<D>> face_leaves() const { return face_leaves_; }

  const MeshDefects& defects() const { return defects_; }
  /// Inverted or flat, ascending.
  std::span<const Index> defective_elements() const { return defective_; }
  /// Per vertex: 1 when the elements around it, if all are positive, are proven to cover no direction twice.
  std::span<const std::uint8_t> locally_injective() const { return locally_injective_; }
  std::span<const ComponentState> component_states() const { return component_states_; }

  /// Where the defects are, as boxes from the box origin, and a hierarchy over them.
  std::span<const Defect> defect_places() const { return defect_places_; }
  const Bvh& defect_hierarchy() const { return defect_hierarchy_; }

  /// Per vertex: 1 when its boundary faces are proven to be locally injective, so that candidates there may be culled.
  std::span<const std::uint8_t> cullable() const { return cullable_; }

  /// Per boundary face: 1 when its owner is inverted or flat.
  std::span<const std::uint8_t> inverted_owners() const { return inverted_owners_; }

  int orientation_of(Index element) const { return orientation(corners_of(element)); }

  /// Around a box given by its corners, as they are scaled here.
  Box box_around(const Vec<D>& lower, const Vec<D>& upper) const { return box_origin_.around(lower, upper); }

 private:
  void place(std::span<const Vec<D>> positions);
  RoundedPositions rounded() const { return {rounded_.data(), rounding_}; }
  void build_elements();
  void build_faces();
  void fit_faces();
  std::array<Vec<D>, D + 1> corners_of(Index element) const;

  void examine();
  void examine_elements();
  /// @return  whether it is inverted or flat
  bool examine_doubtful(Index element);
  bool mark_rays(Index element);
  void add_ray(Index vertex, int backward, std::uint32_t elements);
  void count_rays();
  void prove_boundary_vertices();
  void prove_local_injectivity();

  void find_overwound_interior_ridges();
  void find_overwound_boundary_ridges();
  bool has_locally_injective(const VertexTuple<D - 1>& ridge) const;
  bool turns_forward(const VertexTuple<D - 1>& ridge, std::span<const Index> link, bool closed) const;
  void find_folds();
  template <std::size_t N>
  void add_defect(const std::array<Index, N>& vertices, Index component);
  template <std::size_t N>
  Box box_of(const std::array<Index, N>& vertices) const;

  const SimplexMesh<D>& mesh_;
  const PathTopology<D>& topology_;
  std::vector<Vec<D>> positions_;
  std::vector<std::array<float, 4>> rounded_;
  float rounding_ = 0;
  int exponent_ = 0;
  BoxOrigin<D> box_origin_;

  Bvh elements_, faces_;
  int face_refits_ = 0;
  bool has_faces_ = false, builds_faces_ = true;
  std::vector<LeafNode<D + 1>> element_leaves_;
  std::vector<LeafNode<D>> face_leaves_;

  std::vector<std::uint32_t> inner_rays_;  ///< see ElementTask
  std::int64_t inner_ray_count_ = 0;
  std::vector<std::uint8_t> ray_marks_;    ///< two per vertex, see ElementTask
  std::vector<std::uint32_t> ray_counts_;  ///< per inner vertex; complete only after count_rays()
  std::vector<std::uint8_t> cullable_, locally_injective_;
  bool all_inner_injective_ = false;
  std::vector<NormalBox> vertex_normals_;  ///< of boundary vertices; unbounded where not cullable
  std::vector<NormalBox> node_normals_;    ///< of the faces below each node
  std::vector<ConeNode> cones_;

  MeshDefects defects_;
  std::vector<Index> defective_;
  std::vector<ComponentState> component_states_;
  std::vector<Defect> defect_places_;
  Bvh defect_hierarchy_;
  std::vector<std::uint8_t> inverted_owners_;
};

extern template class DeformedMesh<2>;
extern template class DeformedMesh<3>;

}  // namespace selvage
