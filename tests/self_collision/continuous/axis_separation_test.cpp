#include "self_collision/continuous/axis_separation.h"

#include "random.h"
#include "selvage/geometry/continuous.h"
#include "selvage/mesh/triangle_mesh.h"
#include "selvage/self_collision/proximity.h"
#include "selvage/shapes/shapes.h"
#include "test_scale.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace selvage {
namespace {

struct Flight {
  std::vector<Vec3> t0, t1;
  std::vector<double> thickness;

  ContinuousInput input() const {
    ContinuousInput input{};
    input.positions_t0 = t0.data();
    input.positions_t1 = t1.data();
    input.vertex_thickness = thickness.empty() ? nullptr : thickness.data();
    return input;
  }
};

bool share_a_vertex(std::span<const Index> a, std::span<const Index> b) {
  return std::ranges::find_first_of(a, b) != a.end();
}

TEST(AxisSeparation, NeverTellsWhatMeetsApart) {
  test::Random random(test::seed(7));
  std::int64_t apart = 0, meet = 0;
  for (std::int64_t i = 0; i < test::scaled(200'000, 1000); ++i) {
    // Small whole numbers: coplanar, parallel and touching features are common.
    Flight flight;
    MovingPoints points;
    for (int k = 0; k < 4; ++k)
      for (auto* at : {&flight.t0, &flight.t1}) {
        Vec3 p;
        for (int axis = 0; axis < 3; ++axis) p[axis] = static_cast<double>(random.below(axis < 2 ? 6 : 2));
        at->push_back(p);
      }
    for (int k = 0; k < 4; ++k) {
      points.t0[k] = flight.t0[k];
      points.t1[k] = flight.t1[k];
    }
    for (const int first : {1, 2}) {
      const bool meets = first == 1 ? vertex_meets_face(points) : edge_meets_edge(points);
      const bool is_apart = stay_apart_by_axis(flight.input(), {0, 1, 2, 3}, first);
      ASSERT_FALSE(meets && is_apart) << i;
      apart += is_apart;
      meet += meets;
    }
  }
  EXPECT_GT(apart, 100);
  EXPECT_GT(meet, 100);
}

TEST(AxisSeparation, TellsAllOfAFlatSheetApartThatFallsAndTurnsALittle) {
  const IndexedMesh sheet = make_cloth(1, 1, 0.25);
  const TriangleMesh surface(static_cast<Index>(sheet.positions.size()), sheet.triangles);
  Flight flight{sheet.positions, sheet.positions, {}};
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.01, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (Vec3& p : flight.t1) p = turn * p - Vec3(0, 0, 0.1);
  for (const auto& a : surface.edges())
    for (const auto& b : surface.edges())
      if (!share_a_vertex(a, b)) {
        EXPECT_TRUE(stay_apart_by_axis(flight.input(), {a[0], a[1], b[0], b[1]}, 2));
      }
  for (Index v = 0; v < surface.vertex_count(); ++v)
    for (const auto& t : surface.triangles())
      if (!share_a_vertex({&v, 1}, t)) {
        EXPECT_TRUE(stay_apart_by_axis(flight.input(), {v, t[0], t[1], t[2]}, 1));
      }
}

TEST(AxisSeparation, KeepsTheThicknessBetween) {
  Flight flight{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0.5}, {1, 1, 0.5}}, {}, {}};
  flight.t1 = flight.t0;
  EXPECT_TRUE(are_still(flight.input(), {0, 1, 2, 3}));
  EXPECT_TRUE(stay_apart_by_axis(flight.input(), {0, 1, 2, 3}, 2));
  const double distance = std::sqrt(1.25);
  flight.thickness.assign(4, 0.499 * distance);
  EXPECT_TRUE(stay_apart_by_axis(flight.input(), {0, 1, 2, 3}, 2));
  flight.thickness.assign(4, 0.501 * distance);
  EXPECT_FALSE(stay_apart_by_axis(flight.input(), {0, 1, 2, 3}, 2));
  flight.t1[3] += Vec3(0, 0, 1);
  EXPECT_FALSE(are_still(flight.input(), {0, 1, 2, 3}));
}

}  // namespace
}  // namespace selvage
