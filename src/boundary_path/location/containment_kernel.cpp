#include "boundary_path/location/containment_kernel.h"

#include "boundary_path/location/element_split.h"
#include "boundary_path/location/point_group.h"
#include "boundary_path/traversal/segment.h"
#include "selvage/geometry/predicates.h"

namespace selvage {
inline namespace SELVAGE_ISA {

namespace {

constexpr std::int32_t kLanes[8] = {0, 1, 2, 3, 4, 5, 6, 7};
constexpr std::uint16_t kNoPoints[8] = {};

/// Descends the hierarchy over the elements with a group of points at a time: first to elements that have points near
/// their boxes, then to those that have some inside, which are compared with the points eight elements at a time. Few
/// branches: none of what happens at a node can be predicted.
template <int D>
class GroupSearch {
 public:
  GroupSearch(const ContainmentInput<D>& input, const PointBatch<D>& batch, std::vector<PointInElement>& found)
      : input_(input), batch_(batch), found_(found), waiting_(256) {}

  /// One group of the batch. Level by level, so that nodes have arrived when their turn comes, and in the order of
  /// their places.
  void search(Index number) {
    first_ = number * kPacketSize;
    const auto ids = batch_.ids.subspan(first_);
    group_ =
        PointGroup(batch_.rounded, ids.first(ids.size() < kPacketSize ? ids.size() : kPacketSize), input_.rounding);
    own_ = batch_.own[number];
    waiting_[0] = 0;
    end_ = 1;
    for (std::size_t next = 0; next < end_; ++next) {
      if (waiting_.size() < end_ + BvhNode::kWidth) waiting_.resize(2 * waiting_.size());
      traversal::prefetch_node(input_.nodes[waiting_[next + kAhead < end_ ? next + kAhead : next]]);
      visit(waiting_[next]);
      if (near_count_ > kMaxNear - BvhNode::kWidth) decide_near();
    }
    decide_near();
  }

 private:
  static constexpr std::size_t kAhead = 6;
  static constexpr int kMaxNear = 256;

  /// Sorts the children that have points near into nodes to visit and elements, without a branch.
  SELVAGE_INLINE void visit(Index place) {
    const BvhNode& node = input_.nodes[place];
    // None is passed over, as the box of an own element holds the points that own it.
    const bool has_own = own_->node == place;
    const Int8 points = group_.near_children(node) & ~Int8::load(has_own ? own_->points : kNoPoints);
    own_ += has_own;
    const Int8 children = Int8::load(node.children);
    const unsigned near = ~zero(points) & node.present();
    const unsigned nodes = near & negative(children), elements = near & ~nodes;
    store_packed(~children, nodes, waiting_.data() + end_);
    end_ += count_lanes(nodes);
    Int8::broadcast(place).store(near_.node + near_count_);
    store_packed(Int8::load(kLanes), elements, near_.child + near_count_);
    store_packed(points, elements, near_.points + near_count_);
    near_count_ += count_lanes(elements);
  }

  /// Drops elements that have points near, but not in their boxes.
  void decide_near() {
    int count = 0;
    for (int i = 0; i < near_count_; ++i) {
      const BvhNode& node = input_.nodes[near_.node[i]];
      const unsigned points = group_.in_child(node, near_.child[i], static_cast<unsigned>(near_.points[i]));
      pending_[count] = {node.children[near_.child[i]], points};
      count += points != 0;
    }
    near_count_ = 0;
    decide_pending(count);
  }

  void decide_pending(int count) {
    constexpr int kAtOnce = ElementSplits<D>::kSize;
    for (int begin = 0; begin < count; begin += kAtOnce) {
      const int n = count - begin < kAtOnce ? count - begin : kAtOnce;
      const VertexTuple<D + 1>* elements[kAtOnce];
      for (int i = 0; i < kAtOnce; ++i) elements[i] = input_.elements + pending_[begin + (i < n ? i : 0)].element;
      for (int i = begin + kAtOnce; i < begin + 2 * kAtOnce && i < count; ++i)
        prefetch(input_.elements + pending_[i].element);
      const ElementSplits<D> splits(input_.rounded, input_.rounding, elements);
      for (int i = 0; i < n; ++i) {
        const PointSides sides = splits.sides(i, group_.position(), pending_[begin + i].points);
        for (unsigned rest = sides.inside | sides.unsure; rest != 0; rest &= rest - 1) {
          const int lane = lowest_lane(rest);
          if (batch_.are_vertices && is_own(first_ + lane, *elements[i])) continue;
          if ((sides.inside >> lane & 1u) != 0 || is_inside(first_ + lane, *elements[i]))
            append_found(found_, {first_ + lane, pending_[begin + i].element});
        }
      }
    }
  }

  bool is_own(Index place, const VertexTuple<D + 1>& element) const {
    bool is_own = false;
    for (const Index v : element) is_own |= v == batch_.ids[place];
    return is_own;
  }

  [[gnu::noinline]] bool is_inside(Index place, const VertexTuple<D + 1>& element) const {
    std::array<Vec<D>, D + 1> corners;
    for (int k = 0; k <= D; ++k) corners[k] = input_.positions[element[k]];
    return locate_in_simplex<D>(corners, batch_.points[batch_.ids[place]]).inside;
  }

  const ContainmentInput<D>& input_;
  const PointBatch<D>& batch_;
  std::vector<PointInElement>& found_;
  PointGroup group_;
  Index first_ = 0;  ///< its place in the batch
  const OwnElements* own_ = nullptr;
  KernelVector<Index> waiting_;  ///< nodes to visit
  std::size_t end_ = 0;
  struct {
    Index node[kMaxNear];
    std::int32_t child[kMaxNear];
    std::int32_t points[kMaxNear];
  } near_;  ///< elements that have points near
  int near_count_ = 0;
  struct {
    Index element;
    unsigned points;
  } pending_[kMaxNear];  ///< elements that have points in their boxes
};

template <int D>
void find_all(const ContainmentInput<D>& input, const PointBatch<D>& batch, std::vector<PointInElement>& found) {
  if (input.nodes.empty()) return;
  GroupSearch<D> search(input, batch, found);
  for (Index group = 0; group < std::ssize(batch.own); ++group) search.search(group);
}

}  // namespace

void find_containing(const ContainmentInput<2>& input, const PointBatch<2>& batch, std::vector<PointInElement>& found) {
  find_all(input, batch, found);
}

void find_containing(const ContainmentInput<3>& input, const PointBatch<3>& batch, std::vector<PointInElement>& found) {
  find_all(input, batch, found);
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
