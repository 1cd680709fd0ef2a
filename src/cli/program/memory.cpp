#include "cli/program/memory.h"

#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <limits>

namespace selvage::cli {

void take_large_pages() {
#if defined(__GLIBC__) && defined(MADV_HUGEPAGE)
  constexpr int kNever = std::numeric_limits<int>::max();
  constexpr std::uintptr_t kLargePage = std::uintptr_t{1} << 21;
  mallopt(M_MMAP_THRESHOLD, kNever);
  mallopt(M_TRIM_THRESHOLD, kNever);
  mallopt(M_TOP_PAD, 1 << 30);  // addresses, no memory: what is not touched costs nothing
  const auto begin = reinterpret_cast<std::uintptr_t>(sbrk(0));
  void* volatile block = std::malloc(1 << 20);  // the heap grows; volatile, or compilers leave both out
  std::free(block);
  auto* const top = static_cast<char*>(sbrk(0));
  const auto end = reinterpret_cast<std::uintptr_t>(top);
  const std::uintptr_t first = (begin + kLargePage - 1) / kLargePage * kLargePage;
  if (first < end) madvise(top - (end - first), end - first, MADV_HUGEPAGE);
#endif
}

}  // namespace selvage::cli
