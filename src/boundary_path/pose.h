#pragma once

#include "boundary_path/path_scene.h"
#include "boundary_path/path_topology.h"

namespace selvage {

/// A pose of a mesh: scaled positions, and what is wrong with it.
template <int D>
class Pose {
 public:
  Pose(const SimplexMesh<D>& mesh, const PathTopology<D>& topology) : mesh_(mesh), topology_(topology) {}

  /// Takes new positions and examines them. O(n), parallel.
  /// @throws Error  when the number of positions is not that of the vertices, or one is not finite
  void set(std::span<const Vec<D>> positions);

  std::span<const Vec<D>> positions() const { return positions_; }
  /// positions() are the given ones times 2^-exponent(), so that the largest coordinate is about 1.
  int exponent() const { return exponent_; }
  const BoxFrame<D>& frame() const { return frame_; }

  /// positions() in the frame, each coordinate to the nearest float (the rest 0), and a bound of the error.
  std::span<const std::array<float, 4>> rounded_positions() const { return rounded_; }
  float rounding() const { return rounding_; }
  const PoseDefects& defects() const { return defects_; }
  std::span<const ComponentState> component_states() const { return component_states_; }

  /// Where the defects are, in the frame's boxes, and a hierarchy over them.
  std::span<const Defect> defect_places() const { return defect_places_; }
  const Bvh& defect_hierarchy() const { return defect_hierarchy_; }

  /// Boxes of all elements and of all boundary faces in the frame.
  std::span<const Box> element_boxes() const { return element_boxes_; }
  std::span<const Box> face_boxes() const { return face_boxes_; }

  /// Per vertex: 1 when its boundary faces are proven to be locally injective, so that candidates there may be culled.
  std::span<const std::uint8_t> cullable() const { return cullable_; }

  /// Per vertex the cone of its boundary faces' normals; unbounded where it is not cullable.
  std::span<const NormalCone> normal_cones() const { return normal_cones_; }

  /// Per boundary face: 1 when its owner is inverted or flat.
  std::span<const std::uint8_t> inverted_owners() const { return inverted_owners_; }

  int orientation_of(Index element) const;

  /// Unit outward normal of a boundary face times its length, or twice its area in space.
  Vec<D> measured_normal(Index face) const { return face_normals_[face] * face_measures_[face]; }

 private:
  void place(std::span<const Vec<D>> positions);
  void examine_elements();
  void examine_faces();
  void find_overwound_interior_ridges();
  void find_overwound_boundary_ridges();
  void list_defects();
  bool turns_once(const VertexTuple<D - 1>& ridge, std::span<const Index> open_link) const;
  Box box_of(const VertexTuple<D - 1>& ridge) const;
  void prove_boundary_vertices();
  bool is_boundary_vertex_injective(Index v, NormalCone& cone) const;

  const SimplexMesh<D>& mesh_;
  const PathTopology<D>& topology_;
  std::vector<Vec<D>> positions_;
  std::vector<std::array<float, 4>> rounded_;
  float rounding_ = 0;
  int exponent_ = 0;
  BoxFrame<D> frame_;
  std::vector<Box> element_boxes_, face_boxes_;
  std::vector<Vec<D>> face_normals_;   ///< unit, outward; zero on a flat face
  std::vector<double> face_measures_;  ///< length of the normal before: twice the area, or the length in the plane
  PoseDefects defects_;
  std::vector<ComponentState> component_states_;
  std::vector<Defect> defect_places_;
  Bvh defect_hierarchy_;
  std::vector<std::uint8_t> cullable_;
  std::vector<NormalCone> normal_cones_;
  std::vector<std::uint8_t> inverted_owners_;
};

template <>
bool Pose<2>::turns_once(const VertexTuple<1>& ridge, std::span<const Index> open_link) const;
template <>
bool Pose<3>::turns_once(const VertexTuple<2>& ridge, std::span<const Index> open_link) const;
template <>
bool Pose<2>::is_boundary_vertex_injective(Index v, NormalCone& cone) const;
template <>
bool Pose<3>::is_boundary_vertex_injective(Index v, NormalCone& cone) const;

extern template class Pose<2>;
extern template class Pose<3>;

}  // namespace selvage
