#include "self_collision/continuous/near_features.h"

#include "core/parallel.h"

#include <algorithm>
#include <utility>

namespace selvage {

namespace {

/// Of the mean length of an edge. More lasts for more steps, but leaves more pairs to be tested in each.
constexpr double kMarginPart = 0.03;
constexpr Index kSampledEdges = 256;
/// Where more than half of these stray, or more than one vertex in so many, all pairs are found again.
constexpr Index kSampledVertices = 64;
constexpr std::int64_t kMaxStrayedShare = 4;

/// NaN is not near anything.
bool is_near(const Vec3& a, const Vec3& b, double margin) {
  return ((a - b).array().abs() <= margin).all();
}

}  // namespace

NearFeatures::NearFeatures(const TriangleMesh& mesh) : mesh_(mesh) {}

double NearFeatures::margin_at(std::span<const Vec3> positions) const {
  const Index count = mesh_.edge_count(), asked = std::min(count, kSampledEdges);
  double sum = 0;
  for (Index i = 0; i < asked; ++i) {
    const auto& [a, b] = mesh_.edges()[static_cast<std::int64_t>(i) * count / asked];
    sum += (positions[b] - positions[a]).norm();
  }
  return asked > 0 ? kMarginPart * sum / asked : 0;
}

void NearFeatures::set_motion(double margin, const SweptSurface& motion) {
  is_set_ = true;
  margin_ = margin;
  motion_ = motion;
  vertex_face_.clear();
  edge_edge_.clear();
  strayed_.clear();
  strayed_triangles_.clear();
  is_strayed_.assign(mesh_.vertex_count(), 0);
  is_triangle_strayed_.assign(mesh_.triangle_count(), 0);
  is_listed_.assign(mesh_.vertex_count(), 0);
}

bool NearFeatures::strays(Index vertex, std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1) const {
  return !is_near(positions_t0[vertex], motion_.positions_t0()[vertex], margin_) ||
         !is_near(positions_t1[vertex], motion_.positions_t1()[vertex], margin_);
}

bool NearFeatures::find_strayed(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1) {
  const Index count = mesh_.vertex_count(), asked = std::min(count, kSampledVertices);
  Index sampled = 0;
  for (Index i = 0; i < asked; ++i)
    sampled += strays(static_cast<Index>(static_cast<std::int64_t>(i) * count / asked), positions_t0, positions_t1);
  if (2 * sampled > asked) return false;
  struct Strayed {
    std::vector<Index> vertices;
    void add(const Strayed& other) { vertices.insert(vertices.end(), other.vertices.begin(), other.vertices.end()); }
  };
  strayed_ = parallel_reduce<Strayed>(count, kGrain, [&](std::int64_t first, std::int64_t last, Strayed& strayed) {
               for (auto v = static_cast<Index>(first); v < last; ++v)
                 if (strays(v, positions_t0, positions_t1)) strayed.vertices.push_back(v);
             }).vertices;
  return kMaxStrayedShare * std::ssize(strayed_) <= count;
}

bool NearFeatures::take_strayed(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1) {
  for (const Index v : strayed_) {
    is_strayed_[v] = 1;
    for (const Index t : mesh_.vertex_triangles(v))
      if (std::exchange(is_triangle_strayed_[t], 1) == 0) strayed_triangles_.push_back(t);
  }
  is_set_ = motion_.replace(mesh_, positions_t0, positions_t1, strayed_, strayed_triangles_);
  return is_set_;
}

std::span<const std::uint8_t> NearFeatures::mark_nodes(std::span<const BvhNode> nodes) {
  node_masks_.resize(nodes.size());
  for (std::int64_t n = std::ssize(nodes) - 1; n >= 0; --n) {
    unsigned mask = 0;
    for (int i = 0; i < nodes[n].child_count; ++i) {
      const Index child = nodes[n].children[i];
      mask |= static_cast<unsigned>((child < 0 ? node_masks_[~child] : is_triangle_strayed_[child]) != 0) << i;
    }
    node_masks_[n] = static_cast<std::uint8_t>(mask);
  }
  return node_masks_;
}

void NearFeatures::set_pairs(std::span<const ContinuousResult> results) {
  const auto has_strayed = [&](const FeaturePair& pair) {
    return std::any_of(pair.vertices.begin(), pair.vertices.end(), [&](Index v) { return is_strayed_[v] != 0; });
  };
  std::erase_if(vertex_face_, has_strayed);
  std::erase_if(edge_edge_, has_strayed);
  for (const ContinuousResult& result : results) {
    vertex_face_.insert(vertex_face_.end(), result.near_vertex_face.begin(), result.near_vertex_face.end());
    edge_edge_.insert(edge_edge_.end(), result.near_edge_edge.begin(), result.near_edge_edge.end());
  }
  vertices_.clear();
  for (const auto* pairs : {&vertex_face_, &edge_edge_})
    for (const FeaturePair& pair : *pairs)
      for (const Index v : pair.vertices)
        if (std::exchange(is_listed_[v], 1) == 0) vertices_.push_back(v);
  for (const Index v : vertices_) is_listed_[v] = 0;
  for (const Index v : strayed_) is_strayed_[v] = 0;
  for (const Index t : strayed_triangles_) is_triangle_strayed_[t] = 0;
  strayed_.clear();
  strayed_triangles_.clear();
}

}  // namespace selvage
