#include "peer/collisions/self_collision.h"

#include "peer/collisions/cgal_collider.h"
#include "peer/collisions/collision_query.h"
#include "peer/collisions/embree_collider.h"
#include "selvage/self_collision/self_collision.h"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace selvage::bench {

namespace {

constexpr const char *kCgal = "CGAL", *kRefitted = "Embree, refitted", *kRebuilt = "Embree, rebuilt",
                     *kMorton = "Embree, Morton";

std::string default_method() {
  return std::string(culling_method_names()[static_cast<std::size_t>(SelfCollisionOptions().method)]);
}

ColliderTree tree_of(const std::string& peer) {
  return peer == kRefitted  ? ColliderTree::kRefitted
         : peer == kRebuilt ? ColliderTree::kRebuilt
                            : ColliderTree::kMorton;
}

const char* name_of(QueryKind kind) {
  return kind == QueryKind::kContinuous ? "continuous" : "discrete";
}

class CollisionMeasurement {
 public:
  CollisionMeasurement(QueryKind kind, const CollisionSubject& subject, const SelfCollisionPlan& plan,
                       CollisionReport& report)
      : subject_(subject),
        kind_(kind),
        frames_(query_count(kind, subject)),
        report_(report),
        methods_(plan.methods),
        ours_(default_method()) {
    for (const std::string_view name : culling_method_names())
      if (plan.methods.empty()) methods_.emplace_back(name);
    if (plan.methods.empty()) methods_.emplace_back(kSimpleTraversal);
    if (!has_method(ours_)) ours_ = methods_.back();
    if (!plan.with_peers || kind != QueryKind::kDiscrete) return;
    peers_ = {kRefitted, kRebuilt, kMorton};
    cgal_ = std::make_unique<CgalCollider>(subject.mesh());
    if (cgal_->takes_mesh())
      peers_.insert(peers_.begin(), kCgal);
    else
      report.say("  CGAL left out: it takes oriented manifold surfaces only");
  }

  void count_pairs();
  void compare_peers();
  void measure_times(int threads);

 private:
  bool has_method(const std::string& name) const {
    return std::find(methods_.begin(), methods_.end(), name) != methods_.end();
  }
  std::function<void()> method_run(const std::string& method) const;
  std::function<void()> peer_run(const std::string& peer, bool in_parallel) const;
  PeerAgreement compare(const std::string& peer) const;

  /// The ratio to reach. Where pairs are few, nearly all that a hierarchy tests are neighbours, which culling
  /// can spare.
  double target(const std::string& peer) const {
    if (peer == kCgal) return 20;
    const double triangles = static_cast<double>(subject_.mesh().triangle_count()) * frames_;
    return static_cast<double>(pair_count_) < 0.1 * triangles ? 8 : 3;
  }

