#pragma once

#include "selvage/geometry/triangle_triangle.h"
#include "selvage/mesh/triangle_mesh.h"
#include "selvage/self_collision/pair_filters.h"

#include <compare>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>

namespace selvage {

/// Methods of self-collision culling: whole pieces of surface are left out that cannot collide with themselves. Methods
/// marked as accurate change no answer; see docs/how_it_works/self_collision_cones.md.
enum class CullingMethod : std::uint8_t {
  kBvh,                        ///< accurate: the hierarchy alone, no culling; what the other methods are compared with
  kNormalCone,                 ///< accurate: normal cone test (Volino, Magnenat-Thalmann 1994; Provot 1997)
  kDualCone,                   ///< FASTCD (Heo and others 2010) as published, without internal edges: misses pairs
  kDualConeInternal,           ///< the same with internal edges: may miss pairs
  kEnhancedDualCone,           ///< accurate: EDC (Wang and others 2018), with sufficient conditions
  kEnhancedDualConePublished,  ///< EDC as published: misses pairs
  kAuto,                       ///< accurate: planar embedding test, no cones; the fastest
};

/// The names of the methods, in the order of their numbers.
std::span<const std::string_view> culling_method_names();

/// The method of that name.
/// @throws Error  when there is none; it lists those that there are
CullingMethod culling_method(std::string_view name);

/// Options of self-collision queries.
struct SelfCollisionOptions {
  CullingMethod method = CullingMethod::kAuto;

  /// For kEnhancedDualConePublished, to compare: cull only nodes that pass all tests (the simple traversal of EDC's
  /// Fig. 13), not also what single tests record (its algorithm 3).
  bool simple_traversal = false;

  /// Also pairs of triangles that share a vertex or an edge and meet anywhere else, or share all their vertices. For
  /// discrete queries; continuous ones have no such pairs.
  bool include_adjacent = false;

  /// The finder serves one pose or step, not many: spend less time on building the hierarchy, and more on the search.
  bool asked_once = false;

  /// ContinuousCollisionFinder::update() may keep what it knows of pairs that come near for the steps after, which then
  /// look again only at what has moved otherwise. Changes no answer. False: each step is searched as if it were alone.
  bool reuse = true;

  PairFilters filters;

  /// (n_vertices) thickness of the surface at each vertex [m]; empty: none. That of a triangle or an edge is the
  /// largest of its vertices. Pairs count that are nearer than the sum of their thickness, decided up to rounding in
  /// the distance. During a step those count that come nearer at some time, and perhaps some whose distance stays up to
  /// 2^-20 (below 1e-6) of the sum above it. Not for pairs that share a vertex.
  std::vector<double> thickness;

  /// Progress: called now and then during a query for pairs, segments or times of impact, with the share that is done.
  /// The share never decreases, and is 1 at the end. One thread at a time calls, any of those that search. What it
  /// throws ends the query and leaves it; the finder stays as it was, and can be asked again.
  std::function<void(double share)> on_progress{};
};

/// Two triangles of a surface that meet; first < second, unless they are of two surfaces.
struct TrianglePair {
  Index first;
  Index second;
  TriangleContact contact;  ///< kDisjoint: they do not meet, but are nearer than their thickness

  auto operator<=>(const TrianglePair&) const = default;
};

/// The common points of two triangles that touch or cross: a segment, of equal ends where it is a point. Empty where
/// they overlap in one plane or do not meet (see intersection_segment()).
using CommonSegment = std::optional<std::array<Vec3, 2>>;

/// Statistics of a search, counted on request: queries are concurrent, so that each hands out its own. The same for any
/// number of threads.
struct SelfCollisionCounters {
  std::int64_t node_pairs = 0;        ///< pairs of nodes whose children were compared
  std::int64_t self_node_pairs = 0;   ///< those of a node with itself
  std::int64_t box_pairs = 0;         ///< pairs of triangles whose boxes meet
  std::int64_t adjacent_pairs = 0;    ///< those that share a vertex
  std::int64_t tested_nodes = 0;      ///< nodes that culling tested
  std::int64_t culled_nodes = 0;      ///< nodes that need no comparison with themselves
  std::int64_t culled_triangles = 0;  ///< triangles in them
  std::int64_t exact_tests = 0;       ///< pairs that single precision left undecided, and that filters keep

  SelfCollisionCounters& operator+=(const SelfCollisionCounters& other);
};

/// Discrete self-collision of a surface: all pairs of triangles that meet, each once, decided exactly.
///
/// Holds the hierarchy of one surface. Positions are given with every new pose and copied. Any surface is legal:
/// open, closed, of several components, non-manifold, with degenerate triangles or several in one place.
/// Thread-safe for concurrent queries; update() and rebuild() need exclusive access.
///
/// Example, built and run by the tests:
/// @include self_collision.cpp
class SelfCollisionFinder {
 public:
  /// @param mesh       topology; must outlive the finder: a temporary is refused
  /// @param positions  (n_vertices x 3) [m]
  /// @throws Error     when sizes differ, a position is not finite, or an option does not fit the mesh; update() and
  ///                   rebuild() likewise
  SelfCollisionFinder(const TriangleMesh& mesh, std::span<const Vec3> positions, SelfCollisionOptions options = {});
  SelfCollisionFinder(const TriangleMesh&&, std::span<const Vec3>, SelfCollisionOptions = {}) = delete;
  ~SelfCollisionFinder();
  SelfCollisionFinder(SelfCollisionFinder&&) noexcept;
  SelfCollisionFinder& operator=(SelfCollisionFinder&&) noexcept;

  /// Takes a new pose: refits the hierarchy in O(n), and rebuilds it when its quality has become poor.
  void update(std::span<const Vec3> positions);

  /// Takes a new pose and builds the hierarchy anew.
  void rebuild(std::span<const Vec3> positions);

  /// All pairs of triangles that meet; sorted. Triangles that share a vertex count only with `include_adjacent`.
  /// Parallel; the same for any number of threads.
  /// @param counters  null, or statistics to add those of this search to
  std::vector<TrianglePair> find_pairs(SelfCollisionCounters* counters = nullptr) const;

  /// Whether there is any pair: stops at the first.
  bool has_pairs(SelfCollisionCounters* counters = nullptr) const;

  /// All pairs with at least one of the given triangles, each once; sorted.
  /// @throws Error  when a triangle is out of range or given twice
  std::vector<TrianglePair> find_pairs_of(std::span<const Index> triangles,
                                          SelfCollisionCounters* counters = nullptr) const;

  /// All pairs (triangle of this surface, triangle of another) that meet; sorted. The surfaces have no vertex in
  /// common. Thickness counts on both sides; filters, which speak of one surface, do not. O(n) for both, besides the
  /// search.
  std::vector<TrianglePair> find_pairs_with(const SelfCollisionFinder& other,
                                            SelfCollisionCounters* counters = nullptr) const;

  /// The common points of the triangles of each pair, one answer a pair; a shared vertex or edge is included. Whether
  /// there is a segment, and whether it is a point, is exact; its ends are rounded.
  /// @throws Error  when a triangle is out of range
  std::vector<CommonSegment> find_segments(std::span<const TrianglePair> pairs) const;

  /// The same for pairs that find_pairs_with() gave.
  /// @throws Error  when a triangle is out of range
  std::vector<CommonSegment> find_segments_with(const SelfCollisionFinder& other,
                                                std::span<const TrianglePair> pairs) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace selvage
