// Statements about faces in single precision must hold in double precision, for hostile triangles too.
#include "boundary_path/packets/face_view.h"
#include "boundary_path/traversal/exact_segment.h"
#include "selvage/geometry/closest_point.h"
#include "test_scale.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace selvage {
namespace {

constexpr int kPairs = 16;

/// A face, and of each neighbour the vertex that is not the face's.
template <int D>
struct Star {
  std::array<Vec<D>, D> corners, apexes;
};

/// Places in a box that is `extent` wide: anywhere, close together, on a line, equal, as a needle.
template <int D>
class Maker {
 public:
  Maker(double extent, unsigned seed) : half_(extent / 2), engine_(seed) {}

  unsigned below(unsigned n) { return static_cast<unsigned>(engine_() % n); }
  double number() { return std::uniform_real_distribution<double>(-1, 1)(engine_); }
  Vec<D> point() {
    return Vec<D>::NullaryExpr([&] { return number(); });
  }

  Star<D> star() {
    const Vec<D> middle = 0.5 * point();
    const double size = std::ldexp(0.25, -static_cast<int>(below(20)));
    Star<D> star;
    for (Vec<D>& x : star.corners) x = middle + size * point();
    for (Vec<D>& x : star.apexes) x = middle + size * point();
    Vec<D>& last = star.corners[D - 1];
    const Vec<D>&a = star.corners[0], &b = star.corners[1];
    switch (below(10)) {
      case 0:
        last = a;
        break;
      case 1:
        last = a + 0.7 * (b - a);
        break;
      case 2:
        last = a + 1e-6 * size * point();
        break;
      case 3:
        last = a + 0.3 * (b - a) + 1e-5 * size * point();
        break;
      default:
        break;
    }
    for (Vec<D>& x : star.corners) x *= half_;
    for (Vec<D>& x : star.apexes) x *= half_;
    return star;
  }

  /// Anywhere, or next to a place on the face.
  Vec<D> place_near(const Star<D>& star) {
    if (below(4) == 0) return half_ * point();
    Vec<D> x = star.corners[0];
    for (int i = 1; i < D; ++i) x += (star.corners[i] - star.corners[0]) * number();
    x += half_ * std::ldexp(0.25, -static_cast<int>(below(20))) * point();
    return x.cwiseMax(-half_).cwiseMin(half_);
  }

 private:
  double half_;
  std::mt19937 engine_;
};

ClosestPoint<2, 2> closest(const Vec2& p, const Star<2>& star) {
  return closest_point_on_segment<2>(p, star.corners[0], star.corners[1]);
}
ClosestPoint<3, 3> closest(const Vec3& p, const Star<3>& star) {
  return closest_point_on_triangle(p, star.corners[0], star.corners[1], star.corners[2]);
}

bool is_outside(const Vec2&, const Star<2>&) {
  return false;  // is not looked for
}
bool is_outside(const Vec3& p, const Star<3>& star) {
  const auto& [a, b, c] = star.corners;
  return (b - a).cross(c - a).dot(p - a) > 0;
}

/// By how much of its length, as a cosine, the best neighbour at the closest point leads towards p.
template <int D>
double lead_of_neighbours(const Vec<D>& p, const Star<D>& star, unsigned cullable, unsigned has_neighbour) {
  const auto s = closest(p, star);
  double lead = -1;
  if ((s.vertex_mask & cullable) == 0) return lead;
  for (int k = 0; k < D; ++k) {
    if ((s.vertex_mask >> k & 1) != 0 || (has_neighbour >> k & 1) == 0) continue;
    const Vec<D> way = star.apexes[k] - s.point;
    lead = std::max(lead, way.dot(p - s.point) / (way.norm() * (p - s.point).norm()));
  }
  return lead;
}

template <int D>
struct Batch {
  Vec<D> p[kPairs];
  Star<D> stars[kPairs];
  unsigned cullable[kPairs], has_neighbour[kPairs];
  FaceView<D> view{};

  Batch(Maker<D>& maker, double extent) {
    view.rounding = static_cast<float>(0x1p-24 * extent);
    for (int i = 0; i < kPairs; ++i) {
      stars[i] = maker.star();
      p[i] = maker.place_near(stars[i]);
      cullable[i] = maker.below(3) == 0 ? maker.below(1u << D) : (1u << D) - 1;
      has_neighbour[i] = maker.below(3) == 0 ? maker.below(1u << D) : (1u << D) - 1;
      for (int k = 0; k < D; ++k) {
        view.cullable[k] |= (cullable[i] >> k & 1) << i;
        view.has_neighbour[k] |= (has_neighbour[i] >> k & 1) << i;
      }
    }
    view.p = rows([&](int i) { return p[i]; });
    for (int k = 0; k < D; ++k) {
      view.corners[k] = rows([&](int i) { return stars[i].corners[k]; });
      view.apexes[k] = rows([&](int i) { return stars[i].apexes[k]; });
    }
  }

