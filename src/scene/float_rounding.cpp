#include "scene/float_rounding.h"

#include "core/parallel.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>

namespace selvage {

namespace {

constexpr int kRounds = 13;  // the last one only counts; 1 unit of rounding in the first, 2 in the second...

Vec3 to_floats(const Vec3& p) {
  return p.cast<float>().cast<double>();
}

using Corners = std::array<Vec3, 3>;

/// Unit direction along which b is farthest behind a, of those that separate two triangles that are apart.
Vec3 separating_direction(const Corners& a, const Corners& b) {
  std::vector<Vec3> candidates{(a[1] - a[0]).cross(a[2] - a[0]), (b[1] - b[0]).cross(b[2] - b[0])};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) candidates.push_back((a[(i + 1) % 3] - a[i]).cross(b[(j + 1) % 3] - b[j]));
  double widest = -std::numeric_limits<double>::infinity();
  Vec3 best = Vec3::Zero();
  for (const Vec3& candidate : candidates) {
    if (!(candidate.squaredNorm() > 0)) continue;
    const Vec3 n = candidate.normalized();
    // From one corner: of coordinates far from the origin hardly a digit would be left.
    double a_low = 0, a_high = 0, b_low = std::numeric_limits<double>::infinity(), b_high = -b_low;
    for (const Vec3& p : a) a_low = std::min(a_low, n.dot(p - a[0])), a_high = std::max(a_high, n.dot(p - a[0]));
    for (const Vec3& p : b) b_low = std::min(b_low, n.dot(p - a[0])), b_high = std::max(b_high, n.dot(p - a[0]));
    for (const auto& [gap, direction] : {std::pair(b_low - a_high, n), {a_low - b_high, Vec3(-n)}})
      if (gap > widest) widest = gap, best = direction;
  }
  return best;
}

bool is_before(const TrianglePair& a, const TrianglePair& b) {
  return std::pair(a.first, a.second) < std::pair(b.first, b.second);
}

}  // namespace

std::vector<Vec3> round_to_floats(const TriangleMesh& surface, SelfCollisionFinder& finder,
                                  std::span<const Vec3> positions, std::span<const TrianglePair> pairs) {
  std::vector<Vec3> rounded(positions.size());
  parallel_for(std::ssize(positions), 4096, [&](std::int64_t v) { rounded[v] = to_floats(positions[v]); });
  if (!std::ranges::all_of(rounded, [](const Vec3& p) { return p.allFinite(); })) return rounded;
  std::map<Index, Vec3> shifts;  // of vertices, all rounds together
  std::vector<Vec3> best;
  std::size_t fewest = 0;
  for (int round = 1; round <= kRounds; ++round) {
    finder.update(rounded);
    std::vector<TrianglePair> new_pairs;
    std::ranges::set_difference(finder.find_pairs(), pairs, std::back_inserter(new_pairs), is_before);
    if (round == 1 || new_pairs.size() < fewest) fewest = new_pairs.size(), best = rounded;
    if (new_pairs.empty() || round == kRounds) break;
    std::map<Index, std::pair<Vec3, double>> moves;  // direction, and the unit of rounding
    for (const TrianglePair& pair : new_pairs) {
      const VertexTuple<3>&first = surface.triangles()[pair.first], &second = surface.triangles()[pair.second];
      const Corners a{positions[first[0]], positions[first[1]], positions[first[2]]},
          b{positions[second[0]], positions[second[1]], positions[second[2]]};
      double largest = 0;
      for (const Corners& corners : {a, b})
        for (const Vec3& p : corners) largest = std::max(largest, p.cwiseAbs().maxCoeff());
      const Vec3 apart = separating_direction(a, b);
      for (const auto& [triangle, sign] : {std::pair(first, -1.0), {second, 1.0}})
        for (const Index v : triangle) {
          auto& [direction, unit] = moves.try_emplace(v, Vec3::Zero(), 0).first->second;
          direction += sign * apart;
          unit = std::max(unit, std::numeric_limits<float>::epsilon() * largest);
        }
    }
    for (const auto& [v, move] : moves) {
      const double length = move.first.norm();
      if (length < 1e-3) continue;  // pressed from two sides: what presses gives way
      Vec3& shift = shifts.try_emplace(v, Vec3::Zero()).first->second;
      shift += round * move.second / length * move.first;
      rounded[v] = to_floats(positions[v] + shift);
    }
  }
  return best;
}

}  // namespace selvage
