#include "boundary_path/location/containment.h"

#include "boundary_path/location/group_order.h"
#include "core/isa.h"
#include "core/parallel.h"

#include <algorithm>
#include <numeric>

namespace selvage {

void append_found(std::vector<PointInElement>& found, PointInElement pair) {
  found.push_back(pair);
}

namespace {

/// Coordinates of a mesh, from its box origin, are below 2; what is farther out comes to here.
constexpr double kFarOutside = 8;

constexpr OwnElements kNoOwn = {kBeyondAllNodes, {}};

/// The pairs, ascending by point and then element, in linear time when no point has many.
std::vector<PointInElement> sorted(std::span<const PointInElement> pairs, std::size_t point_count) {
  std::vector<std::int64_t> next(point_count + 1, 0);  // place of the next pair of each point
  for (const PointInElement& pair : pairs) ++next[pair.point + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<PointInElement> result(pairs.size());
  for (const PointInElement& pair : pairs) result[next[pair.point]++] = pair;
  for (auto first = result.begin(), last = first; first != result.end(); first = last) {
    last = result.begin() + next[first->point];
    std::sort(first, last, [](PointInElement a, PointInElement b) { return a.element < b.element; });
  }
  return result;
}

}  // namespace

template <int D>
void ContainmentSearch<D>::rebuild() {
  boundary_order_.assign(mesh_.boundary_vertices().begin(), mesh_.boundary_vertices().end());
  order_in_space(pose_.rounded_positions(), boundary_order_);
  list_own_elements();
}

/// In one pass over all nodes in their order, so that nothing need be sorted.
template <int D>
void ContainmentSearch<D>::list_own_elements() {
  std::vector<Index> place_of(mesh_.vertex_count(), kNone);
  for (std::size_t i = 0; i < boundary_order_.size(); ++i) place_of[boundary_order_[i]] = static_cast<Index>(i);
  own_elements_.clear();
  own_elements_.resize(group_count(boundary_order_.size()));
  const std::span<const BvhNode> nodes = elements_.nodes();
  for (Index n = 0; n < std::ssize(nodes); ++n)
    for (int i = 0; i < nodes[n].child_count; ++i) {
      if (nodes[n].children[i] < 0) continue;
      for (Index v : mesh_.elements()[nodes[n].children[i]]) {
        if (place_of[v] == kNone) continue;
        auto& own = own_elements_[place_of[v] / kPacketSize];
        if (own.empty() || own.back().node != n) own.push_back({n, {}});
        own.back().points[i] |= static_cast<std::uint16_t>(1u << place_of[v] % kPacketSize);
      }
    }
  own_of_groups_.clear();
  for (auto& own : own_elements_) {
    own.push_back(kNoOwn);
    own_of_groups_.push_back(own.data());
  }
}

template <int D>
std::vector<PointInElement> ContainmentSearch<D>::find_boundary_vertices() const {
  return sorted(find({.points = pose_.positions().data(),
                      .rounded = pose_.rounded_positions().data(),
                      .ids = boundary_order_,
                      .own = own_of_groups_}),
                pose_.positions().size());
}

template <int D>
std::vector<PointInElement> ContainmentSearch<D>::find_vertices(std::span<const Index> vertices) const {
  std::vector<Index> order(vertices.begin(), vertices.end());
  order_in_space(pose_.rounded_positions(), order);
  const std::vector<const OwnElements*> own(group_count(order.size()), &kNoOwn);
  auto pairs = find({.points = pose_.positions().data(),
                     .rounded = pose_.rounded_positions().data(),
                     .ids = order,
                     .own = own,
                     .are_vertices = true});
  std::sort(pairs.begin(), pairs.end(), [](PointInElement a, PointInElement b) {
    return std::pair(a.point, a.element) < std::pair(b.point, b.element);
  });
  return pairs;
}

template <int D>
std::vector<PointInElement> ContainmentSearch<D>::find_points(std::span<const Vec<D>> points) const {
  std::vector<RoundedPosition> rounded(points.size());
  parallel_for(std::ssize(points), kGrain, [&](std::int64_t k) {
    rounded[k] = {};
    for (int i = 0; i < D; ++i)
      rounded[k][i] =
          static_cast<float>(std::clamp(points[k][i] - pose_.box_origin().position[i], -kFarOutside, kFarOutside));
  });
  std::vector<Index> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  order_in_space(rounded, order);
  const std::vector<const OwnElements*> own(group_count(points.size()), &kNoOwn);
  return sorted(find({.points = points.data(), .rounded = rounded.data(), .ids = order, .own = own}), points.size());
}

template <int D>
std::vector<PointInElement> ContainmentSearch<D>::find(const PointBatch<D>& batch) const {
  // Few groups one by one, so that there are some for each core.
  constexpr std::size_t kMaxGroups = 32, kPieces = 16;
  const std::size_t at_once = std::clamp<std::size_t>(batch.own.size() / kPieces, 1, kMaxGroups);
  const ContainmentInput<D> input{.positions = pose_.positions().data(),
                                  .elements = mesh_.elements().data(),
                                  .rounded = pose_.rounded_positions().data(),
                                  .rounding = pose_.rounding(),
                                  .nodes = elements_.nodes()};
  const auto share = [](auto all, std::size_t k, std::size_t size) {
    const auto rest = all.subspan(k * size);
    return rest.first(std::min(rest.size(), size));
  };
  std::vector<std::vector<PointInElement>> pieces((batch.own.size() + at_once - 1) / at_once);
  parallel_for(std::ssize(pieces), 1, [&](std::int64_t k) {
    const PointBatch<D> piece{.points = batch.points,
                              .rounded = batch.rounded,
                              .ids = share(batch.ids, k, at_once * kPacketSize),
                              .own = share(batch.own, k, at_once),
                              .are_vertices = batch.are_vertices};
    SELVAGE_DISPATCH(find_containing, input, piece, pieces[k]);
  });

  std::vector<PointInElement> pairs;
  for (std::size_t k = 0; k < pieces.size(); ++k)
    for (const auto& [place, element] : pieces[k])
      pairs.push_back({batch.ids[k * at_once * kPacketSize + place], element});
  return pairs;
}

template class ContainmentSearch<2>;
template class ContainmentSearch<3>;

}  // namespace selvage
