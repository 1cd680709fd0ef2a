#pragma once

#include <memory>
#include <utility>
#include <vector>

namespace selvage {

/// Leaves items without a value as memory happens to be, where a vector would write zeros.
template <typename Item>
struct UnsetAllocator : std::allocator<Item> {
  template <typename Other>
  struct rebind {
    using other = UnsetAllocator<Other>;
  };
  using std::allocator<Item>::allocator;

  template <typename Other>
  void construct(Other* place) {
    ::new (static_cast<void*>(place)) Other;
  }
  template <typename Other, typename... Arguments>
  void construct(Other* place, Arguments&&... arguments) {
    ::new (static_cast<void*>(place)) Other(std::forward<Arguments>(arguments)...);
  }
};

/// A vector for large arrays of plain items that are written as a whole after resize(), which writes nothing.
template <typename Item>
using UnsetVector = std::vector<Item, UnsetAllocator<Item>>;

}  // namespace selvage