  const CollisionSubject& subject_;
  QueryKind kind_;
  int frames_;
  CollisionReport& report_;
  std::vector<std::string> methods_, peers_;
  std::string ours_;  ///< the method that peers are held against
  std::unique_ptr<CgalCollider> cgal_;
  std::vector<FoundPairs> truth_;  ///< the pairs of each frame, by the hierarchy alone
  std::int64_t pair_count_ = 0;
};

void CollisionMeasurement::count_pairs() {
  CollisionWork unused;
  const auto bvh = CollisionQuery::make(kind_, subject_, "bvh");
  for (int i = 0; i < frames_; ++i) {
    truth_.push_back(bvh->find(i, unused));
    pair_count_ += truth_.back().count().sum();
  }
  report_.print_count_header();
  for (const std::string& method : methods_) {
    CollisionCount count{subject_.name(), name_of(kind_), method, subject_.mesh().triangle_count(), frames_};
    const auto query = CollisionQuery::make(kind_, subject_, method);
    for (int i = 0; i < frames_; ++i) {
      const FoundPairs found = query->find(i, count.work);
      count.pairs += found.count();
      count.missed += truth_[i].count_missing_in(found);
      count.invented += found.count_missing_in(truth_[i]);
    }
    report_.add(count);
  }
}

PeerAgreement CollisionMeasurement::compare(const std::string& peer) const {
  PeerAgreement agreement{subject_.name(), peer};
  std::unique_ptr<EmbreeCollider> embree;
  if (peer != kCgal) embree = std::make_unique<EmbreeCollider>(subject_.mesh(), subject_.frame(0), tree_of(peer));
  const auto triangles = subject_.mesh().triangles();
  const auto shares_vertex = [&](const IndexPair& p) {
    return std::any_of(triangles[p.first].begin(), triangles[p.first].end(), [&](Index v) {
      return std::find(triangles[p.second].begin(), triangles[p.second].end(), v) != triangles[p.second].end();
    });
  };
  for (int i = 0; i < frames_; ++i) {
    FoundPairs theirs;
    if (embree) {
      embree->update(subject_.frame(i));
      theirs.triangles = embree->find_pairs();
    } else {
      theirs.triangles = cgal_->find_pairs(subject_.frame(i), true);
    }
    agreement.adjacent += static_cast<std::int64_t>(std::erase_if(theirs.triangles, shares_vertex));
    std::sort(theirs.triangles.begin(), theirs.triangles.end());
    agreement.pairs += theirs.count().sum();
    agreement.only_theirs += theirs.count_missing_in(truth_[i]).sum();
    agreement.only_ours += truth_[i].count_missing_in(theirs).sum();
  }
  return agreement;
}

void CollisionMeasurement::compare_peers() {
  for (const std::string& peer : peers_) report_.add(compare(peer));
}

/// A pose to all its pairs, the next frame with each call.
std::function<void()> CollisionMeasurement::method_run(const std::string& method) const {
  return [query = std::shared_ptr(CollisionQuery::make(kind_, subject_, method)), next = 0]() mutable {
    query->run(next++);
  };
}

std::function<void()> CollisionMeasurement::peer_run(const std::string& peer, bool in_parallel) const {
  if (peer == kCgal)
    return [this, in_parallel, next = 0]() mutable { cgal_->find_pairs(subject_.frame(next++), in_parallel); };
  const auto embree = std::make_shared<EmbreeCollider>(subject_.mesh(), subject_.frame(0), tree_of(peer));
  return [this, embree, next = 0]() mutable {
    embree->update(subject_.frame(next++));
    embree->find_pairs();
  };
}

void CollisionMeasurement::measure_times(int threads) {
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
  Rounds rounds;
  for (const std::string& method : methods_) rounds.add(method, method_run(method));
  for (const std::string& peer : peers_) rounds.add(peer, peer_run(peer, threads > 1));
  // The first frame is the round that is not measured.
  rounds.run(0, frames_ - 1, frames_ - 1);
  const auto ratio = [&](const std::string& slow, const std::string& fast) {
    return slow != fast && rounds.has(slow) ? rounds.ratio(slow, fast) : Duration{};
  };
  for (const std::string& method : methods_)
    report_.add(CollisionTime{subject_.name(), name_of(kind_), method, threads, rounds.mean(method),
                              ratio("bvh", method), ratio("normal-cone", method)});
  for (const std::string& peer : peers_)
    report_.add(PeerTime{subject_.name(), peer, threads, rounds.mean(peer), rounds.ratio(peer, ours_), target(peer)});
}

}  // namespace

void measure_self_collision(const CollisionSubject& subject, const SelfCollisionPlan& plan, CollisionReport& report) {
  report.say(fmt::format("\n{}: {} triangles, {} frames", subject.name(), subject.mesh().triangle_count(),
                         subject.frame_count()));
  for (const QueryKind kind : {QueryKind::kDiscrete, QueryKind::kContinuous}) {
    if (kind == QueryKind::kContinuous && !plan.with_steps) continue;
    report.say(fmt::format("  {}", name_of(kind)));
    CollisionMeasurement measurement(kind, subject, plan, report);
    measurement.count_pairs();
    measurement.compare_peers();
    report.print_time_header();
    for (const int threads : plan.threads) measurement.measure_times(threads);
  }
}

void measure_growth(std::span<const std::int64_t> triangles, int frames, CollisionReport& report) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  report.say(fmt::format("\ngrowth: a crumpled sheet, method {}, one thread", default_method()));
  double smallest = 0;
  for (const std::int64_t wanted : triangles) {
    const CollisionSubject subject("crumple", wanted, frames);
    SelfCollisionFinder finder(subject.mesh(), subject.frame(0));
    std::int64_t pairs = 0;
    int next = 0;
    Rounds rounds;
    rounds.add("ours", [&] {
      finder.update(subject.frame(next++));
      pairs = std::ssize(finder.find_pairs());
    });
    rounds.run(0, subject.frame_count() - 1, subject.frame_count() - 1);
    const double n = subject.mesh().triangle_count();
    const Duration frame = rounds.mean("ours");
    const double unit = frame.processor / (n * std::log2(n) + static_cast<double>(pairs));
    if (smallest == 0) smallest = unit;
    report.add(
        Growth{subject.name(), subject.mesh().triangle_count(), static_cast<double>(pairs), frame, unit / smallest});
  }
}

}  // namespace selvage::bench
