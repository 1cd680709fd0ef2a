#pragma once

#include "core/parallel.h"
#include "self_collision/surface/moving_points.h"
#include "self_collision/surface/search_progress.h"
#include "selvage/geometry/continuous.h"
#include "selvage/geometry/moving_distance.h"

#include <atomic>
#include <limits>
#include <optional>

namespace selvage {

/// When a pair meets, if it does before a time.
inline std::optional<double> impact_of(const ContinuousInput& input, const VertexFacePair& pair, double before = 1) {
  return vertex_face_impact(moving_points(input, pair.vertex, pair.face), before);
}

inline std::optional<double> impact_of(const ContinuousInput& input, const EdgeEdgePair& pair, double before = 1) {
  return edge_edge_impact(moving_edges(input, pair.first, pair.second), before);
}

/// The first time at which the pair meets or is nearer than its thickness.
inline std::optional<double> nearness_of(const ContinuousInput& input, const VertexFacePair& pair, double before) {
  const double thickness = thickness_of(input, pair.vertex, pair.face);
  const MovingPoints points = moving_points(input, pair.vertex, pair.face);
  const auto near = thickness > 0 ? vertex_face_nearness(points, thickness, before) : std::nullopt;
  // A thickness that rounding hides does not hide an impact.
  const auto impact = vertex_face_impact(points, near.value_or(before));
  return impact ? impact : near;
}

inline std::optional<double> nearness_of(const ContinuousInput& input, const EdgeEdgePair& pair, double before) {
  const double thickness = thickness_of_edges(input, pair.first, pair.second);
  const MovingPoints points = moving_edges(input, pair.first, pair.second);
  const auto near = thickness > 0 ? edge_edge_nearness(points, thickness, before) : std::nullopt;
  const auto impact = edge_edge_impact(points, near.value_or(before));
  return impact ? impact : near;
}

/// Calls `ask(i)` for each of `count` pairs, in parallel.
template <typename Ask>
void ask_pairs(std::int64_t count, SearchProgress& progress, Ask&& ask) {
  constexpr std::int64_t kAtOnce = 64;
  parallel_ranges(count, kAtOnce, [&](std::int64_t first, std::int64_t last) {
    for (std::int64_t i = first; i < last; ++i) ask(i);
    progress.add(last - first);
  });
}

template <typename Pair>
std::vector<double> impact_times(const ContinuousInput& input, std::span<const Pair> pairs, SearchProgress& progress) {
  std::vector<double> times(pairs.size());
  ask_pairs(std::ssize(pairs), progress, [&](std::int64_t i) {
    times[i] = impact_of(input, pairs[i]).value_or(std::numeric_limits<double>::quiet_NaN());
  });
  return times;
}

/// Lowers `earliest` to the first time of any of the pairs; each is searched only up to the earliest so far.
///
/// @param time_of  `inline std::optional<double> time_of(const Pair&, double before)`
template <typename Pair, typename TimeOf>
void find_earliest(const std::vector<Pair>& pairs, SearchProgress& progress, std::atomic<double>& earliest,
                   TimeOf&& time_of) {
  ask_pairs(std::ssize(pairs), progress, [&](std::int64_t i) {
    double known = earliest.load(std::memory_order_relaxed);
    const auto time = time_of(pairs[i], known);
    while (time && *time < known && !earliest.compare_exchange_weak(known, *time)) {
    }
  });
}

}  // namespace selvage
