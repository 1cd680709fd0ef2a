#include "simulation/time_step/thin_kernel.h"

#include "core/simd/simd_double.h"
#include "core/simd/vec3.h"

namespace selvage {
inline namespace SELVAGE_ISA {

void find_thin_batches(const double* rows, const ThinBatch* batches, std::int64_t first, std::int64_t last,
                       unsigned char* is_thin) {
  using Point = LaneVec3<WideDouble>;
  for (std::int64_t n = first; n < last; ++n) {
    const ThinBatch& batch = batches[n];
    bool any = false;
    for (int lane = 0; lane < kThinBatch; lane += WideDouble::kLanes) {
      const auto load_point = [&](int k) {
        WideDouble columns[4];
        load_rows(rows, batch.rows[k] + lane, columns);
        return Point{{columns[0], columns[1], columns[2]}};
      };
      const Point origin = load_point(0);
      const Point a = load_point(1) - origin, b = load_point(2) - origin, c = load_point(3) - origin;
      any |= any_less(dot(cross(a, b), c), WideDouble::load(batch.least + lane));
    }
    is_thin[n] = any;
  }
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
