#include "peer/paths/boundary_path.h"

#include "peer/paths/embree_peer.h"
#include "peer/paths/subject.h"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <set>

namespace selvage::bench {

namespace {

constexpr PeerSettings kSettings[] = {
    {PeerTree::kMedium, true}, {PeerTree::kMedium, false}, {PeerTree::kHigh, true},
    {PeerTree::kRefit, true},  {PeerTree::kRefit, false},
};

std::string describe(PeerSettings s) {
  const char* tree = s.tree == PeerTree::kMedium ? "medium" : s.tree == PeerTree::kHigh ? "high" : "dynamic";
  return fmt::format("{} {}", tree, s.triangles ? "triangles" : "boxes");
}

/// The setting in which the peer is fastest at each thing, found by a trial on one thread.
struct PeerChoice {
  PeerSettings build, refit, containment;
  std::vector<PeerSettings> paths;  ///< for each set of queries, with culling or without, whichever is faster
};

class PathMeasurement {
 public:
  PathMeasurement(const Subject& subject, const BoundaryPathPlan& plan, Report& report)
      : subject_(subject), plan_(plan), report_(report) {}

  void choose_settings();
  void measure_hierarchies(int threads);
  void measure_containment(int threads);
  void measure_paths(int threads, std::size_t set);
  void count_work(std::size_t set);
  void compare_paths(std::size_t set);
  void compare_containment();

 private:
  EmbreePeer make_peer(PeerSettings s) const { return {subject_.mesh(), subject_.pose(), s}; }
  BoundaryPathFinder<3> make_finder(PathOptions options = {}) const {
    return {subject_.mesh(), subject_.pose(), options};
  }
  std::vector<PathQuery<3>> sample(std::size_t set) const;
  void add_row(const std::string& measure, int threads, std::int64_t items, const std::string& item,
               const Rounds& rounds, const std::string& ours, const std::string& peer, const std::string& setting);

