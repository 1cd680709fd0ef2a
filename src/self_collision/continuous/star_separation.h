#pragma once

#include "bvh/overlap.h"
#include "selvage/mesh/triangle_mesh.h"

namespace selvage {

/// Separated stars of a moving surface. A star is all triangles around a vertex, its middle. It is separated during a
/// step when no two of its triangles meet but in their common vertices.
///
/// A star is measured once: the smallest distance between features of its triangles that share no vertex, and the
/// positions of its vertices relative to the middle. The star is separated as long as no vertex has moved by half that
/// distance, up to a motion of the star as a rigid body. See docs/how_it_works/contact.md.
class StarSeparation {
 public:
  /// @param mesh  must outlive this
  explicit StarSeparation(const TriangleMesh& mesh);

  /// Whether most stars of a sample change so little in a step that a measurement will last for several: measuring
  /// costs about as much as comparing the triangles three times.
  bool are_nearly_rigid(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1) const;

  /// Takes a step, and measures stars again that have changed their shape. O(n), parallel; deterministic.
  /// @param margin  stars count as separated where they are also if each vertex strays so far along every axis [m]
  /// @param strayed  vertices that have moved since the last place(), which had the same margin; empty: all have
  void place(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1, double margin = 0,
             std::span<const Index> strayed = {});

  /// Vertices whose stars may hold triangles that meet; ascending.
  std::span<const Index> open() const { return open_; }
  bool is_open(Index vertex) const { return is_open_[vertex] != 0; }

  /// Pairs of triangles with common vertices of which every star is open, those of the star of that vertex which have
  /// no common vertex before it: over all open stars each pair once.
  void append_pairs(Index vertex, std::vector<IndexPair>& pairs) const;

  std::int64_t count() const { return std::ssize(middles_); }
  /// How many stars were measured for this step.
  std::int64_t measured_count() const { return measured_count_; }

 private:
  /// The state of a star.
  struct Star {
    double reach = 0;           ///< how far a vertex may move as seen from the middle [m]; 0: not known
    std::uint8_t waiting = 0;   ///< steps before it is measured again
    std::uint8_t patience = 0;  ///< times in a row that this has not helped
  };

  bool update(Index vertex, std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1);
  void measure(Index vertex, std::span<const Vec3> positions);
  std::vector<Index> stars_with(std::span<const Index> vertices);
  double separation(Index vertex, std::span<const Vec3> positions) const;
  bool stays_near_turned(Index vertex, std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1) const;
  bool is_within_reach(Index vertex, std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1);
  bool is_nearly_rigid(Index vertex, std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1) const;

  std::span<const Index> around(Index vertex) const {
    return std::span(around_).subspan(first_[vertex], first_[vertex + 1] - first_[vertex]);
  }

  const TriangleMesh& mesh_;
  std::vector<Index> middles_;         ///< vertices with at least two triangles
  std::vector<Index> first_, around_;  ///< per vertex the others of its star, first two that share a triangle with it
  std::vector<Vec3> shape_;            ///< for each of them where it lay when measured, in box units of the star
  std::vector<Vec3> turned_;           ///< the same, turned as the star was when it last had to be
  std::vector<Star> stars_;            ///< per vertex
  std::vector<std::uint8_t> is_open_, is_listed_;  ///< per vertex; the second all 0 between calls
  std::vector<Index> open_;
  double slack_ = 0;  ///< of a vertex as seen from the middle, for the margin [m]
  std::int64_t measured_count_ = 0;
};

}  // namespace selvage
