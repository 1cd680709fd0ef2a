#include "contact/impacts/met_faces.h"

#include "core/same_bits.h"

#include <algorithm>
#include <utility>

namespace selvage {

namespace {

/// Where more pairs of features meet than one in so many faces, a search costs no more than to test their faces.
constexpr std::int64_t kFacesPerPair = 64;

bool share_vertex(const TriangleMesh::Triangle& a, const TriangleMesh::Triangle& b) {
  return std::find_first_of(a.begin(), a.end(), b.begin(), b.end()) != a.end();
}

}  // namespace

void MetFaces::note(std::span<const Vec3> positions_t1, const ContinuousPairs& pairs) {
  const std::int64_t count = std::ssize(pairs.vertex_face) + std::ssize(pairs.edge_edge);
  is_noted_ = kFacesPerPair * count <= surface_.triangle_count();
  if (!is_noted_) return;
  positions_.assign(positions_t1.begin(), positions_t1.end());
  pairs_ = pairs;
}

void MetFaces::append(std::span<const Index> first, std::span<const Index> second,
                      std::vector<IndexPair>& candidates) const {
  for (const Index a : first)
    for (const Index b : second)
      if (std::min(a, b) < body_faces_ && !share_vertex(surface_.triangles()[a], surface_.triangles()[b]))
        candidates.emplace_back(std::min(a, b), std::max(a, b));
}

std::optional<std::vector<IndexPair>> MetFaces::take_candidates(std::span<const Vec3> positions,
                                                                std::span<const TrianglePair> at_start) {
  if (!std::exchange(is_noted_, false)) return std::nullopt;
  if (kFacesPerPair * std::ssize(at_start) > surface_.triangle_count()) return std::nullopt;
  if (!are_same_bits(positions, positions_)) return std::nullopt;
  std::vector<IndexPair> candidates;
  for (const TrianglePair& pair : at_start) candidates.emplace_back(pair.first, pair.second);
  for (const auto& [vertex, face] : pairs_.vertex_face)
    append(surface_.vertex_triangles(vertex), {&face, 1}, candidates);
  for (const auto& [a, b] : pairs_.edge_edge)
    append(surface_.edge_triangles(a), surface_.edge_triangles(b), candidates);
  std::sort(candidates.begin(), candidates.end());
  candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
  return candidates;
}

}  // namespace selvage
