#pragma once

#include "boundary_path/traversal/segment.h"

namespace selvage {
inline namespace SELVAGE_ISA {

/// Without a call to compare memory.
template <int D>
SELVAGE_INLINE bool is_same(const VertexTuple<D>& a, const VertexTuple<D>& b) {
  bool same = true;
  for (int i = 0; i < D; ++i) same &= a[i] == b[i];
  return same;
}

/// A growing set of features of boundary faces, each named by some indices.
template <int D>
class FeatureSet {
 public:
  bool empty() const { return count_ == 0; }

  bool contains(const VertexTuple<D>& name) const { return !empty() && is_same<D>(slots_[place_of(name)], name); }

  void insert(const VertexTuple<D>& name) {
    if (2 * count_ >= slots_.size()) grow();
    VertexTuple<D>& slot = slots_[place_of(name)];
    count_ += !is_same<D>(slot, name);
    slot = name;
  }

 private:
  static constexpr std::size_t kFirstSize = 256;  // a power of two, as all sizes

  static VertexTuple<D> nothing() {
    VertexTuple<D> name;
    name.fill(kNone);
    return name;
  }

  /// Where the name is, or else where it would be put: half of the slots or more hold nothing.
  std::size_t place_of(const VertexTuple<D>& name) const {
    std::uint64_t hash = 0;
    for (const Index i : name) hash = (hash ^ static_cast<std::uint32_t>(i)) * 0x9e3779b97f4a7c15u;
    std::size_t place = static_cast<std::size_t>(hash >> 32);
    for (;; ++place) {
      place &= slots_.size() - 1;
      if (is_same<D>(slots_[place], name) || is_same<D>(slots_[place], nothing())) return place;
    }
  }

  void grow() {
    KernelVector<VertexTuple<D>> old(slots_.empty() ? kFirstSize : 2 * slots_.size(), nothing());
    old.swap(slots_);
    for (const VertexTuple<D>& name : old)
      if (!is_same<D>(name, nothing())) slots_[place_of(name)] = name;
  }

  KernelVector<VertexTuple<D>> slots_;
  std::size_t count_ = 0;
};

}  // namespace SELVAGE_ISA
}  // namespace selvage
