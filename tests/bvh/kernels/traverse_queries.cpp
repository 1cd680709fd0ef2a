#include "bvh/kernels/traverse_queries.h"

#include "bvh/test_boxes.h"
#include "bvh/traverse_pairs.h"
#include "core/simd/simd16.h"

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
  // Of eight lanes each half is transposed for itself.
  Float8 wide[4] = {Float8::load(a), Float8::load(b), Float8::load(a), Float8::load(b)};
  transpose(wide[0], wide[1], wide[2], wide[3]);
  for (int i = 0; i < 4; ++i) {
    float row[8];
    wide[i].store(row);
    for (int k = 0; k < 8; ++k) good = good && row[k] == (k % 2 == 0 ? a : b)[k / 4 * 4 + i];
  }
  return good;
}

template <typename Operation, typename Expected>
bool check_sixteen(const float* a, const float* b, Operation&& operation, Expected&& expected) {
  float out[16];
  operation(Float16::load(a), Float16::load(b)).store(out);
  for (int i = 0; i < 16; ++i)
    if (std::bit_cast<std::uint32_t>(out[i]) != std::bit_cast<std::uint32_t>(expected(a[i], b[i]))) return false;
  return true;
}

bool check_float16() {
  const float a[16] = {1, -2, 0.0f, -0.0f, kInfinity, kNan, 1e-44f, 7, 3, 1, 4, 1.5f, -9, 2, 6, -5};
  const float b[16] = {0.1f, -3, -0.0f, 0.0f, -kInfinity, 1, 2e-44f, kNan, -3, 5, 8, 9, 7, -9.5f, 3, 2};
  const float* const finite[] = {a + 8, b + 8};
  float c[16], d[16];
  for (int i = 0; i < 16; ++i) {
    c[i] = finite[0][i % 8] * (i < 8 ? 1.0f : 1.1f);
    d[i] = finite[1][i % 8] * (i < 8 ? 1.0f : 0.7f);
  }
  bool good = check_sixteen(
                  c, d, [](Float16 x, Float16 y) { return x + y; }, [](float x, float y) { return x + y; }) &&
              check_sixteen(
                  c, d, [](Float16 x, Float16 y) { return x - y; }, [](float x, float y) { return x - y; }) &&
              check_sixteen(
                  c, d, [](Float16 x, Float16 y) { return x * y; }, [](float x, float y) { return x * y; }) &&
              check_sixteen(
                  a, b, [](Float16 x, Float16 y) { return min(x, y); }, [](float x, float y) { return x < y ? x : y; });
  good = good &&
         check_sixteen(
             c, d, [](Float16 x, Float16 y) { return x / y; }, [](float x, float y) { return x / y; }) &&
         check_sixteen(
             c, d, [](Float16 x, Float16 y) { return sqrt(x * x + y * y); },
             [](float x, float y) { return __builtin_sqrtf(x * x + y * y); }) &&
         check_sixteen(
             a, b, [](Float16 x, Float16 y) { return max(x, y); }, [](float x, float y) { return x > y ? x : y; }) &&
         check_sixteen(
             a, b, [](Float16 x, Float16 y) { return select_less(x, y, Float16::broadcast(1), Float16::broadcast(2)); },
             [](float x, float y) { return x < y ? 1.0f : 2.0f; }) &&
         check_sixteen(
             a, b, [&](Float16, Float16) { return Float16::join(Float8::load(a), Float8::load(a + 8)); },
             [](float x, float) { return x; });
  const std::int32_t numbers[16] = {15, 0, 3, 3, 9, 8, 7, 1, 2, 14, 13, 12, 0, 5, 6, 15};
  float picked[16], same[16];
  Float16::pick(c, numbers).store(picked);
  unsigned equal = 0;
  for (int i = 0; i < 16; ++i) {
    good = good && picked[i] == c[numbers[i]];
    same[i] = i % 3 == 0 ? a[i] : b[i];
    equal |= static_cast<unsigned>(std::bit_cast<std::uint32_t>(same[i]) == std::bit_cast<std::uint32_t>(a[i])) << i;
  }
  good = good && equal_bits(Float16::load(same), Float16::load(a)) == equal;
  for (const unsigned among : {0xffffu, 0u, 0xa5c3u}) {
    unsigned expected = 0;
    for (unsigned i = 0; i < 16; ++i) expected |= static_cast<unsigned>(a[i] <= b[i]) << i;
    good = good && less_equal(Float16::load(a), Float16::load(b), among) == (expected & among);
  }
  return good;
}

