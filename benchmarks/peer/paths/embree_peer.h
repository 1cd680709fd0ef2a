#pragma once

#include "selvage/boundary_path/boundary_path.h"

#include <memory>

namespace selvage::bench {

/// How Embree builds the hierarchies.
enum class PeerTree {
  kMedium,  ///< surface area heuristic, binned
  kHigh,    ///< the same with spatial splits (triangles only)
  kRefit,   ///< a dynamic scene, built once and refitted
};

struct PeerSettings {
  PeerTree tree = PeerTree::kMedium;
  bool triangles = true;  ///< the boundary as Embree's triangles, else as a user geometry with one box a face
};

struct PeerPath {
  Index face = kNone;  ///< kNone: not found
  float distance = 0;
  std::array<float, 3> point{};
};

struct PeerCounters {
  std::int64_t faces_visited = 0, culled = 0, traversals = 0, elements_visited = 0, growing_walks = 0;

  PeerCounters& operator+=(const PeerCounters& other);
};

/// The method of SPB as its paper describes it, on Embree 3: the peer that the library is measured against.
///
/// Single precision; rtcPointQuery with a shrinking radius over the boundary faces, and with radius 0 over the elements
/// for vertex-element DCD; traversal with a tolerance from the boundary point towards the query's point on fixed
/// stacks; infeasible-region culling by choice; no warm start. Written from the paper and its supplement alone. Its
/// tolerances follow from the rounding of single precision: the paper's constants belong to objects of a few metres.
class EmbreePeer {
 public:
  EmbreePeer(const TetMesh& mesh, std::span<const Vec3> positions, PeerSettings settings);
  ~EmbreePeer();
  EmbreePeer(const EmbreePeer&) = delete;
  EmbreePeer& operator=(const EmbreePeer&) = delete;

  /// Takes a pose and builds both hierarchies anew.
  void rebuild(std::span<const Vec3> positions);

  /// Takes a pose and refits both hierarchies; only with PeerTree::kRefit.
  void refit(std::span<const Vec3> positions);

  /// Vertex-element DCD; pairs ordered by vertex.
  std::vector<PathQuery<3>> find_penetrating_vertices() const;

  /// @param counters  empty, or one for all
  std::vector<PeerPath> find_paths(std::span<const PathQuery<3>> queries, bool cull,
                                   PeerCounters* counters = nullptr) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace selvage::bench
