#include "contact/penetration_search.h"

#include "contact/edge_part.h"
#include "geometry/exact_oracle.h"
#include "mesh/simplex_corners.h"
#include "selvage/boundary_path/boundary_path.h"
#include "selvage/geometry/predicates.h"
#include "selvage/shapes/shapes.h"
#include "solids.h"
#include "test_scale.h"

#include <tbb/global_control.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace selvage {
namespace {

using solids::Solid;
using test::Random;
using test::scaled;
using test::seed;

bool is_inverted_at_the_boundary(const TetMesh& mesh, Index element, std::span<const Vec3> x) {
  const auto& across = mesh.neighbours()[element];
  return std::count_if(across.begin(), across.end(), [](HalfFace n) { return !n.exists(); }) > 0 &&
         orientation(corners_of(mesh.elements()[element], x)) < 0;
}

/// A twin of middle_of_parts(), by labels that spread until none changes.
std::optional<EdgePoint> plain_middle_of_parts(const TetMesh& mesh, const std::array<Vec3, 2>& segment,
                                               std::span<const Vec3> x, std::span<const ElementPart> parts,
                                               bool joins) {
  std::vector<std::size_t> label(parts.size());
  std::iota(label.begin(), label.end(), 0);
  for (bool changes = joins; changes;) {
    changes = false;
    for (std::size_t i = 0; i < parts.size(); ++i)
      for (std::size_t k = 0; k < parts.size(); ++k) {
        const double gap =
            std::max(parts[i].part.first, parts[k].part.first) - std::min(parts[i].part.last, parts[k].part.last);
        if (gap > 1e-9 || !share_vertex(mesh.elements()[parts[i].element], mesh.elements()[parts[k].element])) continue;
        changes |= label[i] != label[k];
        label[i] = label[k] = std::min(label[i], label[k]);
      }
  }
  std::optional<EdgePoint> best;
  double best_middle = 2;
  for (std::size_t run = 0; run < parts.size(); ++run) {
    EdgePart whole{2, -1};
    for (std::size_t i = 0; i < parts.size(); ++i)
      if (label[i] == run) {
        whole.first = std::min(whole.first, parts[i].part.first);
        whole.last = std::max(whole.last, parts[i].part.last);
      }
    const double middle = whole.middle();
    if (whole.first > whole.last || std::abs(middle - 0.5) >= std::abs(best_middle - 0.5)) continue;
    best_middle = middle;
    best.reset();
    double closest = 2;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      if (label[i] != run) continue;
      const auto holds = [&](double place) {
        return locate_in_simplex<3>(corners_of(mesh.elements()[parts[i].element], x),
                                    segment[0] + place * (segment[1] - segment[0]))
            .inside;
      };
      const double own = parts[i].part.middle(), off = holds(middle) ? -1 : std::abs(own - middle);
      if (off < closest) best = EdgePoint{off < 0 ? middle : own, parts[i].element};
      closest = std::min(closest, off);
    }
  }
  return best;
}

/// Every feature with every element.
std::vector<Penetration> all_pairs(const TetMesh& mesh, const TriangleMesh& surface, std::span<const Vec3> x,
                                   bool joins) {
  std::vector<Penetration> found;
  const auto vertices = mesh.boundary_vertices();
  for (Index i = 0; i < std::ssize(vertices); ++i)
    for (Index e = 0; e < mesh.element_count(); ++e)
      if (!share_vertex(std::array{vertices[i]}, mesh.elements()[e]) && !is_inverted_at_the_boundary(mesh, e, x) &&
          locate_in_simplex<3>(corners_of(mesh.elements()[e], x), x[vertices[i]]).inside)
        found.push_back({i, e});
  for (Index i = 0; i < surface.edge_count(); ++i) {
    const auto segment = corners_of(surface.edges()[i], x);
    std::vector<ElementPart> parts;
    for (Index e = 0; e < mesh.element_count(); ++e) {
      if (share_vertex(surface.edges()[i], mesh.elements()[e]) || is_inverted_at_the_boundary(mesh, e, x)) continue;
      if (const auto part = part_inside(segment, corners_of(mesh.elements()[e], x))) parts.push_back({e, *part});
    }
    const auto best = plain_middle_of_parts(mesh, segment, x, parts, joins);
    if (best) found.push_back({static_cast<Index>(vertices.size()) + i, best->element, best->place});
  }
  return found;
}

