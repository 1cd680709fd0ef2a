#include "bvh/pairs_kernel.h"

#include "bvh/traverse_pairs.h"

namespace selvage {
inline namespace SELVAGE_ISA {

namespace {

/// Gathers pairs and hands them on in batches, so that the kernel itself allocates nothing.
class Batch {
 public:
  explicit Batch(PairSink sink) : sink_(sink) {}
  SELVAGE_INLINE void add(Index a, Index b) {
    pairs_[count_].first = a;
    pairs_[count_].second = b;
    if (++count_ == kSize) flush();
  }
  SELVAGE_INLINE void flush() {
    sink_.take(sink_.receiver, pairs_, count_);
    count_ = 0;
  }

 private:
  static constexpr std::size_t kSize = 256;
  PairSink sink_;
  std::size_t count_ = 0;
  IndexPair pairs_[kSize];
};

}  // namespace

void find_pairs_kernel(std::span<const BvhNode> a, std::span<const BvhNode> b, NodePair start, PairSink sink) {
  Batch batch(sink);
  visit_pairs(
      a, b, [&](Index i, Index j) { batch.add(i, j); }, start);
  batch.flush();
}

void find_self_pairs_kernel(std::span<const BvhNode> nodes, NodePair start, PairSink sink) {
  Batch batch(sink);
  visit_self_pairs(
      nodes, [&](Index i, Index j) { batch.add(i, j); }, start);
  batch.flush();
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
