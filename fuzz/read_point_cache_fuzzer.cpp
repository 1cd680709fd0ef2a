// libFuzzer target: whatever the bytes, reading a point cache gives one that keeps every promise of
// parse_point_cache(), or an Error of one line.
#include "selvage/core/error.h"
#include "selvage/io/point_cache.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace {

using namespace selvage;

bool is_valid(const PointCache& cache) {
  if (cache.samples.empty() || !(cache.frames_per_sample > 0) || !std::isfinite(cache.first_frame)) return false;
  return std::ranges::all_of(cache.samples, [&](const std::vector<Vec3>& positions) {
    return !positions.empty() && positions.size() == cache.samples[0].size() &&
           std::ranges::all_of(positions, [](const Vec3& p) { return p.allFinite(); });
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* bytes, std::size_t size) {
  const std::string_view input(reinterpret_cast<const char*>(bytes), size);
  try {
    const PointCache cache = parse_point_cache(input, "input.pc2");
    // It holds nothing but what a .pc2 does: written again, it is the same bytes.
    if (!is_valid(cache) || print_point_cache(cache) != input) std::abort();
  } catch (const Error& error) {
    if (std::string_view(error.what()).find('\n') != std::string_view::npos) std::abort();
  }
  return 0;
}