using Pairs = std::vector<std::pair<Index, Index>>;

/// Every inner vertex, and the centroid of every element, with every element.
std::array<Pairs, 2> all_interior_pairs(const TetMesh& mesh, std::span<const Vec3> x) {
  std::array<Pairs, 2> found;
  for (Index e = 0; e < mesh.element_count(); ++e) {
    if (is_inverted_at_the_boundary(mesh, e, x)) continue;
    const auto& element = mesh.elements()[e];
    const auto holds = [&](const Vec3& p) { return locate_in_simplex<3>(corners_of(element, x), p).inside; };
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      if (mesh.vertex_boundary_faces(v).empty() && !mesh.vertex_elements(v).empty() &&
          !share_vertex(std::array{v}, element) && holds(x[v]))
        found[0].push_back({v, e});
    for (Index other = 0; other < mesh.element_count(); ++other) {
      const auto& [a, b, c, d] = mesh.elements()[other];
      if (!share_vertex(mesh.elements()[other], element) && holds((x[a] + x[b] + x[c] + x[d]) / 4))
        found[1].push_back({other, e});
    }
  }
  for (Pairs& pairs : found) std::sort(pairs.begin(), pairs.end());
  return found;
}

Pairs pairs_of(std::span<const PointInside> points) {
  Pairs pairs;
  for (const auto& [point, element] : points) pairs.push_back({point, element});
  return pairs;
}

void expect_same(std::span<const Penetration> a, std::span<const Penetration> b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].feature, b[i].feature);
    EXPECT_EQ(a[i].element, b[i].element);
    EXPECT_EQ(a[i].middle, b[i].middle);
  }
}

class PenetrationSearchOf : public testing::TestWithParam<solids::Family> {};

TEST_P(PenetrationSearchOf, IsThatOfAllPairsInEveryPoseOfEveryMotion) {
  Random random(seed(1));
  bool joins = true;
  for (const solids::Motion& motion : solids::motions()) {
    SCOPED_TRACE(motion.name);
    joins = !joins;
    Solid solid = GetParam().make(random);
    const TetMesh mesh = solid.mesh();
    const TriangleMesh surface = boundary_surface(mesh);
    PenetrationSearch search(mesh, surface, mesh.boundary_face_count(), true, solid.positions, {}, joins);
    for (std::int64_t step = 0; step < scaled(6); ++step) {
      PenetrationCounters counters;
      search.place(solid.positions);
      const auto expected = all_pairs(mesh, surface, solid.positions, joins);
      const auto found = search.find_all(counters);
      expect_same(found, expected);
      const auto interior = search.find_interior();
      const auto [vertices, centroids] = all_interior_pairs(mesh, solid.positions);
      EXPECT_EQ(pairs_of(interior.vertices), vertices);
      EXPECT_EQ(pairs_of(interior.centroids), centroids);
      std::vector<Index> features;
      for (const Penetration& p : expected)
        if (features.empty() || features.back() != p.feature) features.push_back(p.feature);
      expect_same(search.find(features, counters), expected);
      if (HasFailure()) return;
      motion.move(solid.positions, random);
    }
  }
}

