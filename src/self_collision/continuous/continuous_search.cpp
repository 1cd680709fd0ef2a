#include "self_collision/continuous/continuous_search.h"

#include "core/parallel.h"
#include "self_collision/surface/neighbour_pairs.h"
#include "self_collision/surface/search_progress.h"

#include <algorithm>

namespace selvage {

namespace {

bool do_share_vertex(const ContinuousInput& input, const IndexPair& pair) {
  const auto &a = input.triangles[pair.first].vertices, &b = input.triangles[pair.second].vertices;
  return std::find_first_of(a.begin(), a.end(), b.begin(), b.end()) != a.end();
}

}  // namespace

std::vector<ContinuousResult> search_all(const Bvh& bvh, const ContinuousInput& input, std::atomic<bool>* stop,
                                         const SelfCollisionOptions& reporting) {
  const PairWork work = split_self_pair_work(
      bvh, piece_count(bvh), [&](NodePair pair) { return !input.culled.holds(bvh.nodes().data(), pair); });
  std::vector<ContinuousResult> results(work.pieces.size() + 1);
  results.back().counters.node_pairs = work.compared;
  results.back().counters.self_node_pairs = work.compared_selves;
  for (ContinuousResult& result : results) result.stop = stop;
  SELVAGE_DISPATCH(test_listed_pairs, input, work.found, results.back());
  SearchProgress progress(reporting, std::ssize(results));
  parallel_for(std::ssize(work.pieces), 1, [&](std::int64_t i) {
    SELVAGE_DISPATCH(find_continuous_collisions, input, work.pieces[i], results[i]);
    progress.add(1);
  });
  progress.add(1);
  return results;
}

std::vector<ContinuousResult> search_beside_stars(const Bvh& bvh, const ContinuousInput& input,
                                                  const StarSeparation& stars, const MarkedVertices* strayed,
                                                  std::atomic<bool>* stop, const SelfCollisionOptions& reporting) {
  constexpr std::int64_t kStarsAtOnce = 64;
  SelfWork work = split_self_work(bvh, input.neighbours, input.culled, piece_count(bvh));
  const auto has_strayed = [&](const IndexPair& pair) {
    return strayed == nullptr || (strayed->triangle_marks()[pair.first] | strayed->triangle_marks()[pair.second]) != 0;
  };
  std::erase_if(work.found, [&](const IndexPair& pair) { return !has_strayed(pair) || do_share_vertex(input, pair); });
  const std::span<const Index> open = stars.open();
  const std::int64_t cut = std::ssize(work.pieces);
  const std::int64_t run_count = (std::ssize(open) + kStarsAtOnce - 1) / kStarsAtOnce;
  std::vector<ContinuousResult> results(cut + run_count + 1);
  results.back().counters.node_pairs = work.counters.node_pairs;
  results.back().counters.self_node_pairs = work.counters.self_node_pairs;
  for (ContinuousResult& result : results) result.stop = stop;
  SELVAGE_DISPATCH(test_listed_pairs, input, work.found, results.back());
  SearchProgress progress(reporting, std::ssize(results));
  parallel_ranges(cut + run_count, 1, [&](std::int64_t first, std::int64_t last) {
    const std::int64_t pieces_end = std::clamp(cut, first, last);
    if (first < pieces_end)
      SELVAGE_DISPATCH(find_nonadjacent_collisions, input, std::span(work.pieces).subspan(first, pieces_end - first),
                       results[first]);
    std::vector<IndexPair> pairs;
    for (std::int64_t run = pieces_end; run < last; ++run)
      for (std::int64_t i = kStarsAtOnce * (run - cut); i < std::min(kStarsAtOnce * (run - cut + 1), std::ssize(open));
           ++i)
        stars.append_pairs(open[i], pairs);
    std::erase_if(pairs, [&](const IndexPair& pair) { return !has_strayed(pair); });
    if (!pairs.empty()) SELVAGE_DISPATCH(test_listed_pairs, input, pairs, results[last - 1]);
    progress.add(last - first);
  });
  progress.add(1);
  return results;
}

std::vector<ContinuousResult> search_near(const ContinuousInput& input, const NearFeatures& near,
                                          std::atomic<bool>* stop, const SelfCollisionOptions& reporting) {
  constexpr std::int64_t kAtOnce = 256;
  const std::span<const FeaturePair> pairs[] = {near.vertex_face(), near.edge_edge()};
  const auto run_count = [&](int kind) { return (std::ssize(pairs[kind]) + kAtOnce - 1) / kAtOnce; };
  std::vector<ContinuousResult> results(run_count(0) + run_count(1));
  SearchProgress progress(reporting, std::ssize(results) + 1);
  parallel_for(std::ssize(results), 1, [&](std::int64_t i) {
    const int kind = i < run_count(0) ? 0 : 1;
    const std::int64_t first = kAtOnce * (i - (kind == 0 ? 0 : run_count(0)));
    const auto some = pairs[kind].subspan(first, std::min(kAtOnce, std::ssize(pairs[kind]) - first));
    results[i].stop = stop;
    if (stop == nullptr || !stop->load(std::memory_order_relaxed))
      SELVAGE_DISPATCH(test_listed_features, input, kind == 0 ? some : std::span<const FeaturePair>(),
                       kind == 0 ? std::span<const FeaturePair>() : some, results[i]);
    progress.add(1);
  });
  progress.add(1);
  return results;
}

}  // namespace selvage
