#pragma once

#include "contact/closest_rules.h"
#include "contact/contours/cloth_contours.h"
#include "contact/impacts/impact_search.h"
#include "contact/impacts/met_faces.h"
#include "contact/impacts/near_contacts.h"
#include "contact/input/inverted_vertices.h"
#include "contact/penetration_search.h"
#include "contact/tangled_vertices.h"
#include "contact/ways_out/common_ways_out.h"
#include "contact/ways_out/path_contact.h"
#include "contact/ways_out/ways_off_colliders.h"
#include "selvage/contact/contact_finder.h"

#include <optional>

namespace selvage {

/// What a finder keeps, and the parts of a step: ways out are in contact_paths.cpp, the rest in contact_finder.cpp.
struct ContactFinder::Impl {
  const TetMesh& mesh;
  ContactOptions options;
  TriangleMesh surface;
  Index body_faces;  ///< of the boundary and of cloth
  std::vector<Vec3> positions_t0;
  std::optional<PenetrationSearch> search;
  ImpactSearch impacts;
  MetFaces met_faces;              ///< by the last search of impacts
  std::optional<NearSearch> near;  ///< of thick cloth
  std::optional<RestPoseRule> rest_pose;
  std::optional<EuclideanRule> euclidean;
  Contours contours;                    ///< of cloth at the start of the step; none but for kHybrid
  std::optional<CommonWaysOut> common;  ///< of the shortest paths, where bodies penetrate at the start of steps only
  std::optional<WaysOffColliders> off;  ///< likewise, where there are colliders and rest positions

  std::vector<Index> inside;  ///< features of the search that penetrate at the start of the step, and have their turn
  std::vector<std::uint8_t> is_inside;
  std::vector<Index> inside_vertices, inside_edges;
  std::vector<Index> folded_vertices;  ///< by the last find_contacts() of the step
  TangledVertices tangled;             ///< at the start of the step; none but for kHybrid
  InvertedVertices inverted;           ///< at the start of the step
  std::vector<Index> pieces;    ///< connected component of each element; where whole tangles wait, or DCD is alone
  bool own_edges_rest = false;  ///< in this step: those of tangles that have a vertex
  ContactStatistics statistics;
  bool has_begun = false;  ///< any step

  Impl(const TetMesh& m, std::span<const Vec3> rest_positions, std::span<const Vec3> positions,
       std::span<const Index> vertex_objects, ContactOptions o, std::span<const VertexTuple<3>> colliders,
       ContactCloth cloth);

  /// With the colliders'.
  Index vertex_count() const { return surface.vertex_count(); }
  std::span<const Vec3> of_mesh(std::span<const Vec3> positions) const { return positions.first(mesh.vertex_count()); }
  SurfaceStep step_to(std::span<const Vec3> positions) const {
    return {surface, positions_t0, positions, mesh.boundary_face_count(), body_faces};
  }
  bool is_of_collider(Index vertex) const { return vertex >= mesh.vertex_count(); }

  bool uses_ccd() const {
    return options.splits() || (options.mode == DetectionMode::kCcd && !options.interior_points);
  }
  bool uses_dcd() const {
    return options.mode != DetectionMode::kOff && (options.interior_points || options.mode != DetectionMode::kCcd);
  }

  bool is_dcd_alone() const { return uses_dcd() && !options.splits(); }

  void begin_step(std::span<const Vec3> positions, std::int64_t step);
  void split_features(std::int64_t step);
  void take_turns(std::int64_t step);
  void find_contacts(std::span<const Vec3> positions, std::vector<Contact>& contacts);
  std::vector<PenetratingPoint> find_boundary_points(std::span<const Vec3> positions);
  void append_interior_points(std::span<const Vec3> positions, std::vector<PenetratingPoint>& points) const;
  void place(std::span<const Vec3> positions);
  std::vector<BoundaryPath<3>> find_ways_out(std::span<const PenetratingPoint> points, std::span<const Vec3> positions);
  std::vector<PieceWayOff> choose_ways_off(const std::function<bool(Index, const Vec3&)>& is_blocked);
  void append_paths(std::span<const Vec3> positions, std::vector<Contact>& contacts);
  void leave_out_own_edges(std::vector<PenetratingPoint>& points) const;
  std::vector<std::uint8_t> leave_out_waiting(std::vector<PenetratingPoint>& points);
  void append_ways_out(std::span<const Vec3> positions, std::vector<PenetratingPoint>& points,
                       std::vector<Contact>& contacts);
  void leave_out_let_in(ContinuousPairs& pairs) const;
  ContinuousPairs find_pairs(std::span<const Vec3> positions);
  StepImpacts find_impacts(std::span<const Vec3> positions);
  StepImpacts find_untangled_impacts(std::span<const Vec3> positions);
  void append_contacts(const StepImpacts& found, std::span<const Vec3> positions, std::vector<Contact>& contacts) const;
  void append_near(std::vector<Contact>& contacts);
};

}  // namespace selvage
