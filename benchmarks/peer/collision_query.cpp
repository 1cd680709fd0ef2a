#include "peer/collision_query.h"

#include "selvage/self_collision/self_collision.h"

#include <algorithm>

namespace selvage::bench {

namespace {

class DiscreteQuery : public CollisionQuery {
 public:
  DiscreteQuery(const CollisionSubject& subject, SelfCollisionOptions options)
      : subject_(subject), finder_(subject.mesh(), subject.frame(0), std::move(options)) {}

  void run(int frame) override {
    finder_.update(subject_.frame(frame));
    finder_.find_pairs();
  }

  FoundPairs find(int frame, CollisionWork& work) override {
    finder_.update(subject_.frame(frame));
    SelfCollisionCounters counters;
    FoundPairs found;
    for (const TrianglePair& p : finder_.find_pairs(&counters)) found.triangles.emplace_back(p.first, p.second);
    work.node_pairs += counters.node_pairs;
    work.box_pairs += counters.box_pairs;
    work.exact_tests += counters.exact_tests;
    return found;
  }

 private:
  const CollisionSubject& subject_;
  SelfCollisionFinder finder_;
};

std::int64_t count_difference(const std::vector<IndexPair>& pairs, const std::vector<IndexPair>& others) {
  std::vector<IndexPair> missing;
  std::set_difference(pairs.begin(), pairs.end(), others.begin(), others.end(), std::back_inserter(missing));
  return std::ssize(missing);
}

}  // namespace

std::int64_t FoundPairs::count() const {
  return std::ssize(triangles);
}

std::int64_t FoundPairs::count_missing_in(const FoundPairs& others) const {
  return count_difference(triangles, others.triangles);
}

std::unique_ptr<CollisionQuery> CollisionQuery::make(QueryKind, const CollisionSubject& subject,
                                                     const std::string& method) {
  SelfCollisionOptions options;
  options.method = culling_method(method);
  return std::make_unique<DiscreteQuery>(subject, std::move(options));
}

int query_count(QueryKind, const CollisionSubject& subject) {
  return subject.frame_count();
}

}  // namespace selvage::bench
