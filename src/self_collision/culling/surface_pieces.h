#pragma once

#include "bvh/bvh.h"
#include "core/unset_vector.h"
#include "selvage/mesh/triangle_mesh.h"

#include <memory>

namespace selvage {

/// The piece of surface below each node of a hierarchy over triangles: topology, found once.
///
/// Triangles stand in the order of the leaves, so that those below a node are neighbours, and are turned so that
/// neighbours across an edge agree on which side is which, as far as that can be. A directed edge is 3 * place + i: of
/// the triangle at that place, from its vertex i to vertex i + 1, with the triangle at its left.
///
/// A contour of a piece is a closed loop of directed edges that no other triangle of the piece continues. An edge with
/// three or more triangles, or whose two triangles cannot agree on a side, belongs to the contours of every piece that
/// has it, once for each of its triangles. Where two fans of a piece meet in one vertex only, the contours pass through
/// that vertex once for each fan.
class SurfacePieces {
 public:
  SurfacePieces() = default;

  /// O(n), parallel but for the turning of triangles and the sizes of nodes.
  SurfacePieces(const TriangleMesh& mesh, const Bvh& bvh);

  /// (n_triangles) vertices of the triangles in the order of the leaves, turned.
  std::span<const TriangleMesh::Triangle> triangles() const { return triangles_; }

  struct Range {
    Index first;
    Index last;

    bool holds(Index place) const { return first <= place && place < last; }
    Index size() const { return last - first; }
  };

  /// (n_nodes) places of the triangles below each node.
  std::span<const Range> ranges() const { return ranges_; }

  /// The contours of a piece, one loop after the other.
  struct Contours {
    std::vector<Index> edges;  ///< directed edges; each begins where the one before it in its loop ends
    std::vector<Index> loops;  ///< end of each loop among the edges
  };

  /// The contours of a node's piece: traced when they are first asked for, in O(triangles below it), and kept. Most
  /// nodes are never asked. Thread-safe for different nodes.
  /// @param workspace  memory of one thread
  const Contours& contours(Index node, std::vector<char>& workspace);

  /// Vertex where a directed edge begins, and where it ends.
  Index tail(Index edge) const { return triangles_[edge / 3][edge % 3]; }
  Index head(Index edge) const { return tail(next_in_triangle(edge)); }

  /// The same edge of the triangle at its other side, in the other direction; kNone on a border of the whole surface,
  /// and where the triangles at an edge are too many or cannot agree.
  Index opposite(Index edge) const { return opposite_[edge]; }

  /// The child of a node that holds the triangle at a place.
  int child_at(std::span<const BvhNode> nodes, Index node, Index place) const;

 private:
  static Index next_in_triangle(Index edge) { return edge % 3 == 2 ? edge - 2 : edge + 1; }
  /// @param turned  for each triangle of the mesh whether it is listed the other way round; empty: none is
  /// @return the place of each triangle; opposite_ tells what lies across as the mesh does
  UnsetVector<Index> place_triangles(const TriangleMesh& mesh, std::span<const BvhNode> nodes,
                                     std::span<const char> turned);
  void link_edges(std::span<const char> turned, std::span<const Index> place_of);
  Contours trace_contours(Index node, std::vector<char>& workspace) const;

  UnsetVector<TriangleMesh::Triangle> triangles_;
  UnsetVector<Index> opposite_;
  UnsetVector<Range> ranges_;
  std::vector<std::unique_ptr<const Contours>> contours_;
};

}  // namespace selvage
