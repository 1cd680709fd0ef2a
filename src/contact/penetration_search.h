#pragma once

#include "contact/element_blocks.h"
#include "selvage/bvh/overlap.h"
#include "selvage/contact/contact_finder.h"
#include "selvage/mesh/triangle_mesh.h"

namespace selvage {

/// A boundary vertex or edge and an element that holds a part of it.
struct Penetration {
  Index feature;  ///< see PenetrationSearch
  Index element;
  double middle = 0;  ///< of an edge: see middle_of_part()
};

/// Which boundary vertices and edges have a part inside an element that shares no vertex with them.
///
/// Features are numbered: first boundary vertices in their order, then edges of the surface.
///
/// Not every pose is searched. In a reference pose each feature learns a lower bound of its distance to all those
/// elements: its clearance. While every vertex of the feature has moved differently from every vertex of an element by
/// less than that, the two cannot have met: a point of the one and a point of the other have moved as weighted means of
/// their vertices, so by no more differently. What two blocks of vertices have moved differently, as seen from where
/// one of them was, is a question of two affine maps and what these leave over; that is all that most features ever
/// need. The others are searched for among the elements of a block that may be there. It holds for any motion, of
/// inverted elements too. See docs/contact.md.
class PenetrationSearch {
 public:
  /// @param with_edges  whether edges are features, too
  PenetrationSearch(const TetMesh& mesh, const TriangleMesh& surface, bool with_edges, std::span<const Vec3> positions);

  Index feature_count() const { return static_cast<Index>(features_.size()); }
  bool is_edge(Index feature) const { return feature >= vertex_count_; }
  /// Number of a feature among boundary vertices' or among edges' own.
  Index vertex_of(Index feature) const { return features_[feature][0]; }
  Index edge_of(Index feature) const { return feature - vertex_count_; }

  /// Takes a new pose, and it alone for reference where the last one has become too old.
  void place(std::span<const Vec3> positions);

  /// Every vertex with each element that holds it, every edge with the one of them whose part has its middle closest to
  /// that of the edge; ascending. Elements on the boundary that are inverted hold nothing (SPB section 3.5).
  std::vector<Penetration> find_all(PenetrationCounters& counters);

  /// The same for features in ascending order.
  std::vector<Penetration> find(std::span<const Index> features, PenetrationCounters& counters) const;

 private:
  struct Findings {
    std::vector<Penetration> found;
    PenetrationCounters counters;
    std::int64_t avoidable = 0;  ///< searches that a younger reference might have spared
  };

  /// Of a group: blocks near it, how many of its features are of interest to each, and boxes of these.
  struct Scratch {
    std::vector<IndexPair> near;
    std::vector<Boxes<8>> boxes;
  };

  void group_features();
  void take_reference();
  float clearance_of(Index feature) const;
  Range range_of(Index feature) const;
  std::span<Index> members_of(Index group);
  std::span<const Index> members_of(Index group) const;
  void search_group(Index group, Scratch& scratch, Findings& findings) const;
  Index count_below(std::span<const Index> members, double bound) const;
  void search_near(Index feature, Findings& findings) const;
  void search_block(Index feature, Index block, Findings& findings) const;
  void test(Index feature, Index element, Findings& findings) const;
  std::vector<Penetration> merge(std::vector<Findings>& pieces, PenetrationCounters& counters) const;

  const TetMesh& mesh_;
  const TriangleMesh& surface_;
  Index vertex_count_ = 0;
  std::vector<VertexTuple<2>> features_;        ///< vertices; of a vertex twice the same
  std::vector<Index> members_, members_first_;  ///< features by the block they are on, and there by clearance
  std::vector<Vec3> positions_;
  ElementBlocks blocks_;
  std::vector<float> clearances_;
  std::int64_t avoidable_ = 0;
  std::int64_t references_ = 0;  ///< not counted yet
};

}  // namespace selvage
