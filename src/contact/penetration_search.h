#pragma once

#include "selvage/boundary_path/boundary_path.h"
#include "selvage/contact/contact_finder.h"
#include "selvage/self_collision/self_collision.h"

#include <optional>

namespace selvage {

/// A boundary vertex or edge and an element that holds a part of it.
struct Penetration {
  Index feature;      ///< see PenetrationSearch
  Index element;      ///< kNone: see PenetrationSearch::find_all()
  double middle = 0;  ///< of an edge: see middle_of_parts()
};

/// A vertex, or an element by its centroid, and an element that holds it.
struct PointInside {
  Index point;
  Index element;
};

/// Boundary vertices and edges of a mesh, and vertices and edges of colliders, with a part inside an element that
/// shares no vertex with them.
///
/// Features are numbered: first the vertices of bodies on the surface, ascending, then those of colliders, then edges
/// of the surface. Cloth holds nothing, but its vertices and edges may be inside.
///
/// The search looks only near crossings of the boundary with itself. Take an edge with a part inside an element, and
/// follow from there the material that lies in the same place: either it ends at the boundary, which the edge then
/// crosses, or the end of the edge is inside as well. So the search starts from faces that meet others, and continues
/// from each vertex that is inside to the faces around it. This reaches all but features at inverted elements, and at
/// vertices whose elements may overlap each other; these are added. See docs/how_it_works/contact.md.
class PenetrationSearch {
 public:
  /// @param surface     the boundary, cloth, then triangles of colliders: their vertices follow those of the mesh
  /// @param body_faces  the boundary's and the cloth's triangles
  /// @param positions   (surface.vertex_count())
  /// @param with_edges  whether edges are features, too
  /// @param joins_parts  whether an edge's parts in connected elements count as one; see middle_of_parts()
  PenetrationSearch(const TetMesh& mesh, const TriangleMesh& surface, Index body_faces, bool with_edges,
                    std::span<const Vec3> positions, PathOptions options = {}, bool joins_parts = true);

  Index feature_count() const { return vertex_count_ + (with_edges_ ? surface_.edge_count() : 0); }
  bool is_edge(Index feature) const { return feature >= vertex_count_; }
  /// Number of a feature among vertices or among edges.
  Index vertex_of(Index feature) const {
    const auto of_bodies = static_cast<Index>(body_vertices_.size());
    return feature < of_bodies ? body_vertices_[feature] : mesh_.vertex_count() + feature - of_bodies;
  }
  Index feature_of(Index vertex) const { return vertex_feature_[vertex]; }
  Index edge_of(Index feature) const { return feature - vertex_count_; }

  /// Takes a new pose. O(n), parallel.
  void place(std::span<const Vec3> positions);
  const PointLocator<3>& locator() const { return locator_; }
  /// Makes paths() ready for that pose: the search seldom needs them.
  void prepare_paths() { paths_.update(); }
  const BoundaryPathFinder<3>& paths() const { return paths_; }

  /// Every vertex with each element that holds it; every edge with the middle of its part inside, and an element that
  /// holds that middle; ascending. Elements on the boundary that are inverted hold nothing (SPB section 3.5).
  ///
  /// @param candidates  pairs of faces without a common vertex, ascending, no pairs of colliders: no others meet. Else
  ///                    they are searched for
  /// @param leaves_deep_edges  where bodies are crowded, their edges between two vertices that are inside are listed
  ///                           with no element and no middle: to search for these would take most of the time
  std::vector<Penetration> find_all(PenetrationCounters& counters,
                                    const std::optional<std::vector<IndexPair>>& candidates = std::nullopt,
                                    bool leaves_deep_edges = false);

  /// Whether more than one of the bodies' vertices in ten is inside, by the last find_all().
  bool is_crowded() const { return is_crowded_; }

  /// The same for features in ascending order.
  std::vector<Penetration> find(std::span<const Index> features, PenetrationCounters& counters) const;

  /// Pairs of boundary faces that meet, in the pose of the last find_all().
  std::span<const TrianglePair> crossings() const { return crossings_; }

  /// Inner vertices, and elements by their centroids, with each element that holds them and shares no vertex with them;
  /// ascending. To be called after find_all() in the same pose.
  struct Interior {
    std::vector<PointInside> vertices, centroids;
  };
  Interior find_interior() const;

 private:
  using Flags = std::vector<std::uint8_t>;
  using Extent = std::array<Vec3, 2>;

  void list_surface_pieces();
  void suspect_crossings(PenetrationCounters& counters, const std::optional<std::vector<IndexPair>>& candidates);
  std::vector<TrianglePair> meeting_pairs(std::span<const IndexPair> candidates) const;
  void suspect_defects();
  std::vector<Index> find_overlapping_stars(std::vector<Index> vertices) const;
  void suspect_around(Index vertex);
  void suspect(Index face);
  std::vector<Index> suspected_elements() const;
  bool holds_nothing(Index element) const;
  std::vector<PointInside> find_vertices(std::span<const Index> vertices) const;
  void append_collider_vertices(std::span<const Index> vertices, std::vector<PointInside>& inside) const;
  std::span<const Vec3> mesh_positions() const { return std::span(positions_).first(mesh_.vertex_count()); }
  std::vector<PointInside> find_centroids(std::span<const Index> elements) const;
  std::vector<Penetration> find_edges(std::span<const Index> edges, PenetrationCounters& counters) const;
  void append_vertices(std::span<const PointInside> inside, std::vector<Penetration>& found) const;
  std::vector<Penetration> take_deep_edges(std::span<const Penetration> vertices, std::vector<Index>& edges) const;

  const TetMesh& mesh_;
  const TriangleMesh& surface_;
  bool with_edges_, joins_parts_;
  std::vector<Index> body_vertices_;   ///< on the boundary and of cloth, ascending
  Index vertex_count_ = 0;             ///< those, and the colliders'
  std::vector<Index> vertex_feature_;  ///< per vertex: its number as a feature
  std::vector<Index> pieces_;          ///< a face of each connected piece of the surface
  std::vector<Vec3> positions_;
  PointLocator<3> locator_;
  BoundaryPathFinder<3> paths_;
  SelfCollisionFinder collisions_;
  bool collisions_placed_ = true, is_crowded_ = false;
  std::vector<TrianglePair> crossings_;
  Flags is_suspect_;             ///< per face
  std::vector<Index> suspects_;  ///< those faces
};

}  // namespace selvage
