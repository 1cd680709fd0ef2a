#pragma once

#include "selvage/core/types.h"

namespace selvage {

/// The kind of the penetrating or moving point, and how it was detected.
enum class ContactKind : std::uint8_t {
  kVertexPath,    ///< DCD: a vertex inside an element, with its shortest path out
  kEdgePath,      ///< DCD: the middle of the part of a boundary edge that is inside, with its shortest path out
  kCentroidPath,  ///< DCD: an element's centroid inside another element, with its shortest path out
  kVertexFace,    ///< CCD: a vertex ran into a face
  kEdgeEdge,      ///< CCD: two edges ran into each other
  kContour,  ///< DCD: an edge through a face of cloth, which has no way out; both are pulled to where they cross less
};
inline constexpr int kContactKinds = 6;

/// One inequality on positions: a point that must not be behind a point of a surface,
///
///     normal . (sum over i < count of weights[i] * x[vertices[i]]) >= 0.
///
/// The weights of the point are positive and sum to 1, those of the surface are negative and sum to -1. A vertex of
/// both is listed once, with the sum of its weights; a vertex whose weight is 0 is left out. So all vertices differ,
/// and weights[i] * normal is the gradient at each. Of a point of a collider inside an element, that element is the
/// surface: the sum is 0 where it is found, and is to become `distance`.
struct Contact {
  static constexpr int kMaxVertices = 7;  ///< a centroid's four and a face's three

  ContactKind kind = ContactKind::kVertexPath;
  std::uint8_t count = 0;                      ///< vertices
  std::array<Index, kMaxVertices> vertices{};  ///< first those of the point, then those of the surface
  std::array<double, kMaxVertices> weights{};
  Vec3 normal = Vec3::Zero();     ///< unit; out of the surface, or to the side that the point came from
  Vec3 point = Vec3::Zero();      ///< of the surface: the closest boundary point, or where they met [m]
  double distance = 0;            ///< that is kept in front of the surface, where it was there before: of cloth [m].
                                  ///< For kContour: what is to be gained in a step. For a collider's point inside an
                                  ///< element: by how far that is to move off
  double time = 0;                ///< of impact, as a fraction of the step; 0 for DCD
  Index point_feature = kNone;    ///< the penetrating feature: a vertex, a boundary edge or an element, by its number
  Index surface_feature = kNone;  ///< the feature that it meets: a boundary face, or for kEdgeEdge a boundary edge
};

/// Sum of weights[i] * x[vertices[i]]: where the point is, seen from the surface [m].
Vec3 offset_of(const Contact& contact, std::span<const Vec3> positions);

/// Left side of the inequality: negative where the point is behind the surface [m].
double gap_of(const Contact& contact, std::span<const Vec3> positions);

/// Which detection finds contacts.
enum class DetectionMode : std::uint8_t {
  kOff,
  kCcd,     ///< every boundary vertex and edge by CCD; penetrations at the start of a step are not found
  kDcd,     ///< every point by DCD at the end of the step
  kHybrid,  ///< SPB section 4: points inside an element at the start of the step by DCD, all others by CCD
};

/// The boundary point that a penetrating point is sent to. All but the first are for comparison.
enum class ClosestPointRule : std::uint8_t {
  kShortestPath,  ///< SPB
  kRestPose,      ///< closest in the rest pose (SPB figures 22 and 23)
  kEuclidean,     ///< closest on the other object (SPB figure 15a); within one object the shortest path
};

struct ContactOptions {
  DetectionMode mode = DetectionMode::kHybrid;
  ClosestPointRule rule = ClosestPointRule::kShortestPath;
  bool detect_edges = true;  ///< DCD of edges and CCD of pairs of edges
  /// Interior vertices and centroids of elements too, which undoes complete overlaps (SPB section 5.2): everything by
  /// DCD at the end of the step, whatever the mode (but for kOff).
  bool interior_points = false;
  /// Gives no contacts to points and impacts at a vertex of an element that is inverted at the start of the step: the
  /// contacts would keep the element inverted, and without them the material restores it. For kHybrid without interior
  /// points this also leaves out points whose way out ends at such a vertex, and with each such point all of the tangle
  /// in which a connected piece meets itself.
  bool wait_for_inverted = false;
  /// For kHybrid without interior_points: where more than a tenth of the bodies' boundary vertices start a step inside
  /// elements, edges between two of them have no contacts, and vertices with only such neighbours have some in every
  /// third step. What is left out follows what it hangs on. So bodies that lie in one another come apart at a sixth of
  /// the cost: contacts of all points at once press the elements between them flat.
  bool take_turns = false;
  /// For kHybrid without interior_points: after the solver, what still meets is projected again, and what then still
  /// meets, or inverts an element, is held back. So what is free at the start of a step is free at its end.
  bool hold_back = true;
  /// What starts a step free meets nothing on the straight way to its end, decided exactly, or the step fails: see
  /// StepOptions. For kHybrid with edges and hold_back, without interior_points. In addition to hold_back, elements
  /// that are inverted are guarded, too, and vertices against faces of colliders.
  bool guarantee = false;
  bool cull_infeasible_regions = true;  ///< SPB section 3.6; changes no contact

  /// Whether what penetrates at the start of a step is found by DCD and all else by CCD.
  bool splits() const { return mode == DetectionMode::kHybrid && !interior_points; }
};

}  // namespace selvage