bool check_int8() {
  const std::int32_t a[8] = {0, -1, 5, std::numeric_limits<std::int32_t>::min(), 0, 0x12345, 0, 7};
  const std::uint16_t words[8] = {0, 1, 0x8000, 0xffff, 3, 0, 9, 7};
  std::int32_t both[8], either[8], bytes[8], inverse[8], packed[8], same[8];
  (Int8::load(a) & Int8::load(words)).store(both);
  (Int8::load(a) | Int8::load(words)).store(either);
  Int8::from_bytes(0xff807f0100fe0203u).store(bytes);
  (~Int8::load(a)).store(inverse);
  Int8::broadcast(-3).store(same);
  bool good = zero(Int8::load(a)) == 0x51u && negative(Int8::load(a)) == 0x0au;
  for (int i = 0; i < 8; ++i) {
    good = good && both[i] == (a[i] & words[i]) && either[i] == (a[i] | words[i]) && inverse[i] == ~a[i];
    good = good && bytes[i] == static_cast<std::int32_t>(0xff807f0100fe0203u >> 8 * i & 0xffu) && same[i] == -3;
  }
  for (unsigned lanes = 0; lanes < 256; ++lanes) {
    store_packed(Int8::load(a), lanes, packed);
    int count = 0;
    for (int i = 0; i < 8; ++i)
      if ((lanes >> i & 1u) != 0) good = good && packed[count++] == a[i];
  }
  return good;
}

bool check_masks_between() {
  AxisMasks masks;
  for (unsigned axis = 0; axis < 3; ++axis)
    for (unsigned i = 0; i < 32; ++i) masks[axis][i] = static_cast<std::uint16_t>((i * 40503u + axis * 9973u) * 7919u);
  bool good = true;
  for (int first = 0; first < 32; ++first) {
    float places[6][8];
    Float8 lower[3], upper[3];
    for (int k = 0; k < 6; ++k) {
      for (int i = 0; i < 8; ++i) places[k][i] = static_cast<float>((first + i * (k + 1) + 5 * k) % 32) + 0.11f * i;
      (k < 3 ? lower[k] : upper[k - 3]) = Float8::load(places[k]);
    }
    std::int32_t found[8];
    masks_between(masks, lower, upper).store(found);
    for (int i = 0; i < 8; ++i) {
      std::int32_t expected = 0xffff;
      for (int axis = 0; axis < 3; ++axis)
        expected &=
            masks[axis][static_cast<int>(places[axis][i])] & ~masks[axis][static_cast<int>(places[3 + axis][i])];
      good = good && found[i] == expected;
    }
  }
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
    keep_lanes(Float8::load(a), mask).store(out);
    for (unsigned i = 0; i < 8; ++i) good = good && out[i] == ((mask >> i & 1u) != 0 ? a[i] : 0.0f);
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
             c, d, [](Float8 x, Float8 y) { return x / y; }, [](float x, float y) { return x / y; }) &&
         check_lanes(
             a, b, [](Float8 x, Float8 y) { return min(x, y); }, [](float x, float y) { return x < y ? x : y; }) &&
         check_lanes(
             a, b, [](Float8 x, Float8 y) { return max(x, y); }, [](float x, float y) { return x > y ? x : y; }) &&
         check_mask(
             a, b, [](Float8 x, Float8 y) { return less_equal(x, y); }, [](float x, float y) { return x <= y; }) &&
         check_mask(
             a, b, [](Float8 x, Float8 y) { return less_bits(x, y); },
             [&](float x, float y) { return bits(x) < bits(y); }) &&
         check_rearrangements(c, d) && check_masks_of_lanes(c) && check_float16() && check_int8() &&
         check_masks_between();
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
