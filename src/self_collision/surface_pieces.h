#pragma once

#include "selvage/bvh/bvh.h"
#include "selvage/mesh/triangle_mesh.h"

namespace selvage {

/// The piece of surface below each node of a hierarchy over triangles, and its contours: topology, found once.
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

  /// O(n) and parallel within each level, but for the turning of triangles, which is O(n) on one thread.
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

  /// The contours of a node's piece, one loop after the other.
  struct Contours {
    std::span<const Index> edges;  ///< directed edges; each begins where the one before it in its loop ends
    std::span<const Index> loops;  ///< end of each loop among the edges
  };
  Contours contours(Index node) const {
    return {std::span(edges_).subspan(first_edge_[node], first_edge_[node + 1] - first_edge_[node]),
            std::span(loops_).subspan(first_loop_[node], first_loop_[node + 1] - first_loop_[node])};
  }

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
  void place_triangles(const TriangleMesh& mesh, std::span<const Index> order, std::span<const char> turned);
  /// False where two triangles at an edge do not agree which side is which.
  bool link_edges(const TriangleMesh& mesh, std::span<const Index> order, std::span<const char> turned);
  void find_contours(const Bvh& bvh);
  bool is_on_contour(Index edge, const Range& range) const {
    return opposite_[edge] == kNone || !range.holds(opposite_[edge] / 3);
  }
  Index next_on_contour(Index edge, const Range& range) const;

  std::vector<TriangleMesh::Triangle> triangles_;
  std::vector<Index> opposite_;
  std::vector<Range> ranges_;
  std::vector<Index> edges_, loops_;
  std::vector<std::int64_t> first_edge_, first_loop_;
};

}  // namespace selvage
