#include "core/simd/vec3.h"

#include "core/simd/simd16.h"
#include "core/simd/simd_double.h"
#include "selvage/core/types.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace selvage {
namespace {

template <typename Lanes, typename Number, int kLanes>
class Operations {
 public:
  /// Each operation in each lane, against the same in the same order on plain numbers.
  void compare() {
    std::mt19937 random(3);
    std::uniform_real_distribution<Number> number(-2, 2);
    for (int round = 0; round < 50; ++round) {
      for (int i = 0; i < 3; ++i)
        for (int lane = 0; lane < kLanes; ++lane) {
          a_[i][lane] = round == 0 ? Number(0) : number(random);
          b_[i][lane] = round == 1 ? Number(-0.0) : number(random);
        }
      compare_in_space();
      compare_in_the_plane();
    }
  }

 private:
  using Rows = Number[3][kLanes];

  template <typename Expected>
  void expect_lanes(const Lanes& found, Expected&& expected) {
    Number lanes[kLanes];
    found.store(lanes);
    for (int lane = 0; lane < kLanes; ++lane) {
      EXPECT_EQ(lanes[lane], expected(lane));
      EXPECT_EQ(std::signbit(lanes[lane]), std::signbit(expected(lane)));
    }
  }

  void compare_in_space() {
    const LaneVec3<Lanes> a = load_axes<Lanes>(a_), b = load_axes<Lanes>(b_),
                          first = broadcast_axes<Lanes>(b_, 1 % kLanes);
    const LaneVec3<Lanes> product = cross(a, b);
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      expect_lanes((a + b)[i], [&](int l) { return a_[i][l] + b_[i][l]; });
      expect_lanes((a - b)[i], [&](int l) { return a_[i][l] - b_[i][l]; });
      expect_lanes((a[0] * b)[i], [&](int l) { return a_[0][l] * b_[i][l]; });
      expect_lanes(product[i], [&](int l) { return a_[j][l] * b_[k][l] - a_[k][l] * b_[j][l]; });
      expect_lanes(first[i], [&](int) { return b_[i][1 % kLanes]; });
      expect_lanes(abs(a[i]), [&](int l) { return std::abs(a_[i][l]); });
      expect_lanes(negate(b[i]), [&](int l) { return 0 - b_[i][l]; });
    }
    expect_lanes(dot(a, b), [&](int l) { return a_[0][l] * b_[0][l] + a_[1][l] * b_[1][l] + a_[2][l] * b_[2][l]; });
    expect_lanes(abs_sum(a), [&](int l) { return std::abs(a_[0][l]) + std::abs(a_[1][l]) + std::abs(a_[2][l]); });
    expect_lanes(abs_max(a),
                 [&](int l) { return std::max(std::max(std::abs(a_[0][l]), std::abs(a_[1][l])), std::abs(a_[2][l])); });
  }

  void compare_in_the_plane() {
    const LaneVec2<Lanes> a = {{Lanes::load(a_[0]), Lanes::load(a_[1])}},
                          b = {{Lanes::load(b_[0]), Lanes::load(b_[1])}};
    for (int i = 0; i < 2; ++i) {
      expect_lanes((a + b)[i], [&](int l) { return a_[i][l] + b_[i][l]; });
      expect_lanes((a - b)[i], [&](int l) { return a_[i][l] - b_[i][l]; });
      expect_lanes((a[1] * b)[i], [&](int l) { return a_[1][l] * b_[i][l]; });
    }
    expect_lanes(dot(a, b), [&](int l) { return a_[0][l] * b_[0][l] + a_[1][l] * b_[1][l]; });
    expect_lanes(cross(a, b), [&](int l) { return a_[0][l] * b_[1][l] - a_[1][l] * b_[0][l]; });
    expect_lanes(abs_sum(a), [&](int l) { return std::abs(a_[0][l]) + std::abs(a_[1][l]); });
    expect_lanes(abs_max(a), [&](int l) { return std::max(std::abs(a_[0][l]), std::abs(a_[1][l])); });
  }

  Rows a_, b_;
};

TEST(LaneVec, EachLaneIsThePlainOperation) {
  Operations<Float8, float, 8>().compare();
  Operations<Float16, float, 16>().compare();
  Operations<WideDouble, double, WideDouble::kLanes>().compare();
}

}  // namespace
}  // namespace selvage
