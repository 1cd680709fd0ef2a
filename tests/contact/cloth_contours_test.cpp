// Curves along which cloth crosses cloth: their hits, sides and directions, against lengths of crossing triangles.
#include "contact/contours/cloth_contours.h"
#include "random.h"
#include "selvage/shapes/shapes.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

namespace selvage {
namespace {

struct TwoSheets {
  TriangleMesh surface;
  std::vector<Vec3> positions;
  Index second_vertex, second_triangle;  ///< the first of the second sheet

  Contours contours() const { return find_contours(surface, positions, pairs(), 0, surface.triangle_count()); }
  std::vector<TrianglePair> pairs() const { return SelfCollisionFinder(surface, positions).find_pairs(); }
  double length() const {
    double sum = 0;
    const SelfCollisionFinder finder(surface, positions);
    const std::vector<TrianglePair> all = finder.find_pairs();
    for (const CommonSegment& segment : finder.find_segments(all))
      if (segment) sum += ((*segment)[1] - (*segment)[0]).norm();
    return sum;
  }
};

/// The second one turned about an axis through the origin, then moved; both rough.
TwoSheets make_two(const Vec3& axis, double angle, const Vec3& shift, std::uint64_t seed = 3) {
  const IndexedMesh sheet = make_cloth(1, 1, 0.1);
  test::Random random(seed);
  TwoSheets two;
  two.second_vertex = static_cast<Index>(sheet.positions.size());
  two.second_triangle = static_cast<Index>(sheet.triangles.size());
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  std::vector<VertexTuple<3>> triangles = sheet.triangles;
  for (const auto& [a, b, c] : sheet.triangles)
    triangles.push_back({a + two.second_vertex, b + two.second_vertex, c + two.second_vertex});
  for (const Vec3& p : sheet.positions) two.positions.push_back(p + random.vector(0.01));
  for (const Vec3& p : sheet.positions) two.positions.push_back(turn * p + shift + random.vector(0.01));
  two.surface = TriangleMesh(2 * two.second_vertex, triangles);
  return two;
}

TEST(ClothContours, SayHowALengthChangesAsOneSheetMoves) {
  const std::vector<TwoSheets> cases{make_two(Vec3::UnitX(), 1.2, {0.13, 0.4, -0.31}),
                                     make_two(Vec3::UnitY(), -1.4, {0.55, 0.22, -0.43}),
                                     make_two(Vec3(1, 1, 0), 0.9, {0.3, 0.1, -0.2})};
  for (const TwoSheets& two : cases) {
    const Contours contours = two.contours();
    ASSERT_EQ(contours.count, 1);
    Vec3 sum = Vec3::Zero();
    for (const ContourHit& hit : contours.hits) {
      const bool is_second = two.surface.edges()[hit.edge][0] >= two.second_vertex;
      ASSERT_GE(hit.side, 0);
      // All edges of a sheet are on one side of the contour.
      const ContourHit& first = contours.hits.front();
      const bool first_is_second = two.surface.edges()[first.edge][0] >= two.second_vertex;
      EXPECT_EQ(hit.side == first.side, is_second == first_is_second);
      sum += (is_second ? 1 : -1) * hit.shortening;
    }
    constexpr double kShift = 1e-7;
    for (int axis = 0; axis < 3; ++axis) {
      double lengths[2];
      for (const int sign : {-1, 1}) {
        TwoSheets shifted = two;
        for (std::size_t v = two.second_vertex; v < two.positions.size(); ++v)
          shifted.positions[v][axis] += sign * kShift;
        lengths[(sign + 1) / 2] = shifted.length();
      }
      EXPECT_NEAR((lengths[1] - lengths[0]) / (2 * kShift), -sum[axis] / 2, 1e-5 * sum.norm());
    }
  }
}

TEST(ClothContours, AreOneACurve) {
  // Two ends of one sheet, folded over so that both stand through its middle.
  const IndexedMesh sheet = make_cloth(2, 0.4, 0.1);
  std::vector<Vec3> positions = sheet.positions;
  for (Vec3& p : positions) {
    const double out = std::abs(p[0] - 1) - 0.6;
    if (out > 0) p = Vec3(p[0] < 1 ? 0.61 + 0.03 * p[1] : 1.37 - 0.02 * p[1], p[1] + 0.017, 0.17 - out);
  }
  const TriangleMesh surface(static_cast<Index>(positions.size()), sheet.triangles);
  const auto pairs = SelfCollisionFinder(surface, positions).find_pairs();
  const Contours contours = find_contours(surface, positions, pairs, 0, surface.triangle_count());
  EXPECT_EQ(contours.count, 2);
  for (const ContourHit& hit : contours.hits) EXPECT_GE(hit.side, 0);
  EXPECT_TRUE(find_contours(surface, positions, pairs, 0, 0).hits.empty());
  EXPECT_TRUE(find_contours(surface, sheet.positions, {}, 0, surface.triangle_count()).hits.empty());
}

TEST(ClothContours, PullTheEdgesOfASheetOneWayAndTheFacesTheOther) {
  const TwoSheets two = make_two(Vec3::UnitX(), 1.2, {0.13, 0.4, -0.31});
  const Contours contours = two.contours();
  std::vector<Contact> contacts;
  append_contour_contacts(two.surface, two.positions, contours, contacts);
  ASSERT_EQ(contacts.size(), contours.hits.size());
  const auto move_of = [&](const Contact& c) {
    const bool is_second = two.surface.edges()[c.point_feature][0] >= two.second_vertex;
    return Vec3(is_second ? c.normal : -c.normal);
  };
  for (const Contact& contact : contacts) {
    EXPECT_EQ(contact.kind, ContactKind::kContour);
    EXPECT_EQ(contact.count, 5);
    EXPECT_NEAR(contact.normal.norm(), 1, 1e-12);
    EXPECT_GT(contact.distance, 0);
    EXPECT_LT(offset_of(contact, two.positions).norm(), 1e-12);
    EXPECT_LT((move_of(contact) - move_of(contacts.front())).norm(), 1e-12);
  }
  TwoSheets pulled = two;
  for (std::size_t v = two.second_vertex; v < two.positions.size(); ++v)
    pulled.positions[v] += 0.01 * move_of(contacts.front());
  EXPECT_LT(pulled.length(), two.length());
}

}  // namespace
}  // namespace selvage