  template <typename PointOf>
  static Vector16 rows(PointOf&& point_of) {
    Vector16 v;
    for (int axis = 0; axis < 3; ++axis) {
      float row[kPairs];
      for (int i = 0; i < kPairs; ++i) row[i] = axis < D ? static_cast<float>(point_of(i)[axis < D ? axis : 0]) : 0;
      v.at[axis] = Float16::load(row);
    }
    return v;
  }
};

template <int D>
void check(double extent, unsigned seed) {
  Maker<D> maker(extent, seed);
  const double fine = 1e-13 * extent;  // what double precision leaves open
  std::int64_t tight = 0, infeasible = 0, culled = 0, certain = 0;
  const std::int64_t count = test::scaled(4000);
  for (std::int64_t k = 0; k < count; ++k) {
    const Batch<D> batch(maker, extent);
    const FaceFindings found = look_at(batch.view);
    float squared[kPairs];
    found.squared_distance.store(squared);
    for (int i = 0; i < kPairs; ++i) {
      const Vec<D>& p = batch.p[i];
      const auto s = closest(p, batch.stars[i]);
      const double distance = (s.point - p).norm(), bound = std::sqrt(double{squared[i]});
      ASSERT_LE(bound, distance + fine) << k << ' ' << i;
      tight += bound >= distance * 0.999 - 1e-5 * extent;
      const bool is_inside = s.vertex_mask == (1u << D) - 1;
      const double lead = lead_of_neighbours(p, batch.stars[i], batch.cullable[i], batch.has_neighbour[i]);
      if ((found.culled() >> i & 1) != 0) {
        ASSERT_TRUE(is_inside ? is_outside(p, batch.stars[i]) : lead > 0) << k << ' ' << i << ' ' << lead;
      }
      unsigned feature = 0;
      for (int corner = 0; corner < D; ++corner) feature |= (found.spans[corner] >> i & 1u) << corner;
      if (feature != 0) {
        ASSERT_EQ(feature, exact_closest_mask(p, batch.stars[i].corners)) << k << ' ' << i;
      }
      certain += feature != 0;
      const bool is_clear = !is_inside && lead > 0.1 && distance > 0.01 * extent;
      infeasible += is_clear;
      culled += is_clear && (found.culled() >> i & 1) != 0;
    }
  }
  const auto least = [](double share, std::int64_t all) { return share * static_cast<double>(all); };
  EXPECT_GT(static_cast<double>(tight), least(0.9, kPairs * count));
  EXPECT_GT(static_cast<double>(infeasible), least(0.5, count));
  EXPECT_GT(static_cast<double>(culled), least(0.5, infeasible));
  if (D == 3) {  // nothing is looked for in the plane
    EXPECT_GT(static_cast<double>(certain), least(0.5, kPairs * count));
  }
}

TEST(FaceView, NeverSaysTooMuchOfSegments) {
  for (const double extent : {2.0, 1e-3, 1e-9}) check<2>(extent, test::seed(1));
}
TEST(FaceView, NeverSaysTooMuchOfTriangles) {
  for (const double extent : {2.0, 1e-3, 1e-9}) check<3>(extent, test::seed(2));
}

TEST(FaceView, KnowsNothingOfAPointOnTheFace) {
  FaceView<3> view{};
  for (Float16& x : view.p.at) x = Float16::broadcast(0);
  for (auto* points : {view.corners, view.apexes})
    for (int k = 0; k < 3; ++k)
      for (int axis = 0; axis < 3; ++axis) points[k].at[axis] = Float16::broadcast(k == axis && k > 0 ? 1 : 0);
  for (int k = 0; k < 3; ++k) view.cullable[k] = view.has_neighbour[k] = 0xffff;
  view.rounding = 0x1p-24f;
  const FaceFindings found = look_at(view);
  float squared[kPairs];
  found.squared_distance.store(squared);
  for (const float x : squared) EXPECT_EQ(x, 0);
  EXPECT_EQ(found.culled(), 0u);
}

}  // namespace
}  // namespace selvage