  const Subject& subject_;
  const BoundaryPathPlan& plan_;
  Report& report_;
  PeerChoice choice_;
};

std::vector<PathQuery<3>> PathMeasurement::sample(std::size_t set) const {
  constexpr std::int64_t kTrialQueries = 2000;
  const auto& queries = subject_.query_sets()[set].queries;
  const std::int64_t step = std::max<std::int64_t>(1, std::ssize(queries) / kTrialQueries);
  std::vector<PathQuery<3>> some;
  for (std::int64_t i = 0; i < std::ssize(queries); i += step) some.push_back(queries[i]);
  return some;
}

void PathMeasurement::choose_settings() {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const std::size_t sets = subject_.query_sets().size();
  const auto best_of_three = [](const std::function<void()>& run) {
    double best = HUGE_VAL;
    for (int i = 0; i < 3; ++i) best = std::min(best, measure(run).processor);
    return best;
  };
  double build = HUGE_VAL, refit = HUGE_VAL, containment = HUGE_VAL;
  std::vector<double> paths(sets, HUGE_VAL);
  choice_.paths.resize(sets);
  const auto keep = [](double time, double& best, PeerSettings s, PeerSettings& chosen) {
    if (time < best) {
      best = time;
      chosen = s;
    }
  };
  for (const PeerSettings s : kSettings) {
    EmbreePeer peer = make_peer(s);
    for (std::size_t k = 0; k < sets; ++k) {
      const auto queries = sample(k);
      for (bool cull : {true, false})
        keep(best_of_three([&] { peer.find_paths(queries, cull); }), paths[k], s, choice_.paths[k]);
    }
    keep(best_of_three([&] { peer.find_penetrating_vertices(); }), containment, s, choice_.containment);
    keep(best_of_three([&] { peer.rebuild(subject_.pose()); }), build, s, choice_.build);
    if (s.tree == PeerTree::kRefit) keep(best_of_three([&] { peer.refit(subject_.pose()); }), refit, s, choice_.refit);
  }
}

void PathMeasurement::add_row(const std::string& measure, int threads, std::int64_t items, const std::string& item,
                              const Rounds& rounds, const std::string& ours, const std::string& peer,
                              const std::string& setting) {
  report_.add(Row{measure, subject_.name(), threads, items, item, rounds.median(ours), rounds.median(peer),
                  rounds.ratio(peer, ours), setting, rounds.round_count()});
}

void PathMeasurement::measure_hierarchies(int threads) {
  BoundaryPathFinder<3> finder = make_finder();
  const auto pose = [&](bool before) { return before ? subject_.pose_before() : subject_.pose(); };
  {
    EmbreePeer peer = make_peer(choice_.build);
    Rounds rounds;
    rounds.add("ours", [&, before = false]() mutable { finder.rebuild(pose(before = !before)); });
    rounds.add("peer", [&, before = false]() mutable { peer.rebuild(pose(before = !before)); });
    rounds.run(plan_.seconds, plan_.fewest_rounds);
    add_row("build", threads, subject_.mesh().element_count(), "tet", rounds, "ours", "peer", describe(choice_.build));
  }
  EmbreePeer peer = make_peer(choice_.refit);
  Rounds rounds;
  rounds.add("ours", [&, before = false]() mutable { finder.update(pose(before = !before)); });
  rounds.add("peer", [&, before = false]() mutable { peer.refit(pose(before = !before)); });
  rounds.run(plan_.seconds, plan_.fewest_rounds);
  add_row("refit", threads, subject_.mesh().element_count(), "tet", rounds, "ours", "peer", describe(choice_.refit));
}

void PathMeasurement::measure_containment(int threads) {
  const BoundaryPathFinder<3> finder = make_finder();
  const EmbreePeer peer = make_peer(choice_.containment);
  Rounds rounds;
  rounds.add("ours", [&] { finder.find_penetrating_vertices(); });
  rounds.add("peer", [&] { peer.find_penetrating_vertices(); });
  rounds.run(plan_.seconds, plan_.fewest_rounds);
  add_row("vertex-tet DCD", threads, std::ssize(subject_.mesh().boundary_vertices()), "vertex", rounds, "ours", "peer",
          describe(choice_.containment));
}

void PathMeasurement::measure_paths(int threads, std::size_t set) {
  const QuerySet& q = subject_.query_sets()[set];
  const BoundaryPathFinder<3> finder = make_finder();
  const BoundaryPathFinder<3> plain = make_finder({.cull_infeasible_regions = false});
  const EmbreePeer peer = make_peer(choice_.paths[set]);
  Rounds rounds;
  rounds.add("cold", [&] { finder.find_paths(q.queries); });
  rounds.add("peer, culling", [&] { peer.find_paths(q.queries, true); });
  rounds.add("warm", [&] { finder.find_paths(q.queries, q.warm_start); });
  rounds.add("peer, no culling", [&] { peer.find_paths(q.queries, false); });
  rounds.add("no culling", [&] { plain.find_paths(q.queries); });
  rounds.run(2.5 * plan_.seconds, plan_.fewest_rounds);
  const std::string fastest = rounds.fastest({"peer, culling", "peer, no culling"});
  const auto row = [&](const std::string& ours, const std::string& theirs) {
    add_row(fmt::format("{}, {}", q.name, ours), threads, std::ssize(q.queries), "query", rounds, ours, theirs,
            describe(choice_.paths[set]) + theirs.substr(4) + (theirs == fastest ? " [fastest]" : ""));
  };
  row("cold", "peer, culling");
  row("cold", "peer, no culling");
  row("warm", fastest);
  row("no culling", fastest);
}

void PathMeasurement::count_work(std::size_t set) {
  const QuerySet& q = subject_.query_sets()[set];
  const double n = static_cast<double>(std::max<std::size_t>(q.queries.size(), 1));
  const auto count_ours = [&](const std::string& who, PathOptions options, std::span<const Index> warm_start) {
    std::vector<PathCounters> counters(q.queries.size());
    make_finder(options).find_paths(q.queries, warm_start, counters);
    PathCounters sum;
    for (const PathCounters& c : counters) sum += c;
    report_.add(Work{subject_.name(), fmt::format("{}: {}", q.name, who), std::ssize(q.queries), sum.faces_visited / n,
                     sum.volumes_visited / n, sum.culled / n, sum.traversals / n, sum.elements_visited / n,
                     sum.exact_decisions / n});
  };
  count_ours("ours, cold", {}, {});
  count_ours("ours, warm", {}, q.warm_start);
  count_ours("ours, no culling", {.cull_infeasible_regions = false}, {});
  const EmbreePeer peer = make_peer(choice_.paths[set]);
  for (bool cull : {true, false}) {
    PeerCounters sum;
    peer.find_paths(q.queries, cull, &sum);
    report_.add(Work{subject_.name(), fmt::format("{}: peer, {}", q.name, cull ? "culling" : "no culling"),
                     std::ssize(q.queries), sum.faces_visited / n, -1, sum.culled / n, sum.traversals / n,
                     sum.elements_visited / n});
  }
}

void PathMeasurement::compare_paths(std::size_t set) {
  const QuerySet& q = subject_.query_sets()[set];
  const auto ours = make_finder().find_paths(q.queries);
  const EmbreePeer peer = make_peer(choice_.paths[set]);
  for (bool cull : {true, false}) {
    Agreement a{subject_.name(), fmt::format("{}: distances, peer, {}", q.name, cull ? "culling" : "no culling")};
    Agreement::Distances distances;
    const auto theirs = peer.find_paths(q.queries, cull);
    for (std::size_t i = 0; i < ours.size(); ++i) {
      const bool found = ours[i].status == PathStatus::kFound;
      a.missing += found != (theirs[i].face != kNone);
      if (!found || theirs[i].face == kNone) continue;
      ++a.compared;
      const double difference = std::abs(ours[i].distance - theirs[i].distance);
      distances.different += difference > 1e-4 * ours[i].distance;
      distances.beyond_rounding += difference > 1e-4 * ours[i].distance + 1e-6 * subject_.extent();
      distances.worst = std::max(distances.worst, difference / subject_.extent());
    }
    a.distances = distances;
    report_.add(std::move(a));
  }
}

void PathMeasurement::compare_containment() {
  const auto pairs = [](const std::vector<PathQuery<3>>& queries) {
    std::set<std::pair<Index, Index>> set;
    for (const auto& q : queries) set.emplace(q.source[0], q.element);
    return set;
  };
  const auto ours = pairs(make_finder().find_penetrating_vertices());
  const auto theirs = pairs(make_peer(choice_.containment).find_penetrating_vertices());
  std::vector<std::pair<Index, Index>> odd;
  std::set_symmetric_difference(ours.begin(), ours.end(), theirs.begin(), theirs.end(), std::back_inserter(odd));
  report_.add(Agreement{subject_.name(), "vertex-tet DCD: pairs", std::ssize(ours), std::ssize(odd)});
}

}  // namespace

void measure_boundary_paths(const std::string& name, const IndexedMesh& file, const BoundaryPathPlan& plan,
                            Report& report) {
  const Subject subject(name, file, plan.most_queries);
  const TetMesh& mesh = subject.mesh();
  report.say(fmt::format("\n{}: {} tets, {} boundary faces, {} boundary vertices; {} inverted, {} + {} overwound", name,
                         mesh.element_count(), mesh.boundary_face_count(), mesh.boundary_vertices().size(),
                         subject.defects().inverted_elements, subject.defects().overwound_interior_ridges,
                         subject.defects().overwound_boundary_ridges));
  PathMeasurement measurement(subject, plan, report);
  measurement.choose_settings();
  report.print_header();
  const std::size_t sets = subject.query_sets().size();
  for (int threads : plan.threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    measurement.measure_hierarchies(threads);
    measurement.measure_containment(threads);
    for (std::size_t k = 0; k < sets; ++k)
      if (!subject.query_sets()[k].queries.empty()) measurement.measure_paths(threads, k);
  }
  for (std::size_t k = 0; k < sets; ++k) {
    measurement.count_work(k);
    measurement.compare_paths(k);
  }
  measurement.compare_containment();
}

}  // namespace selvage::bench
