#pragma once

#include "peer/collision_subject.h"
#include "selvage/bvh/overlap.h"

#include <memory>

namespace selvage::bench {

enum class QueryKind { kDiscrete, kContinuous };

/// What meets, as numbers; each list sorted. A query fills the lists of its kind.
struct FoundPairs {
  std::vector<IndexPair> triangles;
  std::vector<IndexPair> vertex_face, edge_edge;  ///< edges by their numbers

  std::int64_t count() const;

  /// How many of these are not among others.
  std::int64_t count_missing_in(const FoundPairs& others) const;
};

/// What a search did; sums.
struct CollisionWork {
  std::int64_t node_pairs = 0, box_pairs = 0, exact_tests = 0;
};

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
