#include "bvh/kernels/traverse_queries.h"

#include "bvh/test_boxes.h"
#include "selvage/bvh/traverse_pairs.h"

namespace selvage {
inline namespace SELVAGE_ISA {

NearestVisits list_within(const Bvh& bvh, const Box& point, float squared_bound) {
  NearestVisits visits;
  visit_nearest(
      bvh.nodes(), point, squared_bound,
      [&](Index primitive, float bound) {
        visits.primitives.push_back(primitive);
        visits.bounds.push_back(bound);
        return squared_bound;
      },
      visits.nodes);
  return visits;
}

NearestVisits find_nearest(const Bvh& bvh, std::span<const Box> boxes, const Box& point, float squared_bound) {
  NearestVisits visits;
  visit_nearest(bvh.nodes(), point, squared_bound, [&](Index primitive, float bound) {
    visits.primitives.push_back(primitive);
    visits.bounds.push_back(bound);
    squared_bound =
        std::min(squared_bound, round_up(static_cast<double>(test::squared_distance(boxes[primitive], point))));
    return squared_bound;
  });
  return visits;
}

std::vector<Index> list_overlaps(const Bvh& bvh, const Box& query) {
  std::vector<Index> found;
  visit_overlaps(bvh.nodes(), query, [&](Index primitive) { found.push_back(primitive); });
  return found;
}

std::int64_t count_overlaps_up_to(const Bvh& bvh, const Box& query, std::int64_t most) {
  std::int64_t count = 0;
  visit_overlaps(bvh.nodes(), query, [&](Index) { return ++count < most; });
  return count;
}

std::vector<IndexPair> list_pairs(const Bvh& a, const Bvh& b) {
  std::vector<IndexPair> pairs;
  visit_pairs(a.nodes(), b.nodes(), [&](Index i, Index j) { pairs.emplace_back(i, j); });
  return pairs;
}

std::vector<IndexPair> list_self_pairs(const Bvh& bvh) {
  std::vector<IndexPair> pairs;
  visit_self_pairs(bvh.nodes(), [&](Index i, Index j) { pairs.emplace_back(i, j); });
  return pairs;
}

std::vector<IndexPair> list_self_pairs_of_pieces(const Bvh& bvh, std::span<const NodePair> pieces) {
  std::vector<IndexPair> pairs;
  for (const NodePair& piece : pieces)
    visit_self_pairs(
        bvh.nodes(), [&](Index i, Index j) { pairs.emplace_back(i, j); }, piece);
  return pairs;
}

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

template <typename Operation, typename Expected>
bool check_lanes(const float* a, const float* b, Operation&& operation, Expected&& expected) {
  float out[8];
  operation(Float8::load(a), Float8::load(b)).store(out);
  for (int i = 0; i < 8; ++i)
    if (std::bit_cast<std::uint32_t>(out[i]) != std::bit_cast<std::uint32_t>(expected(a[i], b[i]))) return false;
  return true;
}

template <typename Compare, typename Expected>
bool check_mask(const float* a, const float* b, Compare&& compare, Expected&& expected) {
  const unsigned mask = compare(Float8::load(a), Float8::load(b));
  for (int i = 0; i < 8; ++i)
    if (((mask >> i) & 1u) != static_cast<unsigned>(expected(a[i], b[i]))) return false;
  return mask < 256;
}

bool check_rearrangements(const float* a, const float* b) {
  Float4 rows[4] = {Float4::load(a), Float4::load(a + 4), Float4::load(b), Float4::load(b + 4)};
  float smallest[4], largest[4], columns[4][4];
  reduce_min(rows[0], rows[1], rows[2], rows[3]).store(smallest);
  reduce_max(rows[0], rows[1], rows[2], rows[3]).store(largest);
  transpose(rows[0], rows[1], rows[2], rows[3]);
  bool good = true;
  for (int i = 0; i < 4; ++i) {
    const float* const row = (i < 2 ? a : b) + 4 * (i % 2);
    rows[i].store(columns[i]);
    good = good && smallest[i] == *std::min_element(row, row + 4) && largest[i] == *std::max_element(row, row + 4);
  }
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 4; ++k) good = good && columns[k][i] == ((i < 2 ? a : b) + 4 * (i % 2))[k];
  return good;
}

bool check_masks_of_lanes(const float* a) {
  bool good = true;
  float out[8];
  for (int count = 0; count <= 8; ++count) {
    keep_first(Float8::load(a), count).store(out);
    for (int i = 0; i < 8; ++i) good = good && out[i] == (i < count ? a[i] : 0.0f);
  }
  for (unsigned mask = 0; mask < 256; ++mask) {
    int bits = 0;
    for (unsigned i = 0; i < 8; ++i) bits += static_cast<int>((mask >> i) & 1u);
    good =
        good && count_lanes(mask) == bits && (mask == 0 || ((mask & (mask - 1)) | (1u << lowest_lane(mask))) == mask);
  }
  tag_lanes(Float8::load(a)).store(out);
  for (unsigned i = 0; i < 8; ++i)
    good = good && std::bit_cast<std::uint32_t>(out[i]) == ((std::bit_cast<std::uint32_t>(a[i]) & ~7u) | i);
  return good;
}

}  // namespace

bool check_simd() {
  const float a[8] = {1, -2, 0.0f, -0.0f, kInfinity, kNan, 1e-44f, 7};
  const float b[8] = {0.1f, -3, -0.0f, 0.0f, -kInfinity, 1, 2e-44f, kNan};
  const float c[8] = {3, 1, 4, 1.5f, -9, 2, 6, -5}, d[8] = {-3, 5, 8, 9, 7, -9.5f, 3, 2};
  const auto bits = [](float x) { return std::bit_cast<std::int32_t>(x); };
  return check_lanes(
             c, d, [](Float8 x, Float8 y) { return x + y; }, [](float x, float y) { return x + y; }) &&
         check_lanes(
             c, d, [](Float8 x, Float8 y) { return x - y; }, [](float x, float y) { return x - y; }) &&
         check_lanes(
             c, d, [](Float8 x, Float8 y) { return x * y; }, [](float x, float y) { return x * y; }) &&
         check_lanes(
             a, b, [](Float8 x, Float8 y) { return min(x, y); }, [](float x, float y) { return x < y ? x : y; }) &&
         check_lanes(
             a, b, [](Float8 x, Float8 y) { return max(x, y); }, [](float x, float y) { return x > y ? x : y; }) &&
         check_mask(
             a, b, [](Float8 x, Float8 y) { return less_equal(x, y); }, [](float x, float y) { return x <= y; }) &&
         check_mask(
             a, b, [](Float8 x, Float8 y) { return less_bits(x, y); },
             [&](float x, float y) { return bits(x) < bits(y); }) &&
         check_rearrangements(c, d) && check_masks_of_lanes(c);
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
