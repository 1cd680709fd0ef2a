#pragma once

#include "bvh/overlap.h"
#include "peer/collisions/collision_subject.h"

#include <memory>

namespace selvage::bench {

enum class QueryKind { kDiscrete, kContinuous };

/// How many pairs there are of each kind.
struct PairCount {
  std::int64_t triangles = 0, vertex_face = 0, edge_edge = 0;

  std::int64_t sum() const { return triangles + vertex_face + edge_edge; }
  PairCount& operator+=(const PairCount& other);
};

/// Pairs that meet, as numbers; each list sorted. A query fills the lists of its kind.
struct FoundPairs {
  std::vector<IndexPair> triangles;
  std::vector<IndexPair> vertex_face, edge_edge;  ///< edges by their numbers

  PairCount count() const;

  /// How many of these are not among others.
  PairCount count_missing_in(const FoundPairs& others) const;
};

/// Counters of a search; sums.
struct CollisionWork {
  std::int64_t node_pairs = 0, self_node_pairs = 0, tested_nodes = 0, box_pairs = 0, exact_tests = 0;
};

/// A method that the library has no name for: enhanced-dual-cone-published without what EDC's algorithm 3 skips.
inline constexpr const char* kSimpleTraversal = "published, simple traversal";

/// One culling method of the library on one subject: from a new pose to all its pairs.
class CollisionQuery {
 public:
  static std::unique_ptr<CollisionQuery> make(QueryKind kind, const CollisionSubject& subject,
                                              const std::string& method);
  virtual ~CollisionQuery() = default;

  /// Takes the frame and finds its pairs, to be timed.
  virtual void run(int frame) = 0;

  /// The same, and tells them.
  virtual FoundPairs find(int frame, CollisionWork& work) = 0;
};

/// How many frames a query of that kind has: poses, or steps from one pose to the next.
int query_count(QueryKind kind, const CollisionSubject& subject);

}  // namespace selvage::bench
