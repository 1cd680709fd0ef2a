// What a pose says of itself, against what is plainly so.
#include "boundary_path/injectivity/deformed_mesh.h"

#include "boundary_path/compare.h"
#include "boundary_path/families/families.h"
#include "boundary_path/injectivity/vertex_proof.h"
#include "test_scale.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>
#include <numbers>

namespace selvage {
namespace {

constexpr double kPi = std::numbers::pi;

template <int D>
struct PosedFamily {
  explicit PosedFamily(std::size_t number)
      : family(families::all_families<D>()[number]),
        mesh(static_cast<Index>(family.mesh.positions.size()), family.mesh.elements),
        topology(mesh),
        pose(mesh, topology) {
    pose.rebuild(family.mesh.positions);
  }

  const families::Family<D>& family;
  SimplexMesh<D> mesh;
  PathTopology<D> topology;
  DeformedMesh<D> pose;

  Vec<D> normal(Index face) const { return face_normal(pose.positions(), mesh.boundary_faces()[face]).normalized(); }
};

/// By how much the link turns around the ridge, in all.
double turn(std::span<const Vec3> x, const VertexTuple<2>& ridge, std::span<const Index> link) {
  const Vec3 axis = (x[ridge[1]] - x[ridge[0]]).normalized();
  double sum = 0;
  for (std::size_t i = 0; i + 1 < link.size(); ++i) {
    const Vec3 a = axis.cross(x[link[i]] - x[ridge[0]]), b = axis.cross(x[link[i + 1]] - x[ridge[0]]);
    sum += std::atan2(a.cross(b).norm(), a.dot(b));
  }
  return sum;
}

double turn(std::span<const Vec2> x, const VertexTuple<1>& ridge, std::span<const Index> link) {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < link.size(); ++i) {
    const Vec2 a = x[link[i]] - x[ridge[0]], b = x[link[i + 1]] - x[ridge[0]];
    sum += std::atan2(std::abs(a[0] * b[1] - a[1] * b[0]), a.dot(b));
  }
  return sum;
}

template <int D>
bool is_immersed(const PosedFamily<D>& c, Index element) {
  return c.pose.component_states()[c.topology.component_of[element]] != ComponentState::kInverted;
}

template <int D>
void check_defects(const PosedFamily<D>& c) {
  std::int64_t inverted = 0, flat = 0, inside = 0, at_boundary = 0;
  for (Index e = 0; e < c.mesh.element_count(); ++e) {
    inverted += c.pose.orientation_of(e) < 0;
    flat += c.pose.orientation_of(e) == 0;
  }
  for (std::int64_t k = 0; k < c.topology.interior_fans.count(); ++k) {
    const auto& fan = c.topology.interior_fans.fans[k];
    std::vector<Index> link(c.topology.interior_fans.link(k).begin(), c.topology.interior_fans.link(k).end());
    link.push_back(link.front());
    inside += is_immersed(c, fan.element) && turn(c.pose.positions(), fan.ridge, link) > 3 * kPi;
  }
  for (std::int64_t k = 0; k < c.topology.boundary_fans.count(); ++k) {
    const auto& fan = c.topology.boundary_fans.fans[k];
    at_boundary += is_immersed(c, fan.element) &&
                   turn(c.pose.positions(), fan.ridge, c.topology.boundary_fans.link(k)) > 2 * kPi + 1e-9;
  }
  const MeshDefects& defects = c.pose.defects();
  EXPECT_EQ(defects.inverted_elements, inverted);
  EXPECT_EQ(defects.degenerate_elements, flat);
  if (c.topology.disagreeing.empty()) {  // a turn that goes back at a fold is no turn
    EXPECT_EQ(defects.overwound_interior_ridges, inside);
    EXPECT_EQ(defects.overwound_boundary_ridges, at_boundary);
  }
  EXPECT_GE(std::ssize(c.pose.defect_places()), inverted + flat);
}

/// Whether the element's corner at a vertex has a direction in its inside.
template <int D>
bool holds_direction(const PosedFamily<D>& c, Index element, Index vertex, const Vec<D>& direction) {
  const auto& ids = c.mesh.elements()[element];
  Eigen::Matrix<double, D, D> edges;
  int column = 0;
  for (Index v : ids)
    if (v != vertex) edges.col(column++) = c.pose.positions()[v] - c.pose.positions()[vertex];
  return (edges.inverse() * direction).minCoeff() > 0;
}

/// Where candidates may be culled, the elements cover no direction twice.
template <int D>
void check_proofs(const PosedFamily<D>& c) {
  test::Random random(7);
  for (Index v : c.mesh.boundary_vertices()) {
    const auto star = c.mesh.vertex_elements(v);
    if (!c.pose.cullable()[v] ||
        c.pose.component_states()[c.topology.component_of[star.front()]] != ComponentState::kImmersed)
      continue;
    for (std::int64_t i = 0; i < test::scaled(20); ++i) {
      Vec<D> direction;
      for (int k = 0; k < D; ++k) direction[k] = random.within(-1, 1);
      int held = 0;
      for (Index e : star) held += holds_direction(c, e, v, direction);
      ASSERT_LE(held, 1) << "vertex " << v;
    }
  }
}

/// The boxes of all primitives hold their vertices, closely.
template <int D, int N>
void check_boxes(const PosedFamily<D>& c, const Bvh& hierarchy, std::span<const VertexTuple<N>> primitives) {
  const double slack = 8 * double{c.pose.rounding()} + 1e-30;
  for (const BvhNode& node : hierarchy.nodes()) {
    for (int i = 0; i < node.child_count; ++i) {
      if (node.children[i] < 0) continue;
      for (int axis = 0; axis < D; ++axis) {
        double lower = HUGE_VAL, upper = -HUGE_VAL;
        for (Index v : primitives[node.children[i]]) {
          lower = std::min(lower, c.pose.positions()[v][axis] - c.pose.box_origin().position[axis]);
          upper = std::max(upper, c.pose.positions()[v][axis] - c.pose.box_origin().position[axis]);
        }
        ASSERT_LE(node.lower[axis][i], lower);
        ASSERT_GE(node.upper[axis][i], upper);
        ASSERT_GE(node.lower[axis][i], lower - slack);
        ASSERT_LE(node.upper[axis][i], upper + slack);
      }
    }
  }
}

template <int D>
void list_faces_below(const PosedFamily<D>& c, Index child, std::vector<Index>& faces) {
  if (child >= 0) return faces.push_back(child);
  const BvhNode& node = c.pose.faces().nodes()[~child];
  for (int i = 0; i < node.child_count; ++i) list_faces_below(c, node.children[i], faces);
}

/// The cone of every child holds all that ConeNode promises; returns how many children have one.
template <int D>
std::int64_t check_cones(const PosedFamily<D>& c) {
  std::int64_t bounded = 0;
  for (std::size_t n = 0; n < c.pose.faces().nodes().size(); ++n) {
    const BvhNode& node = c.pose.faces().nodes()[n];
    const ConeNode& cones = c.pose.cones()[n];
    for (int i = 0; i < node.child_count; ++i) {
      if (cones.cosine[i] == 0) {
        EXPECT_EQ(cones.sine[i], 0);
        EXPECT_EQ(cones.two_sided >> i & 1, 0u);
        continue;
      }
      ++bounded;
      EXPECT_NEAR(std::hypot(cones.cosine[i], cones.sine[i]), 1, 1e-6);
      EXPECT_EQ((cones.two_sided >> i & 1) != 0, cones.cosine[i] < std::sqrt(0.5) + 1e-5);
      std::vector<Index> faces;
      list_faces_below(c, node.children[i], faces);
      for (Index face : faces)
        for (Index v : c.mesh.boundary_faces()[face]) {
          EXPECT_TRUE(c.pose.cullable()[v]);
          for (Index other : c.mesh.vertex_boundary_faces(v)) {
            const Vec<D> normal = c.normal(other);
            double cosine = 0;
            for (int k = 0; k < D; ++k) cosine += normal[k] * cones.axis[k][i];
            EXPECT_GE(cosine, cones.cosine[i]);
          }
        }
    }
  }
  return bounded;
}

template <int D>
void check_case(const PosedFamily<D>& c) {
  check_defects(c);
  check_proofs(c);
  check_boxes<D, D + 1>(c, c.pose.elements(), c.mesh.elements());
  check_boxes<D, D>(c, c.pose.faces(), c.mesh.boundary_faces());
  check_cones(c);
}

template <int D>
void expect_same(const DeformedMesh<D>& a, const DeformedMesh<D>& b) {
  EXPECT_EQ(std::memcmp(&a.defects(), &b.defects(), sizeof(MeshDefects)), 0);
  ASSERT_TRUE(std::equal(a.cullable().begin(), a.cullable().end(), b.cullable().begin()));
  ASSERT_EQ(a.defect_places().size(), b.defect_places().size());
}

/// The same after an update from another pose, and with any number of threads, also in the nodes.
template <int D>
void check_updates(const PosedFamily<D>& c) {
  auto elsewhere = c.family.mesh.positions;
  for (auto& x : elsewhere) x = (x * 0.25).reverse().eval();
  DeformedMesh<D> pose(c.mesh, c.topology);
  pose.rebuild(elsewhere);
  pose.update_elements(c.family.mesh.positions);
  pose.update_faces();
  expect_same(pose, c.pose);
  for (const std::size_t threads : {1, 2, 4}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    DeformedMesh<D> other(c.mesh, c.topology);
    other.rebuild(c.family.mesh.positions);
    other.update_elements(c.family.mesh.positions);
    other.update_faces();
    expect_same(other, c.pose);
    EXPECT_EQ(
        std::memcmp(other.faces().nodes().data(), c.pose.faces().nodes().data(), c.pose.faces().nodes().size_bytes()),
        0);
    EXPECT_EQ(std::memcmp(other.elements().nodes().data(), c.pose.elements().nodes().data(),
                          c.pose.elements().nodes().size_bytes()),
              0);
    EXPECT_EQ(std::memcmp(other.cones().data(), c.pose.cones().data(), c.pose.cones().size_bytes()), 0);
  }
}

class PlanarPose : public testing::TestWithParam<std::size_t> {};
class SolidPose : public testing::TestWithParam<std::size_t> {};

TEST_P(PlanarPose, KnowsItself) {
  check_case(PosedFamily<2>(GetParam()));
}
TEST_P(SolidPose, KnowsItself) {
  check_case(PosedFamily<3>(GetParam()));
}
TEST_P(PlanarPose, IsTheSameAfterUpdatesAndWithAnyThreads) {
  check_updates(PosedFamily<2>(GetParam()));
}
TEST_P(SolidPose, IsTheSameAfterUpdatesAndWithAnyThreads) {
  check_updates(PosedFamily<3>(GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Families, PlanarPose, testing::Range<std::size_t>(0, families::planar_families().size()),
                         families::family_name<2>);
INSTANTIATE_TEST_SUITE_P(Families, SolidPose, testing::Range<std::size_t>(0, families::solid_families().size()),
                         families::family_name<3>);

/// Most of an ordinary mesh is proven, and most children of its hierarchy have cones: nothing is vacuous.
TEST(DeformedMesh, ProvesOrdinaryVertices) {
  const auto& all = families::solid_families();
  const auto number = std::find_if(all.begin(), all.end(), [](const auto& f) { return f.name == "jittered"; });
  const PosedFamily<3> c(number - all.begin());
  std::int64_t cullable = 0;
  for (Index v : c.mesh.boundary_vertices()) cullable += c.pose.cullable()[v];
  EXPECT_GT(cullable, 0.9 * std::ssize(c.mesh.boundary_vertices()));
  EXPECT_GT(check_cones(c), c.mesh.boundary_face_count() / 3);
}

/// Every rim of a closed surface goes around its vertex once, counter-clockwise as seen from outside.
TEST(DeformedMesh, ListsRims) {
  const families::Pieces<3> pieces = families::grid(3, 4, 5);
  const TetMesh mesh(static_cast<Index>(pieces.positions.size()), pieces.elements);
  const Rims rims(mesh);
  EXPECT_TRUE(rims.others.empty());
  std::vector<Index> seen;
  for (const RimBatch& batch : rims.batches) {
    for (int i = 0; i < batch.count; ++i) {
      const Index v = rims.vertices[batch.first + i];
      seen.push_back(v);
      EXPECT_EQ(mesh.vertex_boundary_faces(v).size(), static_cast<std::size_t>(batch.length));
      for (int k = 0; k < batch.length; ++k) {
        const Index from = rims.vertices[batch.first + 8 * (k + 1) + i];
        const Index to = rims.vertices[batch.first + 8 * ((k + 1) % batch.length + 1) + i];
        const auto has_corner = [&](Index face) {
          const auto& f = mesh.boundary_faces()[face];
          const int at = static_cast<int>(std::find(f.begin(), f.end(), v) - f.begin());
          return f[(at + 1) % 3] == from && f[(at + 2) % 3] == to;
        };
        const auto star = mesh.vertex_boundary_faces(v);
        EXPECT_EQ(std::count_if(star.begin(), star.end(), has_corner), 1);
      }
    }
  }
  std::sort(seen.begin(), seen.end());
  EXPECT_TRUE(std::equal(seen.begin(), seen.end(), mesh.boundary_vertices().begin(), mesh.boundary_vertices().end()));
}

TEST(DeformedMesh, KnowsWhetherNeighboursAgree) {
  std::vector<VertexTuple<4>> elements = {{0, 1, 2, 3}, {1, 4, 2, 3}};
  EXPECT_TRUE(PathTopology<3>(TetMesh(5, elements)).disagreeing.empty());
  std::swap(elements[1][0], elements[1][1]);
  EXPECT_EQ(PathTopology<3>(TetMesh(5, elements)).disagreeing.size(), 1u);
  std::vector<VertexTuple<3>> triangles = {{0, 1, 2}, {2, 1, 3}};
  EXPECT_TRUE(PathTopology<2>(PlanarMesh(4, triangles)).disagreeing.empty());
  std::swap(triangles[1][0], triangles[1][1]);
  EXPECT_EQ(PathTopology<2>(PlanarMesh(4, triangles)).disagreeing.size(), 1u);
}

}  // namespace
}  // namespace selvage