TEST_P(PenetrationSearchOf, FindsTheVerticesThatTheElementsHierarchyFinds) {
  Random random(seed(2));
  Solid solid = GetParam().make(random);
  const TetMesh mesh = solid.mesh();
  const TriangleMesh surface = boundary_surface(mesh);
  PenetrationSearch search(mesh, surface, mesh.boundary_face_count(), false, solid.positions);
  for (int step = 0; step < 5; ++step) {
    for (Vec3& x : solid.positions) x += random.vector(0.05);
    PenetrationCounters counters;
    search.place(solid.positions);
    const auto expected = BoundaryPathFinder<3>(mesh, solid.positions).find_penetrating_vertices();
    const auto found = search.find_all(counters);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(search.vertex_of(found[i].feature), expected[i].source[0]);
      EXPECT_EQ(found[i].element, expected[i].element);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Families, PenetrationSearchOf, testing::ValuesIn(solids::families()),
                         [](const auto& family) { return family.param.name; });

/// Two balls that fly towards each other and turn, apart at first.
struct Flight {
  Solid solid = solids::together({solids::of(make_ball(1, 0.15)), solids::of(make_ball(1, 0.15))});
  std::vector<Vec3> start = solid.positions;

  std::span<const Vec3> at(int step) {
    const std::size_t half = start.size() / 2;
    for (std::size_t i = 0; i < start.size(); ++i) {
      const double side = i < half ? -1 : 1;
      const Eigen::AngleAxisd turn(side * 0.002 * step, Vec3(1, 0.5, 0.2).normalized());
      solid.positions[i] = turn * Vec3(start[i]) + Vec3(side * (1.3 - 0.01 * step), 0, 5.0 * step);
    }
    return solid.positions;
  }
};

TEST(PenetrationSearch, LooksAtFewFeaturesOfAMotionInSmallSteps) {
  Flight flight;
  const TetMesh mesh = flight.solid.mesh();
  const TriangleMesh surface = boundary_surface(mesh);
  PenetrationSearch search(mesh, surface, mesh.boundary_face_count(), true, flight.at(0));
  PenetrationCounters counters;
  std::int64_t held = 0;
  for (int step = 0; step < 60; ++step) {
    search.place(flight.at(step));
    held += std::ssize(search.find_all(counters));
  }
  EXPECT_GT(held, 0);
  EXPECT_EQ(counters.features, 60 * search.feature_count());
  EXPECT_LT(counters.searched, counters.features);
}

TEST(PenetrationSearch, IsTheSameForAnyNumberOfThreads) {
  std::vector<std::vector<Penetration>> first;
  PenetrationCounters first_counters;
  for (const int threads : {1, 2, 4}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    Flight flight;
    const TetMesh mesh = flight.solid.mesh();
    const TriangleMesh surface = boundary_surface(mesh);
    PenetrationSearch search(mesh, surface, mesh.boundary_face_count(), true, flight.at(0));
    PenetrationCounters counters;
    std::vector<std::vector<Penetration>> all;
    for (int step = 30; step < 50; step += 4) {
      search.place(flight.at(step));
      all.push_back(search.find_all(counters));
    }
    if (first.empty()) {
      first = all;
      first_counters = counters;
    }
    ASSERT_EQ(all.size(), first.size());
    for (std::size_t i = 0; i < all.size(); ++i) expect_same(all[i], first[i]);
    EXPECT_EQ(counters.searched, first_counters.searched);
    EXPECT_EQ(counters.elements_tested, first_counters.elements_tested);
    EXPECT_EQ(counters.crossings, first_counters.crossings);
  }
}

const std::array<Vec3, 4> kCorner{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};

TEST(PartInside, ByHandInAllOrders) {
  const std::array<Vec3, 2> through{Vec3{-1, 0.25, 0.25}, Vec3{1, 0.25, 0.25}};  // inside from x = 0 to x = 0.5
  std::array<int, 4> order{0, 1, 2, 3};
  do {
    std::array<Vec3, 4> corners;
    for (int i = 0; i < 4; ++i) corners[i] = kCorner[order[i]];
    const auto part = part_inside(through, corners), back = part_inside({through[1], through[0]}, corners);
    ASSERT_TRUE(part && back);
    EXPECT_DOUBLE_EQ(part->first, 0.5);
    EXPECT_DOUBLE_EQ(part->last, 0.75);
    EXPECT_DOUBLE_EQ(back->first, 0.25);
    EXPECT_DOUBLE_EQ(back->last, 0.5);
    const auto whole = part_inside({Vec3{0.1, 0.1, 0.1}, Vec3{0.3, 0.1, 0.1}}, corners);
    ASSERT_TRUE(whole);
    EXPECT_EQ(whole->first, 0);
    EXPECT_EQ(whole->last, 1);
    EXPECT_FALSE(part_inside({Vec3{-1, 1, 1}, Vec3{1, 1, 1}}, corners));
    EXPECT_FALSE(part_inside({Vec3{-2, 0.25, 0.25}, Vec3{-1, 0.25, 0.25}}, corners));
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST(PartInside, IsWithinWhatSamplesFindInside) {
  Random random(seed(3));
  int inside_count = 0;
  for (std::int64_t n = 0; n < scaled(3000); ++n) {
    std::array<Vec3, 4> corners;
    for (Vec3& x : corners) x = random.vector(1);
    const std::array<Vec3, 2> segment{random.vector(1), random.vector(1)};
    constexpr int kSamples = 200;
    double first = 2, last = -1;
    for (int i = 0; i <= kSamples; ++i) {
      const double t = static_cast<double>(i) / kSamples;
      if (!locate_in_simplex<3>(corners, (1 - t) * segment[0] + t * segment[1]).inside) continue;
      first = std::min(first, t);
      last = std::max(last, t);
    }
    const auto part = part_inside(segment, corners);
    if (first <= last) {
      ++inside_count;
      ASSERT_TRUE(part);
      EXPECT_NEAR(part->first, first, 1.0 / kSamples + 1e-12);
      EXPECT_NEAR(part->last, last, 1.0 / kSamples + 1e-12);
    } else if (part) {
      EXPECT_TRUE(locate_in_simplex<3>(corners, segment[0] + part->middle() * (segment[1] - segment[0])).inside);
    }
  }
  EXPECT_GT(inside_count, 0);
}

/// Whether a segment meets a tetrahedron, in rational arithmetic.
bool meets_exactly(const std::array<Vec3, 2>& segment, const std::array<Vec3, 4>& corners) {
  const int upright = test::rational_orientation<3>(corners);
  test::Rational first = 0, last = 1;
  for (int i = 0; i < 4; ++i) {
    const auto height = [&](const Vec3& p) {
      std::array<test::RationalPoint<3>, 4> of;
      for (int k = 0; k < 4; ++k) of[k] = test::to_rational<3>(k == i ? p : corners[k]);
      return test::Rational(upright * test::signed_volume(of));
    };
    const test::Rational start = height(segment[0]), end = height(segment[1]);
    if (start < 0 && end < 0) return false;
    if (start < 0) first = std::max(first, test::Rational(start / (start - end)));
    if (end < 0) last = std::min(last, test::Rational(start / (start - end)));
  }
  return first <= last;
}

TEST(PartInside, IsNoneBesideATetrahedronHoweverNear) {
  // From a run: an edge passes another one by less than rounding.
  const std::array<Vec3, 2> edge{Vec3{-0x1.4b045a5fefaa4p-1, -0x1.709cbdbebcb09p-3, -0x1.962eab4443fa3p-4},
                                 Vec3{-0x1.2883366de08dfp-1, -0x1.79220663e815fp-3, -0x1.e1b089a027530p-4}};
  const std::array<Vec3, 4> element{Vec3{-0x1.2d5042de9a211p-1, -0x1.bd371af4ad3bdp-3, -0x1.e19875185899bp-4},
                                    Vec3{-0x1.38198d70f6ec5p-1, -0x1.578674978736bp-3, -0x1.b28d39f1b113ap-4},
                                    Vec3{-0x1.4258d483c83bep-1, -0x1.8218cc8edcae6p-3, -0x1.afdf52d571c9ap-4},
                                    Vec3{-0x1.32955b91c0ad4p-1, -0x1.456c5aadb6fa9p-3, -0x1.6bc355b9a14ebp-4}};
  EXPECT_FALSE(meets_exactly(edge, element));
  EXPECT_FALSE(part_inside(edge, element));
  Random random(seed(4));
  int beside = 0;
  for (std::int64_t n = 0; n < scaled(3000); ++n) {
    std::array<Vec3, 4> corners;
    for (Vec3& x : corners) x = random.vector(1);
    const double place = random.unit();
    const Vec3 on_edge = (1 - place) * corners[0] + place * corners[1], way = random.vector(1);
    const std::array<Vec3, 2> segment{on_edge - way, on_edge + way};
    const bool meets = meets_exactly(segment, corners);
    beside += !meets;
    EXPECT_TRUE(meets || !part_inside(segment, corners));
  }
  EXPECT_GT(beside, 0);
}

TEST(PartInside, FlatTetrahedraHoldNothing) {
  const std::array<Vec3, 4> flat{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{1, 1, 0}};
  EXPECT_FALSE(part_inside({Vec3{0.2, 0.2, -1}, Vec3{0.2, 0.2, 1}}, flat));
  EXPECT_FALSE(part_inside({Vec3{0.1, 0.2, 0}, Vec3{0.4, 0.2, 0}}, flat));
}

/// The middle of the part of a segment inside a mesh.
EdgePoint middle_inside(const Solid& solid, const std::array<Vec3, 2>& segment) {
  const TetMesh mesh = solid.mesh();
  std::vector<ElementPart> parts;
  for (Index e = 0; e < mesh.element_count(); ++e)
    if (const auto part = part_inside(segment, corners_of(mesh.elements()[e], solid.positions)))
      parts.push_back({e, *part});
  std::reverse(parts.begin(), parts.end());
  const EdgePoint middle = middle_of_parts(mesh, solid.positions, segment, parts);
  EXPECT_TRUE(locate_in_simplex<3>(corners_of(mesh.elements()[middle.element], solid.positions),
                                   segment[0] + middle.place * (segment[1] - segment[0]))
                  .inside);
  return middle;
}

/// An edge that enters a box from the side a little above its floor, at several places and in several directions: the
/// middle of the part inside does not depend on how the box is cut into elements.
TEST(MiddleOfParts, IsThatOfTheWholeBodyHoweverItIsCut) {
  for (const double cell : {1.0, 0.5, 0.26, 0.1})
    for (const double height : {0.1, 1e-3, 1e-7})
      for (const double y : {0.5, 0.31, 0.77}) {
        const Solid box = solids::of(make_box({1, 1, 1}, cell));
        const std::array<Vec3, 2> enters{Vec3{-1, y, height}, Vec3{0.6, y + 0.1, height}};
        EXPECT_NEAR(middle_inside(box, enters).place, (1 / 1.6 + 1) / 2, 1e-9) << cell << height << y;
        const std::array<Vec3, 2> crosses{Vec3{2, y, height}, Vec3{-0.5, y, height}};
        EXPECT_NEAR(middle_inside(box, crosses).place, 0.6, 1e-9) << cell << height << y;
      }
}

TEST(MiddleOfParts, OfTwoBodiesIsInTheOneCloserToTheMiddle) {
  Solid left = solids::of(make_box({1, 1, 1}, 0.5)), right = left;
  for (Vec3& x : right.positions) x[0] += 1;  // they touch, and have no vertex in common
  const Solid both = solids::together({left, right});
  const std::array<Vec3, 2> through{Vec3{-1, 0.4, 0.3}, Vec3{4, 0.4, 0.3}};
  EXPECT_NEAR(middle_inside(both, through).place, 0.5, 1e-9);
  EXPECT_NEAR(middle_inside(both, {Vec3{-2, 0.4, 0.3}, Vec3{3, 0.4, 0.3}}).place, 0.5, 1e-9);
}

}  // namespace
}  // namespace selvage
