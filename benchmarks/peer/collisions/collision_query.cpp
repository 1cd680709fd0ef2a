#include "peer/collisions/collision_query.h"

#include "selvage/self_collision/continuous_collision.h"

#include <algorithm>

namespace selvage::bench {

namespace {

template <typename Counters>
void add_work(CollisionWork& work, const Counters& counters) {
  work.node_pairs += counters.node_pairs;
  work.self_node_pairs += counters.self_node_pairs;
  work.tested_nodes += counters.tested_nodes;
  work.box_pairs += counters.box_pairs;
  work.exact_tests += counters.exact_tests;
}

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
    add_work(work, counters);
    return found;
  }

 private:
  const CollisionSubject& subject_;
  SelfCollisionFinder finder_;
};

class ContinuousQuery : public CollisionQuery {
 public:
  ContinuousQuery(const CollisionSubject& subject, SelfCollisionOptions options)
      : subject_(subject), finder_(subject.mesh(), subject.frame(0), subject.frame(1), std::move(options)) {}

  void run(int frame) override {
    finder_.update(subject_.frame(frame), subject_.frame(frame + 1));
    finder_.find_pairs();
  }

  FoundPairs find(int frame, CollisionWork& work) override {
    finder_.update(subject_.frame(frame), subject_.frame(frame + 1));
    ContinuousCounters counters;
    const ContinuousPairs pairs = finder_.find_pairs(&counters);
    FoundPairs found;
    for (const VertexFacePair& p : pairs.vertex_face) found.vertex_face.emplace_back(p.vertex, p.face);
    for (const EdgeEdgePair& p : pairs.edge_edge) found.edge_edge.emplace_back(p.first, p.second);
    add_work(work, counters);
    return found;
  }

 private:
  const CollisionSubject& subject_;
  ContinuousCollisionFinder finder_;
};

std::int64_t count_difference(const std::vector<IndexPair>& pairs, const std::vector<IndexPair>& others) {
  std::vector<IndexPair> missing;
  std::set_difference(pairs.begin(), pairs.end(), others.begin(), others.end(), std::back_inserter(missing));
  return std::ssize(missing);
}

}  // namespace

PairCount& PairCount::operator+=(const PairCount& other) {
  triangles += other.triangles;
  vertex_face += other.vertex_face;
  edge_edge += other.edge_edge;
  return *this;
}

PairCount FoundPairs::count() const {
  return {std::ssize(triangles), std::ssize(vertex_face), std::ssize(edge_edge)};
}

PairCount FoundPairs::count_missing_in(const FoundPairs& others) const {
  return {count_difference(triangles, others.triangles), count_difference(vertex_face, others.vertex_face),
          count_difference(edge_edge, others.edge_edge)};
}

std::unique_ptr<CollisionQuery> CollisionQuery::make(QueryKind kind, const CollisionSubject& subject,
                                                     const std::string& method) {
  SelfCollisionOptions options;
  options.simple_traversal = method == kSimpleTraversal;
  options.method = options.simple_traversal ? CullingMethod::kEnhancedDualConePublished : culling_method(method);
  if (kind == QueryKind::kContinuous) return std::make_unique<ContinuousQuery>(subject, std::move(options));
  return std::make_unique<DiscreteQuery>(subject, std::move(options));
}

int query_count(QueryKind kind, const CollisionSubject& subject) {
  return kind == QueryKind::kContinuous ? subject.frame_count() - 1 : subject.frame_count();
}

}  // namespace selvage::bench
